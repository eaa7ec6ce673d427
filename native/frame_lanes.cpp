// SPDX-License-Identifier: GPL-3.0-or-later
// One packet of camera rays: the first surface, the sun on it, the smoke before it.
#include "embree.hpp"
#include "lanes.hpp"
#include "sampling.hpp"

#include <algorithm>
#include <cmath>

namespace sfumato::SFUMATO_ISA {
namespace {

struct Surface {
    Mask hit;
    Real distance; // or the ray's reach
    vec3 normal;   // shading normal, towards the eye
    vec3 geometric_normal;
    vec3 albedo;
};

// Embree's packets want -1 for lanes that trace and 0 for those that rest.
inline void valid_lanes(Mask mask, int *valid) {
    alignas(64) float chosen[LANES];
    pick(mask, 1.0F, 0.0F).store_aligned(chosen);
    for (int lane = 0; lane < LANES; ++lane) {
        valid[lane] = chosen[lane] != 0.0F ? -1 : 0;
    }
}

template <typename R>
void set_rays(R &rays, const vec3 &origin, const vec3 &direction, Real near_t, Real far_t) {
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
        rays.time[lane] = 0.0F;
        rays.id[lane] = 0;
        rays.flags[lane] = 0;
    }
}

inline vec3 normalised(const vec3 &v) {
    return v * (1.0F / sqrt(dot(v, v)));
}

Surface first_surface(const SurfaceView &view, const Ray &ray, Mask active) {
    Surface surface;
    surface.hit = Mask(false);
    surface.distance = ray.reach;
    if (view.scene == nullptr) {
        return surface;
    }
    typename Rays<LANES>::RayHit rays;
    set_rays(rays.ray, ray.origin, ray.direction, 0.0F, ray.reach);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    alignas(64) int valid[LANES];
    valid_lanes(active, valid);
    Rays<LANES>::intersect(valid, view.scene, rays);

    alignas(64) float hits[LANES];
    alignas(64) std::int32_t triangles[LANES];
    bool any = false;
    for (int lane = 0; lane < LANES; ++lane) {
        const bool hit = valid[lane] != 0 && rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
        hits[lane] = hit ? 1.0F : 0.0F;
        triangles[lane] = hit ? static_cast<std::int32_t>(rays.hit.primID[lane]) : 0;
        any = any || hit;
    }
    if (!any) {
        return surface;
    }
    surface.hit = Real::load_aligned(hits) > 0.0F;
    surface.distance = pick(surface.hit, Real::load_aligned(rays.ray.tfar), ray.reach);

    const Index triangle = Index::load_aligned(triangles);
    const Real u = Real::load_aligned(rays.hit.u), v = Real::load_aligned(rays.hit.v);
    const Index corners = triangle * Index(9);
    const auto normal_axis = [&](int axis) {
        return (1.0F - u - v) * gather(view.corner_normals + axis, corners) +
               u * gather(view.corner_normals + 3 + axis, corners) +
               v * gather(view.corner_normals + 6 + axis, corners);
    };
    // The corner normals say which side is the front, the triangle which side is seen: turning the shading normal by
    // its own angle to the ray would flip it at the rim of smooth objects.
    surface.normal = normalised({normal_axis(0), normal_axis(1), normal_axis(2)});
    const vec3 face = normalised(
        {Real::load_aligned(rays.hit.Ng_x), Real::load_aligned(rays.hit.Ng_y), Real::load_aligned(rays.hit.Ng_z)});
    surface.geometric_normal = face * pick(dot(face, surface.normal) < 0.0F, -1.0F, 1.0F);
    const Real side = pick(dot(surface.geometric_normal, ray.direction) > 0.0F, -1.0F, 1.0F);
    surface.normal = surface.normal * side;
    surface.geometric_normal = surface.geometric_normal * side;
    alignas(64) std::int32_t materials[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        materials[lane] = 3 * view.material[triangles[lane]];
    }
    const Index material = Index::load_aligned(materials);
    surface.albedo = {gather(view.albedo, material), gather(view.albedo + 1, material),
                      gather(view.albedo + 2, material)};
    return surface;
}

// The share of the sun that no solid keeps from `point`, asked for one direction within the sun's disk.
Real sun_visibility(const SurfaceView &view, const vec3 &point, const vec3 &towards, Mask asked) {
    if (view.scene == nullptr || !xsimd::any(asked)) {
        return 1.0F;
    }
    typename Rays<LANES>::Ray rays;
    set_rays(rays, point, towards, 0.0F, 1e30F);
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::occluded(valid, view.scene, rays);
    return pick(Real::load_aligned(rays.tfar) < 0.0F, 0.0F, 1.0F);
}

// The sun as one packet's surfaces see it.
struct SunLight {
    Real cosine;     // between the shading normal and the sun, 0 for surfaces that face away
    Real visibility; // T_opaque
    Real column;     // column density of the smoke before the sun
};

SunLight sunlight(const FrameView &frame, const Packet &packet, const Ray &ray, const Surface &surface) {
    SunLight light{0.0F, 0.0F, 0.0F};
    if (!frame.sun.present) {
        return light;
    }
    const vec3 towards =
        normalised(broadcast(frame.sun.towards) + broadcast(frame.sun.across) * Real::load_aligned(packet.sun_x) +
                   broadcast(frame.sun.up) * Real::load_aligned(packet.sun_y));
    const Real cosine = dot(surface.normal, towards);
    const Mask facing = surface.hit & (cosine > 0.0F) & (dot(surface.geometric_normal, towards) > 0.0F);
    if (!xsimd::any(facing)) {
        return light;
    }
    light.cosine = pick(facing, cosine, 0.0F);
    const vec3 point = ray.origin + ray.direction * surface.distance;
    // Start the shadow ray off the surface by a few rounding errors of the coordinates.
    const Real offset = 4e-6F * max(max(abs(point.x), abs(point.y)), max(abs(point.z), surface.distance));
    light.visibility = sun_visibility(frame.surfaces, point + surface.geometric_normal * offset, towards, facing);
    if (frame.smoke && frame.medium.present) {
        const vec3 m = transform_point(frame.map.world_to_map, point);
        light.column = column_density(frame.map, locate(frame.map, m.x, m.y), m.z);
    }
    return light;
}

struct Smoke {
    Real transmittance[3];
    Real scattered[3];
};

template <int Colours, bool Shaded>
Smoke march(const MediumView &medium, const Ray &ray, Real distance, Mask active) {
    const vec3 origin = transform_point(medium.world_to_grid, ray.origin);
    const vec3 direction = transform_vector(medium.world_to_grid, ray.direction);
    const vec3 size{Real(static_cast<float>(medium.lit.nx)), Real(static_cast<float>(medium.lit.ny)),
                    Real(static_cast<float>(medium.lit.nz))};
    const Interval inside = clip_to_box({Real(0.0F), distance}, origin, direction, size);
    const Real stretch = max(pick(active, inside.far_t - inside.near_t, 0.0F), 0.0F);
    Smoke smoke;
    March state[Colours];
    for (March &m : state) {
        m.optical_depth = 0.0F;
        m.scattered = 0.0F;
    }
    if (xsimd::any(stretch > 0.0F)) {
        const Real steps = pick(stretch > 0.0F, march_steps(stretch, medium.step_length), 0.0F);
        const Real step = stretch / max(steps, 1.0F);
        const Real speed = max(max(abs(direction.x), abs(direction.y)), abs(direction.z)) * step; // cells a step
        const Real leap = 1.0F / max(speed, 1e-6F);
        const float most = highest(steps);
        for (float k = 0.0F; k < most;) {
            const Real t = inside.near_t + (k + 0.5F) * step;
            const vec3 p = origin + direction * t;
            const Mask marching = Real(k) < steps;
            const Real clear = pick(marching, clearance_at(medium.clearance, p), 1e6F);
            if (!xsimd::any(clear < 0.0F)) {
                k += 1.0F + std::floor(std::min(lowest(clear * leap), 1e6F));
                continue;
            }
            const Cell cell = locate(medium.lit, p);
            const Real density = pick(marching, sample(medium.lit, cell, 0), 0.0F) * step;
            const Real column = sample(medium.lit, cell, 1);
            const Real occlusion = Shaded ? sample(medium.lit, cell, 2) : Real(0.0F);
            for (int c = 0; c < Colours; ++c) {
                const float extinction = medium.extinction[c];
                state[c] = march_step(state[c], density * extinction, column * extinction, occlusion);
            }
            k += 1.0F;
        }
    }
    for (int c = 0; c < 3; ++c) {
        const March &m = state[Colours == 1 ? 0 : c];
        smoke.transmittance[c] = transmittance_of(m.optical_depth);
        smoke.scattered[c] = m.scattered;
    }
    return smoke;
}

} // namespace

void trace(const FrameView &frame, const Packet &packet, Light &light) {
    const Mask active = Real::load_aligned(packet.active) > 0.0F;
    const auto &c = frame.camera;
    const Ray ray = camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                               broadcast(c[5]), Real::load_aligned(packet.u), Real::load_aligned(packet.v));
    const Surface surface = first_surface(frame.surfaces, ray, active);
    surface.distance.store_aligned(light.distance);

    Real rgb[3]; // of the surface, before the smoke
    for (int i = 0; i < 3; ++i) {
        rgb[i] = frame.lit ? frame.background[i] : 0.0F;
    }
    Real arriving[3] = {1.0F, 1.0F, 1.0F}; // transmittance of the map, T_map
    if (xsimd::any(surface.hit)) {
        const SunLight sun = sunlight(frame, packet, ray, surface);
        const Real albedos[3] = {surface.albedo.x, surface.albedo.y, surface.albedo.z};
        for (int i = 0; i < 3; ++i) {
            const Real reflected =
                frame.lit ? diffuse_reflection(albedos[i], sun.cosine) * frame.sun.irradiance[i] : sun.cosine;
            const Real visibility = frame.lit || i == 0 ? sun.visibility : Real(1.0F);
            rgb[i] = pick(surface.hit, visibility * reflected, rgb[i]);
            arriving[i] = transmittance_of(sun.column * frame.medium.extinction[i]);
        }
    }
    ((rgb[0] + rgb[1] + rgb[2]) * (1.0F / 3.0F)).store_aligned(light.surface);
    if (!frame.smoke || !frame.medium.present) {
        for (int i = 0; i < 3; ++i) {
            rgb[i].store_aligned(light.radiance[i]);
        }
        pick(surface.hit, 1.0F, 0.0F).store_aligned(light.alpha);
        Real(1.0F).store_aligned(light.seen);
        return;
    }
    const auto march_kind = frame.medium.lit.channels == 3 ? (frame.medium.grey ? march<1, true> : march<3, true>)
                                                           : (frame.medium.grey ? march<1, false> : march<3, false>);
    const Smoke smoke = march_kind(frame.medium, ray, surface.distance, active);
    const Real phase = henyey_greenstein(dot(broadcast(frame.sun.towards), ray.direction), frame.medium.anisotropy);
    Real through = 0.0F, seen = 0.0F;
    for (int i = 0; i < 3; ++i) {
        const float source = frame.sun.irradiance[i] * frame.medium.albedo[i];
        const Real left = smoke.transmittance[i] * arriving[i];
        (rgb[i] * left + phase * source * smoke.scattered[i]).store_aligned(light.radiance[i]);
        through = through + smoke.transmittance[i] * (1.0F / 3.0F);
        seen = max(seen, left);
    }
    pick(surface.hit, 1.0F, 1.0F - through).store_aligned(light.alpha);
    seen.store_aligned(light.seen);
}

} // namespace sfumato::SFUMATO_ISA
