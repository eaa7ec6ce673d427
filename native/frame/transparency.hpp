// SPDX-License-Identifier: GPL-3.0-or-later
// Transparent fragments composited without sorting, as the GPU does (shaders/frame/oit.glsl), after what it keeps of a
// pixel was rounded to what it is kept in: for the console, for tests and for the planner. A frame of the CPU sorts.
#pragma once

#include <cstddef>
#include <span>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace sfumato {

// Of one pixel, in any order. Depth in [0, 1]; an opacity of 0 is no fragment.
struct PixelFragments {
    std::span<const float> depth, alpha;
    std::span<const glm::vec3> colour;
};

constexpr std::size_t MOST_NEAREST = 8, MOST_HARMONICS = 31;

// All of them: radiance, premultiplied, and opacity.
glm::vec4 composite_nearest(const PixelFragments &pixel, std::size_t nearest, std::size_t harmonics);
glm::vec4 composite_fourier(const PixelFragments &fragments, std::size_t terms, float sigma);
glm::vec4 composite_weighted(const PixelFragments &fragments);

// Multiplies a Fourier series (a0, a1, b1, ...) by its sigma factors to the p-th power.
void average_series(std::span<float> coefficients, float p);

} // namespace sfumato
