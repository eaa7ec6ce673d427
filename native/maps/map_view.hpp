// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/affine.hpp"

namespace sfumato {

// A light map: of each texel's ray the column density, as a series of `count` half-range cosines over the ray's own
// range of depths (shaders/rays/basis.glsl), and the depth of the first solid on it (infinite where there is none). A
// texel is HEAD_FLOATS + count - 1 floats: the total, where the range begins, one over its extent, and a_k / (pi k) for
// k = 1, ... Texel centres are at (i + 1/2) / width. A map of light from one direction is affine in the world. One of
// light from one point has a rectangle of the octahedral square across (shaders/lights/light.glsl) and the distance to
// the point along. Owns nothing.
constexpr int HEAD_FLOATS = 3;
struct LightMapView {
    [[nodiscard]] int stride() const { return HEAD_FLOATS + count - 1; }
    const float *coefficients = nullptr; // null where the light cannot meet the medium
    const float *solid_depth = nullptr;
    int count = 1;
    int width = 0, height = 0;
    bool radial = false;
    Affine world_to_light;               // onto [0, 1]^3; radial: turned and moved, with the light at the origin
    float low[3] = {0.0F, 0.0F, 0.0F};   // radial: where the rectangle and the distances begin,
    float scale[3] = {1.0F, 1.0F, 1.0F}; // and one over their extent
};

} // namespace sfumato
