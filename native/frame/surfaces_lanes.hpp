// SPDX-License-Identifier: GPL-3.0-or-later
// What a packet of rays sees of the scene's surfaces: the first of them, and the light on it past solids and smoke.
#pragma once

#include "frame/trace.hpp"
#include "lights/lights_lanes.hpp"
#include "lights/shading.hpp"
#include "maps/sampling.hpp"
#include "solids/hits_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"
#include "text/surfaces_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using SurfacesText = text::SurfacesText<Real, Isa>;
using Ray = CameraText::Ray;

struct Surface {
    Mask hit;
    Real distance; // or the ray's reach
    vec3 normal;   // shading normal, towards the eye
    vec3 geometric_normal;
    vec3 albedo;
    bool glossy = false; // whether any lane is
    Plane tangents;      // x the direction of alpha_x; set where glossy
    vec3 reflectance;    // seen straight on; so it is at grazing angles, or with `edge` 1 all light
    Real edge, alpha_x, alpha_y, apart, index;
    vec3 gain{1.0F, 1.0F, 1.0F}; // of the gloss, by what facets send to each other
    vec3 emission;
    Real diffuse_roughness;
};

Surface first_surface(const SurfaceView &view, const Ray &ray, Mask active) {
    Surface surface;
    surface.hit = Mask(false);
    surface.distance = ray.reach;
    if (view.scene == nullptr) {
        return surface;
    }
    typename Rays<LANES>::RayHit rays;
    // A surface in the far plane itself is seen: the boxes around it may round to either side of it.
    set_rays(rays.ray, ray.origin, ray.direction, 0.0F, ray.reach * 1.000001F);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    alignas(64) int valid[LANES];
    valid_lanes(active, valid);
    Rays<LANES>::intersect(valid, view.scene, !view.instanced, rays);

    alignas(64) float hits[LANES];
    bool any = false;
    for (int lane = 0; lane < LANES; ++lane) {
        const bool hit = valid[lane] != 0 && rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
        hits[lane] = hit ? 1.0F : 0.0F;
        any = any || hit;
    }
    if (!any) {
        return surface;
    }
    surface.hit = Real::load_aligned(hits) > 0.0F;
    surface.distance = pick(surface.hit, Real::load_aligned(rays.ray.tfar), ray.reach);

    // The lanes' places have arrays of their own, so these are read lane by lane.
    alignas(64) float normals[3][LANES], faces[3][LANES], tangents[3][LANES];
    alignas(64) std::int32_t materials[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        const bool hit = hits[lane] != 0.0F;
        const unsigned instance = rays.hit.instID[0][lane];
        const unsigned place = instance != RTC_INVALID_GEOMETRY_ID ? instance : rays.hit.geomID[lane];
        const Corners corners =
            hit ? corners_of(view.places[place], rays.hit.primID[lane], rays.hit.u[lane], rays.hit.v[lane]) : Corners{};
        for (int axis = 0; axis < 3; ++axis) {
            normals[axis][lane] = corners.normal[axis];
            faces[axis][lane] = corners.face[axis];
            tangents[axis][lane] = corners.tangent[axis];
        }
        materials[lane] = MATERIAL_FLOATS * corners.material;
    }
    const auto loaded = [](const float(&v)[3][LANES]) {
        return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
    };
    // The corner normals say which side is the front, the triangle which side is seen: turning the shading normal by
    // its own angle to the ray would flip it at the rim of smooth objects.
    surface.normal = normalised(loaded(normals));
    const vec3 face = normalised(loaded(faces));
    surface.geometric_normal = face * pick(dot(face, surface.normal) < 0.0F, -1.0F, 1.0F);
    const Real side = pick(dot(surface.geometric_normal, ray.direction) > 0.0F, -1.0F, 1.0F);
    surface.normal = surface.normal * side;
    surface.geometric_normal = surface.geometric_normal * side;
    const Index material = Index::load_aligned(materials);
    const auto property = [&](int number) { return gather(view.properties + number, material); };
    surface.albedo = {property(0), property(1), property(2)};
    surface.reflectance = {property(3), property(4), property(5)};
    surface.edge = property(6);
    surface.alpha_x = property(7);
    surface.alpha_y = property(8);
    surface.apart = property(9);
    surface.index = property(10);
    surface.emission = {property(11), property(12), property(13)};
    surface.diffuse_roughness = property(14);
    surface.glossy = xsimd::any(surface.alpha_x > 0.0F);
    if (surface.glossy) {
        surface.tangents = plane_across(surface.normal);
        // Curves over the cosine to the eye.
        constexpr int STEPS = CURVE_POINTS - 1;
        const Real place = clamp(-dot(surface.normal, ray.direction), 0.0F, 1.0F) * static_cast<float>(STEPS);
        const Real step = min(xsimd::floor(place), static_cast<float>(STEPS - 1)), beyond = place - step;
        const Index at = material + xsimd::to_int(step);
        const auto curve = [&](int first) {
            const Real here = gather(view.properties + first, at), next = gather(view.properties + first + 1, at);
            return here + (next - here) * beyond;
        };
        surface.albedo = surface.albedo * curve(18);
        surface.gain = vec3(property(15), property(16), property(17)) * curve(18 + CURVE_POINTS) + surface.gain;
        if (view.tangents) {
            const vec3 tangent = loaded(tangents);
            const vec3 along = tangent - surface.normal * dot(tangent, surface.normal);
            const Real length2 = dot(along, along);
            const Mask usable = length2 > 1e-12F;
            const Real scale = 1.0F / sqrt(pick(usable, length2, 1.0F));
            const auto chosen = [&](Real found, Real other) { return pick(usable, found * scale, other); };
            Plane &plane = surface.tangents;
            plane.x = {chosen(along.x, plane.x.x), chosen(along.y, plane.x.y), chosen(along.z, plane.x.z)};
            plane.y = cross(surface.normal, plane.x);
        }
    }
    return surface;
}

// Whether nothing solid stands on the first `distance` metres from `point`.
Real visibility(const SurfaceView &view, const vec3 &point, const Towards &towards, Mask asked) {
    if (view.scene == nullptr || !xsimd::any(asked)) {
        return 1.0F;
    }
    typename Rays<LANES>::Ray rays;
    set_rays(rays, point, towards.direction, 0.0F, towards.distance);
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::occluded(valid, view.scene, !view.instanced, rays);
    return pick(Real::load_aligned(rays.tfar) < 0.0F, 0.0F, 1.0F);
}

// What the smoke lets through from a light to a point: the mean over the light's samples.
void smoke_transmittance(const FrameView &frame, const LightView &light, const vec3 &point, Real out[3]) {
    const int colours = frame.grey ? 1 : 3;
    const std::size_t media = frame.media.size();
    Real sum[3] = {0.0F, 0.0F, 0.0F};
    for (std::size_t j = 0; j < light.samples.size(); ++j) {
        Real depth[3] = {0.0F, 0.0F, 0.0F};
        for (std::size_t m = 0; m < media; ++m) {
            const LightMapView &map = light.maps[j * media + m];
            if (map.coefficients == nullptr) {
                continue;
            }
            const vec3 place = place_on(map, point);
            const Real column = column_density(map, locate(map, place.x, place.y), place.z);
            for (int c = 0; c < colours; ++c) {
                depth[c] = depth[c] + column * frame.media[m].extinction[c];
            }
        }
        for (int c = 0; c < colours; ++c) {
            sum[c] = sum[c] + RaysText().transmittance_of(depth[c]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        out[c] = sum[c < colours ? c : 0] * (1.0F / static_cast<float>(light.samples.size()));
    }
}

// The light that a packet's surfaces send to the eye, with the shadow of the smoke and without.
struct Reflected {
    Real shadowed[3], open[3];
    Real unshadowed; // without shadows of solids either, the mean of the colours; of shadows, the irradiance
};

void store(const vec3 &v, float (&to)[3][MAX_LANES]) {
    v.x.store_aligned(to[0]);
    v.y.store_aligned(to[1]);
    v.z.store_aligned(to[2]);
}

void pack(const Surface &surface, const vec3 &point, const vec3 &direction, ShadingPacket &packet) {
    store(point, packet.point);
    store(surface.normal, packet.normal);
    store(direction, packet.direction);
    packet.glossy = surface.glossy;
    const Plane plane = surface.glossy ? surface.tangents : plane_across(surface.normal);
    store(plane.x, packet.tangent);
    store(plane.y, packet.bitangent);
    surface.alpha_x.store_aligned(packet.alpha_x);
    surface.alpha_y.store_aligned(packet.alpha_y);
    surface.apart.store_aligned(packet.apart);
    surface.index.store_aligned(packet.index);
}

// The share of a light that reaches a surface: past solids, asked for one point of the light, and through the smoke.
// What the surface's shading normal does not see of the light is not in its shading, and counts as visible.
Real solid_visibility(const FrameView &frame, const Surface &surface, const vec3 &start, const Towards &towards) {
    const Mask above = surface.hit & (dot(surface.normal, towards.direction) > 0.0F);
    const Mask asked = above & (dot(surface.geometric_normal, towards.direction) > 0.0F);
    const Real visible = visibility(frame.surfaces, start, towards, asked);
    return pick(asked, visible, pick(above, 0.0F, 1.0F));
}

Ray ray_through(const FrameView &frame, Real u, Real v) {
    const auto &c = frame.camera;
    return CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                                   broadcast(c[5]), u, v);
}

// Where another ray meets the plane of a surface; where that is far away, as it is on one seen edge-on, `start`, a
// point on it.
vec3 beside(const Surface &surface, const vec3 &start, const Ray &other) {
    const vec3 &normal = surface.geometric_normal;
    const Real facing = min(dot(other.direction, normal), -1e-6F);
    const Real distance = dot(start - other.origin, normal) / facing;
    const Mask near = abs(distance - surface.distance) < 0.1F * surface.distance;
    return pick(near, other.origin + other.direction * distance, start);
}

// The share of a light that solids leave a surface, for what it reflects diffusely and for its gloss.
struct PastSolids {
    Real diffuse, gloss;
};

// Of the sample that the ray stands for; or a mean over the packet's shadow samples, each by what the surface would
// make of it: with that the closed forms count as a control (Heitz, Hill and McGuire, "Combining analytic direct
// illumination and stochastic shadows", 2018), and of what hides a part of a light a mirror knows only the part that it
// shows.
PastSolids light_past_solids(const FrameView &frame, const Packet &packet, const Surface &surface,
                             const LightView &light, const vec3 &start, ShadingPacket &shading) {
    if (packet.shadows.empty()) {
        const Real u = Real::load_aligned(packet.light_u), v = Real::load_aligned(packet.light_v);
        const Real visible = solid_visibility(frame, surface, start, sample_towards(light, start, u, v));
        return {visible, visible};
    }
    constexpr float NOTHING = 1e-20F; // what the surface makes nothing of is a plain mean
    PastSolids sum{0.0F, 0.0F}, all{0.0F, 0.0F};
    for (const ShadowSample &sample : packet.shadows) {
        const vec3 from =
            beside(surface, start, ray_through(frame, Real::load_aligned(sample.u), Real::load_aligned(sample.v)));
        const Real u = Real::load_aligned(sample.light_u), v = Real::load_aligned(sample.light_v);
        const Towards towards = sample_towards(light, from, u, v);
        const Real visible = solid_visibility(frame, surface, from, towards);
        const Real diffuse = max(dot(surface.normal, towards.direction), 0.0F) * towards.irradiance + NOTHING;
        all.diffuse = all.diffuse + diffuse;
        sum.diffuse = sum.diffuse + diffuse * visible;
        if (surface.glossy) {
            store(towards.direction, shading.towards);
            weigh_gloss(shading);
            const Real gloss = Real::load_aligned(shading.plain) * towards.irradiance + NOTHING;
            all.gloss = all.gloss + gloss;
            sum.gloss = sum.gloss + gloss * visible;
        }
    }
    return {sum.diffuse / all.diffuse, surface.glossy ? sum.gloss / all.gloss : Real(0.0F)};
}

// Of light from the middle of a light, for all of it.
Real rim_of(const Surface &surface, const LightView &light, const vec3 &point, const vec3 &direction) {
    if (!xsimd::any(surface.diffuse_roughness >= 0.0F)) {
        return 1.0F;
    }
    const vec3 towards =
        light.kind == LightKind::SUN ? broadcast(-light.direction) : normalised(broadcast(light.position) - point);
    return SurfacesText().diffuse_rim(dot(surface.normal, towards), -dot(surface.normal, direction),
                                      -dot(direction, towards), surface.diffuse_roughness);
}

Reflected reflected(const FrameView &frame, Output output, const Packet &packet, const Ray &ray,
                    const Surface &surface) {
    Reflected out{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 0.0F};
    const bool picture = output == Output::PICTURE || output == Output::SURFACES;
    if (picture) {
        const Real emissions[3] = {surface.emission.x, surface.emission.y, surface.emission.z};
        for (int c = 0; c < 3; ++c) {
            out.open[c] = out.shadowed[c] = emissions[c];
            out.unshadowed = out.unshadowed + emissions[c] * (1.0F / 3.0F);
        }
    }
    const vec3 point = ray.origin + ray.direction * surface.distance;
    // Off the surface by a few rounding errors of the coordinates, for shadow rays, and for light from the surface
    // itself if that glows: whether it is seen from before or from behind must not hang on the last digit.
    const Real offset = 4e-6F * max(max(abs(point.x), abs(point.y)), max(abs(point.z), surface.distance));
    const vec3 start = point + surface.geometric_normal * offset;
    const Real albedos[3] = {surface.albedo.x, surface.albedo.y, surface.albedo.z};
    const Real reflectances[3] = {surface.reflectance.x, surface.reflectance.y, surface.reflectance.z};
    const Real gains[3] = {surface.gain.x, surface.gain.y, surface.gain.z};
    ShadingPacket packed;
    pack(surface, start, ray.direction, packed);
    Real facing[3] = {1e-20F, 1e-20F, 1e-20F};
    for (const LightView &light : frame.lights) {
        shade(light, packed);
        const Real diffuse = Real::load_aligned(packed.diffuse), plain = Real::load_aligned(packed.plain);
        const Real fresnel = Real::load_aligned(packed.fresnel);
        const Mask lit = surface.hit & ((diffuse > 0.0F) | (plain > 0.0F));
        const bool any_lit = xsimd::any(lit);
        if (picture && !any_lit) {
            continue;
        }
        if (!picture) {
            // From the light's middle: a share's denominator must not depend on where this sample fell.
            const Real irradiance = pick(surface.hit, sample_towards(light, start, 0.5F, 0.5F).irradiance, 0.0F);
            for (int c = 0; c < 3; ++c) {
                facing[c] = facing[c] + irradiance * light.strength[c];
            }
        }
        if (!any_lit) {
            continue;
        }
        const PastSolids past = light_past_solids(frame, packet, surface, light, start, packed);
        const Real visible = pick(lit, past.diffuse, 0.0F), mirrored = pick(lit, past.gloss, 0.0F);
        Real through[3];
        smoke_transmittance(frame, light, point, through);
        const Real rim = picture ? rim_of(surface, light, start, ray.direction) : Real(1.0F);
        for (int c = 0; c < 3; ++c) {
            if (picture) {
                const Real edge = surface.edge * (1.0F - reflectances[c]);
                const Real dull = albedos[c] * diffuse * rim * light.strength[c];
                const Real gloss = (reflectances[c] * plain + edge * fresnel) * gains[c] * light.strength[c];
                const Real sent = dull * visible + gloss * mirrored;
                out.unshadowed = out.unshadowed + (dull + gloss) * (1.0F / 3.0F);
                out.open[c] = out.open[c] + sent;
                out.shadowed[c] = out.shadowed[c] + sent * through[c];
                continue;
            }
            // The share of light that is missing, of all that would be there if the surface faced every light.
            const Real all = diffuse * (3.14159265F * light.strength[c]);
            out.unshadowed = out.unshadowed + all * (1.0F / 3.0F);
            const Real solid = all * visible;
            out.shadowed[c] = out.shadowed[c] + ((output == Output::ALL_SHADOWS ? all : solid) - solid * through[c]);
        }
    }
    if (!picture) {
        for (int c = 0; c < 3; ++c) {
            out.shadowed[c] = min(out.shadowed[c] / facing[c], 1.0F);
        }
    }
    return out;
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
