// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces reflect, before anything stands in its way: closed forms for every kind of light.
// A file of its own, because g++ stops inlining what it should where a file grows large: with the march it made frames
// four times as slow.
#include "lights/lights_lanes.hpp"
#include "lights/shading.hpp"
#include "text/integrals_text.hpp"
#include "text/lanes.hpp"
#include "text/microfacets_text.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

using IntegralsText = text::IntegralsText<Real, Isa>;
using MicrofacetsText = text::MicrofacetsText<Real, Isa>;
using Microfacets = MicrofacetsText::Microfacets;
using Reflection = MicrofacetsText::Reflection;

// A surface as closed forms want it: with the shading point at the origin, gloss in a frame of its own.
struct Receiver {
    vec3 point, normal, tangent, bitangent;
    vec3 view; // towards the eye, in the surface's frame
    Real alpha_x, alpha_y, apart, index;

    explicit Receiver(const ShadingPacket &p)
        : point(load(p.point)), normal(load(p.normal)), tangent(load(p.tangent)), bitangent(load(p.bitangent)),
          view(local(-load(p.direction))), alpha_x(Real::load_aligned(p.alpha_x)),
          alpha_y(Real::load_aligned(p.alpha_y)), apart(Real::load_aligned(p.apart)),
          index(Real::load_aligned(p.index)) {}

    [[nodiscard]] Microfacets facets(int brdf) const {
        Microfacets m = MicrofacetsText().microfacets(brdf, view, alpha_x, alpha_y);
        m.apart = apart;
        m.index = index;
        return m;
    }

    [[nodiscard]] vec3 local(const vec3 &v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }

    static vec3 load(const float (&v)[3][MAX_LANES]) {
        return {Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2])};
    }
};

// What a surface makes of lights of radiance 1, or of light from a direction, of an irradiance of 1 on what faces it.
// Diffusely; in all below `r` stands for the surface.
struct Dull {
    using Sent = Real;
    static Sent direction(const Receiver &r, const vec3 &towards) {
        return max(dot(r.normal, towards), 0.0F) * 0.318309886F;
    }
    static Sent sphere(const Receiver &r, const vec3 &middle, Real radius) {
        return IntegralsText().diffuse_sphere(r.normal, middle, radius);
    }
    static Sent quad(const Receiver &r, const vec3 &a, const vec3 &b, const vec3 &c, const vec3 &d) {
        return IntegralsText().diffuse_quad(r.normal, a, b, c, d);
    }
    static Sent ellipse(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
        return IntegralsText().diffuse_ellipse(r.normal, middle, across, up);
    }
    static Sent scaled(Sent sent, Real by) { return sent * by; }
};

// By the facets of one layer of gloss. The closed forms hand structures on to each other: inlined into one function
// they stay in registers, 1.6 times as fast.
template <int BRDF>
struct Facets {
    using Sent = Reflection;
    static Sent direction(const Receiver &r, const vec3 &towards) {
        return MicrofacetsText().microfacet_reflection(r.facets(BRDF), r.local(towards));
    }
    [[gnu::flatten]] static Sent sphere(const Receiver &r, const vec3 &middle, Real radius) {
        return MicrofacetsText().microfacet_sphere(r.facets(BRDF), r.local(middle), radius);
    }
    [[gnu::flatten]] static Sent quad(const Receiver &r, const vec3 &a, const vec3 &b, const vec3 &c, const vec3 &d) {
        return MicrofacetsText().microfacet_quad(r.facets(BRDF), r.local(a), r.local(b), r.local(c), r.local(d));
    }
    [[gnu::flatten]] static Sent ellipse(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
        return MicrofacetsText().microfacet_ellipse(r.facets(BRDF), r.local(middle), r.local(across), r.local(up));
    }
    static Sent scaled(const Sent &sent, Real by) { return {sent.plain * by, sent.fresnel * by}; }
};

// A lamp as a plate with a light's outline, its axes in the surface's frame.
struct Plate {
    vec3 middle, across, up, direction; // half axes
    bool ellipse;
};

Plate plate_of(const Receiver &r, const LightView &light, const vec3 &middle) {
    if (light.kind != LightKind::SPHERE) {
        return {r.local(middle), r.local(broadcast(light.across)), r.local(broadcast(light.up)),
                r.local(broadcast(light.direction)), light.kind == LightKind::ELLIPSE};
    }
    // The disk that a sphere shows to the surface.
    const vec3 direction = normalised(-r.local(middle));
    const Plane plane = plane_across(direction);
    return {r.local(middle), plane.x * Real(light.radius), plane.y * Real(light.radius), direction, true};
}

// Where a narrow lobe sees a plate: the middle of what it sees, in half axes, and how wide that is, in metres.
struct Spotlight {
    Real x, y, width;
};

Spotlight all_of(const Plate &plate) {
    return {0.0F, 0.0F, 100.0F * sqrt(max(dot(plate.across, plate.across), dot(plate.up, plate.up)))};
}

Spotlight seen_by_gloss(const Receiver &r, const Plate &plate) {
    const vec3 mirrored{-r.view.x, -r.view.y, r.view.z};
    // Mirrored rays that miss the plate's plane, or graze it, are bent down to it.
    const Real distance = dot(plate.middle, plate.direction) / min(dot(mirrored, plate.direction), -0.1F);
    const vec3 offset = mirrored * max(distance, 0.0F) - plate.middle;
    const Real across2 = dot(plate.across, plate.across), up2 = dot(plate.up, plate.up);
    const Real x = dot(offset, plate.across) / across2, y = dot(offset, plate.up) / up2;
    // Far beside the plate the lobe is but its tail, which changes no faster than with the distance.
    const Real beside = max(max(abs(x) - 1.0F, 0.0F) * sqrt(across2), max(abs(y) - 1.0F, 0.0F) * sqrt(up2));
    const Real width = 2.0F * sqrt(max(r.alpha_x * r.alpha_y, 1e-4F)) * max(distance, 0.0F);
    return {clamp(x, -20.0F, 20.0F), clamp(y, -20.0F, 20.0F), max(width, 0.5F * beside)};
}

// GGX's density seen edge on, (width^2 + s^2)^-3/2, between two ends: the place up to which a share of it lies, and the
// length per share there.
struct Node {
    Real place, length;
};

Node node_between(Real low, Real high, Real width, float share) {
    const Real w2 = width * width;
    const Real u0 = low / sqrt(w2 + low * low), u1 = high / sqrt(w2 + high * high);
    const Real u = u0 + (u1 - u0) * share, left = max(1.0F - u * u, 1e-6F), scale = width / sqrt(left);
    return {u * scale, (u1 - u0) * scale / left};
}

// A lamp dims each of its points by the direction in which that sends its light: by the grid before it, or by the rim
// of its cone. No closed form knows of it: what the surface makes of the whole lamp is multiplied by the mean over
// points, each weighed by what it is worth to the surface. The points are where the surface looks.
template <typename Fade, typename Worth>
Real mean_fade(const Plate &plate, const Spotlight &seen, const Fade &fade, const Worth &worth) {
    constexpr int SIDE = 6;
    const Real length_x = sqrt(dot(plate.across, plate.across)), length_y = sqrt(dot(plate.up, plate.up));
    Real weights = 1e-30F, sum = 0.0F;
    for (int i = 0; i < SIDE; ++i) {
        const float column = (static_cast<float>(i) + 0.5F) / SIDE;
        const Node x = node_between((-1.0F - seen.x) * length_x, (1.0F - seen.x) * length_x, seen.width, column);
        const Real at_x = seen.x + x.place / length_x;
        const Real chord = plate.ellipse ? sqrt(max(1.0F - at_x * at_x, 1e-6F)) : Real(1.0F);
        const Real width = sqrt(seen.width * seen.width + x.place * x.place);
        for (int j = 0; j < SIDE; ++j) {
            const float row = (static_cast<float>(j) + 0.5F) / SIDE;
            const Node y = node_between((-chord - seen.y) * length_y, (chord - seen.y) * length_y, width, row);
            const vec3 there = plate.middle + plate.across * at_x + plate.up * (seen.y + y.place / length_y);
            const Real distance2 = max(dot(there, there), 1e-20F);
            const vec3 towards = there * (1.0F / sqrt(distance2));
            const Real cosine = max(-dot(towards, plate.direction), 0.0F);
            const Real weight = worth(towards) * cosine / distance2 * (x.length * y.length);
            weights = weights + weight;
            sum = sum + weight * fade(towards, cosine);
        }
    }
    return sum / weights;
}

template <typename Fade>
Real share_left(Dull /*what*/, const Receiver & /*r*/, const Plate &plate, const Fade &fade) {
    return mean_fade(plate, all_of(plate), fade, [](const vec3 &towards) { return max(towards.z, 0.0F); });
}

template <int BRDF, typename Fade>
Real share_left(Facets<BRDF> /*what*/, const Receiver &r, const Plate &plate, const Fade &fade) {
    const Microfacets m = r.facets(BRDF);
    return mean_fade(plate, seen_by_gloss(r, plate), fade,
                     [&](const vec3 &towards) { return MicrofacetsText().microfacet_reflection(m, towards).plain; });
}

template <class What>
typename What::Sent sent_by(What what, const Receiver &r, const LightView &light) {
    if (light.kind == LightKind::SUN) {
        const vec3 towards = broadcast(-light.direction);
        if (light.radius == 0.0F) {
            return what.direction(r, towards);
        }
        // The cone of the sun as a sphere at distance 1; irradiance 1 from a cone is a radiance of 1 / (pi sin^2).
        return what.scaled(what.sphere(r, towards, light.radius), 0.318309886F / (light.radius * light.radius));
    }
    if (light.kind == LightKind::POLYGON) {
        const auto corner = [&](int i) { return broadcast(light.corners[i]) - r.point; };
        return what.quad(r, corner(0), corner(1), corner(2), corner(3));
    }
    const vec3 middle = broadcast(light.position) - r.point;
    if (light.kind == LightKind::SPHERE) {
        const Real distance2 = max(dot(middle, middle), 1e-20F);
        if (light.radius == 0.0F) {
            return what.scaled(what.direction(r, middle * (1.0F / sqrt(distance2))),
                               spot_share(light, -middle) / distance2);
        }
        const Real radius = light.radius / sqrt(1.0F + light.facing2 / distance2);
        const float brightness = 0.318309886F / (light.radius * light.radius);
        const auto whole = what.scaled(what.sphere(r, middle, radius), brightness);
        if (light.cone_cosine <= -1.0F) {
            return whole;
        }
        const vec3 axis = r.local(broadcast(light.direction));
        return what.scaled(whole,
                           share_left(what, r, plate_of(r, light, middle), [&](const vec3 &towards, Real /*cosine*/) {
                               return spot_share_along(light, -dot(towards, axis));
                           }));
    }
    const vec3 across = broadcast(light.across), up = broadcast(light.up);
    auto whole = light.kind == LightKind::RECTANGLE ? what.quad(r, middle - across - up, middle + across - up,
                                                                middle + across + up, middle - across + up)
                                                    : what.ellipse(r, middle, across, up);
    if (light.spread_cotangent > 0.0F) {
        whole = what.scaled(
            whole, share_left(what, r, plate_of(r, light, middle), [&light](const vec3 & /*towards*/, Real cosine) {
                return LightsText().spread_fade(cosine, light.spread_cotangent);
            }));
    }
    return what.scaled(whole, pick(dot(middle, broadcast(light.direction)) < 0.0F, 1.0F, 0.0F));
}

} // namespace

void shade_diffuse(const LightView &light, ShadingPacket &packet) {
    sent_by(Dull(), Receiver(packet), light).store_aligned(packet.diffuse);
}

void shade_gloss(const LightView &light, ShadingPacket &packet) {
    const Receiver r(packet);
    const Reflection sent =
        packet.beckmann ? sent_by(Facets<BRDF_BECKMANN>(), r, light) : sent_by(Facets<BRDF_GGX>(), r, light);
    sent.plain.store_aligned(packet.plain);
    sent.fresnel.store_aligned(packet.fresnel);
}

void weigh_gloss(ShadingPacket &packet) {
    const Receiver r(packet);
    MicrofacetsText()
        .microfacet_reflection(r.facets(packet.beckmann ? BRDF_BECKMANN : BRDF_GGX),
                               r.local(Receiver::load(packet.towards)))
        .plain.store_aligned(packet.plain);
}

} // namespace sfumato::SFUMATO_ISA
