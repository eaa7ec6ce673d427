// SPDX-License-Identifier: GPL-3.0-or-later
// The first surface on each ray of a packet, with all that shading reads of it.
#pragma once

#include "lights/lights_lanes.hpp"
#include "solids/hits_lanes.hpp"
#include "solids/surface_view.hpp"
#include "solids/varying_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/surfaces_text.hpp"

#include <cstdint>

namespace sfumato::SFUMATO_ISA {
namespace {

// One of a surface's layers of gloss; of lanes without it the gain is 0.
struct Lobe {
    vec3 reflectance; // seen straight on; so it is at grazing angles, or with `edge` 1 all light
    vec3 dip;
    Real edge, alpha_x, alpha_y, apart, index;
    vec3 gain;
    Real cosine, sine; // of the turn of its tangent
    Mask beckmann;
};

struct Surface {
    Mask hit;
    Real distance; // or the ray's reach
    vec3 normal;   // shading normal, towards the eye
    vec3 geometric_normal;
    Mask varied = Mask(false); // what is textured: its looks are a pixel's mean already
    Real even;                 // and this albedo tells where its light changes; set where any is
    bool bent = false;         // whether any lane's normal is,
    vec3 smooth_normal;        // and before; set where one is
    vec3 albedo;
    int lobes = 0; // of gloss, of the lane that has most
    Lobe lobe[MAX_LOBES];
    Plane tangents; // x the direction of alpha_x, unless turned; set where there is gloss
    vec3 emission{0.0F, 0.0F, 0.0F};
    vec3 transmittance;        // set where it is a sheet
    Real spreading, roughness; // of what is diffuse
    vec3 again;
    vec3 translucence, sheen;              // set where any material has one,
    Real sheen_spreading, sheen_roughness; // with these
    Index material = 0;                    // where its row of properties begins
    Real object_index = 0.0F;
    const Visibility *visibility[LANES]; // of what is hit, else null; set where any place is not plain
};

// Of the lanes, those that hit a place of which something is true.
template <typename Question>
Mask where(const Surface &surface, const Question &is_so) {
    alignas(64) float chosen[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        chosen[lane] = surface.visibility[lane] != nullptr && is_so(*surface.visibility[lane]) ? 1.0F : 0.0F;
    }
    return Real::load_aligned(chosen) > 0.0F;
}

// The layers of gloss from the top, each dimmed by those above; what they leave of the albedo. `varying` are those
// whose curves have to be made, or null.
inline void add_lobes(const SurfaceView &view, const Slots &slots, const VaryingCurves *varying, Real to_eye,
                      Surface &surface) {
    const Index material = surface.material;
    // Curves over the cosine to the eye.
    constexpr int STEPS = CURVE_POINTS - 1;
    const Real place = clamp(to_eye, 0.0F, 1.0F) * static_cast<float>(STEPS);
    const Real step = min(xsimd::floor(place), static_cast<float>(STEPS - 1)), beyond = place - step;
    const Index at = material + xsimd::to_int(step);
    Real left = 1.0F;
    for (int k = 0; k < surface.lobes; ++k) {
        const float *const first = view.properties + material_row::FIRST_LOBE + k * lobe_row::FLOATS;
        const auto property = [&](int number) { return gather(first + number, material); };
        const auto curve = [&](int number) {
            const Real here = gather(first + number, at), next = gather(first + number + 1, at);
            return here + (next - here) * beyond;
        };
        using namespace lobe_row;
        Lobe &lobe = surface.lobe[k];
        const int slot = pattern_slot::FIRST_LOBE + k * pattern_slot::LOBE_SLOTS;
        lobe.reflectance = slots.colour(slot + pattern_slot::REFLECTANCE);
        lobe.dip = slots.colour(slot + pattern_slot::DIP);
        lobe.edge = property(EDGE);
        lobe.alpha_x = slots.slot(slot + pattern_slot::ALPHA_X);
        lobe.alpha_y = slots.slot(slot + pattern_slot::ALPHA_Y);
        lobe.apart = property(APART);
        lobe.index = slots.slot(slot + pattern_slot::INDEX);
        lobe.beckmann = property(BECKMANN) > 0.5F;
        lobe.cosine = property(TURN_COSINE);
        lobe.sine = property(TURN_SINE);
        if (slots.has(slot + pattern_slot::TURN)) {
            const Real turn = slots.slot(slot + pattern_slot::TURN) * 6.28318530717958648F;
            lobe.cosine = cos(turn);
            lobe.sine = sin(turn);
        }
        // A material without this layer has rows of zeros here.
        const Mask there = lobe.alpha_x > 0.0F;
        vec3 gain{curve(GAIN), curve(GAIN + CURVE_POINTS), curve(GAIN + 2 * CURVE_POINTS)};
        Real leaves = curve(LEFT);
        if (varying != nullptr) {
            gain = pick(varying[k].where, varying[k].gain, gain);
            leaves = pick(varying[k].where, varying[k].left, leaves);
        }
        lobe.gain = gain * left;
        left = left * pick(there, leaves, 1.0F);
    }
    surface.albedo = surface.albedo * left;
}

// All that shading reads of what is met.
// As again_of() has it.
inline vec3 grooves_again(const Surface &surface) {
    using Text = text::SurfacesText<Real, Isa>;
    const Mask again = surface.spreading == static_cast<float>(Spreading::GROOVES_AGAIN);
    const Mask deeper = surface.spreading == static_cast<float>(Spreading::GROOVES_DEEPER);
    vec3 out;
    for (int c = 0; c < 3; ++c) {
        const Real albedo = axis_of(surface.albedo, c), sent = Text().grooves_again(albedo, surface.roughness);
        (c == 0 ? out.x : c == 1 ? out.y : out.z) = pick(deeper, sent * albedo, pick(again, sent, 0.0F));
    }
    return out;
}

// Of the lanes whose materials vary, what patterns give of them. Apart, with all that it puts on the stack: what is
// plain would be slower with that in one function.
[[gnu::noinline]] inline void vary(const SurfaceView &view, const Met &met, const text::CameraText<Real, Isa>::Ray &ray,
                                   const Beside *beside, Mask back, Slots &slots, Surface &surface,
                                   VaryingCurves *curves) {
    PatternPacket packet;
    const vec3 position = ray.origin + ray.direction * surface.distance;
    place_point(view, met, position, packet);
    put(surface.normal, packet.normal);
    put(surface.geometric_normal, packet.face);
    put(-ray.direction, packet.incoming);
    pick(back, 1.0F, 0.0F).store_aligned(packet.back);
    bool moved = false;
    packet.stands_for = beside == nullptr ? 1.0F : beside->stands_for;
    Real outputs[pattern_slot::SLOTS];
    for_each_varying(view, slots, surface.hit, [&](const Varying &varying, Mask where) {
        const Pattern &pattern = *varying.pattern;
        if ((pattern.moves || pattern.points > 1) && beside != nullptr && !moved) {
            moved = true;
            put(position + step_on_plane(position, surface.geometric_normal, surface.distance, beside->along),
                packet.position[1]);
            put(position + step_on_plane(position, surface.geometric_normal, surface.distance, beside->across),
                packet.position[2]);
            ask(view, met, surface.hit, packet); // of the pattern before only its own were
            move_on_triangles(packet);
        }
        ask(view, met, where, packet);
        surface.varied = surface.varied | (where & !run_filtered(pattern, packet, beside != nullptr, outputs));
        vec3 normal = surface.normal;
        for (std::size_t i = 0; i < pattern.outputs.size(); ++i) {
            const Real value = outputs[i];
            switch (pattern.outputs[i].slot) {
            case pattern_slot::NORMAL:
                normal.x = value;
                break;
            case pattern_slot::NORMAL + 1:
                normal.y = value;
                break;
            case pattern_slot::NORMAL + 2:
                normal.z = value;
                break;
            default:
                slots.set(where, pattern.outputs[i].slot, value);
            }
        }
        if (pattern.bends) {
            if (!surface.bent) {
                surface.bent = true;
                surface.smooth_normal = got(packet.normal);
            }
            const Real length2 = dot(normal, normal);
            const Mask usable = where & (length2 > 1e-20F) & (length2 < 1e30F);
            surface.normal = pick(usable, normal * (1.0F / sqrt(pick(usable, length2, 1.0F))), surface.normal);
        }
        for (int k = 0; k < MAX_LOBES; ++k) {
            if (varying.gloss[k] != nullptr) {
                add_curves(*varying.gloss[k], slots, pattern_slot::FIRST_LOBE + k * pattern_slot::LOBE_SLOTS,
                           -dot(surface.normal, ray.direction), where, curves[k]);
            }
        }
    });
}

// `beside` are neighbouring rays, if any: what is textured is a pixel's mean then.
inline Surface surface_at(const SurfaceView &view, const Met &met, const text::CameraText<Real, Isa>::Ray &ray,
                          const Beside *beside = nullptr) {
    Surface surface;
    // The lanes' places have arrays of their own, so these are read lane by lane.
    alignas(64) float hits[LANES], normals[3][LANES], faces[3][LANES], tangents[3][LANES], objects[LANES];
    alignas(64) std::int32_t materials[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        const bool hit = met.hit[lane];
        hits[lane] = hit ? 1.0F : 0.0F;
        const PlaceView *const place = hit ? view.places + met.place[lane] : nullptr;
        const Corners corners = hit ? corners_of(*place, met.triangle[lane], met.u[lane], met.v[lane]) : Corners{};
        for (int axis = 0; axis < 3; ++axis) {
            normals[axis][lane] = corners.normal[axis];
            faces[axis][lane] = corners.face[axis];
            tangents[axis][lane] = corners.tangent[axis];
        }
        materials[lane] = material_row::FLOATS * corners.material;
        objects[lane] = hit ? place->object_index : 0.0F;
        if (!view.plain) {
            surface.visibility[lane] = hit ? &place->visibility : nullptr;
        }
    }
    surface.hit = Real::load_aligned(hits) > 0.0F;
    surface.distance = pick(surface.hit, met.distance, ray.reach);

    const auto loaded = [](const float(&v)[3][LANES]) {
        return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
    };
    // The corner normals say which side is the front, the triangle which side is seen: turning the shading normal by
    // its own angle to the ray would flip it at the rim of smooth objects.
    surface.normal = normalised(loaded(normals));
    const vec3 face = normalised(loaded(faces));
    surface.geometric_normal = face * pick(dot(face, surface.normal) < 0.0F, -1.0F, 1.0F);
    const Mask back = dot(surface.geometric_normal, ray.direction) > 0.0F;
    const Real side = pick(back, -1.0F, 1.0F);
    surface.normal = surface.normal * side;
    surface.geometric_normal = surface.geometric_normal * side;
    const Index material = Index::load_aligned(materials);
    surface.material = material;
    surface.object_index = Real::load_aligned(objects);
    Slots slots(view.properties, material);
    VaryingCurves curves[MAX_LOBES];
    if (view.varying != nullptr) {
        vary(view, met, ray, beside, back, slots, surface, curves);
        // Another one for each material, so that they end in an edge.
        const Real number = 0.618033989F * slots.property(material_row::PATTERN);
        surface.even = 0.3F + 0.6F * (number - floor(number));
    }
    surface.albedo = slots.colour(pattern_slot::ALBEDO);
    surface.emission = slots.colour(pattern_slot::EMISSION);
    if (view.sheets.scene != nullptr) {
        surface.transmittance = slots.colour(pattern_slot::TRANSMITTANCE);
    }
    if (view.more) {
        surface.translucence = slots.colour(pattern_slot::TRANSLUCENCE);
        surface.sheen = slots.colour(pattern_slot::SHEEN);
        surface.sheen_spreading = slots.property(material_row::SHEEN_SPREADING);
        surface.sheen_roughness = slots.slot(pattern_slot::SHEEN_ROUGHNESS);
    }
    surface.spreading = slots.property(material_row::SPREADING);
    surface.roughness = slots.slot(pattern_slot::ROUGHNESS);
    surface.again = {slots.property(material_row::AGAIN), slots.property(material_row::AGAIN + 1),
                     slots.property(material_row::AGAIN + 2)};
    if (slots.has(pattern_slot::ALBEDO) || slots.has(pattern_slot::ROUGHNESS)) {
        surface.again = grooves_again(surface);
    }
    const Real lobes = slots.property(material_row::LOBES);
    while (xsimd::any(lobes > static_cast<float>(surface.lobes))) {
        ++surface.lobes;
    }
    if (surface.lobes > 0) {
        add_lobes(view, slots, view.varying == nullptr ? nullptr : curves, -dot(surface.normal, ray.direction),
                  surface);
        surface.tangents = plane_across(surface.normal);
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

// Of what is in `among`, which has the numbers of all places.
inline Surface first_surface(const SurfaceView &view, const RayScene &among,
                             const text::CameraText<Real, Isa>::Ray &ray, Mask active, const Beside *beside) {
    Surface none;
    none.hit = Mask(false);
    none.distance = ray.reach;
    if (among.scene == nullptr) {
        return none;
    }
    typename Rays<LANES>::RayHit rays;
    // A surface in the far plane itself is seen: the boxes around it may round to either side of it.
    set_rays(rays.ray, among, ray.origin, ray.direction, 0.0F, ray.reach * 1.000001F);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    alignas(64) int valid[LANES];
    valid_lanes(active, valid);
    Rays<LANES>::intersect(valid, among.scene, !among.instanced, rays);

    Met met;
    met.distance = Real::load_aligned(rays.ray.tfar);
    bool any = false;
    for (int lane = 0; lane < LANES; ++lane) {
        met.hit[lane] = valid[lane] != 0 && rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
        any = any || met.hit[lane];
        const unsigned instance = rays.hit.instID[0][lane];
        met.place[lane] = instance != RTC_INVALID_GEOMETRY_ID ? instance : rays.hit.geomID[lane];
        met.triangle[lane] = rays.hit.primID[lane];
        met.u[lane] = rays.hit.u[lane];
        met.v[lane] = rays.hit.v[lane];
    }
    return any ? surface_at(view, met, ray, beside) : none;
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
