// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers of what is measured: of a seed, and of what a number is for. The same everywhere.
#pragma once

#include <cstdint>

namespace sfumato {

// SplitMix64 (Steele, Lea and Flood 2014) of numbers that tell what a number is for.
inline std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

struct Random {
    std::uint64_t state;

    Random(std::uint64_t seed, std::uint64_t subject, std::uint64_t number)
        : state(mixed(mixed(mixed(seed) ^ subject) ^ number)) {}
    double operator()() { // in [0, 1)
        state = mixed(state);
        return static_cast<double>(state >> 11U) * 0x1p-53;
    }
};

enum RandomSubject : std::uint64_t { PLACES = 1, LIGHTS = 2, PIXELS = 3 };

} // namespace sfumato
