// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/**.glsl as C++: one class template for each room of the text, whose members are the text itself.
//
//     using RaysText = text::RaysText<float>;
//     const RaysText::Harmonic first = RaysText().harmonic(1.0F, z);
//
// The second parameter tells the code of different instruction sets apart. In *_lanes.cpp it has no linkage beyond the
// file (lanes.hpp), so that no function compiled for a newer processor can replace its twin in code that runs on all.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

namespace sfumato::text {

// One number at a time, float or double, on any processor.
struct OneLane {
    static constexpr int LANES = 1;

    template <class Real>
    static Real load(const Real *lanes) {
        return *lanes;
    }
    template <class Real>
    static void store(Real x, Real *lanes) {
        *lanes = x;
    }
    template <class Real>
    static Real inversesqrt(Real x) {
        return Real(1) / std::sqrt(x);
    }
    template <class Real>
    static Real reciprocal(Real x) {
        return Real(1) / x;
    }
    template <class Real>
    static Real atan(Real y, Real x) {
        return std::atan2(y, x);
    }
    template <class Real>
    static Real atanh(Real x) {
        return std::atanh(x);
    }
    template <class Real>
    static Real pick(bool condition, Real a, Real b) {
        return condition ? a : b;
    }
    static bool any_lane(bool condition) { return condition; }
    template <class Real>
    static Real lowest_lane(Real x) {
        return x;
    }

    // Whole numbers of 32 bits: TexturesText says what for.
    template <class Real>
    static Real real_of(std::uint32_t x) {
        return static_cast<Real>(x);
    }
    // What an int cannot hold is 0.
    template <class Real>
    static std::uint32_t uint_of(Real x) {
        return x > Real(-2147483648.0) && x < Real(2147483648.0)
                   ? static_cast<std::uint32_t>(static_cast<std::int32_t>(x))
                   : 0U;
    }
    template <class Real>
    static std::uint32_t float_bits(Real x) {
        return std::bit_cast<std::uint32_t>(static_cast<float>(x));
    }
    static std::uint32_t rotated(std::uint32_t x, int left) { return std::rotl(x, left); }
    template <class Real>
    static Real negated(Real x, std::uint32_t highest) {
        return (highest >> 31U) != 0U ? -x : x;
    }
    static bool none_of(std::uint32_t x, std::uint32_t bits) { return (x & bits) == 0U; }
};

} // namespace sfumato::text
