// SPDX-License-Identifier: GPL-3.0-or-later
// What rays from one surface bring of the next.
#include "frame/bounced_lanes.hpp"
#include "frame/more_lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <numbers>

namespace sfumato::SFUMATO_ISA {

// march_lanes.cpp: what smoke on rays sends, and what it leaves of all beyond `reach`.
void march_rays(const FrameView &frame, const BounceRays &rays, const float *reach, float (&sent)[3][MAX_LANES],
                float (&left)[3][MAX_LANES]);

namespace {

constexpr float FAR = 1e6F; // metres

struct MetSurface {
    Ray ray;
    Surface surface;
};

inline MetSurface met_along(const FrameView &frame, const vec3 &origin, const vec3 &direction, Mask active) {
    MetSurface out;
    out.ray = Ray{origin, direction, FAR};
    out.surface = first_surface(frame.surfaces, frame.surfaces.seen, out.ray, active, nullptr);
    if (xsimd::any(out.surface.hit)) {
        // For what lights stand for, these are asked.
        const Mask lamp =
            out.surface.hit & (gather(frame.surfaces.properties + material_row::LAMP, out.surface.material) > 0.5F);
        out.surface.emission = pick(lamp, vec3(0.0F, 0.0F, 0.0F), out.surface.emission);
    }
    return out;
}

// What comes from skies to what is matt, less what sheets take.
inline vec3 sky_along(const FrameView &frame, const vec3 &origin, const vec3 &direction, Mask asked) {
    vec3 sum{0.0F, 0.0F, 0.0F};
    for (const LightView &light : frame.lights) {
        if (!light.surrounds() || !light.reach.diffuse || !xsimd::any(asked)) {
            continue;
        }
        vec3 radiance = broadcast(light.strength * (0.25F * std::numbers::inv_pi_v<float>));
        if (light.sky != nullptr) {
            const glm::vec3 by = 1.0F / glm::max(light.sky->mean(), glm::vec3(1e-30F));
            radiance = multiplied(radiance, multiplied(nearest_in(light.sky->looks(), direction), broadcast(by)));
        }
        if (light.sheets.scene != nullptr) {
            radiance =
                multiplied(radiance, past_sheets(frame.surfaces, light.sheets, origin, direction, Real(1e30F), asked));
        }
        sum = sum + radiance;
    }
    return pick(asked, sum, vec3(0.0F, 0.0F, 0.0F));
}

// Of gloss, what it sends to all sides.
inline vec3 shine_of(const Surface &surface) {
    vec3 sum{0.0F, 0.0F, 0.0F};
    for (int k = 0; k < surface.lobes; ++k) {
        const Lobe &lobe = surface.lobe[k];
        sum = sum + pick(lobe.alpha_x > 0.0F, multiplied(lobe.reflectance, lobe.gain), vec3(0.0F, 0.0F, 0.0F));
    }
    return sum;
}

} // namespace

void shine(const FrameView &frame, BounceRays &rays) {
    const Mask active = Real::load_aligned(rays.active) > 0.0F;
    const vec3 nothing{0.0F, 0.0F, 0.0F};
    vec3 radiance = nothing;
    const MetSurface met = met_along(frame, load(rays.origin), load(rays.direction), active);
    const Surface &surface = met.surface;
    if (xsimd::any(surface.hit)) {
        KeptLanes kept{nothing, nothing, nothing};
        const vec3 point = met.ray.origin + met.ray.direction * surface.distance;
        if (frame.bounces.cache != nullptr) {
            kept = kept_lanes(*frame.bounces.cache, point, surface.normal, surface.hit);
        }
        const vec3 gloss = shine_of(surface);
        if (rays.closely) {
            Packet packet;
            std::copy_n(rays.light_u, LANES, packet.light_u);
            std::copy_n(rays.light_v, LANES, packet.light_v);
            const Reflected light = all_reflected(frame, Layer::RADIANCE, packet, met.ray, surface);
            radiance = vec3(light.shadowed[0], light.shadowed[1], light.shadowed[2]) +
                       multiplied(surface.albedo + gloss, kept.settled);
        } else {
            radiance = surface.emission + multiplied(surface.albedo + gloss, kept.direct + kept.indirect);
        }
        radiance = pick(surface.hit, radiance, nothing);
    }
    if (rays.closely && !frame.seen_media.empty() && xsimd::any(active)) {
        alignas(64) float reach[MAX_LANES], sent[3][MAX_LANES], left[3][MAX_LANES];
        pick(active, surface.distance, 0.0F).store_aligned(reach);
        march_rays(frame, rays, reach, sent, left);
        radiance = load(sent) + multiplied(radiance, load(left));
    }
    store(pick(active, radiance, nothing), rays.radiance);
    if (!rays.closely) {
        store(sky_along(frame, met.ray.origin, met.ray.direction, active & !surface.hit), rays.sky);
    }
}

void meet(const FrameView &frame, std::span<const BounceRay> rays, std::span<BouncePoint> out) {
    for (std::size_t first = 0; first < rays.size(); first += LANES) {
        const auto some = rays.subspan(first, std::min(rays.size() - first, std::size_t{LANES}));
        alignas(64) float origin[3][MAX_LANES], direction[3][MAX_LANES], active[MAX_LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const BounceRay &ray = some[std::min(lane, some.size() - 1)];
            for (int axis = 0; axis < 3; ++axis) {
                origin[axis][lane] = ray.origin[axis];
                direction[axis][lane] = ray.direction[axis];
            }
            active[lane] = lane < some.size() ? 1.0F : 0.0F;
        }
        const MetSurface met = met_along(frame, load(origin), load(direction), Real::load_aligned(active) > 0.0F);
        const Surface &surface = met.surface;
        const bool any = xsimd::any(surface.hit);
        const Mask missed = (Real::load_aligned(active) > 0.0F) & !surface.hit;
        const vec3 beyond = frame.bounces.diffuse ? sky_along(frame, met.ray.origin, met.ray.direction, missed)
                                                  : vec3(0.0F, 0.0F, 0.0F);
        alignas(64) float hits[MAX_LANES], position[3][MAX_LANES], normal[3][MAX_LANES], albedo[3][MAX_LANES],
            emission[3][MAX_LANES];
        pick(surface.hit, 1.0F, 0.0F).store_aligned(hits);
        store(beyond, emission);
        if (any) {
            const vec3 point = met.ray.origin + met.ray.direction * surface.distance;
            store(point + surface.geometric_normal * offset_of(point, surface.distance), position);
            store(surface.normal, normal);
            store(surface.albedo + shine_of(surface), albedo);
            store(pick(surface.hit, surface.emission, beyond), emission);
        }
        for (std::size_t lane = 0; lane < some.size(); ++lane) {
            BouncePoint &point = out[first + lane];
            point = {};
            point.hit = any && hits[lane] > 0.0F;
            for (int axis = 0; axis < 3; ++axis) {
                point.emission[axis] = emission[axis][lane];
            }
            for (int axis = 0; axis < 3 && point.hit; ++axis) {
                point.position[axis] = position[axis][lane];
                point.normal[axis] = normal[axis][lane];
                point.albedo[axis] = albedo[axis][lane];
            }
        }
    }
}

void lit(const FrameView &frame, std::span<const BouncePoint> points, std::span<glm::vec3> out) {
    static constexpr Visibility PLAIN{};
    for (std::size_t first = 0; first < points.size(); first += LANES) {
        const auto some = points.subspan(first, std::min(points.size() - first, std::size_t{LANES}));
        alignas(64) float position[3][MAX_LANES], normal[3][MAX_LANES];
        Packet packet;
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const BouncePoint &point = some[std::min(lane, some.size() - 1)];
            for (int axis = 0; axis < 3; ++axis) {
                position[axis][lane] = point.position[axis];
                normal[axis][lane] = point.normal[axis];
            }
            // Roberts' additive recurrence of the plastic number (2018).
            const double number = static_cast<double>(first + lane) + 0.5;
            packet.light_u[lane] = static_cast<float>(std::fmod(number * 0.7548776662466927, 1.0));
            packet.light_v[lane] = static_cast<float>(std::fmod(number * 0.5698402909980532, 1.0));
        }
        Surface surface;
        surface.hit = Mask(true);
        surface.normal = surface.geometric_normal = load(normal);
        surface.distance = 1.0F;
        surface.albedo = {1.0F, 1.0F, 1.0F};
        surface.spreading = static_cast<float>(Spreading::LAMBERT);
        surface.roughness = 0.0F;
        surface.again = {0.0F, 0.0F, 0.0F};
        std::fill_n(surface.visibility, LANES, &PLAIN);
        const Ray ray{load(position) + surface.normal, -surface.normal, Real(1.0F)};
        const Reflected light = reflected(frame, Layer::RADIANCE, packet, ray, surface);
        alignas(64) float sent[3][MAX_LANES];
        for (int c = 0; c < 3; ++c) {
            light.shadowed[c].store_aligned(sent[c]);
        }
        for (std::size_t lane = 0; lane < some.size(); ++lane) {
            out[first + lane] = {sent[0][lane], sent[1][lane], sent[2][lane]};
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
