// SPDX-License-Identifier: GPL-3.0-or-later
// Textures that are formulas: see text.hpp.
#pragma once

#include "text/text.hpp"

#include <cstdint>

namespace sfumato::text {

template <class Real, class Isa = OneLane>
struct TexturesText {
#include "text/vocabulary.inc"

    // Whole numbers of 32 bits, which wrap around: GLSL's uint. Mask is its bool.
    using Bits = decltype(Isa::uint_of(Real()));

    static inline Real trunc(Real x) {
        using std::trunc;
        return trunc(x);
    }
    // GLSL's float(x).
    static inline Real real_of(Bits x) {
        return Isa::template real_of<Real>(x);
    }
    static inline Real real_of(int x) {
        return Real(static_cast<float>(x));
    }
    // uint(int(x)), of a whole number.
    static inline Bits uint_of(Real x) {
        return Isa::uint_of(x);
    }
    // floatBitsToUint(x).
    static inline Bits float_bits(Real x) {
        return Isa::float_bits(x);
    }
    // (x << left) | (x >> (32 - left)).
    static inline Bits rotated(Bits x, int left) {
        return Isa::rotated(x, left);
    }
    // Negated where the highest bit is set: uintBitsToFloat(floatBitsToUint(x) ^ (highest & 0x80000000u)).
    static inline Real negated(Real x, Bits highest) {
        return Isa::negated(x, highest);
    }
    // (x & bits) == 0u.
    static inline Mask none_of(Bits x, std::uint32_t bits) {
        return Isa::none_of(x, bits);
    }

#define float Real // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#define uint Bits
// Each after what it needs.
// clang-format off
#include "../../shaders/textures/hashes.glsl"
#include "../../shaders/textures/noise.glsl"
#include "../../shaders/textures/voronoi.glsl"
#include "../../shaders/textures/patterns.glsl"
// clang-format on
#undef uint
#undef float
};

} // namespace sfumato::text
