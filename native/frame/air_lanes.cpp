// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the air: what it scatters of all lights, emits and takes between the eye and the first opaque surface of
// each ray. Of a light, for one colour, on the ray x(t),
//     L = int sigma_s rho p E V exp(-tau_eye - tau_light) dt ,
// where the irradiance E, the phase function p and both optical depths of the air are smooth, and V, what solids, sheets,
// smoke and other things leave of the light, is not. So a ray is cut into sections that are short where V is looked up;
// over a section V goes straight from end to end, and the rest is integrated by Gauss and Legendre's rule. A section at
// whose ends V differs is cut again.
#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/arriving_lanes.hpp"
#include "media/air_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/media_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using Ray = CameraText::Ray;

constexpr float NOTHING_SEEN = 14.0F; // optical depth

// Rays through the air, up to the surfaces.
struct Way {
    const FrameView &frame;
    const AirView &air;
    Ray ray;
    Real end;
    int colours; // that the optical depths have

    [[nodiscard]] vec3 place(Real t) const { return ray.origin + ray.direction * t; }
    [[nodiscard]] Real amount(Real t) const { return amount_on(air, ray.origin, ray.direction, t); }
};

// Of a light at a place: what arrives there past all but the world's air, as a share of its falloff.
struct Open {
    Real of[3];
};

// One light as it shines along a ray. Sections are equal in u: of parallel light that is the way itself; else the angle at
// the light, in which the inverse square of the distance is even: t = middle + width tan u.
class Shine {
public:
    Shine(const Way &way, const LightView &light) : way_(way), light_(light), parallel_(light.parallel()) {
        at_ = {&light, way.frame.extinctions, way.frame.air_body, way.colours == 1};
        if (parallel_) {
            return;
        }
        const vec3 towards = broadcast(light.position) - way.ray.origin;
        const Real distance2 = dot(towards, towards);
        middle_ = dot(towards, way.ray.direction);
        const vec3 across = towards - way.ray.direction * middle_;
        // A point is as large as a pixel of a good picture.
        least2_ = max(distance2 * 1e-8F + 1e-12F, light.size2);
        width_ = sqrt(dot(across, across) + least2_);
    }

    [[nodiscard]] Real u(Real t) const { return parallel_ ? t : atan((t - middle_) / width_, Real(1.0F)); }

    // Adds what is scattered between two places.
    void add(Real from, Real to, Real (&sum)[3]) const {
        if (parallel_ && way_.frame.air_body >= 0) {
            add_through_map(from, to, sum);
        } else {
            add_sections(from, to, sections(from, to), sum);
        }
    }

private:
    // The light's first map of what throws shadows; null where it does not meet that.
    [[nodiscard]] const LightMapView *map() const {
        const LightMapView *const map =
            way_.frame.air_body < 0 ? nullptr : light_.maps + way_.frame.air_body;
        return map == nullptr || map->empty() ? nullptr : map;
    }

    // So many that a section crosses no more than two texels of the map, and that the air is thin in it.
    [[nodiscard]] int sections(Real from, Real to) const {
        constexpr float FEWEST = 2.0F, MOST = 1024.0F, PER_DEPTH = 1.0F, PER_TURN = 12.0F;
        float extinction = 0.0F;
        for (int c = 0; c < way_.colours; ++c) {
            extinction = std::max(extinction, way_.air.extinction[c]);
        }
        const Real length = max(to - from, 0.0F);
        Real count = min((way_.amount(to) - way_.amount(from)) * (extinction * PER_DEPTH), 64.0F);
        const LightMapView *const map = this->map();
        if (!parallel_) {
            const Real turn = max(u(to) - u(from), 0.0F);
            count = count + turn * PER_TURN;
            if (map != nullptr) {
                // From the middle of the octahedron's square to its edge it is a quarter of a turn.
                const float per_radian = static_cast<float>(map->width) * map->scale[0] * 0.6366F;
                count = max(count, turn * (0.5F * per_radian));
            }
        } else if (map != nullptr) {
            const vec3 along = transform_vector(map->world_to_light, way_.ray.direction);
            const vec3 begin = transform_point(map->world_to_light, way_.place(from));
            const vec3 close = transform_point(map->world_to_light, way_.place(to));
            // Beside the map there is nothing, and behind it what changes across it changes no more along it.
            const Mask beside = ((max(begin.x, close.x) <= 0.0F) | (min(begin.x, close.x) >= 1.0F)) |
                                ((max(begin.y, close.y) <= 0.0F) | (min(begin.y, close.y) >= 1.0F));
            const Mask behind = min(begin.z, close.z) >= 1.0F;
            const Real across = max(abs(along.x) * static_cast<float>(map->width),
                                    abs(along.y) * static_cast<float>(map->height));
            const Real deep = abs(along.z) * static_cast<float>(std::max(map->width, map->height));
            const Real texels = length * pick(behind, across, max(across, deep));
            count = max(count, pick(beside, 0.0F, texels * 0.5F));
        }
        const Real wanted = pick(length > 0.0F, max(count, FEWEST), 0.0F);
        return static_cast<int>(std::ceil(std::min(highest(wanted), MOST)));
    }

    // Of parallel light: before the map's box, in it, and beside it or behind it are different.
    void add_through_map(Real from, Real to, Real (&sum)[3]) const {
        const LightMapView *const map = this->map();
        Real ends[6] = {from, from, from, to, to, to};
        if (map != nullptr) {
            const vec3 along = transform_vector(map->world_to_light, way_.ray.direction);
            const vec3 origin = transform_point(map->world_to_light, way_.ray.origin);
            Real first = from, last = to;
            clip(origin.x, along.x, first, last);
            clip(origin.y, along.y, first, last);
            const Mask any = first < last;
            ends[1] = pick(any, first, from);
            ends[4] = pick(any, last, from);
            Real enters = ends[1], leaves = ends[4];
            clip(origin.z, along.z, enters, leaves);
            const Mask within = enters < leaves;
            ends[2] = pick(within, enters, ends[1]);
            ends[3] = pick(within, leaves, ends[1]);
        }
        for (int i = 0; i < 5; ++i) {
            add_sections(ends[i], ends[i + 1], sections(ends[i], ends[i + 1]), sum);
        }
    }

    static void clip(Real origin, Real along, Real &from, Real &to) {
        const Real safe = pick(abs(along) < 1e-20F, 1e-20F, along);
        const Real a = -origin / safe, b = (1.0F - origin) / safe;
        from = max(from, min(a, b));
        to = min(to, max(a, b));
    }

    [[nodiscard]] Real t(Real u) const {
        if (parallel_) {
            return u;
        }
        return middle_ + width_ * sin(u) / max(cos(u), 1e-7F);
    }

    [[nodiscard]] Open open(Real t) const {
        const Arriving arriving = SFUMATO_ISA::arriving(at_, way_.place(t));
        Open out;
        for (int c = 0; c < 3; ++c) {
            out.of[c] = c < way_.colours ? arriving.share * RaysText().transmittance_of(arriving.optical_depth[c])
                                         : out.of[0];
        }
        return out;
    }

    void add_sections(Real from, Real to, int count, Real (&sum)[3]) const {
        constexpr int PARTS = 8;
        constexpr float DIFFERENT = 0.03F;
        if (count == 0) {
            return;
        }
        const Mask any = to > from;
        const Real low = u(from), step = pick(any, u(to) - low, 0.0F) * (1.0F / static_cast<float>(count));
        Open before = open(from);
        for (int i = 0; i < count; ++i) {
            const Real u0 = low + step * static_cast<float>(i), u1 = u0 + step;
            const Open after = open(t(u1));
            const Real change = max(abs(after.of[0] - before.of[0]), abs(after.of[2] - before.of[2]));
            if (!xsimd::any(any & (change > DIFFERENT))) {
                add_section(u0, u1, before, after, sum);
                before = after;
                continue;
            }
            const Real part = step * (1.0F / PARTS);
            for (int k = 0; k < PARTS; ++k) {
                const Real v0 = u0 + part * static_cast<float>(k);
                const Open next = k + 1 < PARTS ? open(t(v0 + part)) : after;
                add_section(v0, v0 + part, before, next, sum);
                before = next;
            }
        }
    }

    void add_section(Real u0, Real u1, const Open &before, const Open &after, Real (&sum)[3]) const {
        constexpr float NODES[3] = {0.112701665F, 0.5F, 0.887298335F}, WEIGHTS[3] = {0.277777778F, 0.444444444F, 0.277777778F};
        Mask lit(false);
        for (int c = 0; c < 3; ++c) {
            lit = lit | (before.of[c] + after.of[c] > 0.0F);
        }
        if (!xsimd::any(lit)) {
            return;
        }
        const Real width = u1 - u0;
        for (int node = 0; node < 3; ++node) {
            const Real t = this->t(u0 + width * NODES[node]);
            const vec3 place = way_.place(t);
            Real rate = width * WEIGHTS[node], cosine = 0.0F;
            if (parallel_) {
                cosine = -dot(broadcast(light_.direction), way_.ray.direction);
            } else {
                const vec3 from_light = place - broadcast(light_.position);
                const Real distance2 = dot(from_light, from_light);
                const Real s = t - middle_;
                rate = rate * ((s * s + width_ * width_) / width_) * LightsText().falloff(distance2, light_.size2);
                rate = rate * min(distance2 / max(least2_, 1e-30F), 1.0F);
                cosine = -dot(from_light, way_.ray.direction) * inversesqrt(max(distance2, 1e-30F));
            }
            const AirView &air = way_.air;
            const Real dust = phase_of_dust(air, cosine);
            const Real molecules = RAYLEIGH * (1.0F + cosine * cosine);
            rate = rate * density_of(air, place.z);
            const Real ways = way_.amount(t) + amount_from(place);
            Real left = 0.0F;
            for (int c = 0; c < 3; ++c) {
                if (c < way_.colours) {
                    left = exp(-min(ways * air.extinction[c], 80.0F));
                }
                const Real open = before.of[c] + (after.of[c] - before.of[c]) * NODES[node];
                sum[c] = sum[c] + rate * left * open * (dust * air.mie[c] + molecules * air.rayleigh[c]) *
                                      light_.strength[c];
            }
        }
    }

    // From the light's middle.
    [[nodiscard]] Real amount_from(const vec3 &place) const {
        return amount_to(way_.air, light_, parallel_ ? -light_.direction : light_.position, place);
    }

    static constexpr float RAYLEIGH = 0.0596831037F; // 3 / (16 pi)
    static Real phase_of_dust(const AirView &air, Real cosine) {
        const float g = air.anisotropy;
        const Real plain = text::MediaText<Real, Isa>().henyey_greenstein(cosine, g);
        return air.cornette_shanks ? plain * (1.0F + cosine * cosine) * (1.5F / (2.0F + g * g)) : plain;
    }

    const Way &way_;
    const LightView &light_;
    bool parallel_;
    ArrivingAt at_;
    Real middle_ = 0.0F, width_ = 1.0F, least2_ = 0.0F;
};

// What the air between two places sends to the eye.
void sent_between(const Way &way, Real from, Real to, Real (&sum)[3]) {
    const Real before = way.amount(from), amount = way.amount(to) - before;
    for (int c = 0; c < 3; ++c) {
        const float extinction = way.air.extinction[c];
        // Both go with the density.
        sum[c] = sum[c] + amount * mean_left(amount * extinction) * exp(-before * extinction) * way.air.emission[c];
    }
    for (const LightView &light : way.frame.lights) {
        if (light.reach.smoke && (light.reach.lights & way.air.lit_by) != 0 && !light.samples.empty()) {
            Shine(way, light).add(from, to, sum);
        }
    }
}

void leave_knot(const Way &way, Real t, const Real (&radiance)[3], AirKnots &knots) {
    const auto keep = [&knots](Real value) {
        knots.values.resize(knots.values.size() + MAX_LANES);
        value.store_unaligned(knots.values.data() + (knots.values.size() - MAX_LANES));
    };
    keep(t);
    for (const Real &value : radiance) {
        keep(value);
    }
    const Real amount = way.amount(t);
    for (int c = 0; c < way.colours; ++c) {
        keep(amount * way.air.extinction[c]);
    }
    ++knots.count;
}

// From the first to the last of what else is met on any ray, in each lane within its own way; the whole way where nothing
// is met.
struct Stretch {
    Real from, to;
};

Stretch met(const Events &events, Real end, int colours) {
    constexpr float FAR = 1e30F;
    alignas(64) float from[MAX_LANES], to[MAX_LANES];
    for (std::size_t lane = 0; lane < LANES; ++lane) {
        from[lane] = FAR;
        to[lane] = 0.0F;
        const auto take = [&](float near, float far) {
            from[lane] = std::min(from[lane], near);
            to[lane] = std::max(to[lane], far);
        };
        for (const Fragment &fragment : events.fragments[lane]) {
            take(fragment.distance, fragment.distance);
        }
        if (events.slices.count > 0 && events.slices.width[lane] > 0.0F) {
            const float first = events.slices.first[lane];
            take(first, first + events.slices.width[lane] * static_cast<float>(events.slices.count));
        }
        if (events.knots.count > 0) {
            const auto row = static_cast<std::size_t>(4 + colours) * MAX_LANES;
            const float first = events.knots.values[lane];
            const float last = events.knots.values[(static_cast<std::size_t>(events.knots.count) - 1) * row + lane];
            take(first - events.knots.step[lane], last);
        }
    }
    const Real first = Real::load_aligned(from), last = Real::load_aligned(to);
    const Mask none = first > last;
    return {clamp(pick(none, 0.0F, first), 0.0F, end), clamp(pick(none, end, last), 0.0F, end)};
}

} // namespace

void trace_air(const FrameView &frame, const Packet &packet, Layers &out) {
    constexpr int STEPS = 48;
    const auto &c = frame.camera;
    const Real u = Real::load_aligned(packet.u), v = Real::load_aligned(packet.v);
    const Ray ray = CameraText().camera_ray(broadcast(c[0]), broadcast(c[1]), broadcast(c[2]), broadcast(c[3]),
                                            broadcast(c[4]), broadcast(c[5]), u, v);
    const Real end = Real::load_aligned(out.distance) * Real::load_aligned(packet.active);
    const Way way{frame, frame.air.front(), ray, end, frame.grey ? 1 : 3};
    Events &events = *out.events;
    Real radiance[3] = {0.0F, 0.0F, 0.0F};
    Real at = 0.0F;
    leave_knot(way, at, radiance, events.air);
    const auto go = [&](Real to) {
        sent_between(way, at, to, radiance);
        at = to;
        leave_knot(way, at, radiance, events.air);
    };
    if (events.any() || events.knots.count > 0) {
        const Stretch stretch = met(events, end, way.colours);
        for (int i = 0; i <= STEPS; ++i) {
            go(stretch.from + (stretch.to - stretch.from) * (static_cast<float>(i) * (1.0F / STEPS)));
        }
    }
    go(end);
}

} // namespace sfumato::SFUMATO_ISA
