// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces reflect, before anything stands in its way: closed forms for every kind of light.
#pragma once

#include "kernels.hpp"
#include "lanes.hpp"
#include "lights_lanes.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

struct Surface {
    Mask hit;
    Real distance; // or the ray's reach
    vec3 normal;   // shading normal, towards the eye
    vec3 geometric_normal;
    vec3 albedo;
    bool glossy = false; // whether any lane is
    Plane tangents;      // x the direction of alpha_x; set where glossy
    vec3 reflectance;    // seen straight on; so it is at grazing angles, or with `edge` 1 all light
    Real edge, alpha_x, alpha_y;
};

// For a light of strength 1: what a white diffuse surface sends to the eye, and what its gloss does.
struct Shading {
    Real diffuse;
    Reflection gloss;
};

inline Shading scaled(const Shading &s, Real by) {
    return {s.diffuse * by, {s.gloss.plain * by, s.gloss.schlick * by}};
}

// A surface as closed forms want it: with the shading point at the origin, gloss in a frame of its own.
struct Receiver {
    const Surface &surface;
    vec3 point, view; // view: towards the eye, in the surface's frame

    Receiver(const Surface &s, const vec3 &at, const vec3 &direction)
        : surface(s), point(at), view(s.glossy ? local(-direction) : -direction) {}

    [[nodiscard]] vec3 local(const vec3 &v) const {
        return {dot(v, surface.tangents.x), dot(v, surface.tangents.y), dot(v, surface.normal)};
    }
};

inline Shading from_direction(const Receiver &r, const vec3 &towards) {
    const Real diffuse = max(dot(r.surface.normal, towards), 0.0F) * 0.318309886F;
    if (!r.surface.glossy) {
        return {diffuse, {0.0F, 0.0F}};
    }
    const Microfacets m = microfacets(BRDF_GGX, r.view, r.surface.alpha_x, r.surface.alpha_y);
    return {diffuse, microfacet_reflection(m, r.local(towards))};
}

// The closed forms hand structures on to each other: inlined into one function they stay in registers, 1.6 times as
// fast.
[[gnu::flatten]] inline Reflection gloss_of_sphere(const Receiver &r, const vec3 &middle, Real radius) {
    return ggx_sphere(r.view, r.surface.alpha_x, r.surface.alpha_y, r.local(middle), radius);
}

[[gnu::flatten]] inline Reflection gloss_of_quad(const Receiver &r, const vec3 &a, const vec3 &b, const vec3 &c,
                                                 const vec3 &d) {
    return ggx_quad(r.view, r.surface.alpha_x, r.surface.alpha_y, r.local(a), r.local(b), r.local(c), r.local(d));
}

[[gnu::flatten]] inline Reflection gloss_of_ellipse(const Receiver &r, const vec3 &middle, const vec3 &across,
                                                    const vec3 &up) {
    return ggx_ellipse(r.view, r.surface.alpha_x, r.surface.alpha_y, r.local(middle), r.local(across), r.local(up));
}

// A sphere of radiance 1.
inline Shading from_sphere(const Receiver &r, const vec3 &middle, Real radius) {
    Shading out{diffuse_sphere(r.surface.normal, middle, radius), {0.0F, 0.0F}};
    if (r.surface.glossy) {
        out.gloss = gloss_of_sphere(r, middle, radius);
    }
    return out;
}

inline Shading from_rectangle(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
    const vec3 a = middle - across - up, b = middle + across - up, c = middle + across + up, d = middle - across + up;
    Shading out{diffuse_quad(r.surface.normal, a, b, c, d), {0.0F, 0.0F}};
    if (r.surface.glossy) {
        out.gloss = gloss_of_quad(r, a, b, c, d);
    }
    return out;
}

inline Shading from_ellipse(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
    Shading out{diffuse_ellipse(r.surface.normal, middle, across, up), {0.0F, 0.0F}};
    if (r.surface.glossy) {
        out.gloss = gloss_of_ellipse(r, middle, across, up);
    }
    return out;
}

// The grid before a lamp dims each of its points by the direction in which that sends its light. No closed form knows
// of it: what the surface makes of the whole lamp is multiplied by the mean over a lattice of points, each weighed by
// what it is worth to the surface. For gloss no narrower lobe is weighed than the lattice can see.
inline Shading through_grid(const Receiver &r, const LightView &light, const vec3 &middle, const Shading &whole) {
    constexpr int SIDE = 6;
    constexpr float WIDEST = 0.3F;
    Real weights = 1e-20F, sum = 0.0F, gloss_weights = 1e-20F, gloss_sum = 0.0F;
    const Microfacets m = microfacets(BRDF_GGX, r.view, max(r.surface.alpha_x, WIDEST), max(r.surface.alpha_y, WIDEST));
    for (int i = 0; i < SIDE * SIDE; ++i) {
        float x = (2.0F * static_cast<float>(i % SIDE) + 1.0F) / SIDE - 1.0F;
        float y = (2.0F * static_cast<float>(i / SIDE) + 1.0F) / SIDE - 1.0F;
        if (light.kind == Light::Kind::ELLIPSE && x * x + y * y > 1.0F) {
            continue;
        }
        const vec3 there = middle + broadcast(light.across) * Real(x) + broadcast(light.up) * Real(y);
        const Real distance2 = max(dot(there, there), 1e-20F);
        const vec3 towards = there * (1.0F / sqrt(distance2));
        const Real cosine = -dot(towards, broadcast(light.direction));
        const Real patch = max(cosine, 0.0F) / distance2;
        const Real left = spread_fade(cosine, light.spread_cotangent);
        const Real weight = patch * max(dot(r.surface.normal, towards), 0.0F);
        weights = weights + weight;
        sum = sum + weight * left;
        if (r.surface.glossy) {
            const Real gloss = patch * microfacet_reflection(m, r.local(towards)).plain;
            gloss_weights = gloss_weights + gloss;
            gloss_sum = gloss_sum + gloss * left;
        }
    }
    const Real gloss = gloss_sum / gloss_weights;
    return {whole.diffuse * (sum / weights), {whole.gloss.plain * gloss, whole.gloss.schlick * gloss}};
}

inline Shading shade(const Receiver &r, const LightView &light) {
    if (light.kind == Light::Kind::SUN) {
        const vec3 towards = broadcast(-light.direction);
        if (light.radius == 0.0F) {
            return from_direction(r, towards);
        }
        // The cone of the sun as a sphere at distance 1; irradiance 1 from a cone is a radiance of 1 / (pi sin^2).
        const float sine2 = light.radius * light.radius / (1.0F + light.radius * light.radius);
        return scaled(from_sphere(r, towards, std::sqrt(sine2)), 0.318309886F / sine2);
    }
    const vec3 middle = broadcast(light.position) - r.point;
    if (light.kind == Light::Kind::SPHERE) {
        const Real distance2 = max(dot(middle, middle), 1e-20F);
        const Real fade = spot_share(light, -middle);
        if (light.radius == 0.0F) {
            return scaled(from_direction(r, middle * (1.0F / sqrt(distance2))), fade / distance2);
        }
        const Real radius = light.radius / sqrt(1.0F + light.facing2 / distance2);
        const float brightness = 0.318309886F / (light.radius * light.radius);
        return scaled(from_sphere(r, middle, radius), fade * brightness);
    }
    const vec3 across = broadcast(light.across), up = broadcast(light.up);
    Shading whole = light.kind == Light::Kind::RECTANGLE ? from_rectangle(r, middle, across, up)
                                                         : from_ellipse(r, middle, across, up);
    if (light.spread_cotangent > 0.0F) {
        whole = through_grid(r, light, middle, whole);
    }
    return scaled(whole, pick(dot(middle, broadcast(light.direction)) < 0.0F, 1.0F, 0.0F));
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
