// SPDX-License-Identifier: GPL-3.0-or-later
// What of a light arrives at a point as it is, and not as a light map has it: where few points are asked about, the way
// to the light is marched from each of them.
#pragma once

#include "media/medium_view.hpp"
#include "solids/ray_scene.hpp"
#include "text/dispatch.hpp"

#include <glm/vec3.hpp>

namespace sfumato {

struct ArrivingAt;  // maps/map_kernels.hpp
struct SurfaceView; // solids/surface_view.hpp

// The rays from one point of a light through one grid. Takes a map's place: LightMapView::exact. Owns nothing.
struct ExactRays {
    GridView density;
    ClearanceView clearance;
    Affine world_to_grid;
    bool hides = true; // whether the grid's smoke hides the light,
    bool lit = true;   // and whether it is lit by it
    glm::vec3 light{0.0F};
    bool parallel = false; // then `light` is the direction towards it
    float nearest = 0.0F;  // metres before the light, in which solids do not hide it
    RayScene solids, sheets;
    const SurfaceView *surfaces = nullptr;
};

// Points, and what is found of each.
struct ExactPacket {
    alignas(64) float world[3][MAX_LANES];
    alignas(64) float out[4][MAX_LANES];
};

} // namespace sfumato
