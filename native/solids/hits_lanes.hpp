// SPDX-License-Identifier: GPL-3.0-or-later
// Packets of rays as Embree takes them, and what a hit on a triangle of a shape tells.
#pragma once

#include "solids/embree.hpp"
#include "solids/ray_scene.hpp"
#include "solids/surface_view.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sfumato::SFUMATO_ISA {
namespace {

// Embree's packets want -1 for lanes that trace and 0 for those that rest.
inline void valid_lanes(Mask mask, int *valid) {
    alignas(64) float chosen[LANES];
    pick(mask, 1.0F, 0.0F).store_aligned(chosen);
    for (int lane = 0; lane < LANES; ++lane) {
        valid[lane] = chosen[lane] != 0.0F ? -1 : 0;
    }
}

template <typename R>
void set_rays(R &rays, const RayScene &among, const vec3 &origin, const vec3 &direction, Real near_t, Real far_t) {
    origin.x.store_aligned(rays.org_x);
    origin.y.store_aligned(rays.org_y);
    origin.z.store_aligned(rays.org_z);
    direction.x.store_aligned(rays.dir_x);
    direction.y.store_aligned(rays.dir_y);
    direction.z.store_aligned(rays.dir_z);
    near_t.store_aligned(rays.tnear);
    far_t.store_aligned(rays.tfar);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.mask[lane] = 0xFFFFFFFFU;
        rays.time[lane] = among.time;
        rays.id[lane] = 0;
        rays.flags[lane] = 0;
    }
}

// Whether nothing solid stands on the first `distance` metres from a point: 1, or 0. Anything where that is not asked.
inline Real unblocked(const RayScene &solids, const vec3 &point, const vec3 &direction, Real distance, Mask asked) {
    if (solids.scene == nullptr || !xsimd::any(asked)) {
        return 1.0F;
    }
    typename Rays<LANES>::Ray rays;
    set_rays(rays, solids, point, direction, 0.0F, distance);
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::occluded(valid, solids.scene, !solids.instanced, rays);
    return pick(Real::load_aligned(rays.tfar) < 0.0F, 0.0F, 1.0F);
}

// What a hit on one triangle tells, in the world; vectors of any length.
struct Corners {
    float normal[3] = {0.0F, 0.0F, 1.0F};
    float face[3] = {0.0F, 0.0F, 1.0F};
    float tangent[3] = {0.0F, 0.0F, 0.0F}; // 0 where the shape has none
    std::int32_t material = 0;
};

// By the columns of a matrix. An object without thickness has no normals; then any will do.
inline void turn(const float (&m)[9], const float (&v)[3], float (&out)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = m[axis] * v[0] + m[3 + axis] * v[1] + m[6 + axis] * v[2];
    }
}

inline void turn_normal(const PlaceView &place, const float (&v)[3], float (&out)[3]) {
    turn(place.normals_to_world, v, out);
    if (!(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] > 1e-30F)) {
        out[0] = out[1] = 0.0F;
        out[2] = 1.0F;
    }
}

// At (u, v) of a triangle. Normals and tangents are interpolated in the shape's own space, as Cycles does.
inline Corners corners_of(const PlaceView &place, std::uint32_t triangle, float u, float v) {
    Corners out;
    const std::uint32_t *const vertex = place.triangles + std::size_t{3} * triangle;
    const auto corner = [vertex](const float *values, int i) { return values + std::size_t{3} * vertex[i]; };
    const float *const a = corner(place.vertices, 0), *const b = corner(place.vertices, 1),
                       *const c = corner(place.vertices, 2);
    const float p[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const float flat[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    const float scale = 1.0F / std::sqrt(std::max(flat[0] * flat[0] + flat[1] * flat[1] + flat[2] * flat[2], 1e-37F));
    const float face[3] = {flat[0] * scale, flat[1] * scale, flat[2] * scale};
    turn_normal(place, face, out.face);
    const auto between = [u, v](const float *first, const float *second, const float *third, float(&to)[3]) {
        for (int axis = 0; axis < 3; ++axis) {
            to[axis] = (1.0F - u - v) * first[axis] + u * second[axis] + v * third[axis];
        }
    };
    float normal[3] = {face[0], face[1], face[2]};
    if (place.corner_normals != nullptr) {
        const float *const n = place.corner_normals + std::size_t{9} * triangle;
        between(n, n + 3, n + 6, normal);
    } else if (place.vertex_normals != nullptr) {
        const float *const n = place.vertex_normals;
        between(corner(n, 0), corner(n, 1), corner(n, 2), normal);
    }
    turn_normal(place, normal, out.normal);
    if (place.corner_tangents != nullptr) {
        const float *const t = place.corner_tangents + std::size_t{9} * triangle;
        float tangent[3];
        between(t, t + 3, t + 6, tangent);
        turn(place.to_world, tangent, out.tangent);
    }
    out.material = place.first_material;
    if (place.material != nullptr) {
        out.material += static_cast<std::int32_t>(place.material[triangle]);
    }
    return out;
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
