// SPDX-License-Identifier: GPL-3.0-or-later
// The values of one node of a .vdb file's tree: found, unpacked, as floats.
#pragma once

#include "scene/vdb_file.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sfumato {

// One bit for each place of a node, in the file's bytes.
class VdbMask {
public:
    VdbMask() = default;
    VdbMask(VdbSource &source, int places) : bytes(source.take(places / 8)), words(places / 64) {}

    [[nodiscard]] std::uint64_t word(int index) const {
        std::uint64_t value = 0;
        std::memcpy(&value, bytes + std::ptrdiff_t{8} * index, sizeof value);
        return value;
    }
    [[nodiscard]] bool on(int place) const { return ((word(place / 64) >> (place % 64)) & 1U) != 0; }
    [[nodiscard]] int count() const;
    [[nodiscard]] int places() const { return 64 * words; }

    // use(place) of all that are on, in order.
    template <typename Use>
    void for_each(const Use &use) const;

private:
    const std::byte *bytes = nullptr;
    int words = 0;
};

// Where they lie in the file's bytes, and what stands in place of those that are not there.
struct VdbValues {
    VdbMask active;                  // the only ones that are stored, unless all are
    int stored = 0;                  // numbers
    bool packed = false;             // compressed
    std::span<const std::byte> data; // of the stored ones
    float inactive[2]{0.0F, 0.0F};   // which of them, `second` says
    VdbMask second;                  // nowhere where it has no places
};

// The values of a node from where the source is, which is behind them then. Throws std::runtime_error where they are
// not all there.
VdbValues find_values(VdbSource &source, const VdbNumbers &numbers, const VdbMask &active, float background);
// Those of a leaf of bools, which has a form of its own.
VdbValues find_bools(VdbSource &source, const VdbMask &active);

// The next number of the source.
float read_value(VdbSource &source, const VdbNumbers &numbers);

// Unpacks values. Not for two threads at once.
class VdbUnpacker {
public:
    explicit VdbUnpacker(const VdbNumbers &those) : numbers(those) {}

    // One for each place of the node. Throws std::runtime_error where they cannot be unpacked.
    void unpack(const VdbValues &values, std::span<float> out);

private:
    VdbNumbers numbers;
    std::vector<std::byte> plain, shuffled;
    std::vector<float> stored;
};

template <typename Use>
void VdbMask::for_each(const Use &use) const {
    for (int index = 0; index < words; ++index) {
        for (std::uint64_t left = word(index); left != 0; left &= left - 1) {
            use(64 * index + std::countr_zero(left));
        }
    }
}

} // namespace sfumato
