// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/*.glsl as C++, one lane wide.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sfumato::glsl {
namespace {

using glm::cross;
using glm::dot;
using glm::vec3;
using std::abs;
using std::atanh;
using std::ceil;
using std::clamp;
using std::cos;
using std::exp;
using std::floor;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::sin;
using std::sqrt;

inline float pick(bool condition, float a, float b) {
    return condition ? a : b;
}
inline vec3 pick(bool condition, const vec3 &a, const vec3 &b) {
    return condition ? a : b;
}
inline bool any_lane(bool condition) {
    return condition;
}
inline float reciprocal(float x) {
    return 1.0F / x;
}
inline float inversesqrt(float x) {
    return 1.0F / std::sqrt(x);
}
inline float atan(float y, float x) {
    return std::atan2(y, x);
}

// The text is one vocabulary for many users: no file uses all of it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include "text/glsl_text.inc"
#pragma GCC diagnostic pop

} // namespace
} // namespace sfumato::glsl
