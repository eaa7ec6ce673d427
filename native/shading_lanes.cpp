// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces reflect, before anything stands in its way: closed forms for every kind of light.
// A file of its own, because g++ stops inlining what it should where a file grows large: with the march it made frames
// four times as slow.
#include "lanes.hpp"
#include "lights_lanes.hpp"
#include "shading.hpp"

#include <cmath>

namespace sfumato::SFUMATO_ISA {
namespace {

// For a light of strength 1: what a white diffuse surface sends to the eye, and what its gloss does.
struct Shading {
    Real diffuse;
    Reflection gloss;
};

Shading scaled(const Shading &s, Real by) {
    return {s.diffuse * by, {s.gloss.plain * by, s.gloss.schlick * by}};
}

// A surface as closed forms want it: with the shading point at the origin, gloss in a frame of its own.
struct Receiver {
    vec3 point, normal, tangent, bitangent;
    vec3 view; // towards the eye, in the surface's frame
    Real alpha_x, alpha_y, apart;
    bool glossy;

    explicit Receiver(const ShadingPacket &p)
        : point(load(p.point)), normal(load(p.normal)), tangent(load(p.tangent)), bitangent(load(p.bitangent)),
          view(local(-load(p.direction))), alpha_x(Real::load_aligned(p.alpha_x)),
          alpha_y(Real::load_aligned(p.alpha_y)), apart(Real::load_aligned(p.apart)), glossy(p.glossy) {}

    // The lobe, no narrower than a given alpha.
    [[nodiscard]] Microfacets facets(float narrowest = 0.0F) const {
        Microfacets m = microfacets(BRDF_GGX, view, max(alpha_x, narrowest), max(alpha_y, narrowest));
        m.apart = apart;
        return m;
    }

    [[nodiscard]] vec3 local(const vec3 &v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }

    static vec3 load(const float (&v)[3][MAX_LANES]) {
        return {Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2])};
    }
};

Shading from_direction(const Receiver &r, const vec3 &towards) {
    const Real diffuse = max(dot(r.normal, towards), 0.0F) * 0.318309886F;
    if (!r.glossy) {
        return {diffuse, {0.0F, 0.0F}};
    }
    return {diffuse, microfacet_reflection(r.facets(), r.local(towards))};
}

// The closed forms hand structures on to each other: inlined into one function they stay in registers, 1.6 times as
// fast.
[[gnu::flatten]] Reflection gloss_of_sphere(const Receiver &r, const vec3 &middle, Real radius) {
    return microfacet_sphere(r.facets(), r.local(middle), radius);
}

[[gnu::flatten]] Reflection gloss_of_quad(const Receiver &r, const vec3 &a, const vec3 &b, const vec3 &c,
                                          const vec3 &d) {
    return microfacet_quad(r.facets(), r.local(a), r.local(b), r.local(c), r.local(d));
}

[[gnu::flatten]] Reflection gloss_of_ellipse(const Receiver &r, const vec3 &middle, const vec3 &across,
                                             const vec3 &up) {
    return microfacet_ellipse(r.facets(), r.local(middle), r.local(across), r.local(up));
}

// A sphere of radiance 1.
Shading from_sphere(const Receiver &r, const vec3 &middle, Real radius) {
    Shading out{diffuse_sphere(r.normal, middle, radius), {0.0F, 0.0F}};
    if (r.glossy) {
        out.gloss = gloss_of_sphere(r, middle, radius);
    }
    return out;
}

Shading from_rectangle(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
    const vec3 a = middle - across - up, b = middle + across - up, c = middle + across + up, d = middle - across + up;
    Shading out{diffuse_quad(r.normal, a, b, c, d), {0.0F, 0.0F}};
    if (r.glossy) {
        out.gloss = gloss_of_quad(r, a, b, c, d);
    }
    return out;
}

Shading from_ellipse(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
    Shading out{diffuse_ellipse(r.normal, middle, across, up), {0.0F, 0.0F}};
    if (r.glossy) {
        out.gloss = gloss_of_ellipse(r, middle, across, up);
    }
    return out;
}

// The grid before a lamp dims each of its points by the direction in which that sends its light. No closed form knows
// of it: what the surface makes of the whole lamp is multiplied by the mean over a lattice of points, each weighed by
// what it is worth to the surface. For gloss no narrower lobe is weighed than the lattice can see.
Shading through_grid(const Receiver &r, const LightView &light, const vec3 &middle, const Shading &whole) {
    constexpr int SIDE = 6;
    constexpr float WIDEST = 0.3F;
    Real weights = 1e-20F, sum = 0.0F, gloss_weights = 1e-20F, gloss_sum = 0.0F;
    const Microfacets m = r.facets(WIDEST);
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
        const Real weight = patch * max(dot(r.normal, towards), 0.0F);
        weights = weights + weight;
        sum = sum + weight * left;
        if (r.glossy) {
            const Real gloss = patch * microfacet_reflection(m, r.local(towards)).plain;
            gloss_weights = gloss_weights + gloss;
            gloss_sum = gloss_sum + gloss * left;
        }
    }
    const Real gloss = gloss_sum / gloss_weights;
    return {whole.diffuse * (sum / weights), {whole.gloss.plain * gloss, whole.gloss.schlick * gloss}};
}

Shading shading_of(const Receiver &r, const LightView &light) {
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

void shade(const LightView &light, ShadingPacket &packet) {
    const Shading shading = shading_of(Receiver(packet), light);
    shading.diffuse.store_aligned(packet.diffuse);
    shading.gloss.plain.store_aligned(packet.plain);
    shading.gloss.schlick.store_aligned(packet.schlick);
}

} // namespace sfumato::SFUMATO_ISA
