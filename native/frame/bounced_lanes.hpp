// SPDX-License-Identifier: GPL-3.0-or-later
// The light that a packet of surfaces sends on from other surfaces.
#pragma once

#include "frame/bounce.hpp"
#include "frame/light_cells.hpp"
#include "frame/more_lanes.hpp"
#include "frame/reflected_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sfumato::SFUMATO_ISA {

void shine(const FrameView &frame, BounceRays &rays); // bounce_lanes.cpp

namespace {

// What is kept at a place of light that comes to a white matt surface.
struct KeptLight {
    glm::vec3 direct{0.0F}, indirect{0.0F}, settled{0.0F};
};

// Linear between the cells around a place, of those that are known.
inline KeptLight kept_light(const LightCacheView &cache, const glm::vec3 &place, const glm::vec3 &normal) {
    const glm::vec3 away = place - cache.eye;
    const float distance = std::sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
    const int level = cell_level(cache, distance);
    const std::uint32_t face = cell_face(normal);
    const float by = 1.0F / std::ldexp(cache.size, level);
    const glm::vec3 q = away * by - 0.5F;
    const glm::vec3 low{std::floor(q.x), std::floor(q.y), std::floor(q.z)}, beyond = q - low;
    KeptLight sum;
    float weights = 0.0F;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        const float weight = (dx == 1 ? beyond.x : 1.0F - beyond.x) * (dy == 1 ? beyond.y : 1.0F - beyond.y) *
                             (dz == 1 ? beyond.z : 1.0F - beyond.z);
        const std::uint32_t key = cell_key(level, face, static_cast<int>(low.x) + dx, static_cast<int>(low.y) + dy,
                                           static_cast<int>(low.z) + dz);
        const std::uint32_t slot = cell_slot(cache.keys, cache.mask, key);
        if (cache.keys[slot] != NO_CELL) {
            weights += weight;
            sum.direct += cache.direct[slot] * weight;
            sum.indirect += cache.indirect[slot] * weight;
            sum.settled += cache.settled[slot] * weight;
        }
    }
    if (weights > 0.0F) {
        const float share = 1.0F / weights;
        return {sum.direct * share, sum.indirect * share, sum.settled * share};
    }
    return sum;
}

// The same of a packet.
struct KeptLanes {
    vec3 direct, indirect, settled;
};

[[gnu::noinline]] inline KeptLanes kept_lanes(const LightCacheView &cache, const vec3 &place, const vec3 &normal,
                                              Mask asked) {
    alignas(64) float places[3][MAX_LANES], normals[3][MAX_LANES], wanted[MAX_LANES];
    alignas(64) float out[9][MAX_LANES];
    store(place, places);
    store(normal, normals);
    pick(asked, 1.0F, 0.0F).store_aligned(wanted);
    for (int lane = 0; lane < LANES; ++lane) {
        KeptLight light;
        if (wanted[lane] > 0.0F) {
            light = kept_light(cache, {places[0][lane], places[1][lane], places[2][lane]},
                               {normals[0][lane], normals[1][lane], normals[2][lane]});
        }
        for (int c = 0; c < 3; ++c) {
            out[c][lane] = light.direct[c];
            out[3 + c][lane] = light.indirect[c];
            out[6 + c][lane] = light.settled[c];
        }
    }
    const auto loaded = [&out](int first) {
        return vec3(Real::load_aligned(out[first]), Real::load_aligned(out[first + 1]),
                    Real::load_aligned(out[first + 2]));
    };
    return {loaded(0), loaded(3), loaded(6)};
}

// Of what others send to a surface, what it sends on: `weight` times the mean of what rays find, which neighbouring
// pixels share; and what is as sharp as it is.
struct FromOthers {
    struct Part {
        vec3 weight, found;
    };
    Part dull, gloss;
    vec3 sharp;
};

inline FromOthers from_no_others() {
    const vec3 nothing{0.0F, 0.0F, 0.0F};
    return {{nothing, nothing}, {nothing, nothing}, nothing};
}

// Directions to what is bright of what lies around a surface, by a density of their own beside the cosine's.
class BrightGuide {
public:
    BrightGuide(const LightCacheView &cache, const vec3 &point, const vec3 &normal) : count_(cache.bright_count) {
        Real sum = 1e-30F;
        for (int k = 0; k < count_; ++k) {
            const BrightPlace &place = cache.bright[static_cast<std::size_t>(k)];
            const vec3 there = broadcast(place.middle) - point;
            const Real distance2 = max(dot(there, there), 1e-20F), distance = sqrt(distance2);
            Cone &cone = cones_[k];
            cone.axis = there * (1.0F / distance);
            const Real sine = place.radius / distance;
            const Mask outside = sine < 0.95F;
            cone.cosine = sqrt(1.0F - min(sine * sine, 0.9025F));
            const Real facing = max(dot(cone.axis, normal) + sine, 0.0F);
            cone.share = pick(outside, place.flux * facing / distance2, 0.0F);
            sum = sum + cone.share;
        }
        for (int k = 0; k < count_; ++k) {
            cones_[k].share = cones_[k].share * (1.0F / sum);
        }
        any_ = sum > 1e-29F;
    }

    // Whether anything that is bright can be seen, and is not too close for that.
    [[nodiscard]] Mask any() const { return any_; }

    // For a point of the unit square.
    [[nodiscard]] vec3 direction(Real u, Real v) const {
        vec3 axis{0.0F, 0.0F, 1.0F};
        Real cosine = 1.0F, below = 0.0F, within = u;
        for (int k = 0; k < count_; ++k) {
            const Cone &cone = cones_[k];
            const Mask chosen = (u >= below) & (cone.share > 0.0F);
            axis = pick(chosen, cone.axis, axis);
            cosine = pick(chosen, cone.cosine, cosine);
            within = pick(chosen, (u - below) / max(cone.share, 1e-20F), within);
            below = below + cone.share;
        }
        const Real height = 1.0F - clamp(within, 0.0F, 1.0F) * (1.0F - cosine), angle = 6.28318531F * v;
        const Real across = sqrt(max(1.0F - height * height, 0.0F));
        const Plane plane = plane_across(axis);
        return axis * height + (plane.x * cos(angle) + plane.y * sin(angle)) * across;
    }

    // By the solid angle.
    [[nodiscard]] Real density(const vec3 &direction) const {
        Real sum = 0.0F;
        for (int k = 0; k < count_; ++k) {
            const Cone &cone = cones_[k];
            const Mask within = dot(direction, cone.axis) >= cone.cosine;
            sum = sum + pick(within, cone.share / (6.28318531F * max(1.0F - cone.cosine, 1e-6F)), 0.0F);
        }
        return sum;
    }

private:
    struct Cone {
        vec3 axis;
        Real cosine, share;
    };
    int count_;
    Mask any_ = Mask(false);
    Cone cones_[LightCacheView::MOST_BRIGHT];
};

// Of gloss that reflects less, whatever it shows is left out.
constexpr float LEAST_GLOSS = 0.01F;
// The least slope of facets that lights know: ALPHA_MIN.
constexpr float LEAST_ALPHA = 0.01F;

// `settled`: by what is kept, and one ray where a mirror would have it; else by rays that differ from pixel to pixel.
[[gnu::noinline]] inline FromOthers from_others(const FrameView &frame, const Packet &packet, const Ray &ray,
                                                const Surface &surface, Mask asked, bool settled) {
    constexpr double GOLDEN = 0.6180339887498949;
    constexpr std::size_t GLOSS_LOOKS = 2;
    constexpr float RIM = 1e-3F; // on which facets would lie flat
    const BounceView &bounces = frame.bounces;
    FromOthers out = from_no_others();
    const vec3 point = ray.origin + ray.direction * surface.distance, to_eye = -ray.direction;
    const vec3 start = point + surface.geometric_normal * offset_of(point, surface.distance);
    ShadingPacket shading;
    pack(surface, start, ray.direction, shading);
    const LightView &white = *bounces.surroundings;

    const bool dull =
        bounces.diffuse && xsimd::any(asked & (max(max(surface.albedo.x, surface.albedo.y), surface.albedo.z) > 0.0F));
    if (dull) {
        out.dull.weight = multiplied(surface.albedo, over_lamberts(surface, white, start, to_eye));
    }
    Real share[MAX_LOBES]; // of the gloss there is
    Mask sharp[MAX_LOBES], blurred[MAX_LOBES];
    vec3 colour[MAX_LOBES];
    SeenFacets seen[MAX_LOBES];
    const int lobes = bounces.gloss ? surface.lobes : 0;
    bool any_gloss = false;
    for (int k = 0; k < lobes; ++k) {
        const Lobe &lobe = surface.lobe[k];
        const Mirrored all = mirrored(white, surface, lobe, shading);
        const auto of = [&](int c) { return max(reflected_by(lobe, all, c) * white.strength[0], 0.0F); };
        const Mask there = asked & (lobe.alpha_x > 0.0F);
        colour[k] = pick(there, vec3(of(0), of(1), of(2)), vec3(0.0F, 0.0F, 0.0F));
        share[k] = (colour[k].x + colour[k].y + colour[k].z) * (1.0F / 3.0F);
        const Mask shown = there & (share[k] > LEAST_GLOSS);
        sharp[k] = shown & (alpha_of(lobe) <= MIRROR);
        blurred[k] = shown & !(alpha_of(lobe) <= MIRROR);
        any_gloss = any_gloss || xsimd::any(shown);
        if (xsimd::any(shown)) {
            seen[k] = seen_facets(surface, lobe, to_eye);
        }
    }
    if (settled && dull) {
        out.dull.found = kept_lanes(*bounces.cache, start, surface.normal, asked).settled;
    }
    const bool gathers = dull && !settled && packet.looks > 0;
    if (!gathers && !any_gloss) {
        return out;
    }

    const Plane plane = plane_across(surface.normal);
    vec3 found_sky{0.0F, 0.0F, 0.0F}, sky = found_sky; // by the last ray, and all
    const auto follow = [&](const vec3 &from, const vec3 &towards, Mask these, Real u, Real v, bool closely) {
        BounceRays rays;
        store(from, rays.origin);
        store(towards, rays.direction);
        // Facets may mirror what is below the surface.
        pick(these & (dot(surface.geometric_normal, towards) > 0.0F), 1.0F, 0.0F).store_aligned(rays.active);
        u.store_aligned(rays.light_u);
        v.store_aligned(rays.light_v);
        rays.closely = closely;
        shine(frame, rays);
        if (!closely) {
            found_sky = load(rays.sky);
        }
        return load(rays.radiance);
    };
    std::optional<BrightGuide> guide;
    std::size_t guided_count = 0;
    if (gathers && packet.looks > 1 && bounces.cache->bright_count > 0) {
        guide.emplace(*bounces.cache, start, surface.normal);
        guided_count = static_cast<std::size_t>(packet.looks) / 2;
    }
    Real gloss_worths[MAX_LOBES];
    vec3 gloss_found[MAX_LOBES];
    for (int k = 0; k < lobes; ++k) {
        gloss_worths[k] = 1e-20F;
        gloss_found[k] = {0.0F, 0.0F, 0.0F};
    }
    const auto look = [&](const vec3 &from, Real u, Real v, std::size_t count) {
        // The looks of neighbouring pixels, or of one's samples, share the square: each has `count` points around its
        // own.
        for (std::size_t i = 0; i < count; ++i) {
            // Those of either density share it among themselves.
            const bool guided = i >= count - guided_count;
            const std::size_t alike = guided ? guided_count : count - guided_count;
            const double number = static_cast<double>(guided ? i - (count - guided_count) : i) + 0.5;
            const auto shifted = [](Real middle, double to) {
                const Real at = middle + static_cast<float>(0.125 * (to - 0.5));
                return clamp(at - floor(at), RIM, 1.0F - RIM);
            };
            const Real x = shifted(u, number / static_cast<double>(alike));
            const Real y = shifted(v, std::fmod(GOLDEN * number, 1.0));
            const LightsText::DiskPoint disk = LightsText().point_on_disk(2.0F * x - 1.0F, 2.0F * y - 1.0F);
            // Turned, so that the edges of what is upright or level lie across the lattice's rows.
            const Real x1 = 0.8F * disk.x - 0.6F * disk.y, y1 = 0.6F * disk.x + 0.8F * disk.y;
            if (gathers) {
                // As many as their cosines (Malley's method), or where it is bright; and both count by the density of
                // all together (Veach and Guibas' balance heuristic, 1995).
                const Real height = sqrt(max(1.0F - disk.x * disk.x - disk.y * disk.y, 1e-6F));
                const vec3 towards =
                    guided ? guide->direction(x, y) : plane.x * x1 + plane.y * y1 + surface.normal * height;
                Real worth = 1.0F / static_cast<float>(count);
                if (guided_count > 0) {
                    const Real own = max(dot(towards, surface.normal), 0.0F) * 0.318309886F;
                    const Real others = pick(guide->any(), static_cast<float>(guided_count), 0.0F);
                    worth = own / max(static_cast<float>(count - guided_count) * own + others * guide->density(towards),
                                      1e-20F);
                    worth = guided ? pick(guide->any(), worth, 0.0F) : worth;
                }
                out.dull.found = out.dull.found + follow(from, towards, asked & (worth > 0.0F), x, y, false) * worth;
                sky = sky + found_sky * pick(asked & (worth > 0.0F), worth, 0.0F);
            }
            for (int k = 0; k < lobes && i < GLOSS_LOOKS; ++k) {
                const Mask these =
                    (i == 0 ? sharp[k] : Mask(false)) | (settled || packet.looks > 0 ? blurred[k] : Mask(false));
                if (!xsimd::any(these)) {
                    continue;
                }
                // A view that moves shows what lies where a mirror would. Slopes of less than the least are in
                // proportion.
                const Real narrow = min(alpha_of(surface.lobe[k]) * (1.0F / LEAST_ALPHA), 1.0F);
                const Real spread = settled ? Real(0.0F) : narrow;
                const vec3 facet = MicrofacetsText().seen_facet(seen[k].m, x1 * spread, y1 * spread);
                const vec3 towards = seen[k].mirrored(facet);
                const Real worth =
                    pick(these, MicrofacetsText().masking_at(seen[k].m, facet, dot(seen[k].m.view, facet)).plain, 0.0F);
                const bool closely = bounces.cache == nullptr || xsimd::any(sharp[k]);
                gloss_worths[k] = gloss_worths[k] + worth;
                gloss_found[k] = gloss_found[k] + follow(from, towards, these, x, y, closely) * worth;
            }
        }
    };
    const auto looks = static_cast<std::size_t>(std::max(packet.looks, 1));
    look(start, Real::load_aligned(packet.look_u), Real::load_aligned(packet.look_v),
         settled   ? 1
         : gathers ? looks
                   : std::min(looks, GLOSS_LOOKS));
    if (gathers) {
        for (const LightView &light : frame.lights) {
            if (light.surrounds()) { // of a sky there is one
                Real past_hair[3], past_smoke[3];
                media_transmittance(frame, light, point, surface.normal, past_hair, past_smoke);
                for (int c = 0; c < 3; ++c) {
                    sky[c] = sky[c] * past_hair[c] * past_smoke[c];
                }
            }
        }
        out.dull.found = out.dull.found + sky;
    }
    // Of several layers the filter sees one, in the colour of all that they show.
    for (int k = 0; k < lobes; ++k) {
        const vec3 sent = multiplied(colour[k], gloss_found[k] * (1.0F / gloss_worths[k]));
        out.sharp = out.sharp + pick(sharp[k], sent, vec3(0.0F, 0.0F, 0.0F));
        out.gloss.weight = out.gloss.weight + pick(blurred[k], colour[k], vec3(0.0F, 0.0F, 0.0F));
        out.gloss.found = out.gloss.found + pick(blurred[k], sent, vec3(0.0F, 0.0F, 0.0F));
    }
    for (int c = 0; c < 3; ++c) {
        out.gloss.found[c] = out.gloss.found[c] / max(out.gloss.weight[c], 1e-20F);
    }
    return out;
}

// What neighbouring pixels share is no edge.
inline void add_from_others(const FromOthers &others, Reflected &light) {
    const vec3 shared =
        multiplied(others.dull.weight, others.dull.found) + multiplied(others.gloss.weight, others.gloss.found);
    for (int c = 0; c < 3; ++c) {
        const Real sharp = component(others.sharp, c);
        light.shadowed[c] = light.shadowed[c] + sharp + component(shared, c);
        light.open[c] = light.open[c] + sharp;
        light.bounced[c] = sharp + component(shared, c);
        light.unshadowed = light.unshadowed + sharp * (1.0F / 3.0F);
        light.even = light.even + sharp * (1.0F / 3.0F);
        light.even_unshadowed = light.even_unshadowed + sharp * (1.0F / 3.0F);
    }
}

// To what light comes through, what is kept of that of others on the other side.
inline void add_from_behind(const FrameView &frame, const Packet &packet, const Ray &ray, const Surface &surface,
                            Mask asked, Reflected &light, Reflected *own = nullptr) {
    if (frame.surfaces.more && xsimd::any(asked & any_colour(surface.translucence))) {
        const Surface other = behind(surface);
        const FromOthers others = from_others(frame, packet, ray, other, asked & other.hit, true);
        add_from_others(others, light);
        if (own != nullptr) {
            add_from_others(others, *own);
        }
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
