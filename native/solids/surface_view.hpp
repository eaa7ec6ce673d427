// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lights/gloss_curves.hpp"
#include "solids/embree.hpp"

#include <cstdint>

namespace sfumato {

constexpr int MATERIAL_FLOATS = 19 + 2 * CURVE_POINTS;

// Views own nothing. One place of a shape: its arrays, as scene.hpp has them, null where it has none, and what takes
// its normals and tangents to the world, column by column.
struct PlaceView {
    const float *vertices = nullptr;
    const std::uint32_t *triangles = nullptr;
    const float *corner_normals = nullptr;
    const float *vertex_normals = nullptr;
    const float *corner_tangents = nullptr;
    const std::uint32_t *material = nullptr;
    std::int32_t first_material = 0; // of its rows among all properties
    float object_index = 0.0F;
    float to_world[9];
    float normals_to_world[9];
};

struct SurfaceView {
    RTCScene scene = nullptr;
    bool instanced = false;            // whether any place is an instance to Embree
    const PlaceView *places = nullptr; // by Embree's number of the instance, or else of the geometry
    // MATERIAL_FLOATS a material: albedo, reflectance, edge, alpha_x, alpha_y, apart, index, emission,
    // diffuse roughness (negative for none); of GlossCurves again, kept, lost; and its index
    const float *properties = nullptr;
    bool tangents = false; // whether any shape has tangents
};

} // namespace sfumato
