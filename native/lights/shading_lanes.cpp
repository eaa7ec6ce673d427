// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces reflect, before anything stands in its way: closed forms for every kind of light.
// A file of its own, because g++ stops inlining what it should where a file grows large: with the march it made frames
// four times as slow.
#include "lights/lights_lanes.hpp"
#include "lights/shading.hpp"
#include "lights/sky_lanes.hpp"
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

    [[nodiscard]] vec3 world(const vec3 &v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
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
    static Sent all_sides(const Receiver & /*r*/) { return 1.0F; }
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
    // Of light that is the same from all sides: as of a sun that fills all of it, which the closed form knows well
    // where facets are smooth, within 1 %; where they are rough, which it takes for 7 % too dark, the mean over facets
    // that are seen. These are too few where they are smooth, and in between both count.
    static Sent all_sides(const Receiver &r) {
        constexpr float BROADEST = 0.9998F, SMOOTH = 0.2F, ROUGH = 0.5F;
        const Sent whole = sphere(r, r.normal, BROADEST);
        const Real rough = clamp((sqrt(r.alpha_x * r.alpha_y) - SMOOTH) * (1.0F / (ROUGH - SMOOTH)), 0.0F, 1.0F);
        if (BRDF != BRDF_GGX || !xsimd::any(rough > 0.0F)) {
            return whole;
        }
        const Sent seen = by_facets(r);
        return {whole.plain + (seen.plain - whole.plain) * rough,
                whole.fresnel + (seen.fresnel - whole.fresnel) * rough};
    }
    static Sent by_facets(const Receiver &r) {
        const Microfacets m = r.facets(BRDF);
        Sent sum{0.0F, 0.0F};
        for (std::size_t k = 0; k < FACETS; ++k) {
            const vec3 facet = MicrofacetsText().seen_facet(m, Real(spiral().x[k]), Real(spiral().y[k]));
            const Reflection one = MicrofacetsText().masking_at(m, facet, dot(m.view, facet));
            sum.plain = sum.plain + one.plain;
            sum.fresnel = sum.fresnel + one.fresnel;
        }
        return scaled(sum, m.view_reach * (1.0F / FACETS));
    }
    [[gnu::flatten]] static Sent quad(const Receiver &r, const vec3 &a, const vec3 &b, const vec3 &c, const vec3 &d) {
        return MicrofacetsText().microfacet_quad(r.facets(BRDF), r.local(a), r.local(b), r.local(c), r.local(d));
    }
    [[gnu::flatten]] static Sent ellipse(const Receiver &r, const vec3 &middle, const vec3 &across, const vec3 &up) {
        return MicrofacetsText().microfacet_ellipse(r.facets(BRDF), r.local(middle), r.local(across), r.local(up));
    }
    static Sent scaled(const Sent &sent, Real by) { return {sent.plain * by, sent.fresnel * by}; }
};

// What a point sees of a light as a plate, its axes in the surface's frame: a lamp itself, or of suns and spheres the
// disk at distance 1 that hides as much.
struct Plate {
    vec3 middle, across, up, direction; // half axes
    bool ellipse;
};

Plate plate_of(const Receiver &r, const LightView &light, const vec3 &from) {
    if (light.kind == LightKind::RECTANGLE || light.kind == LightKind::ELLIPSE) {
        return {r.local(broadcast(light.position) - from), r.local(broadcast(light.across)),
                r.local(broadcast(light.up)), r.local(broadcast(light.direction)), light.kind == LightKind::ELLIPSE};
    }
    const vec3 middle = light.parallel() ? broadcast(-light.direction) : broadcast(light.position) - from;
    const Real distance2 = max(dot(middle, middle), 1e-20F);
    const Real sine2 = min(light.radius * light.radius / (distance2 + light.facing2), 1.0F - LOWEST_SUN * LOWEST_SUN);
    const Real tangent = sqrt(sine2 / (1.0F - sine2));
    const vec3 direction = normalised(-r.local(middle));
    const Plane plane = plane_across(direction);
    return {-direction, plane.x * tangent, plane.y * tangent, direction, true};
}

// Where a narrow lobe sees a plate: the middle of what it sees, in half axes, and how wide that is, in metres.
struct Spotlight {
    Real x, y, width;
};

Real longest2(const Plate &plate) {
    return max(dot(plate.across, plate.across), dot(plate.up, plate.up));
}

Spotlight all_of(const Plate &plate) {
    return {0.0F, 0.0F, 100.0F * sqrt(longest2(plate))};
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

Node node_between(Real low, Real high, Real width, Real share) {
    const Real w2 = width * width;
    const Real u0 = low / sqrt(w2 + low * low), u1 = high / sqrt(w2 + high * high);
    const Real u = u0 + (u1 - u0) * share, left = max(1.0F - u * u, 1e-6F), scale = width / sqrt(left);
    return {u * scale, (u1 - u0) * scale / left};
}

vec3 one_of(Mask first, const vec3 &a, const vec3 &b) {
    return {pick(first, a.x, b.x), pick(first, a.y, b.y), pick(first, a.z, b.z)};
}

// A part of a plate, and where the shares u and v of what a lobe sees of it end.
struct Patch {
    vec3 towards;
    Real distance, cosine; // cosine: to the plate's direction
    Real area;             // of the plate, for all of u and v
};

Patch patch_at(const Plate &plate, Real x, Real y, Real area) {
    const vec3 there = plate.middle + plate.across * x + plate.up * y;
    const Real distance = sqrt(max(dot(there, there), 1e-20F));
    const vec3 towards = there * (1.0F / distance);
    return {towards, distance, max(-dot(towards, plate.direction), 0.0F), area};
}

Patch patch_seen(const Plate &plate, const Spotlight &seen, Real u, Real v) {
    const Real length_x = sqrt(dot(plate.across, plate.across)), length_y = sqrt(dot(plate.up, plate.up));
    const Node x = node_between((-1.0F - seen.x) * length_x, (1.0F - seen.x) * length_x, seen.width, u);
    const Real at_x = seen.x + x.place / length_x;
    const Real chord = plate.ellipse ? sqrt(max(1.0F - at_x * at_x, 1e-6F)) : Real(1.0F);
    const Real width = sqrt(seen.width * seen.width + x.place * x.place);
    const Node y = node_between((-chord - seen.y) * length_y, (chord - seen.y) * length_y, width, v);
    return patch_at(plate, at_x, seen.y + y.place / length_y, x.length * y.length);
}

// Of a lamp with a grid before it, what shines at the surface.
Patch patch_shining(const LightView &light, const Plate &plate, Real u, Real v) {
    const auto foot = [&plate](const vec3 &axis) { return -dot(plate.middle, axis) / dot(axis, axis); };
    const Real height = -dot(plate.middle, plate.direction);
    const SpreadDisk disk = spread_disk(light, height, foot(plate.across), foot(plate.up));
    // Evenly across: of a tent's nodes the outermost would count for too much.
    const Real low = clamp(disk.foot_x - disk.radius_x, -1.0F, 1.0F);
    const Real length = clamp(disk.foot_x + disk.radius_x, -1.0F, 1.0F) - low;
    const OnPlate on = within_spread(light, disk, {low + length * u, length}, v);
    return patch_at(plate, on.x, on.y, on.share * light.area);
}

// Whether what of a lamp with a grid before it shines at the surface is but a part of it.
Mask shines_in_part(const LightView &light, const Plate &plate) {
    if (light.spread_cotangent <= 0.0F) {
        return Mask(false);
    }
    const Real radius = spread_radius(light, -dot(plate.middle, plate.direction));
    return radius * radius < longest2(plate);
}

// Whether a lobe sees but a part of that.
Mask is_narrow(const LightView &light, const Plate &plate, const Spotlight &seen) {
    const Mask within_plate = seen.width * seen.width < longest2(plate);
    return light.spread_cotangent > 0.0F
               ? within_plate & (seen.width < spread_radius(light, -dot(plate.middle, plate.direction)))
               : within_plate;
}

Patch one_of(Mask first, const Patch &a, const Patch &b) {
    return {one_of(first, a.towards, b.towards), pick(first, a.distance, b.distance), pick(first, a.cosine, b.cosine),
            pick(first, a.area, b.area)};
}

// What a light sends to a surface in a direction, of what it would without a grid before it or the rim of its cone.
Real fade_of(const LightView &light, const Receiver &r, const Patch &patch) {
    if (light.kind == LightKind::SPHERE) {
        return spot_share(light, -r.world(patch.towards));
    }
    return light.spread_cotangent > 0.0F ? LightsText().spread_fade(patch.cosine, light.spread_cotangent) : Real(1.0F);
}

// A lamp dims each of its points by the direction in which that sends its light. No closed form knows of it: what the
// surface makes of the whole lamp, `whole`, is multiplied by the mean over points, each weighed by what it is worth to
// the surface. The points are where the surface looks; or, in lanes of `part`, where the light comes from, and then
// they are all there is of it.
template <typename Worth>
Real dimmed(const Receiver &r, const LightView &light, const Plate &plate, const Spotlight &seen, Mask part, Real whole,
            const Worth &worth) {
    constexpr int SIDE = 6;
    Real weights = 1e-30F, sum = 0.0F;
    for (int i = 0; i < SIDE; ++i) {
        const float column = (static_cast<float>(i) + 0.5F) / SIDE;
        for (int j = 0; j < SIDE; ++j) {
            const float row = (static_cast<float>(j) + 0.5F) / SIDE;
            Patch patch = patch_seen(plate, seen, column, row);
            if (xsimd::any(part)) {
                patch = one_of(part, patch_shining(light, plate, column, row), patch);
            }
            const Real weight = worth(patch.towards) * patch.cosine / (patch.distance * patch.distance) * patch.area;
            weights = weights + weight;
            sum = sum + weight * fade_of(light, r, patch);
        }
    }
    return pick(part, sum * (1.0F / (SIDE * SIDE)), whole * (sum / weights));
}

// Of a whole lamp, what is left of it by its grid or its cone.
Real left_by(Dull /*what*/, const Receiver &r, const LightView &light, Real whole) {
    const Plate plate = plate_of(r, light, r.point);
    return dimmed(r, light, plate, all_of(plate), shines_in_part(light, plate), whole,
                  [](const vec3 &towards) { return max(towards.z, 0.0F) * 0.318309886F; });
}

template <int BRDF>
Reflection left_by(Facets<BRDF> /*what*/, const Receiver &r, const LightView &light, const Reflection &whole) {
    const Plate plate = plate_of(r, light, r.point);
    const Spotlight seen = seen_by_gloss(r, plate);
    const Mask part = shines_in_part(light, plate) & !is_narrow(light, plate, seen);
    const Microfacets m = r.facets(BRDF);
    const Real plain = dimmed(r, light, plate, seen, part, whole.plain, [&](const vec3 &towards) {
        return MicrofacetsText().microfacet_reflection(m, towards).plain;
    });
    return {plain, whole.fresnel * (plain / max(whole.plain, 1e-30F))};
}

template <class What>
typename What::Sent sent_by(What what, const Receiver &r, const LightView &light) {
    if (light.kind == LightKind::SUN) {
        const vec3 towards = broadcast(-light.direction);
        constexpr float NARROW = 1e-4F; // below it what is divided by the radius' square loses its digits
        if (light.radius < NARROW) {
            return what.direction(r, towards);
        }
        // The cone of the sun as a sphere at distance 1; irradiance 1 from a cone is a radiance of 1 / (pi sin^2).
        return what.scaled(what.sphere(r, towards, light.radius), 0.318309886F / (light.radius * light.radius));
    }
    if (light.surrounds()) {
        return what.scaled(what.all_sides(r), 0.0795774715F);
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
        return light.cone_cosine > -1.0F ? left_by(what, r, light, whole) : whole;
    }
    const vec3 across = broadcast(light.across), up = broadcast(light.up);
    auto whole = light.kind == LightKind::RECTANGLE ? what.quad(r, middle - across - up, middle + across - up,
                                                                middle + across + up, middle - across + up)
                                                    : what.ellipse(r, middle, across, up);
    if (light.spread_cotangent > 0.0F) {
        whole = left_by(what, r, light, whole);
    }
    return what.scaled(whole, pick(dot(middle, broadcast(light.direction)) < 0.0F, 1.0F, 0.0F));
}

// Along a direction from a point, short of the light.
Real reach_of(const LightView &light, const vec3 &from, const vec3 &towards, Real distance) {
    if (light.kind == LightKind::SUN) {
        return 1e30F;
    }
    if (light.kind == LightKind::SPHERE) {
        const vec3 to_middle = broadcast(light.position) - from;
        const Real along = dot(to_middle, towards), aside2 = dot(to_middle, to_middle) - along * along;
        distance = max(along - sqrt(max(light.radius * light.radius - aside2, 0.0F)), 0.0F);
    }
    return distance * ALMOST;
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

void look(const LightView &light, ShadingPacket &packet) {
    const Receiver r(packet);
    const vec3 from = Receiver::load(packet.from);
    vec3 towards = Receiver::load(packet.towards);
    Real reach = Real::load_aligned(packet.reach), irradiance = Real::load_aligned(packet.irradiance), moved = 0.0F;
    if (!light.of_mesh() && light.radius > 0.0F) {
        const Plate usual = plate_of(r, light, r.point), plate = plate_of(r, light, from);
        const Mask narrow = is_narrow(light, usual, seen_by_gloss(r, usual));
        const Patch patch = patch_seen(plate, seen_by_gloss(r, plate), Real::load_aligned(packet.light_u),
                                       Real::load_aligned(packet.light_v));
        const vec3 there = r.world(patch.towards);
        towards = one_of(narrow, there, towards);
        reach = pick(narrow, reach_of(light, from, there, patch.distance), reach);
        const Real sent = fade_of(light, r, patch) * patch.cosine * patch.area / (patch.distance * patch.distance);
        irradiance = pick(narrow, sent, irradiance);
        moved = pick(narrow, 1.0F, 0.0F);
    }
    const Real plain =
        MicrofacetsText()
            .microfacet_reflection(r.facets(packet.beckmann ? BRDF_BECKMANN : BRDF_GGX), r.local(towards))
            .plain;
    (plain * irradiance).store_aligned(packet.worth);
    towards.x.store_aligned(packet.towards[0]);
    towards.y.store_aligned(packet.towards[1]);
    towards.z.store_aligned(packet.towards[2]);
    reach.store_aligned(packet.reach);
    moved.store_aligned(packet.moved);
}

} // namespace sfumato::SFUMATO_ISA
