// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solids/embree.hpp"

#include <cstdint>

namespace sfumato {

constexpr int MATERIAL_FLOATS = 15;

// The triangles' attributes, indexed by Embree's primitive number. Owns nothing.
struct SurfaceView {
    RTCScene scene = nullptr;
    const float *corner_normals = nullptr;  // nine floats a triangle
    const std::int32_t *material = nullptr; // one a triangle
    // MATERIAL_FLOATS a material: albedo, reflectance, edge, alpha_x, alpha_y, apart, index, emission,
    // diffuse roughness (negative for none)
    const float *properties = nullptr;
    const float *corner_tangents = nullptr; // nine floats a triangle; null where no mesh has any
};

} // namespace sfumato
