// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "maps/depth_tree.hpp"
#include "rays/basis.hpp"
#include "scene/affine.hpp"

#include <cstdint>

namespace sfumato {

struct ExactRays; // maps/exact_rays.hpp

// What stands on the rays of a map and lets light through: SheetDepths. Null where nothing does. Owns nothing.
struct SheetsOnMap {
    const std::uint32_t *first = nullptr;
    const float *depth = nullptr;
    const float *left = nullptr; // three colours each
};

// A light map: of each texel's ray the column density as a series of `count` coefficients (rays/basis.hpp), and the
// depth of the first solid on it (infinite where there is none). A texel is
//     where each ray has its own range:  the total, where the range begins, one over its extent, then `count` - 1
//     numbers where the map's whole depth is the range of all:  the total, then `count` - 1 numbers, which may be
//     filtered
// with the numbers of integral_of() in rays/series_lanes.hpp. Or a texel has a curve (rays/curve.hpp) for each of its
// colours: of the transmittance, since a curve is not linear in density. Texel centres are at (i + 1/2) / width. A map
// of light from one direction is affine in the world. One of light from one point has a rectangle of the octahedral
// square across (shaders/lights/light.glsl) and the distance to the point along. Owns nothing.
struct LightMapView {
    // Floats of a texel before its numbers.
    static constexpr int OWN_HEAD = 3, SHARED_HEAD = 1;
    [[nodiscard]] int head() const { return shared ? SHARED_HEAD : OWN_HEAD; }
    [[nodiscard]] int stride() const { return head() + count - 1; }
    // Where the light cannot meet the medium.
    [[nodiscard]] bool empty() const { return width == 0; }
    // Where the medium does not hide the light: of the rays only their solids are known.
    [[nodiscard]] bool clear() const { return coefficients == nullptr && curves == nullptr; }

    const float *coefficients = nullptr;
    const float *solid_depth = nullptr;
    SheetsOnMap sheets;
    DepthTreeView tree; // of solid_depth, where rays are followed across the map
    int count = 1;
    int width = 0, height = 0;
    bool radial = false;
    Affine world_to_light;               // onto [0, 1]^3; radial: turned and moved, with the light at the origin
    float low[3] = {0.0F, 0.0F, 0.0F};   // radial: where the rectangle and the distances begin,
    float scale[3] = {1.0F, 1.0F, 1.0F}; // and one over their extent
    BasisName basis = COSINE;
    bool shared = false;
    bool sharp = false; // rays of their own ranges: between texels, what they let through is filtered, not columns
    TablesView tables;  // of a learned basis
    const std::int32_t *curves = nullptr; // in the place of coefficients
    int colours = 1;                      // of the curves,
    float per_depth[3] = {};              // and column density for an optical depth of one in each
    // In the place of all that: a place on it is one in the world, from which the way to the light is marched.
    const ExactRays *exact = nullptr;
};

} // namespace sfumato
