// SPDX-License-Identifier: GPL-3.0-or-later
// The light that a packet of surfaces sends to the eye, past solids and smoke.
#pragma once

#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "lights/shading.hpp"
#include "lights/sky_lanes.hpp"
#include "maps/sampling.hpp"
#include "media/air_lanes.hpp"
#include "solids/all_hits_lanes.hpp"
#include "solids/first_surface_lanes.hpp"
#include "solids/hits_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/microfacets_text.hpp"
#include "text/rays_text.hpp"
#include "text/surfaces_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sfumato::SFUMATO_ISA {
namespace {
using CameraText = text::CameraText<Real, Isa>;
using SurfacesText = text::SurfacesText<Real, Isa>;
using MicrofacetsText = text::MicrofacetsText<Real, Isa>;
using Ray = CameraText::Ray;

inline Ray ray_through(const FrameView &frame, Real u, Real v) {
    const auto &c = frame.camera;
    return CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), broadcast(c[4]),
                                   broadcast(c[5]), u, v);
}

// Of a packet's samples; none where nothing is textured.
inline std::optional<Beside> beside_of(const FrameView &frame, const Packet &packet) {
    if (frame.surfaces.varying == nullptr) {
        return std::nullopt;
    }
    const Real u = Real::load_aligned(packet.u), v = Real::load_aligned(packet.v);
    return Beside{ray_through(frame, u + packet.beside_u, v), ray_through(frame, u, v + packet.beside_v),
                  packet.stands_for};
}

// What hair lets through from a light to a point, and of that what smoke and particles do: the mean over the light's
// samples, by what each brings.
inline void media_transmittance(const FrameView &frame, const LightView &light, const vec3 &point, const vec3 &normal,
                                Real past_hair[3], Real past_smoke[3]) {
    const int colours = frame.grey ? 1 : 3;
    const std::size_t bodies = frame.extinctions.size();
    constexpr float NOTHING = 1e-12F; // what none of them shines at has a plain mean
    Real sum[3] = {0.0F, 0.0F, 0.0F}, hair[3] = {0.0F, 0.0F, 0.0F}, all = 0.0F;
    for (std::size_t j = 0; j < light.samples.size(); ++j) {
        Real facing = 1.0F;
        if (light.surrounds()) {
            facing = max(dot(normal, broadcast(light.samples[j])), 0.0F);
        } else if (!light.parallel() && light.samples.size() > 1) {
            const vec3 towards = broadcast(light.samples[j]) - point;
            facing = max(dot(normal, towards), 0.0F) / sqrt(max(dot(towards, towards), 1e-20F));
        }
        const Real share = sample_share(light, j, point) * facing + NOTHING;
        all = all + share;
        Real smoke[3] = {0.0F, 0.0F, 0.0F}, strands[3] = {0.0F, 0.0F, 0.0F};
        for (std::size_t m = 0; m < bodies; ++m) {
            const LightMapView &map = light.maps[j * bodies + m];
            if (map.empty()) {
                continue;
            }
            const vec3 place = place_on(map, point);
            add_optical_depth(map, locate(map, place.x, place.y), place, &frame.extinctions[m].x, colours,
                              m < frame.first_hair ? smoke : strands);
        }
        if (frame.world_air != nullptr) {
            add_air(*frame.world_air, light, light.samples[j], point, colours, smoke);
        }
        for (int c = 0; c < colours; ++c) {
            const Real left = frame.first_hair < bodies ? share * RaysText().transmittance_of(strands[c]) : share;
            hair[c] = hair[c] + left;
            sum[c] = sum[c] + left * RaysText().transmittance_of(smoke[c]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        const int from = c < colours ? c : 0;
        past_hair[c] = hair[from] / all;
        past_smoke[c] = sum[from] / max(hair[from], 1e-30F);
    }
}

// Where a lamp, or a sun, is asked at one of its points for all of them, those count by what they bring: what is
// missing at this one, by its share of `whole`, all that a matt surface gets of a radiance of one, over pi. Not
// inlined: few ask.
[[gnu::noinline]] inline void weigh_point(const LightView &light, const vec3 &point, const vec3 &normal, Real whole,
                                          Real through[3]) {
    const vec3 sample = broadcast(light.samples.front());
    const Towards there = light.parallel() ? Towards{sample, 1e30F, sample_share(light, 0, point)}
                                           : towards_place(light, point, sample, light.area);
    const Real share = max(dot(normal, there.direction), 0.0F) * there.irradiance * 0.318309886F / max(whole, 1e-20F);
    for (int c = 0; c < 3; ++c) {
        through[c] = 1.0F - (1.0F - through[c]) * share;
    }
}

// Of a sky's light, one part of what a surface sends to the eye: all of it, were none hidden by solids, past smoke;
// and, by a few directions, what comes from these and what solids leave of that.
struct FromSky {
    Real light[3];
    vec3 all, seen;
    Real open; // the mean of the light's colours, without smoke
};

// The light that a packet's surfaces send to the eye, with the shadow of the smoke and without.
struct Reflected {
    Real shadowed[3], open[3];
    Real unshadowed;            // without shadows of solids either, the mean of the colours; of shadows, the irradiance
    Real lit[3];                // the same of each colour, without what glows
    Real even, even_unshadowed; // the mean of `open`, and `unshadowed`, of what is textured as if it were not
    Real alone[3];              // where a catcher is met: in the shadows of catchers alone
    FromSky dull, gloss;        // of that light what a sky sends, by what becomes of it
    Real bounced[3];            // of `shadowed`, what comes from other surfaces
};

inline Real component(const vec3 &v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

inline vec3 multiplied(const vec3 &a, const vec3 &b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}

inline void store(const vec3 &v, float (&to)[3][MAX_LANES]) {
    v.x.store_aligned(to[0]);
    v.y.store_aligned(to[1]);
    v.z.store_aligned(to[2]);
}

inline vec3 load(const float (&from)[3][MAX_LANES]) {
    return {Real::load_aligned(from[0]), Real::load_aligned(from[1]), Real::load_aligned(from[2])};
}

inline void pack(const Surface &surface, const vec3 &point, const vec3 &direction, ShadingPacket &packet) {
    store(point, packet.point);
    store(surface.normal, packet.normal);
    store(direction, packet.direction);
    const Plane plane = surface.lobes > 0 ? surface.tangents : plane_across(surface.normal);
    store(plane.x, packet.tangent);
    store(plane.y, packet.bitangent);
}

// The directions of a lobe's alpha_x and alpha_y.
inline Plane turned(const Lobe &lobe, const Plane &tangents) {
    return {tangents.x * lobe.cosine + tangents.y * lobe.sine, tangents.y * lobe.cosine - tangents.x * lobe.sine};
}

inline void pack_lobe(const Lobe &lobe, const Plane &tangents, ShadingPacket &packet) {
    lobe.alpha_x.store_aligned(packet.alpha_x);
    lobe.alpha_y.store_aligned(packet.alpha_y);
    lobe.apart.store_aligned(packet.apart);
    lobe.index.store_aligned(packet.index);
    const Plane own = turned(lobe, tangents);
    store(own.x, packet.tangent);
    store(own.y, packet.bitangent);
}

// What a layer of gloss makes of a light, past solids too; `dip` for Fresnel's share of its dip.
struct Mirrored {
    Real plain, fresnel, dip, visible;
};

// Facets are of one kind in all lanes of a packet, and hardly ever of both in one.
template <typename Body>
inline void for_both_facets(const Surface &surface, const Lobe &lobe, ShadingPacket &packet, const Body &body) {
    for (const bool beckmann : {false, true}) {
        const Mask these = beckmann ? lobe.beckmann : !lobe.beckmann;
        if (xsimd::any(these & surface.hit & (lobe.alpha_x > 0.0F))) {
            packet.beckmann = beckmann;
            body(these);
        }
    }
}

inline Mirrored mirrored(const LightView &light, const Surface &surface, const Lobe &lobe, ShadingPacket &packet) {
    Mirrored out{0.0F, 0.0F, 0.0F, 0.0F};
    pack_lobe(lobe, surface.tangents, packet);
    for_both_facets(surface, lobe, packet, [&](Mask these) {
        shade_gloss(light, packet);
        out.plain = pick(these, Real::load_aligned(packet.plain), out.plain);
        out.fresnel = pick(these, Real::load_aligned(packet.fresnel), out.fresnel);
    });
    if (xsimd::any(max(max(lobe.dip.x, lobe.dip.y), lobe.dip.z) > 0.0F)) {
        packet.beckmann = false;
        Real(DIP_BEFORE_EDGE).store_aligned(packet.index);
        shade_gloss(light, packet);
        out.dip = Real::load_aligned(packet.fresnel);
    }
    return out;
}

// What may stand between a surface and a light. Without sheets no colour is asked for.
struct Between {
    const SurfaceView *surfaces;
    RayScene solids, sheets;

    [[nodiscard]] bool tinted() const { return sheets.scene != nullptr; }
};

// The share of a light that gets past solids, and, where there are sheets, what these leave of that.
struct Passing {
    Real visible;
    vec3 tint;
};

// The share of a light that reaches a surface: past solids and sheets, asked for one point of the light. What the
// surface's shading normal does not see of the light is not in its shading, and counts as visible.
inline Passing passing(const Between &between, const Surface &surface, const vec3 &start, const Towards &towards,
                       Mask wanted) {
    const Mask above = wanted & (dot(surface.normal, towards.direction) > 0.0F);
    const Mask asked = above & (dot(surface.geometric_normal, towards.direction) > 0.0F);
    const Real visible = pick(asked, unblocked(between.solids, start, towards.direction, towards.distance, asked),
                              pick(above, 0.0F, 1.0F));
    Passing out;
    out.visible = visible;
    if (between.tinted()) {
        out.tint = past_sheets(*between.surfaces, between.sheets, start, towards.direction, towards.distance,
                               asked & (visible > 0.0F));
    }
    return out;
}

// Where another ray meets the plane of a surface; where that is far away, as it is on one seen edge-on, `start`, a
// point on it.
inline vec3 beside(const Surface &surface, const vec3 &start, const Ray &other) {
    const vec3 &normal = surface.geometric_normal;
    const Real facing = min(dot(other.direction, normal), -1e-6F);
    const Real distance = dot(start - other.origin, normal) / facing;
    const Mask near = abs(distance - surface.distance) < 0.1F * surface.distance;
    return pick(near, other.origin + other.direction * distance, start);
}

// The share of a light that solids leave a surface, for what it reflects diffusely and for each of its layers of gloss;
// and of that, what sheets leave, where there are any.
struct PastSolids {
    Passing diffuse, gloss[MAX_LOBES];
    // Of a sky what its directions bring, and what solids leave of that.
    struct Looked {
        vec3 all, seen;
        Real looks; // how many, by their weights
    };
    Looked dull_looks, gloss_looks[MAX_LOBES];
};

// What one sample of a light is worth to a surface, or one of its layers of gloss, and whether it is visible.
struct Sampled {
    Real worth;
    Passing passing;
};

// Sums of what passes, by what each is worth.
inline void add_passing(const Between &between, Real worth, const Passing &passing, Passing &sum) {
    const Real seen = worth * passing.visible;
    sum.visible = sum.visible + seen;
    if (between.tinted()) {
        sum.tint = sum.tint + passing.tint * seen;
    }
}

inline void divide(const Between &between, Real worth, Passing &sum) {
    if (between.tinted()) {
        sum.tint = sum.tint * (1.0F / max(sum.visible, 1e-30F));
    }
    sum.visible = sum.visible / worth;
}

// Of a layer of gloss, which may look elsewhere on the light than what is diffuse, `dull`.
inline Sampled sampled(const Between &between, const Surface &surface, const Lobe &lobe, const LightView &light,
                       const vec3 &from, Real u, Real v, const Towards &towards, const Passing &dull,
                       ShadingPacket &shading) {
    Sampled out{0.0F, dull};
    pack_lobe(lobe, surface.tangents, shading);
    store(from, shading.from);
    u.store_aligned(shading.light_u);
    v.store_aligned(shading.light_v);
    for_both_facets(surface, lobe, shading, [&](Mask these) {
        store(towards.direction, shading.towards);
        towards.distance.store_aligned(shading.reach);
        towards.irradiance.store_aligned(shading.irradiance);
        look(light, shading);
        const Towards seen{load(shading.towards), Real::load_aligned(shading.reach), 0.0F};
        const Mask moved = these & surface.hit & (Real::load_aligned(shading.moved) > 0.0F);
        out.worth = pick(these, Real::load_aligned(shading.worth), out.worth);
        const Passing there = passing(between, surface, from, seen, moved);
        out.passing.visible = pick(moved, there.visible, out.passing.visible);
        if (between.tinted()) {
            out.passing.tint = pick(moved, there.tint, out.passing.tint);
        }
    });
    return out;
}

inline vec3 mirror_of(const Surface &surface, const vec3 &to_eye) {
    return surface.normal * (2.0F * dot(surface.normal, to_eye)) - to_eye;
}

inline Real alpha_of(const Lobe &lobe) {
    return sqrt(lobe.alpha_x * lobe.alpha_y);
}

// A layer of gloss, as the eye sees its facets, in the frame of its tangents.
struct SeenFacets {
    MicrofacetsText::Microfacets m;
    vec3 x, y, z;

    // The direction that a facet, a half vector of any length, mirrors to the eye.
    [[nodiscard]] vec3 mirrored(const vec3 &facet) const {
        const vec3 there = facet * (2.0F * dot(m.view, facet) / max(dot(facet, facet), 1e-30F)) - m.view;
        return x * there.x + y * there.y + z * there.z;
    }
};

inline SeenFacets seen_facets(const Surface &surface, const Lobe &lobe, const vec3 &to_eye) {
    SeenFacets out;
    const Plane own = turned(lobe, surface.tangents);
    out.x = own.x;
    out.y = own.y;
    out.z = surface.normal;
    const vec3 view{dot(to_eye, out.x), dot(to_eye, out.y), dot(to_eye, out.z)};
    out.m = MicrofacetsText().microfacets(BRDF_GGX, view, lobe.alpha_x, lobe.alpha_y);
    out.m.apart = lobe.apart;
    return out;
}

// The mean radiance over all that facets mirror, from a picture of as much gloss as lies between them.
inline vec3 wide_gloss(const Sky &sky, const SeenFacets &seen, Real level, Mask asked) {
    vec3 sum{0.0F, 0.0F, 0.0F};
    Real worths = 1e-20F;
    for (std::size_t k = 0; k < FACETS; ++k) {
        const vec3 facet = MicrofacetsText().seen_facet(seen.m, Real(spiral().x[k]), Real(spiral().y[k]));
        const Real worth = MicrofacetsText().masking_at(seen.m, facet, dot(seen.m.view, facet)).plain;
        const vec3 towards = seen.mirrored(facet);
        worths = worths + worth;
        for (int i = 0; i < GLOSS_LEVELS; ++i) {
            const Mask here = asked & (xsimd::floor(level) == static_cast<float>(i));
            if (xsimd::any(here)) {
                sum = sum + nearest_in(sky.gloss(i), towards) * pick(here, worth, 0.0F);
            }
        }
    }
    return sum * (1.0F / worths);
}

// What of a sky's colours a surface sends back, where `strength` is that of all of it: 1 where it is the same all
// around.
struct OfSky {
    vec3 diffuse, gloss[MAX_LOBES];
};

inline OfSky of_sky(const Sky &sky, const Surface &surface, int lobes, const vec3 &to_eye) {
    const glm::vec3 &mean = sky.mean();
    const vec3 by = broadcast(1.0F / glm::max(mean, glm::vec3(1e-30F)));
    OfSky out;
    out.diffuse = multiplied(radiance_in(sky.dull(), surface.normal), by);
    const vec3 mirrored = mirror_of(surface, to_eye);
    for (int k = 0; k < lobes; ++k) {
        const Real alpha = alpha_of(surface.lobe[k]);
        const Real octave = xsimd::log2(max(alpha, 1e-6F) * (1.0F / FIRST_ALPHA));
        const Real level = clamp(pick(alpha < FIRST_ALPHA, alpha * (1.0F / FIRST_ALPHA), octave + 1.0F), 0.0F,
                                 static_cast<float>(GLOSS_LEVELS - 1));
        // A narrow lobe is as round as the picture's; of a wide one each of many facets has its own place on a sharper
        // picture.
        constexpr float WIDE = 1.0F;
        const Mask narrow = level < WIDE;
        out.gloss[k] = {0.0F, 0.0F, 0.0F};
        for (int i = 0; i <= static_cast<int>(WIDE); ++i) {
            const Real share = pick(narrow, max(1.0F - abs(level - static_cast<float>(i)), 0.0F), 0.0F);
            if (xsimd::any(surface.hit & (share > 0.0F))) {
                out.gloss[k] = out.gloss[k] + radiance_in(sky.gloss(i), mirrored) * share;
            }
        }
        if (xsimd::any(surface.hit & !narrow)) {
            out.gloss[k] = pick(narrow, out.gloss[k],
                                wide_gloss(sky, seen_facets(surface, surface.lobe[k], to_eye), max(0.5F * level, WIDE),
                                           surface.hit & !narrow));
        }
        out.gloss[k] = multiplied(out.gloss[k], by);
    }
    return out;
}

// Of a sky a few directions, by what they bring to what faces as the surface does, and to what it mirrors: of each look
// another share of them, and neighbouring pixels look elsewhere (picture.cpp puts them together).
inline PastSolids sky_past_solids(const FrameView &frame, const Packet &packet, const Surface &surface, int lobes,
                                  const Between &between, const LightView &light, const vec3 &start,
                                  ShadingPacket &shading) {
    constexpr float GOLDEN = 0.618033989F;
    PastSolids sum{};
    const vec3 nothing{0.0F, 0.0F, 0.0F}, to_eye = -load(shading.direction);
    sum.dull_looks = {nothing, nothing, 1e-20F};
    Real all_gloss[MAX_LOBES];
    SeenFacets seen[MAX_LOBES];
    for (int k = 0; k < lobes; ++k) {
        seen[k] = seen_facets(surface, surface.lobe[k], to_eye);
        sum.gloss_looks[k] = {nothing, nothing, 1e-20F};
        all_gloss[k] = 1e-20F;
    }
    Real all = 1e-20F;
    const Plane plane = plane_across(surface.normal);
    const auto look = [&](Real weight, const vec3 &towards, const vec3 &from, Real &worths, Passing &passed,
                          PastSolids::Looked &looked) {
        const vec3 radiance =
            (light.sky == nullptr ? vec3(1.0F, 1.0F, 1.0F) : nearest_in(light.sky->looks(), towards)) * weight;
        const Real worth = (radiance.x + radiance.y + radiance.z) * (1.0F / 3.0F);
        const Passing past = passing(between, surface, from, {towards, 1e30F, 1.0F}, surface.hit & (worth > 0.0F));
        worths = worths + worth;
        add_passing(between, worth, past, passed);
        looked.looks = looked.looks + weight;
        looked.all = looked.all + radiance;
        looked.seen = looked.seen + radiance * past.visible;
    };
    const auto add = [&](const vec3 &from, Real u, Real v, std::size_t count) {
        // The sixteen looks of neighbouring pixels are one lattice of as many times `count` points.
        const Real turn = 0.25F * (floor(4.0F * u) + v);
        for (std::size_t i = 0; i < count; ++i) {
            // Evenly over a disk: as many as their cosines over the half sphere above it (Malley's method).
            const Real number = turn + static_cast<float>(i);
            const Real x = number * (1.0F / static_cast<float>(count)), y = number * (16.0F * GOLDEN);
            const LightsText::DiskPoint disk =
                LightsText().point_on_disk(2.0F * x - 1.0F, 2.0F * (y - floor(y)) - 1.0F);
            const Real height = sqrt(max(1.0F - disk.x * disk.x - disk.y * disk.y, 1e-6F));
            // Turned, so that the edges of what is upright or level lie across the lattice's rows.
            const Real x1 = 0.8F * disk.x - 0.6F * disk.y, y1 = 0.6F * disk.x + 0.8F * disk.y;
            const vec3 towards = plane.x * x1 + plane.y * y1 + surface.normal * height;
            look(1.0F, towards, from, all, sum.diffuse, sum.dull_looks);
            // Gloss is asked half as often, by the facets that the eye sees.
            for (int k = 0; k < lobes && i % 2 == 0; ++k) {
                const vec3 facet = MicrofacetsText().seen_facet(seen[k].m, x1, y1);
                const Real worth = MicrofacetsText().masking_at(seen[k].m, facet, dot(seen[k].m.view, facet)).plain;
                look(worth, seen[k].mirrored(facet), from, all_gloss[k], sum.gloss[k], sum.gloss_looks[k]);
            }
        }
    };
    const std::size_t looks = std::clamp<std::size_t>(light.samples.size() / 4, 1, packet.sky_looks);
    for (const ShadowSample &sample : packet.shadows) {
        const Real u = Real::load_aligned(sample.u), v = Real::load_aligned(sample.v);
        add(beside(surface, start, ray_through(frame, u, v)), Real::load_aligned(sample.light_u),
            Real::load_aligned(sample.light_v), looks);
    }
    if (packet.shadows.empty()) {
        add(start, Real::load_aligned(packet.light_u), Real::load_aligned(packet.light_v), looks);
    }
    divide(between, all, sum.diffuse);
    for (int k = 0; k < lobes; ++k) {
        divide(between, all_gloss[k], sum.gloss[k]);
    }
    return sum;
}

// Of the sample that the ray stands for; or a mean over the packet's shadow samples, each by what the surface would
// make of it: with that the closed forms count as a control (Heitz, Hill and McGuire, "Combining analytic direct
// illumination and stochastic shadows", 2018), and of what hides a part of a light a mirror knows only the part that it
// shows.
inline PastSolids light_past_solids(const FrameView &frame, const Packet &packet, const Surface &surface, int lobes,
                                    const Between &between, const LightView &light, const vec3 &start,
                                    ShadingPacket &shading) {
    if (light.surrounds()) {
        return sky_past_solids(frame, packet, surface, lobes, between, light, start, shading);
    }
    PastSolids sum{};
    Real all = 0.0F, all_gloss[MAX_LOBES]{};
    const auto add = [&](const vec3 &from, Real u, Real v) {
        constexpr float NOTHING = 1e-20F; // what the surface makes nothing of is a plain mean
        const Towards towards = sample_towards(light, from, u, v);
        const Passing seen = passing(between, surface, from, towards, surface.hit);
        const Real diffuse = max(dot(surface.normal, towards.direction), 0.0F) * towards.irradiance + NOTHING;
        all = all + diffuse;
        add_passing(between, diffuse, seen, sum.diffuse);
        for (int k = 0; k < lobes; ++k) {
            const Sampled gloss = sampled(between, surface, surface.lobe[k], light, from, u, v, towards, seen, shading);
            all_gloss[k] = all_gloss[k] + gloss.worth + NOTHING;
            add_passing(between, gloss.worth + NOTHING, gloss.passing, sum.gloss[k]);
        }
    };
    for (const ShadowSample &sample : packet.shadows) {
        const Real u = Real::load_aligned(sample.u), v = Real::load_aligned(sample.v);
        add(beside(surface, start, ray_through(frame, u, v)), Real::load_aligned(sample.light_u),
            Real::load_aligned(sample.light_v));
    }
    if (packet.shadows.empty()) {
        add(start, Real::load_aligned(packet.light_u), Real::load_aligned(packet.light_v));
    }
    divide(between, all, sum.diffuse);
    for (int k = 0; k < lobes; ++k) {
        divide(between, all_gloss[k], sum.gloss[k]);
    }
    return sum;
}

// Off a surface by a few rounding errors of the coordinates, for shadow rays, and for light from the surface itself if
// that glows: whether it is seen from before or from behind must not hang on the last digit.
inline Real offset_of(const vec3 &point, Real distance) {
    return 4e-6F * max(max(abs(point.x), abs(point.y)), max(abs(point.z), distance));
}

inline bool any_spreads(const Surface &surface, Spreading from) {
    return xsimd::any(surface.hit & (surface.spreading >= static_cast<float>(from)));
}

// What grooves send of light from a direction, over Lambert's.
inline vec3 grooves(const Surface &surface, const vec3 &towards, const vec3 &to_eye) {
    const Real light = dot(surface.normal, towards), eye = dot(surface.normal, to_eye), rough = surface.roughness;
    const Real lost =
        (1.0F - SurfacesText().grooves_albedo(light, rough)) * (1.0F - SurfacesText().grooves_albedo(eye, rough));
    const Real once = SurfacesText().grooves(light, eye, dot(towards, to_eye), rough);
    return {surface.again.x * lost + once, surface.again.y * lost + once, surface.again.z * lost + once};
}

// What fibres send of it, likewise.
[[gnu::noinline]] inline Real sheen(const Surface &surface, const vec3 &towards, const vec3 &to_eye) {
    const Real light = dot(surface.normal, towards), eye = dot(surface.normal, to_eye), between = dot(towards, to_eye);
    const Mask velvet = surface.spreading == static_cast<float>(Spreading::VELVET);
    const Mask fibres = surface.spreading == static_cast<float>(Spreading::FIBRES);
    return pick(
        velvet, SurfacesText().velvet(light, eye, between, surface.roughness),
        pick(fibres, SurfacesText().fibres(light, eye, between, surface.roughness), SurfacesText().sheen(between)));
}

// What a diffuse surface sends to the eye of a light, over Lambert's: Burley's of light from the middle of it, for all
// of it; grooves' as the mean over points of the light, by what each brings, since they send most of it back.
inline vec3 over_lamberts(const Surface &surface, const LightView &light, const vec3 &point, const vec3 &to_eye) {
    vec3 out{1.0F, 1.0F, 1.0F};
    if (!any_spreads(surface, Spreading::BURLEY) && !surface.bent) {
        return out;
    }
    const vec3 middle = light.surrounds()  ? surface.normal
                        : light.parallel() ? broadcast(-light.direction)
                                           : normalised(broadcast(light.position) - point);
    const Real rim = SurfacesText().diffuse_rim(dot(surface.normal, middle), dot(surface.normal, to_eye),
                                                dot(to_eye, middle), surface.roughness);
    const Mask burley = surface.spreading == static_cast<float>(Spreading::BURLEY);
    const Real one = pick(burley, rim, 1.0F);
    Real soft = 1.0F;
    if (surface.bent && !light.surrounds()) {
        soft = SurfacesText().bent_share(dot(surface.normal, middle), dot(surface.smooth_normal, middle),
                                         dot(surface.normal, surface.smooth_normal));
    }
    const Real by_middle = one * soft;
    out = {by_middle, by_middle, by_middle};
    if (!any_spreads(surface, Spreading::GROOVES)) {
        return out;
    }
    const bool sheens = any_spreads(surface, Spreading::SHEEN); // and then all lanes are
    // Of a lattice whose rows are shifted; of a sky only half of it is above the surface.
    const int side = sheens && light.surrounds() ? 12 : 4;
    vec3 sum{0.0F, 0.0F, 0.0F};
    Real weights = 1e-30F;
    for (int k = 0; k < side * side; ++k) {
        const Real u = (static_cast<float>(k) + 0.5F) / static_cast<float>(side * side),
                   v = (static_cast<float>(k % side) + 0.5F) / static_cast<float>(side);
        const Towards towards = sample_towards(light, point, u, v);
        const Real weight = max(dot(surface.normal, towards.direction), 0.0F) * towards.irradiance;
        weights = weights + weight;
        if (sheens) {
            const Real sent = sheen(surface, towards.direction, to_eye);
            sum = sum + vec3(sent, sent, sent) * weight;
        } else {
            sum = sum + grooves(surface, towards.direction, to_eye) * weight;
        }
    }
    const Mask grooved = surface.spreading > static_cast<float>(Spreading::BURLEY);
    const Real by = soft / weights;
    return {pick(grooved, sum.x * by, out.x), pick(grooved, sum.y * by, out.y), pick(grooved, sum.z * by, out.z)};
}

// Of a light of strength 1, in a colour.
inline Real reflected_by(const Lobe &lobe, const Mirrored &gloss, int colour) {
    const Real straight_on = component(lobe.reflectance, colour);
    const Real edge = lobe.edge * (1.0F - straight_on);
    const Real sent = straight_on * gloss.plain + edge * gloss.fresnel - component(lobe.dip, colour) * gloss.dip;
    return sent * component(lobe.gain, colour);
}

inline Mask catchers(const Surface &surface) {
    return where(surface, [](const Visibility &v) { return v.seen == Seen::CATCHER; });
}

// Of the lanes that meet a surface, those that a light is to light.
inline Mask reached_by(const SurfaceView &surfaces, const LightView &light, const Surface &surface) {
    return surfaces.plain ? surface.hit
                          : where(surface, [&](const Visibility &v) { return (v.lit_by & light.reach.lights) != 0; });
}

inline Real seen_share(const PastSolids::Looked &looked, int colour) {
    const Real all = component(looked.all, colour);
    return pick(all > 0.0F, component(looked.seen, colour) / max(all, 1e-30F), 1.0F);
}

// The alpha from which neighbouring pixels' gloss of a sky is taken together.
constexpr float MIRROR = 0.08F;

inline Reflected no_light() {
    const vec3 nothing{0.0F, 0.0F, 0.0F};
    const FromSky none{{0.0F, 0.0F, 0.0F}, nothing, nothing, 0.0F};
    return {
        {0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 0.0F, {0.0F, 0.0F, 0.0F}, 0.0F, 0.0F, {0.0F, 0.0F, 0.0F}, none, none,
        {0.0F, 0.0F, 0.0F}};
}

inline Reflected reflected(const FrameView &frame, LayerSet wanted, const Packet &packet, const Ray &ray,
                           const Surface &surface) {
    Reflected out = no_light();
    const bool radiance = wanted.has(Layer::RADIANCE);
    const bool catches = radiance && !frame.surfaces.plain && xsimd::any(catchers(surface));
    if (radiance) {
        const Real emissions[3] = {surface.emission.x, surface.emission.y, surface.emission.z};
        for (int c = 0; c < 3; ++c) {
            out.open[c] = out.shadowed[c] = emissions[c];
            out.unshadowed = out.unshadowed + emissions[c] * (1.0F / 3.0F);
        }
    }
    const vec3 point = ray.origin + ray.direction * surface.distance;
    const vec3 start = point + surface.geometric_normal * offset_of(point, surface.distance);
    // A share in shadow is one of what comes, not of what is reflected.
    const int lobes = radiance ? surface.lobes : 0;
    const bool textured = radiance && xsimd::any(surface.varied);
    ShadingPacket packed;
    pack(surface, start, ray.direction, packed);
    Real facing[3] = {1e-20F, 1e-20F, 1e-20F};
    for (const LightView &light : frame.lights) {
        shade_diffuse(light, packed);
        const Real whole_diffuse = Real::load_aligned(packed.diffuse);
        const Mask reached = reached_by(frame.surfaces, light, surface);
        // Where surfaces light each other, rays for that find the sky, too.
        const bool spreads = light.reach.diffuse && !(radiance && frame.bounces.diffuse && light.surrounds());
        const Real diffuse = spreads ? pick(reached, whole_diffuse, 0.0F) : Real(0.0F);
        Mirrored gloss[MAX_LOBES];
        Mask lit = diffuse > 0.0F;
        const int mirrors = light.reach.gloss ? lobes : 0;
        for (int k = 0; k < mirrors; ++k) {
            gloss[k] = mirrored(light, surface, surface.lobe[k], packed);
            lit = lit | (gloss[k].plain > 0.0F);
        }
        lit = lit & reached;
        const bool any_lit = xsimd::any(lit);
        if (radiance && !any_lit) {
            continue;
        }
        if (!radiance) {
            // From the light's middle: a share's denominator must not depend on where this sample fell.
            const Real whole = sample_towards(light, start, 0.5F, 0.5F).irradiance;
            const Real irradiance = light.reach.diffuse ? pick(reached, whole, 0.0F) : Real(0.0F);
            for (int c = 0; c < 3; ++c) {
                facing[c] = facing[c] + irradiance * light.strength[c];
            }
        }
        if (!any_lit) {
            continue;
        }
        const Between between{&frame.surfaces, light.solids, light.sheets};
        const PastSolids past = light_past_solids(frame, packet, surface, mirrors, between, light, start, packed);
        const Real visible = pick(lit, past.diffuse.visible, 0.0F);
        for (int k = 0; k < mirrors; ++k) {
            gloss[k].visible = pick(lit, past.gloss[k].visible, 0.0F);
        }
        if (light.surrounds()) {
            out.dull.all = past.dull_looks.all;
            out.dull.seen = past.dull_looks.seen;
        }
        PastSolids alone{};
        if (catches && light.reach.plate) {
            const Between catchers{&frame.surfaces, frame.surfaces.catchers, {}};
            alone = light_past_solids(frame, packet, surface, mirrors, catchers, light, start, packed);
        }
        const bool tinted = between.tinted();
        Real past_hair[3], through[3];
        media_transmittance(frame, light, point, surface.normal, past_hair, through);
        if (light.finer > 1.0F && (light.area > 0.0F || (light.parallel() && !light.surrounds())) &&
            light.samples.size() == 1) {
            weigh_point(light, point, surface.normal, whole_diffuse, through);
        }
        const auto left = [&](Real seen, const Passing &passed, int colour) {
            const Real arrives = seen * past_hair[colour];
            return tinted ? arrives * component(passed.tint, colour) : arrives;
        };
        vec3 spread = radiance ? over_lamberts(surface, light, start, -ray.direction) : vec3(0.0F, 0.0F, 0.0F);
        OfSky coloured{vec3(1.0F, 1.0F, 1.0F), {}};
        if (light.sky != nullptr) {
            coloured = of_sky(*light.sky, surface, mirrors, -ray.direction);
            spread = spread * coloured.diffuse;
        }
        for (int c = 0; c < 3; ++c) {
            if (radiance) {
                const Real dull = component(surface.albedo, c) * diffuse * component(spread, c) * light.strength[c];
                Real sent = dull * left(visible, past.diffuse, c), all = dull;
                // What of it is textured, over what it would be if it were not.
                Real textured_dull = 0.0F, even_dull = 0.0F;
                if (textured) {
                    textured_dull = dull;
                    even_dull = surface.even * diffuse * component(spread, c) * light.strength[c];
                }
                if (light.surrounds()) {
                    const Real whole = left(1.0F, past.diffuse, c) * dull;
                    sent = whole * pick(lit, seen_share(past.dull_looks, c), 0.0F);
                    out.dull.light[c] = whole * through[c];
                    const Real told =
                        textured ? pick(surface.varied, even_dull * left(1.0F, past.diffuse, c), whole) : whole;
                    out.dull.open = out.dull.open + told * (1.0F / 3.0F);
                }
                Real kept = dull * alone.diffuse.visible;
                for (int k = 0; k < mirrors; ++k) {
                    // Lanes without this layer, whose facets have no width, may hold anything that is no number.
                    const Mask there = reached & (surface.lobe[k].alpha_x > 0.0F);
                    Real shine = pick(there, reflected_by(surface.lobe[k], gloss[k], c), 0.0F) * light.strength[c];
                    if (light.sky != nullptr) {
                        shine = shine * component(coloured.gloss[k], c);
                    }
                    all = all + shine;
                    if (light.surrounds()) {
                        const Real whole = shine * left(1.0F, past.gloss[k], c);
                        const PastSolids::Looked &looked = past.gloss_looks[k];
                        sent = sent + pick(there, whole * seen_share(looked, c), 0.0F);
                        // What is nearly a mirror is as sharp as what it shows.
                        const Mask blurred = there & lit & (alpha_of(surface.lobe[k]) > MIRROR);
                        out.gloss.light[c] = out.gloss.light[c] + pick(blurred, whole * through[c], 0.0F);
                        const Real mean = light.sky == nullptr
                                              ? Real(1.0F)
                                              : max(component(coloured.gloss[k], c) * light.sky->mean()[c], 1e-30F);
                        const Real each = pick(blurred, whole / (mean * looked.looks), 0.0F);
                        out.gloss.all[c] = out.gloss.all[c] + pick(blurred, each * component(looked.all, c), 0.0F);
                        out.gloss.seen[c] = out.gloss.seen[c] + pick(blurred, each * component(looked.seen, c), 0.0F);
                        out.gloss.open = out.gloss.open + pick(blurred, whole * (1.0F / 3.0F), 0.0F);
                    } else {
                        sent = sent + pick(there, shine * left(gloss[k].visible, past.gloss[k], c), 0.0F);
                    }
                    kept = kept + pick(there, shine * alone.gloss[k].visible, 0.0F);
                }
                if (textured) {
                    const Real passed = light.surrounds() ? left(1.0F, past.diffuse, c) *
                                                                pick(lit, seen_share(past.dull_looks, c), 0.0F)
                                                          : left(visible, past.diffuse, c);
                    const Real more = even_dull - textured_dull;
                    out.even = out.even + (sent + more * passed) * (1.0F / 3.0F);
                    out.even_unshadowed = out.even_unshadowed + (all + more) * (1.0F / 3.0F);
                }
                out.unshadowed = out.unshadowed + all * (1.0F / 3.0F);
                out.lit[c] = out.lit[c] + all;
                out.open[c] = out.open[c] + sent;
                out.shadowed[c] = out.shadowed[c] + sent * through[c];
                if (catches && light.reach.plate) {
                    out.alone[c] = out.alone[c] + pick(lit, kept, 0.0F);
                }
                continue;
            }
            // The share of light that is missing, of all that would be there if the surface faced every light.
            const Real all = diffuse * (3.14159265F * light.strength[c]) *
                             (light.sky == nullptr ? Real(1.0F) : component(coloured.diffuse, c));
            out.unshadowed = out.unshadowed + all * (1.0F / 3.0F);
            const Real solid = all * left(visible, past.diffuse, c);
            out.shadowed[c] = out.shadowed[c] + ((wanted.has(Layer::ALL_SHADOWS) ? all : solid) - solid * through[c]);
        }
    }
    if (!radiance) {
        for (int c = 0; c < 3; ++c) {
            out.shadowed[c] = min(out.shadowed[c] / facing[c], 1.0F);
        }
    }
    return out;
}

// Of an artist's mist, with what is not a surface at its end.
inline Real mist_at(const Mist &mist, const vec3 &point, Mask hit) {
    const vec3 away = point - broadcast(mist.eye), axis = broadcast(mist.axis);
    const bool parallel = mist.axis != glm::vec3(0.0F);
    const Real distance = parallel ? dot(away, axis) : sqrt(dot(away, away));
    const Real share = clamp((distance - mist.start) * (1.0F / mist.depth), 0.0F, 1.0F);
    return pick(hit, xsimd::pow(share, Real(mist.power)), 1.0F);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
