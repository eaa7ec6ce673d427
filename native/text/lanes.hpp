// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as many lanes wide as the instruction set of this translation unit allows, and what the kernels do with them.
//
// The files that include this one are compiled once per instruction set, each time into a namespace of its own,
// SFUMATO_ISA; dispatch.hpp chooses among them at run time. Everything here has internal linkage, and so has the text
// (text.hpp) made of it: no function compiled for a newer processor can replace its twin in code that runs on every
// processor.
#pragma once

#include "scene/affine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>

#include <glm/vec3.hpp>
#include <xsimd/xsimd.hpp>

namespace sfumato::SFUMATO_ISA {
namespace {

using Real = xsimd::batch<float>;
using Index = xsimd::batch<std::int32_t>;
using Bits = xsimd::batch<std::uint32_t>;

// xsimd's own names a batch in some versions, and its numbers in others.
template <class To, class From>
To same_bits(const From &from) {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    std::memcpy(&to, &from, sizeof to);
    return to;
}

// What text::OneLane is for one lane.
struct Isa {
    static constexpr int LANES = static_cast<int>(Real::size);

    static Real load(const float *lanes) { return Real::load_aligned(lanes); }
    static void store(Real x, float *lanes) { x.store_aligned(lanes); }
    static Real pick(xsimd::batch_bool<float> condition, Real a, Real b) { return xsimd::select(condition, a, b); }
    static bool any_lane(xsimd::batch_bool<float> condition) { return xsimd::any(condition); }

    // xsimd 8 has no horizontal minimum yet.
    static float lowest_lane(Real x) {
        alignas(64) float lanes[LANES];
        x.store_aligned(lanes);
        return *std::min_element(lanes, lanes + LANES);
    }

    // The processor's estimate and one step of Newton's: a few units in the last place, at a quarter of the exact
    // price.
    static Real inversesqrt(Real x) {
#ifdef __AVX512F__
        const Real y = _mm512_rsqrt14_ps(x); // xsimd 8 names an instruction that does not exist
#else
        const Real y = xsimd::rsqrt(x);
#endif
        return y * (1.5F - 0.5F * x * y * y);
    }

    // Of numbers that are neither 0 nor infinite, likewise.
    static Real reciprocal(Real x) {
#ifdef __AVX512F__
        const Real y = _mm512_rcp14_ps(x);
#else
        const Real y = xsimd::reciprocal(x);
#endif
        return y * (2.0F - x * y);
    }

    // xsimd's own takes several branches and computes them all. Of the smaller over the larger, a polynomial t P(t^2):
    // our fit by least squares with Lawson's weights, 1e-9 before rounding. (0, 0) gives 0.
    static Real atan(Real y, Real x) {
        constexpr float P[] = {0.999999981F,   -0.333331802F, 0.199964341F,   -0.142472045F,  0.108779404F,
                               -0.0821360064F, 0.0550257995F, -0.0284887934F, 0.00956639632F, -0.00150911243F};
        const Real ax = xsimd::abs(x), ay = xsimd::abs(y);
        const Real t = xsimd::min(ax, ay) / xsimd::max(xsimd::max(ax, ay), Real(1e-37F)), t2 = t * t;
        Real sum = P[9];
        for (int k = 8; k >= 0; --k) {
            sum = xsimd::fma(sum, t2, Real(P[k]));
        }
        const Real steep = pick(ay > ax, 1.57079632679489662F - t * sum, t * sum);
        const Real turned = pick(x < 0.0F, 3.14159265358979324F - steep, steep);
        return xsimd::copysign(turned, y);
    }

    // A power series where the quotient's logarithm would cancel.
    static Real atanh(Real x) {
        const Real x2 = x * x;
        const Real series =
            x *
            (1.0F + x2 * (1.0F / 3.0F + x2 * (0.2F + x2 * (1.0F / 7.0F + x2 * (1.0F / 9.0F + x2 * (1.0F / 11.0F))))));
        const Real quotient = (1.0F + x) / xsimd::max(1.0F - x, Real(1e-37F));
        return pick(x2 < 0.04F, series, 0.5F * xsimd::log(quotient));
    }

    // xsimd 8 has no conversion from Bits. Of two halves, which are exact, the sum is rounded once.
    template <class To>
    static Real real_of(Bits x) {
#ifdef __AVX512F__
        return _mm512_cvtepu32_ps(x);
#else
        const Index high = same_bits<Index>(x >> 16), low = same_bits<Index>(x & Bits(0xffffU));
        return xsimd::to_float(high) * 65536.0F + xsimd::to_float(low);
#endif
    }
    static Bits uint_of(Real x) {
        return same_bits<Bits>(xsimd::to_int(x));
    }
    static Bits float_bits(Real x) {
        return same_bits<Bits>(x);
    }
    static Bits rotated(Bits x, int left) {
#ifdef __AVX512F__
        return _mm512_rolv_epi32(x, _mm512_set1_epi32(left));
#else
        return (x << left) | (x >> (32 - left));
#endif
    }
    static Real negated(Real x, Bits highest) {
        return same_bits<Real>(same_bits<Bits>(x) ^ (highest & Bits(0x80000000U)));
    }
    // Nor one from masks of Bits, so that this compares numbers.
    static xsimd::batch_bool<float> none_of(Bits x, std::uint32_t bits) {
#ifdef __AVX512F__
        return xsimd::batch_bool<float>(_mm512_testn_epi32_mask(x, Bits(bits)));
#else
        return xsimd::to_float(same_bits<Index>(x & Bits(bits))) == Real(0.0F);
#endif
    }
};

constexpr int LANES = Isa::LANES;
#include "text/vocabulary.inc"

// 0, 1, 2, ... : the number of each lane.
inline Real lane_numbers() {
    alignas(64) float numbers[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        numbers[lane] = static_cast<float>(lane);
    }
    return Real::load_aligned(numbers);
}

inline float lowest(Real x) {
    return Isa::lowest_lane(x);
}

inline float sum(Real x) {
    alignas(64) float lanes[LANES];
    x.store_aligned(lanes);
    return std::accumulate(lanes, lanes + LANES, 0.0F);
}

inline float highest(Real x) {
    return -lowest(-x);
}

// xsimd 8 means to use the processor's own instruction, but never matches its own overload and inserts one lane after
// another. With sixteen lanes that was most of a frame's light maps. With eight the instruction gains a fifth, and
// where microcode guards it (Intel, 2023) it is slow, so there it stays as it is.
inline Real gather(const float *source, Index index) {
#ifdef __AVX512F__
    return _mm512_i32gather_ps(index, source, sizeof(float));
#else
    return Real::gather(source, index);
#endif
}
inline Index gather(const std::int32_t *source, Index index) {
#ifdef __AVX512F__
    return _mm512_i32gather_epi32(index, source, sizeof(std::int32_t));
#else
    return Index::gather(source, index);
#endif
}
inline Index truncate(Real x) {
    return xsimd::to_int(x);
}
inline vec3 broadcast(const glm::vec3 &v) {
    return {Real(v.x), Real(v.y), Real(v.z)};
}

inline vec3 transform_point(const Affine &m, const vec3 &p) {
    return {p.x * m.rows[0][0] + p.y * m.rows[0][1] + p.z * m.rows[0][2] + m.rows[0][3],
            p.x * m.rows[1][0] + p.y * m.rows[1][1] + p.z * m.rows[1][2] + m.rows[1][3],
            p.x * m.rows[2][0] + p.y * m.rows[2][1] + p.z * m.rows[2][2] + m.rows[2][3]};
}

inline vec3 transform_vector(const Affine &m, const vec3 &v) {
    return {v.x * m.rows[0][0] + v.y * m.rows[0][1] + v.z * m.rows[0][2],
            v.x * m.rows[1][0] + v.y * m.rows[1][1] + v.z * m.rows[1][2],
            v.x * m.rows[2][0] + v.y * m.rows[2][1] + v.z * m.rows[2][2]};
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
