// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/*.glsl as C++, as many lanes wide as the instruction set of this translation unit allows.
//
// The files that include this one are compiled once per instruction set, each time into a namespace of its own,
// SFUMATO_ISA; dispatch.cpp chooses among them at run time. Everything here has internal linkage, so that no function
// compiled for a newer processor can replace its twin in code that runs on every processor.
#pragma once

#include "kernels.hpp"

#include <algorithm>
#include <cstdint>

#include <glm/vec3.hpp>
#include <xsimd/xsimd.hpp>

namespace sfumato::SFUMATO_ISA {
namespace {

using Real = xsimd::batch<float>;
using Index = xsimd::batch<std::int32_t>;
using Mask = xsimd::batch_bool<float>;
using vec3 = glm::vec<3, Real>;
constexpr int LANES = static_cast<int>(Real::size);

// Plain functions rather than xsimd's templates, so that a float among lanes converts by itself.
inline Real abs(Real x) {
    return xsimd::abs(x);
}
inline Real ceil(Real x) {
    return xsimd::ceil(x);
}
inline Real floor(Real x) {
    return xsimd::floor(x);
}
inline Real cos(Real x) {
    return xsimd::cos(x);
}
inline Real sin(Real x) {
    return xsimd::sin(x);
}
inline Real log(Real x) {
    return xsimd::log(x);
}
inline Real sqrt(Real x) {
    return xsimd::sqrt(x);
}
inline Real min(Real a, Real b) {
    return xsimd::min(a, b);
}
inline Real max(Real a, Real b) {
    return xsimd::max(a, b);
}
inline Real clamp(Real x, Real low, Real high) {
    return xsimd::min(xsimd::max(x, low), high);
}
inline Real pick(Mask condition, Real a, Real b) {
    return xsimd::select(condition, a, b);
}
inline Real exp(Real x) {
    return xsimd::exp(x);
}
inline Real dot(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline vec3 cross(vec3 a, vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#define float Real
#include "glsl_text.inc"
#undef float
#pragma GCC diagnostic pop

// 0, 1, 2, ... : the number of each lane.
inline Real lane_numbers() {
    alignas(64) float numbers[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        numbers[lane] = static_cast<float>(lane);
    }
    return Real::load_aligned(numbers);
}

// xsimd 8 has no horizontal minimum yet.
inline float lowest(Real x) {
    alignas(64) float lanes[LANES];
    x.store_aligned(lanes);
    return *std::min_element(lanes, lanes + LANES);
}

inline float highest(Real x) {
    return -lowest(-x);
}

inline Real gather(const float *source, Index index) {
    return Real::gather(source, index);
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
