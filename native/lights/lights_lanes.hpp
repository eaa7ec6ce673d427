// SPDX-License-Identifier: GPL-3.0-or-later
// Lights as the lane kernels see them: which way they lie, and how they fade.
#pragma once

#include "lights/light.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cstddef>

#include <glm/geometric.hpp>

namespace sfumato::SFUMATO_ISA {
namespace {

using LightsText = text::LightsText<Real, Isa>;

inline vec3 normalised(const vec3 &v) {
    return v * (1.0F / sqrt(dot(v, v)));
}

// Whether what is seen of it is the surface of a ball.
inline bool is_ball(const LightView &light) {
    return light.kind == LightKind::SPHERE && light.facing2 == 0.0F && light.radius > 0.0F;
}

// What the smoke takes for the light at a point: it falls off from the light's middle, and all else that happens to it
// is in the light volume.
inline Real falloff_of(const LightView &light, const vec3 &from_light) {
    return light.parallel() ? Real(1.0F) : LightsText().falloff(dot(from_light, from_light), light.size2);
}

inline Real spot_share(const LightView &light, const vec3 &from_light) {
    if (light.cone_cosine <= -1.0F) {
        return 1.0F;
    }
    const vec3 axis = broadcast(light.direction);
    const Real cosine = light.oval
                            ? LightsText().oval_cosine(from_light, axis, broadcast(light.across), broadcast(light.up))
                            : dot(from_light, axis) / sqrt(max(dot(from_light, from_light), 1e-20F));
    const Real fade = LightsText().spot_fade(cosine, light.cone_cosine, light.blend);
    return light.spot_cosine ? fade * cosine : fade;
}

// Each part of a sun's disk brings as much to a surface that faces its middle, and more to what faces the part. The
// rim of a sun that fills half the sky would bring that surface next to nothing for infinitely much.
constexpr float LOWEST_SUN = 0.02F;

// What a part of an area light sends in a direction whose cosine to the light's is given, of its radiance by its area.
inline Real sent_along(const LightView &light, Real cosine) {
    return light.kind == LightKind::POLYGON
               ? abs(cosine)
               : max(cosine, 0.0F) * LightsText().spread_fade(cosine, light.spread_cotangent);
}

// The same for all of a patch around a sample. Where what shines at a point would slip through between samples, a
// sample's light spreads as wide as two radii of its patch, and loses as much by it. `height`: above the lamp's plane.
inline Real patch_fade(const LightView &light, Real cosine, Real height, float patch) {
    const Real steep = light.spread_cotangent / max(height, 1e-9F);
    const Real lower = 1.0F / max(4.0F * 0.318309886F * patch * steep * steep, 1.0F);
    return lower * LightsText().spread_fade(cosine, light.spread_cotangent * sqrt(lower));
}

// Whether what one of the light's samples brings, as a share of falloff_of(), is the same everywhere.
inline bool shares_alike(const LightView &light) {
    return light.parallel() || (light.kind == LightKind::SPHERE && light.cone_cosine <= -1.0F);
}

// What one of the light's samples, by number, brings to a point, as a share of falloff_of().
inline Real sample_share(const LightView &light, std::size_t number, const vec3 &world) {
    const glm::vec3 &sample = light.samples[number];
    const float count = static_cast<float>(light.samples.size());
    if (light.kind == LightKind::SUN) {
        return 1.0F / (count * std::max(-glm::dot(sample, light.direction), LOWEST_SUN));
    }
    if (light.surrounds()) {
        return light.shares[number];
    }
    if (light.kind == LightKind::SPHERE) {
        return spot_share(light, world - broadcast(sample)) * (1.0F / count);
    }
    const vec3 from_sample = world - broadcast(sample), from_middle = world - broadcast(light.position);
    const float stands_for = light.area / count, patch = stands_for / light.finer;
    const Real distance2 = dot(from_sample, from_sample);
    const Real cosine = dot(from_sample, broadcast(light.direction)) / sqrt(max(distance2, 1e-20F));
    const Real sent =
        light.spread_cotangent > 0.0F
            ? max(cosine, 0.0F) * patch_fade(light, cosine, dot(from_sample, broadcast(light.direction)), patch)
            : sent_along(light, cosine);
    // A patch of the light as large as a sample stands for is nowhere nearer than its own radius.
    return sent * stands_for / ((distance2 + patch * 0.318F) * falloff_of(light, from_middle));
}

// Two unit vectors at right angles to n and to each other: Duff et al., "Building an orthonormal basis, revisited",
// 2017.
struct Plane {
    vec3 x, y;
};

inline Plane plane_across(const vec3 &n) {
    const Real sign = pick(n.z < 0.0F, -1.0F, 1.0F);
    const Real a = -1.0F / (sign + n.z), b = n.x * n.y * a;
    return {{1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

// A point on a light as a surface sees it, and the irradiance that the whole light would bring to a surface that faces
// this way if all of the light were like this point, which is taken as often as others or, before a grid, oftener.
struct Towards {
    vec3 direction;
    Real distance;
    Real irradiance; // for a strength of one
};

constexpr float ALMOST = 0.9999F; // of the way to a light: short of the light itself, should it have a mesh

inline Towards towards_place(const LightView &light, const vec3 &point, const vec3 &place, Real area) {
    const vec3 to_light = place - point;
    const Real distance2 = max(dot(to_light, to_light), 1e-20F);
    const Real distance = sqrt(distance2);
    const vec3 direction = to_light * (1.0F / distance);
    const Real cosine = -dot(direction, broadcast(light.direction));
    return {direction, distance * ALMOST, sent_along(light, cosine) * area / distance2};
}

// A point on a lamp with a grid before it, in half axes, as likely as the grid lets it shine at the point; and the area
// that it stands for, of the lamp's.
struct OnPlate {
    Real x, y, share;
};

// What a point below a lamp with a grid before it gets from the lamp comes out of a disk on its plane, around the
// point's foot: all in half axes.
struct SpreadDisk {
    Real foot_x, foot_y, radius_x, radius_y;
};

// The light of a point spreads to a disk; so does, on the lamp's plane, what shines at a point.
inline Real spread_radius(const LightView &light, Real height) {
    return max(height, 0.0F) * (1.0F / light.spread_cotangent);
}

inline SpreadDisk spread_disk(const LightView &light, Real height, Real foot_x, Real foot_y) {
    const Real radius = spread_radius(light, height);
    return {foot_x, foot_y, radius * (1.0F / glm::length(light.across)), radius * (1.0F / glm::length(light.up))};
}

inline OnPlate within_spread(const LightView &light, const SpreadDisk &disk, const LightsText::DensityPoint &x,
                             Real v) {
    const bool ellipse = light.kind == LightKind::ELLIPSE;
    const Real chord = ellipse ? sqrt(max(1.0F - x.place * x.place, 1e-6F)) : Real(1.0F);
    const Real aside = (x.place - disk.foot_x) / max(disk.radius_x, 1e-9F);
    const Real radius = disk.radius_y * sqrt(max(1.0F - aside * aside, 1e-6F));
    const auto y = LightsText().tent_point(v, -chord, chord, disk.foot_y, radius);
    return {x.place, y.place, x.length * y.length * (ellipse ? 0.318309886F : 0.25F)};
}

inline Towards sample_towards(const LightView &light, const vec3 &point, Real u, Real v) {
    if (light.kind == LightKind::POLYGON) {
        const auto &c = light.corners;
        return towards_place(
            light, point,
            LightsText().point_on_quad(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]), u, v),
            light.area);
    }
    if (light.spread_cotangent > 0.0F) {
        const vec3 offset = point - broadcast(light.position);
        const auto foot = [&offset](const glm::vec3 &axis) {
            return dot(offset, broadcast(axis)) * (1.0F / glm::dot(axis, axis));
        };
        const Real height = dot(offset, broadcast(light.direction));
        const SpreadDisk disk = spread_disk(light, height, foot(light.across), foot(light.up));
        const auto x = LightsText().tent_point(u, -1.0F, 1.0F, disk.foot_x, disk.radius_x);
        const OnPlate on = within_spread(light, disk, x, v);
        const vec3 place = broadcast(light.position) + broadcast(light.across) * on.x + broadcast(light.up) * on.y;
        return towards_place(light, point, place, on.share * light.area);
    }
    const Real a = 2.0F * u - 1.0F, b = 2.0F * v - 1.0F;
    const LightsText::DiskPoint disk = LightsText().point_on_disk(a, b);
    const Real x = disk.x, y = disk.y;
    if (light.kind == LightKind::SUN) {
        const vec3 aside = broadcast(light.across) * x + broadcast(light.up) * y;
        const Real height = sqrt(max(1.0F - dot(aside, aside), LOWEST_SUN * LOWEST_SUN));
        return {aside - broadcast(light.direction) * height, 1e30F, 1.0F / height};
    }
    if (light.surrounds()) {
        // Lambert's projection: equal areas of the disk and the sphere.
        const Real share = min(x * x + y * y, 1.0F), across = 2.0F * sqrt(1.0F - share);
        return {{x * across, y * across, 1.0F - 2.0F * share}, 1e30F, 1.0F};
    }
    if (light.kind == LightKind::SPHERE) {
        const vec3 to_middle = broadcast(light.position) - point;
        const Real distance2 = max(dot(to_middle, to_middle), 1e-20F);
        const Real distance = sqrt(distance2);
        const vec3 axis = to_middle * (1.0F / distance);
        if (light.radius == 0.0F) {
            return {axis, distance * ALMOST, spot_share(light, -to_middle) / distance2};
        }
        // Uniform in the solid angle of the sphere: 2 pi (1 - cos), of radiance 1 / (pi radius^2).
        const Real sine2 = min(light.radius * light.radius / (distance2 + light.facing2), 1.0F);
        const Real cap = sine2 / (1.0F + sqrt(1.0F - sine2)); // 1 - cos, without its cancellation
        const Real share = x * x + y * y;
        const Real height = 1.0F - share * cap;
        const Real across = sqrt(max(cap * (2.0F - share * cap), 0.0F)); // over the disk: its own radius is in x and y
        const Plane plane = plane_across(axis);
        const vec3 direction = axis * height + (plane.x * x + plane.y * y) * across;
        const Real reach =
            distance * height - sqrt(max(light.radius * light.radius - distance2 * across * across * share, 0.0F));
        const Real brightness = 2.0F / (light.radius * light.radius);
        return {direction, max(reach, 0.0F) * ALMOST, spot_share(light, -direction) * cap * brightness};
    }
    const bool ellipse = light.kind == LightKind::ELLIPSE;
    const vec3 there = broadcast(light.position) + broadcast(light.across) * (ellipse ? x : a) +
                       broadcast(light.up) * (ellipse ? y : b);
    return towards_place(light, point, there, light.area);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
