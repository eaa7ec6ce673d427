// SPDX-License-Identifier: GPL-3.0-or-later
// What some surfaces send to the eye besides: of light that falls on their other side, and by fibres on them.
#pragma once

#include "frame/reflected_lanes.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

inline Mask any_colour(const vec3 &colour) {
    return max(max(colour.x, colour.y), colour.z) > 0.0F;
}

// A surface that has this, in some lanes, and nothing else.
inline Surface alone(const Surface &surface, const vec3 &albedo, Mask where) {
    Surface out = surface;
    out.hit = surface.hit & where;
    out.albedo = albedo;
    out.lobes = 0;
    out.emission = {0.0F, 0.0F, 0.0F};
    return out;
}

inline void add(const Reflected &more, Reflected &out) {
    for (int c = 0; c < 3; ++c) {
        out.shadowed[c] = out.shadowed[c] + more.shadowed[c];
        out.open[c] = out.open[c] + more.open[c];
        out.lit[c] = out.lit[c] + more.lit[c];
        out.alone[c] = out.alone[c] + more.alone[c];
    }
    out.unshadowed = out.unshadowed + more.unshadowed;
    out.even = out.even + more.even;
    out.even_unshadowed = out.even_unshadowed + more.even_unshadowed;
}

// Of what light comes through, the other side: seen from here, and lit from there.
inline Surface behind(const Surface &surface) {
    Surface out = alone(surface, surface.translucence, any_colour(surface.translucence));
    out.normal = -surface.normal;
    out.geometric_normal = -surface.geometric_normal;
    out.smooth_normal = -surface.smooth_normal;
    out.spreading = static_cast<float>(Spreading::LAMBERT);
    return out;
}

// Apart, with all that it puts on the stack: few surfaces have any of this.
[[gnu::noinline]] inline void add_more(const FrameView &frame, LayerSet wanted, const Packet &packet, const Ray &ray,
                                       const Surface &surface, Reflected &out) {
    const Mask sheen = any_colour(surface.sheen), translucent = any_colour(surface.translucence);
    if (xsimd::any(surface.hit & sheen)) {
        Surface fibres = alone(surface, surface.sheen, sheen);
        fibres.spreading = surface.sheen_spreading;
        fibres.roughness = surface.sheen_roughness;
        const Reflected more = reflected(frame, wanted, packet, ray, fibres);
        add(more, out);
        for (int c = 0; c < 3; ++c) {
            out.dull.light[c] = out.dull.light[c] + pick(fibres.hit, more.dull.light[c], 0.0F);
        }
        out.dull.open = out.dull.open + pick(fibres.hit, more.dull.open, 0.0F);
    }
    if (xsimd::any(surface.hit & translucent)) {
        // What solids hide there of a sky, the directions of this side do not tell: it stays as its few rays have it.
        add(reflected(frame, wanted, packet, ray, behind(surface)), out);
    }
}

// All that a packet's surfaces send to the eye.
inline Reflected all_reflected(const FrameView &frame, LayerSet wanted, const Packet &packet, const Ray &ray,
                               const Surface &surface) {
    Reflected out = reflected(frame, wanted, packet, ray, surface);
    if (frame.surfaces.more && wanted.has(Layer::RADIANCE)) {
        add_more(frame, wanted, packet, ray, surface, out);
    }
    return out;
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
