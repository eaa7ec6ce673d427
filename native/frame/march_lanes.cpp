// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the media: the smoke before the first surface of each ray of a packet.
#include "frame/layers.hpp"
#include "frame/rays_lanes.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/sampling.hpp"
#include "text/media_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>

namespace sfumato::SFUMATO_ISA {
namespace {

using MediaText = text::MediaText<Real, Isa>;

struct Smoke {
    Real transmittance[3];
    Real radiance[3];
};

// A ray in the grid of one medium.
struct Crossing {
    vec3 origin, direction;
    CameraText::Interval inside;
};

Crossing crossing_of(const MediumView &medium, const Ray &ray, Real distance) {
    Crossing crossing;
    crossing.origin = transform_point(medium.world_to_grid, ray.origin);
    crossing.direction = transform_vector(medium.world_to_grid, ray.direction);
    const vec3 size{Real(static_cast<float>(medium.density.nx)), Real(static_cast<float>(medium.density.ny)),
                    Real(static_cast<float>(medium.density.nz))};
    crossing.inside = CameraText().clip_to_box({Real(0.0F), distance}, crossing.origin, crossing.direction, size);
    return crossing;
}

// What one step through one medium scatters to the eye from all lights.
template <int Colours>
void scatter(const FrameView &frame, const MediumView &medium, const Cell &cell, const Ray &ray, Real t,
             const Real *scattering, const Real *tau, const Real *tau_eye, Smoke &smoke) {
    GridView volume = medium.density;
    volume.channels = medium.light_channels;
    const Cell light_cell{cell.first * Index(volume.channels), cell.x, cell.y, cell.z};
    const vec3 world = ray.origin + ray.direction * t;
    for (std::size_t i = 0; i < frame.lights.size(); ++i) {
        const LightView &light = frame.lights[i];
        volume.values = medium.light[i];
        Real incoming = sample(volume, light_cell, Colours);
        Real cosine;
        if (light.parallel()) {
            cosine = dot(broadcast(light.direction), ray.direction);
        } else {
            const vec3 from_light = world - broadcast(light.position);
            incoming = incoming * falloff_of(light, from_light);
            cosine = dot(from_light, ray.direction) / sqrt(max(dot(from_light, from_light), 1e-20F));
        }
        incoming = incoming * MediaText().henyey_greenstein(-cosine, medium.anisotropy);
        for (int c = 0; c < Colours; ++c) {
            const Real sent = incoming * MediaText().scattered_by_step(scattering[c], tau[c], tau_eye[c],
                                                                       sample(volume, light_cell, c));
            if (Colours == 3) {
                smoke.radiance[c] = smoke.radiance[c] + sent * light.strength[c];
                continue;
            }
            for (int rgb = 0; rgb < 3; ++rgb) {
                // Grey smoke may still scatter in colours, so the one march takes it for white until here.
                smoke.radiance[rgb] = smoke.radiance[rgb] + sent * (light.strength[rgb] * medium.scattering[rgb]);
            }
        }
    }
}

template <int Colours>
Smoke march(const FrameView &frame, const Ray &ray, Real distance, Mask active) {
    Crossing crossings[MAX_MEDIA];
    Real near_t = 1e30F, far_t = 0.0F, step_length = 1e30F;
    const std::size_t media = frame.media.size();
    for (std::size_t m = 0; m < media; ++m) {
        const Crossing &crossing = crossings[m] = crossing_of(frame.media[m], ray, distance);
        const Mask met = crossing.inside.near_t < crossing.inside.far_t;
        const Real length = frame.media[m].step_length / sqrt(dot(crossing.direction, crossing.direction));
        near_t = pick(met, min(near_t, crossing.inside.near_t), near_t);
        far_t = pick(met, max(far_t, crossing.inside.far_t), far_t);
        step_length = pick(met, min(step_length, length), step_length);
    }
    const Real stretch = max(pick(active, far_t - near_t, 0.0F), 0.0F);
    Smoke smoke{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}};
    Real depth[Colours]; // optical, towards the eye
    for (Real &d : depth) {
        d = 0.0F;
    }
    if (xsimd::any(stretch > 0.0F)) {
        const Real steps = pick(stretch > 0.0F, MediaText().march_steps(stretch, step_length), 0.0F);
        const Real step = stretch / max(steps, 1.0F);
        const Real per_step = 1.0F / max(step, 1e-30F);
        const float most = highest(steps);
        for (float k = 0.0F; k < most;) {
            const Real t = near_t + (k + 0.5F) * step;
            const Mask marching = Real(k) < steps;
            Real tau[Colours];
            for (Real &value : tau) {
                value = 0.0F;
            }
            Cell cells[MAX_MEDIA];
            Real amounts[MAX_MEDIA]; // of density times length
            bool met[MAX_MEDIA];
            float leap = 1e6F;
            bool any_met = false;
            for (std::size_t m = 0; m < media; ++m) {
                const MediumView &medium = frame.media[m];
                const Crossing &crossing = crossings[m];
                const vec3 p = crossing.origin + crossing.direction * t;
                const vec3 &d = crossing.direction;
                const Mask inside = marching & (t >= crossing.inside.near_t) & (t <= crossing.inside.far_t);
                // Steps that surely meet nothing: empty bricks inside, the way up to the box before it.
                const Real speed = max(max(abs(d.x), abs(d.y)), abs(d.z)) * step; // cells a step
                const Real ahead =
                    pick(marching & (t < crossing.inside.near_t), (crossing.inside.near_t - t) * per_step - 1.0F, 1e6F);
                const Real clear = clearance_at(medium.clearance, p);
                met[m] = xsimd::any(inside & (clear < 0.0F));
                any_met = any_met || met[m];
                if (!met[m]) {
                    leap = std::min(leap, lowest(pick(inside, clear / max(speed, 1e-6F), ahead)));
                    continue;
                }
                cells[m] = locate(medium.density, p);
                amounts[m] = pick(inside, sample(medium.density, cells[m], 0), 0.0F) * step;
                for (int c = 0; c < Colours; ++c) {
                    tau[c] = tau[c] + amounts[m] * medium.extinction[c];
                }
            }
            if (!any_met) {
                k += 1.0F + std::floor(std::max(leap, 0.0F));
                continue;
            }
            for (std::size_t m = 0; m < media; ++m) {
                if (!met[m]) {
                    continue;
                }
                Real scattering[Colours];
                for (int c = 0; c < Colours; ++c) {
                    scattering[c] = Colours == 1 ? amounts[m] : amounts[m] * frame.media[m].scattering[c];
                }
                scatter<Colours>(frame, frame.media[m], cells[m], ray, t, scattering, tau, depth, smoke);
            }
            for (int c = 0; c < Colours; ++c) {
                depth[c] = depth[c] + tau[c];
            }
            k += 1.0F;
        }
    }
    for (int c = 0; c < 3; ++c) {
        smoke.transmittance[c] = RaysText().transmittance_of(depth[Colours == 1 ? 0 : c]);
    }
    return smoke;
}

} // namespace

void trace_surfaces(const FrameView &frame, LayerSet wanted, const Packet &packet, Layers &out); // surfaces_lanes.cpp

void march(const FrameView &frame, const Packet &packet, Layers &out) {
    const Mask active = Real::load_aligned(packet.active) > 0.0F;
    const Ray ray = ray_through(frame, Real::load_aligned(packet.u), Real::load_aligned(packet.v));
    const Real distance = Real::load_aligned(out.distance);
    const Smoke smoke = frame.grey ? march<1>(frame, ray, distance, active) : march<3>(frame, ray, distance, active);
    for (int c = 0; c < 3; ++c) {
        smoke.radiance[c].store_aligned(out.smoke[c]);
        smoke.transmittance[c].store_aligned(out.through[c]);
    }
}

extern const FrameKernels frame_kernels{trace_surfaces, march};

} // namespace sfumato::SFUMATO_ISA
