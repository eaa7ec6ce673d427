// SPDX-License-Identifier: GPL-3.0-or-later
// A light ray's transmittance in 20 bytes, once all its absorbers are known: shaders/rays/curve.glsl for batches of
// rays.
#pragma once

#include "rays/basis.hpp"

namespace sfumato {

constexpr std::size_t CURVE_KNOTS = 7; // between the two ends, which the head holds
constexpr std::size_t CURVE_BYTES = HEAD_BYTES + 2 * CURVE_KNOTS;

struct CurveVertex {
    double z = 0.0;
    double t = 1.0; // transmittance
};

// The exact transmittance of a ray as straight lines, from 1 before its first absorber to the total behind its last.
// Flat absorbers are steps; slabs may overlap. Exponentials are lines of at most an eighth of optical depth.
std::vector<CurveVertex> exact_curve(const Absorbers &absorbers);

// The curve with the least mean square error over depth that was found: vertices are taken away one by one, always the
// one that costs least; then depths are rounded, and the values at the remaining knots are fitted and rounded.
// Depths must not fall and transmittance must not rise. The far end stays exact.
void fit_curve(std::span<const CurveVertex> vertices, std::span<std::uint8_t> texel);

// The transmittance of as many rays as there are texels, each at its share of `depth`.
void curve_transmittance(std::span<const std::uint8_t> texels, std::span<const float> depth, std::span<float> out);

} // namespace sfumato
