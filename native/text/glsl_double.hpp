// SPDX-License-Identifier: GPL-3.0-or-later
// The formulas of area lights as C++ in double precision, one lane wide.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sfumato::glsl_double {
namespace {

using Real = double;
using vec3 = glm::dvec3;
constexpr int LANES = 1;
using glm::cross;
using glm::dot;
using std::abs;
using std::atanh;
using std::clamp;
using std::cos;
using std::exp;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::sin;
using std::sqrt;

inline bool any_lane(bool condition) {
    return condition;
}
inline double reciprocal(double x) {
    return 1.0 / x;
}
inline double inversesqrt(double x) {
    return 1.0 / std::sqrt(x);
}
inline double atan(double y, double x) {
    return std::atan2(y, x);
}

// The text's literals are single: it mixes them with doubles.
inline double min(double a, float b) {
    return std::min(a, double{b});
}
inline double max(double a, float b) {
    return std::max(a, double{b});
}
inline double clamp(double x, float low, float high) {
    return std::clamp(x, double{low}, double{high});
}
inline double pow(double x, float y) {
    return std::pow(x, double{y});
}
inline double atan(double y, float x) {
    return std::atan2(y, double{x});
}
inline double pick(bool condition, double a, double b) {
    return condition ? a : b;
}
inline vec3 pick(bool condition, const vec3 &a, const vec3 &b) {
    return condition ? a : b;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#define float double // NOLINT(clang-diagnostic-keyword-macro): the text is GLSL
#include "text/glsl_area_light.inc"
#undef float
#pragma GCC diagnostic pop

} // namespace
} // namespace sfumato::glsl_double
