// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the particles: what the puffs before the first surface take and send, slice by slice of each ray. Their
// densities add wherever they overlap, so it does not matter which comes first, and none begins at once.
#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/arriving_lanes.hpp"
#include "rays/bins_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/media_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using MediaText = text::MediaText<Real, Isa>;
using Ray = CameraText::Ray;

constexpr float HIDDEN_DEPTH = 12.5F; // what lies behind it, 4e-6
constexpr float OPAQUE_DEPTH = 9.0F;  // what lies behind it adds less than 2e-4 of its radiance

// Where rays are in a puff: between `middle` - `half` and `middle` + `half`, metres, cut by the eye and by surfaces.
struct Chord {
    Real middle, half, inside;
    Mask met;
};

[[gnu::always_inline]] inline Chord chord_of(const Puff &puff, const Ray &ray, const Real &reach) {
    const vec3 away = broadcast(puff.middle) - ray.origin;
    Chord chord;
    chord.middle = dot(away, ray.direction);
    const vec3 across = ray.direction * chord.middle - away;
    const float per_radius = 1.0F / puff.radius;
    chord.inside = 1.0F - dot(across, across) * (per_radius * per_radius);
    chord.half = puff.radius * sqrt(max(chord.inside, 0.0F));
    chord.met = (chord.inside > 0.0F) & (chord.middle + chord.half > 0.0F) & (chord.middle - chord.half < reach);
    return chord;
}

// What puffs add to the slices that they are in: the optical depth, and of that in the strongest colour, times their
// albedo, what they scatter.
template <int COLOURS>
void add_to_slices(const Chord &chord, const Puff &puff, const glm::vec3 &extinction, const glm::vec3 &albedo,
                   Slices &slices, float *scattered) {
    const Real first = Real::load_aligned(slices.first), width = Real::load_aligned(slices.width);
    const Real per_width = 1.0F / max(width, 1e-20F), per_half = 1.0F / max(chord.half, 1e-20F);
    const Real enters = (chord.middle - chord.half - first) * per_width;
    const Real leaves = (chord.middle + chord.half - first) * per_width;
    const auto begin = static_cast<int>(std::max(lowest(pick(chord.met, enters, 1e6F)), 0.0F));
    const auto end = static_cast<int>(
        std::min(std::ceil(highest(pick(chord.met, leaves, -1.0F))), static_cast<float>(slices.count)));
    const Real column = pick(chord.met, puff.depth * MediaText().puff_column(chord.inside), 0.0F);
    const Real step = width * per_half;
    Real u = (first + width * static_cast<float>(begin) - chord.middle) * per_half;
    Real before = MediaText().puff_before(u);
    for (int s = begin; s < end; ++s) {
        u = u + step;
        const Real next = MediaText().puff_before(u);
        const Real depth = column * (next - before);
        before = next;
        float *to = slices.depth.data() + static_cast<std::ptrdiff_t>(s) * COLOURS * MAX_LANES;
        for (int c = 0; c < COLOURS; ++c, to += MAX_LANES) {
            (Real::load_unaligned(to) + depth * extinction[c]).store_unaligned(to);
        }
        to = scattered + static_cast<std::ptrdiff_t>(s) * 3 * MAX_LANES;
        for (int c = 0; c < 3; ++c, to += MAX_LANES) {
            (Real::load_unaligned(to) + depth * albedo[c]).store_unaligned(to);
        }
    }
}

// Light that arrives at places of one of the bodies, and goes on towards the eye: radiance, for each unit of optical
// depth that scatters it.
template <int COLOURS>
void arriving_light(const FrameView &frame, const Puffs::Body &body, std::size_t number, const vec3 &place,
                    const vec3 &direction, Real (&sum)[3], bool past_smoke = true) {
    for (const LightView &light : frame.lights) {
        if (!light.reach.smoke || (light.reach.lights & body.visibility.lit_by) == 0 || light.samples.empty()) {
            continue;
        }
        const Arriving arriving =
            SFUMATO_ISA::arriving({&light, frame.extinctions, static_cast<int>(frame.particles.first_body + number),
                                   COLOURS == 1, frame.world_air},
                                  place);
        vec3 travel = broadcast(light.direction);
        Real share = arriving.share;
        if (!light.parallel()) {
            const vec3 from_light = place - broadcast(light.position);
            const Real distance2 = max(dot(from_light, from_light), 1e-20F);
            share = share * LightsText().falloff(distance2, light.size2);
            travel = from_light * inversesqrt(distance2);
        }
        share = share * (body.anisotropy == 0.0F
                             ? Real(0.0795774715F)
                             : MediaText().henyey_greenstein_of_cap(-dot(travel, direction), Real(body.anisotropy),
                                                                    Real(light.concentration)));
        for (int c = 0; c < 3; ++c) {
            const Real depth = arriving.optical_depth[COLOURS == 1 ? 0 : c];
            const Real left = past_smoke ? RaysText().transmittance_of(depth) : Real(1.0F);
            sum[c] = sum[c] + share * left * light.strength[c];
        }
    }
}

// Adds what the particles of one body send.
template <int COLOURS>
void light_slices(const FrameView &frame, const Puffs::Body &body, std::size_t number, const Ray &ray, Slices &slices) {
    const Real first = Real::load_aligned(slices.first), width = Real::load_aligned(slices.width);
    Real passed = 0.0F; // optical depth of the slices before, in the least opaque colour
    for (int s = 0; s < slices.count && xsimd::any(passed < OPAQUE_DEPTH); ++s) {
        const float *const depth = slices.depth.data() + static_cast<std::ptrdiff_t>(s) * COLOURS * MAX_LANES;
        Real least = Real::load_unaligned(depth);
        for (int c = 1; c < COLOURS; ++c) {
            least = min(least, Real::load_unaligned(depth + static_cast<std::ptrdiff_t>(c) * MAX_LANES));
        }
        passed = passed + least;
        const float *from = slices.scattered.data() + static_cast<std::ptrdiff_t>(s) * 3 * MAX_LANES;
        Real scattered[3];
        Mask any(false);
        for (int c = 0; c < 3; ++c, from += MAX_LANES) {
            scattered[c] = Real::load_unaligned(from);
            any = any | (scattered[c] > 0.0F);
        }
        if (!xsimd::any(any)) {
            continue;
        }
        const Real t = first + width * (static_cast<float>(s) + 0.5F);
        Real light[3] = {0.0F, 0.0F, 0.0F};
        arriving_light<COLOURS>(frame, body, number, ray.origin + ray.direction * t, ray.direction, light);
        float *to = slices.sent.data() + static_cast<std::ptrdiff_t>(s) * 3 * MAX_LANES;
        for (int c = 0; c < 3; ++c, to += MAX_LANES) {
            const Real sent = scattered[c] * light[c] * body.extinction[c];
            (Real::load_unaligned(to) + sent).store_unaligned(to);
        }
    }
}

template <int COLOURS>
void slice_particles(const FrameView &frame, const Packet &packet, Layers &out) {
    constexpr float FAR = 1e30F;
    constexpr int MOST = 64;           // slices
    constexpr float PER_RADIUS = 4.0F; // slices, of the mean puff
    const ParticlesView &particles = frame.particles;
    const auto &c = frame.camera;
    const Real u = Real::load_aligned(packet.u), v = Real::load_aligned(packet.v);
    const Ray ray = CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]),
                                            broadcast(c[4]), broadcast(c[5]), u, v);
    const Real reach = Real::load_aligned(out.distance);
    const Mask active = Real::load_aligned(packet.active) > 0.0F;
    Slices &slices = out.events->slices;
    Real near(FAR), far(0.0F);
    double radii = 0.0;
    std::vector<std::int32_t> &met = slices.met;
    met.clear();
    // Once those that are met hide all that lies behind them, what begins behind the end of the last one is hidden.
    Real passed = 0.0F;
    float last = FAR;
    const bool grey = COLOURS == 1; // else what takes one colour may leave another
    for_primitives(particles.bins, u * particles.width, v * particles.height, active, [&](std::int32_t number) {
        const Puff &puff = particles.puffs[number];
        if (particles.begin[number] > last) {
            return false;
        }
        const Chord chord = chord_of(puff, ray, reach);
        const Mask here = chord.met & active;
        if (xsimd::any(here)) {
            met.push_back(number);
            // Not what the eye is in.
            const Mask whole = here & (chord.middle > chord.half);
            passed = passed + pick(whole, puff.depth * MediaText().puff_column(max(chord.inside, 0.0F)), 0.0F);
            if (grey && last == FAR && !xsimd::any(active & (passed < HIDDEN_DEPTH))) {
                last = particles.begin[number] + particles.widest;
            }
            radii += double{puff.radius};
            near = pick(here, min(near, max(chord.middle - chord.half, 0.0F)), near);
            far = pick(here, max(far, min(chord.middle + chord.half, reach)), far);
        }
        return true;
    });
    if (met.empty()) {
        return;
    }
    const Mask any = far > near;
    const Real stretch = pick(any, far - near, 0.0F);
    const double thin = radii / (double{PER_RADIUS} * static_cast<double>(met.size()));
    const double count = std::ceil(double{highest(stretch)} / thin);
    slices.reset(static_cast<int>(std::clamp(count, 1.0, double{MOST})), COLOURS);
    pick(any, near, reach).store_aligned(slices.first);
    (stretch * (1.0F / static_cast<float>(slices.count))).store_aligned(slices.width);
    std::vector<float> &scattered = slices.scattered;
    if (particles.bodies.size() > 1) {
        std::stable_sort(met.begin(), met.end(), [&particles](std::int32_t a, std::int32_t b) {
            return particles.puffs[a].body < particles.puffs[b].body;
        });
    }
    for (std::size_t first = 0, end = 0; first < met.size(); first = end) {
        const auto number = static_cast<std::size_t>(particles.puffs[met[first]].body);
        const Puffs::Body &body = particles.bodies[number];
        scattered.assign(slices.sent.size(), 0.0F);
        for (; end < met.size() && particles.puffs[met[end]].body == static_cast<std::int32_t>(number); ++end) {
            const Puff &puff = particles.puffs[met[end]];
            Chord chord = chord_of(puff, ray, reach);
            chord.met = chord.met & active;
            add_to_slices<COLOURS>(chord, puff, body.extinction, particles.albedo[met[end]], slices, scattered.data());
        }
        light_slices<COLOURS>(frame, body, number, ray, slices);
    }
}

// As many as there are lanes, or fewer, of one body.
template <int COLOURS>
void light_some(const FrameView &frame, std::span<const Puff> puffs, std::span<const glm::vec3> directions,
                bool past_smoke, std::span<glm::vec3> out) {
    alignas(64) float place[3][LANES], direction[3][LANES], rgb[3][LANES];
    for (std::size_t lane = 0; lane < LANES; ++lane) {
        const std::size_t from = std::min(lane, puffs.size() - 1);
        for (int axis = 0; axis < 3; ++axis) {
            place[axis][lane] = puffs[from].middle[axis];
            direction[axis][lane] = directions[from][axis];
        }
    }
    const auto loaded = [](const float(&v)[3][LANES]) {
        return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
    };
    const auto number = static_cast<std::size_t>(puffs.front().body);
    const Puffs::Body &body = frame.particles.bodies[number];
    Real light[3] = {0.0F, 0.0F, 0.0F};
    arriving_light<COLOURS>(frame, body, number, loaded(place), loaded(direction), light, past_smoke);
    for (int c = 0; c < 3; ++c) {
        light[c].store_aligned(rgb[c]);
    }
    for (std::size_t lane = 0; lane < puffs.size(); ++lane) {
        out[lane] = glm::vec3(rgb[0][lane], rgb[1][lane], rgb[2][lane]) * body.extinction;
    }
}

} // namespace

void light_puffs(const FrameView &frame, std::span<const Puff> puffs, std::span<const glm::vec3> directions,
                 bool past_smoke, std::span<glm::vec3> out) {
    for (std::size_t first = 0, end = 0; first < puffs.size(); first = end) {
        while (end < puffs.size() && end - first < LANES && puffs[end].body == puffs[first].body) {
            ++end;
        }
        const auto light = frame.grey ? light_some<1> : light_some<3>;
        light(frame, puffs.subspan(first, end - first), directions.subspan(first), past_smoke, out.subspan(first));
    }
}

void trace_particles(const FrameView &frame, const Packet &packet, Layers &out) {
    frame.grey ? slice_particles<1>(frame, packet, out) : slice_particles<3>(frame, packet, out);
}

} // namespace sfumato::SFUMATO_ISA
