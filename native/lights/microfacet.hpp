// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by microfacets (shaders/surfaces/microfacet_lights.glsl): batches for the console, for tests
// and charts.
#pragma once

#include "lights/area_light.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfumato {

enum class Brdf { GGX, BECKMANN, BLINN_PHONG };

// Lights as in LightBatch, but all in the frame of the shading point: the normal is z.
template <typename Number>
struct MicrofacetBatch {
    LightShape shape = LightShape::POLYGON;
    Brdf brdf = Brdf::GGX;
    std::size_t count = 0;
    const Number *lights = nullptr;
    std::size_t width = 0;                  // numbers a light
    const std::int32_t *vertices = nullptr; // of each polygon, or null where all have width / 3
    PerLight<Number> view, alpha;           // alpha_x and alpha_y
    Number index = 0;                       // of refraction, for Fresnel's curve; 0: Schlick's
    // Two numbers a light: all that is reflected for F = 1, and the same weighted by Fresnel's share of v.h.
    Number *out = nullptr;
};

// As many lights at a time as this processor has lanes; and one at a time in double precision.
void reflect(const MicrofacetBatch<float> &batch);
void reflect(const MicrofacetBatch<double> &batch);

// The pairs of `out` as a reflectance of `f0` straight on mixes them, one number a light.
void mix_fresnel(std::vector<float> &out, float f0);
void mix_fresnel(std::vector<double> &out, double f0);

} // namespace sfumato
