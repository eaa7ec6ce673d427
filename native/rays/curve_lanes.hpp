// SPDX-License-Identifier: GPL-3.0-or-later
// Texels of 20 bytes (basis.hpp, curve.hpp) in lanes, each lane a texel of its own.
#pragma once

#include "rays/ray_kernels.hpp"
#include "rays/series_lanes.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

inline void read_words(const std::int32_t *texels, Index first, Index word[RAY_WORDS]) {
    for (int w = 0; w < RAY_WORDS; ++w) {
        word[w] = Index::gather(texels + w, first);
    }
}

inline Index byte_of(Index word, int byte) {
    return (word >> (8 * byte)) & Index(255);
}

// The range in 16 bits each, and the total as a half float, not negative.
struct Head {
    DepthRange range;
    Real total;
};

inline Head head_of(Index low_high, Index total) {
    Head head;
    const Index low = low_high & Index(65535), high = (low_high >> 16) & Index(65535);
    head.range.low = RaysText().stored_depth(xsimd::to_float(low));
    head.range.high = RaysText().stored_depth(xsimd::to_float(high));
    const Index exponent = (total >> 10) & Index(31), mantissa = total & Index(1023);
    const Real scale = xsimd::ldexp(Real(1.0F), xsimd::max(exponent, Index(1)) - Index(25));
    head.total = (xsimd::to_float(mantissa) + pick(xsimd::to_float(exponent) > 0.5F, 1024.0F, 0.0F)) * scale;
    return head;
}

// The transmittance at depth z of the curve whose words begin at `first`.
inline Real curve_at(const std::int32_t *texels, Index first, Real z) {
    Index word[RAY_WORDS];
    read_words(texels, first, word);
    const Head head = head_of(word[0], word[1]);
    const Real d = RaysText().relative_depth(head.range, z), total = RaysText().transmittance_of(head.total);
    RaysText::CurveSegment segment = RaysText().curve_start();
    Real depth_left(1.0F), share_left(1.0F);
#pragma GCC unroll 7
    for (int k = 0; k < 7; ++k) {
        const int z_at = 6 + k, t_at = 13 + k;
        depth_left = RaysText().next_left(depth_left, xsimd::to_float(byte_of(word[z_at / 4], z_at % 4)));
        share_left = RaysText().next_left(share_left, xsimd::to_float(byte_of(word[t_at / 4], t_at % 4)));
        segment = RaysText().curve_step(segment, d, depth_left, share_left);
    }
    return RaysText().curve_transmittance(z, head.range, RaysText().curve_inside(segment, d, total), total);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
