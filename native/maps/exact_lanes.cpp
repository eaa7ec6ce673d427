// SPDX-License-Identifier: GPL-3.0-or-later
// The ways from points to a light, through a grid and past solids: what light maps are judged by. A file of its own, so
// that the loops that ask maps stay as small as they are.
#include "maps/arriving_lanes.hpp"
#include "solids/all_hits_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/media_text.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

constexpr float STEP = 0.5F; // cells

vec3 world_of(const ExactPacket &packet) {
    return {Real::load_aligned(packet.world[0]), Real::load_aligned(packet.world[1]),
            Real::load_aligned(packet.world[2])};
}

struct WayToLight {
    vec3 direction;
    Real distance;
};

WayToLight way_to(const ExactRays &rays, const vec3 &world) {
    if (rays.parallel) {
        return {broadcast(rays.light), 1e9F};
    }
    const vec3 way = broadcast(rays.light) - world;
    const Real distance = sqrt(max(dot(way, way), 1e-20F));
    return {way * (1.0F / distance), distance};
}

} // namespace

void exact_column(const ExactRays &rays, ExactPacket &packet) {
    using CameraText = text::CameraText<Real, Isa>;
    using MediaText = text::MediaText<Real, Isa>;
    const vec3 world = world_of(packet);
    const WayToLight way = way_to(rays, world);
    const vec3 start = transform_point(rays.world_to_grid, world);
    const vec3 along = transform_vector(rays.world_to_grid, way.direction);
    const vec3 size{Real(static_cast<float>(rays.density.nx)), Real(static_cast<float>(rays.density.ny)),
                    Real(static_cast<float>(rays.density.nz))};
    const CameraText::Interval inside = CameraText().clip_to_box({Real(0.0F), way.distance}, start, along, size);
    const Real stretch = max(inside.far_t - inside.near_t, 0.0F);
    const Real per_cell = sqrt(dot(along, along));
    const Real steps = pick(stretch > 0.0F, MediaText().march_steps(stretch * per_cell, STEP), 0.0F);
    const Real dt = stretch / max(steps, 1.0F), near = pick(stretch > 0.0F, inside.near_t, 0.0F);
    const Real speed = max(max(abs(along.x), abs(along.y)), abs(along.z)) * dt; // cells a step
    Real sum = 0.0F;
    const float last = highest(steps);
    for (float k = 0.0F; k < last;) {
        const vec3 p = start + along * (near + (k + 0.5F) * dt);
        const Mask marching = steps > k;
        const Real clear = clearance_at(rays.clearance, p);
        if (xsimd::any(marching & (clear < 0.0F))) {
            sum = sum + pick(marching, sample(rays.density, locate(rays.density, p), 0), 0.0F);
            k += 1.0F;
        } else {
            k += 1.0F + std::floor(std::max(lowest(pick(marching, clear / max(speed, 1e-6F), 1e6F)), 0.0F));
        }
    }
    (sum * dt).store_aligned(packet.out[0]);
}

// What sheets leave of each colour, and, last, what solids leave.
void exact_open(const ExactRays &rays, ExactPacket &packet) {
    const vec3 world = world_of(packet);
    const WayToLight way = way_to(rays, world);
    const Real reach = rays.parallel ? way.distance : max(way.distance * ALMOST - rays.nearest, 0.0F);
    const Mask all(true);
    const Real visible = unblocked(rays.solids, world, way.direction, reach, all);
    const vec3 left = past_sheets(*rays.surfaces, rays.sheets, world, way.direction, reach, visible > 0.0F);
    left.x.store_aligned(packet.out[0]);
    left.y.store_aligned(packet.out[1]);
    left.z.store_aligned(packet.out[2]);
    visible.store_aligned(packet.out[3]);
}

// The optical depth in each colour, and, last, the share.
void exact_arriving(const ArrivingAt &at, ExactPacket &packet) {
    const Arriving found = arriving(at, world_of(packet));
    for (int c = 0; c < 3; ++c) {
        found.optical_depth[at.grey ? 0 : c].store_aligned(packet.out[c]);
    }
    found.share.store_aligned(packet.out[3]);
}

} // namespace sfumato::SFUMATO_ISA
