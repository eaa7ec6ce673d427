// SPDX-License-Identifier: GPL-3.0-or-later
// What lights send to the eye through air. Of a light, in one colour, on the ray x(t),
//     L = int sigma_s rho p E V exp(-D) dt
// where the irradiance E, the phase function p and the optical depth D of the air, before the eye and before the light,
// are smooth, and what is left of the light by all else, V, is not. So a ray is cut into sections. V is a sum over the
// points at which the light is sampled: of each point, solids leave stretches of the ray, which a tree over its map
// finds without a look-up for each section; smoke and fogs dim these, which is looked up at the ends of sections. Over
// a section what a point sends goes straight from end to end, and what its stretches are of that is summed over all
// points before air.glsl integrates the rest, once.
#pragma once

#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/arriving_lanes.hpp"
#include "maps/sections_lanes.hpp"
#include "media/air_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using Ray = text::CameraText<Real, Isa>::Ray;

// What fogs take on the way to the eye: from `start` on so much a metre.
struct Taken {
    Real start = 0.0F;
    Real before[3] = {0.0F, 0.0F, 0.0F}, by_metre[3] = {0.0F, 0.0F, 0.0F};
};

// Between two places of rays where no wall of a fog is met; in lanes that have nothing of the air there they are one.
struct Step {
    Real from, to;
    Taken fogs;
};

struct Colours {
    Real of[3] = {0.0F, 0.0F, 0.0F};
};

// Rays through air, of which one scatters here, the world's takes light everywhere, and fogs take some, too.
struct Way {
    const FrameView &frame;
    const Packet &packet;
    const AirView &air; // that scatters
    int body;           // its own, on whose maps solids are looked up; or none
    const Ray &ray;
    int colours;                   // that the optical depths have
    std::span<const Step> steps;   // one behind the other
    std::vector<Colours> &scatter; // what each of them sends to the eye

    [[nodiscard]] bool of_world() const { return &air == frame.world_air; }
    [[nodiscard]] vec3 place(Real t) const { return ray.origin + ray.direction * t; }
    // Of the air that scatters, metres as dense as at its ground.
    [[nodiscard]] Real column(Real t) const { return min(column_on(air, ray.origin, ray.direction, t), endless(air)); }
    // Towards the eye, in the first of the colours and in all.
    struct Depth {
        Real of[3];
    };
    [[nodiscard]] Depth to_eye(const Taken &fogs, Real t) const {
        Depth depth = in_world([&](const AirView &world) { return column_on(world, ray.origin, ray.direction, t); });
        for (int c = 0; c < colours; ++c) {
            depth.of[c] = depth.of[c] + fogs.before[c] + fogs.by_metre[c] * (t - fogs.start);
        }
        return depth;
    }
    // Towards a sample of a light, which knows by its maps what fogs take.
    [[nodiscard]] Depth to_light(const LightView &light, const glm::vec3 &sample, Real t) const {
        return in_world([&](const AirView &world) { return column_to(world, light, sample, place(t)); });
    }

private:
    // Metres of which no more are told apart. Columns end there, and depths with them: what an air sends is the
    // quotient.
    static float endless(const AirView &air) {
        return 1e36F / std::max({air.extinction.x, air.extinction.y, air.extinction.z, 1e8F});
    }

    template <typename Column>
    [[nodiscard]] Depth in_world(const Column &column) const {
        Depth depth{{0.0F, 0.0F, 0.0F}};
        if (frame.world_air != nullptr) {
            const Real metres = min(column(*frame.world_air), endless(*frame.world_air));
            for (int c = 0; c < colours; ++c) {
                depth.of[c] = metres * frame.world_air->extinction[c];
            }
        }
        return depth;
    }
};

// Of a light at a place: what arrives there past all but the world's air, as a share of its falloff.
struct Open {
    Real of[3];
};

// Sections of a piece of rays, equally long in whatever x goes along it from 0 to 1.
struct Cut {
    int first, count;
};

// What of a light gets through on rays: of each section the integrals of that and of u times that, over u from 0 to 1.
class Through {
public:
    Through(int sections, int colours)
        : colours_(colours), moments_(static_cast<std::size_t>(sections * colours) * 2, Real(0.0F)) {}

    // Of a part of a piece a share of what is at the ends of its sections, of each the colours.
    void add(const Cut &cut, Mask which, Real x0, Real x1, Real share, const Real *ends) {
        const Real from = pick(which, x0, 1.0F) * static_cast<float>(cut.count);
        const Real to = pick(which, x1, 0.0F) * static_cast<float>(cut.count);
        share = pick(which, share, 0.0F);
        const int first = std::clamp(static_cast<int>(lowest(from)), 0, cut.count - 1);
        const int last = std::clamp(static_cast<int>(highest(to)), first, cut.count - 1);
        for (int i = first; i <= last; ++i) {
            const auto number = static_cast<float>(i);
            const Real a = clamp(from - number, 0.0F, 1.0F), b = max(clamp(to - number, 0.0F, 1.0F), a);
            const Real w0 = share * (b - a), w1 = w0 * (0.5F * (a + b));
            const Real w2 = w0 * ((a * a + a * b + b * b) * (1.0F / 3.0F));
            const Real *const front = ends + i * colours_;
            Real *const m = moments_.data() + at(cut.first + i, 0);
            for (int c = 0; c < colours_; ++c) {
                const Real change = front[c + colours_] - front[c];
                m[2 * c] = m[2 * c] + front[c] * w0 + change * w1;
                m[2 * c + 1] = m[2 * c + 1] + front[c] * w1 + change * w2;
            }
        }
    }
    [[nodiscard]] Real mean(int section, int colour) const { return moments_[at(section, colour)]; }
    // Of what a section's integrand is at each of the two points of Gauss there, how often it counts.
    struct Factors {
        Real front, back;
    };
    [[nodiscard]] Factors factors(int section, int colour) const {
        const Real *const m = moments_.data() + at(section, colour);
        constexpr float APART = 2.0F / (GAUSS[1] - GAUSS[0]);
        // Of what is lit at one end alone it would be less than nothing at the other.
        const Real back = clamp((m[1] - GAUSS[0] * m[0]) * APART, 0.0F, 2.0F * m[0]);
        return {2.0F * m[0] - back, back};
    }
    [[nodiscard]] bool any(int section) const {
        Real sum = 0.0F;
        for (int c = 0; c < colours_; ++c) {
            sum = sum + mean(section, c);
        }
        return xsimd::any(sum > 0.0F);
    }

    static constexpr float GAUSS[2] = {0.211324865F, 0.788675135F};

private:
    [[nodiscard]] std::size_t at(int section, int colour) const {
        return 2 * static_cast<std::size_t>(section * colours_ + std::min(colour, colours_ - 1));
    }

    int colours_;
    std::vector<Real> moments_;
};

// What one light sends along rays: what is the same for all kinds of them.
class Shine {
public:
    Shine(const Way &way, const LightView &light)
        : way_(way), light_(light),
          bodies_(way.frame.extinctions.size()), at_{&light, way.frame.extinctions, way.body, way.colours == 1} {
        if (light.samples.size() % way.packet.turns == 0) {
            first_ = way.packet.turn;
            every_ = way.packet.turns;
        }
        for_dimming([this](const LightMapView &, float) { dimmed_ = true; });
    }

protected:
    static constexpr float MOST = 1024.0F; // sections

    // The light's map of what throws shadows in the air, of one of its samples; null where that does not meet it.
    [[nodiscard]] const LightMapView *solids(std::size_t sample) const {
        if (way_.body < 0) {
            return nullptr;
        }
        const LightMapView *const map = light_.maps + sample * bodies_ + static_cast<std::size_t>(way_.body);
        return map->empty() ? nullptr : map;
    }
    // Sheets dim the light, too, and no tree knows them: a sample's map that has some, if any has.
    [[nodiscard]] const LightMapView *with_sheets() const {
        for (std::size_t j = 0; j < light_.samples.size(); ++j) {
            if (const LightMapView *const map = solids(j); map != nullptr && map->sheets.first != nullptr) {
                return map;
            }
        }
        return nullptr;
    }
    // Calls found(map, texels) for each map of what dims the light: so many of its texels a section may cross. A fog's
    // own columns change slowly but at its walls; and of several samples the errors differ.
    template <typename Found>
    void for_dimming(const Found &found) const {
        constexpr float OF_FOG = 16.0F, OF_SEVERAL = 4.0F, OF_ONE = 2.0F;
        const float texels = light_.samples.size() < 4 ? OF_ONE : OF_SEVERAL;
        for (std::size_t m = 0; m < light_.samples.size() * bodies_; ++m) {
            if (!(light_.maps[m].empty() || light_.maps[m].clear())) {
                const bool own = !way_.of_world() && m % bodies_ == static_cast<std::size_t>(way_.body);
                found(light_.maps[m], own ? OF_FOG : texels);
            }
        }
    }

    [[nodiscard]] Open open(const ArrivingAt &at, Real t) const {
        const Arriving arriving = SFUMATO_ISA::arriving(at, way_.place(t));
        Open out;
        for (int c = 0; c < 3; ++c) {
            out.of[c] =
                c < way_.colours ? arriving.share * RaysText().transmittance_of(arriving.optical_depth[c]) : out.of[0];
        }
        return out;
    }

    // Of all samples, past solids and sheets, too.
    [[nodiscard]] Open open_to_all(Real t) const {
        Open sum{{0.0F, 0.0F, 0.0F}};
        ArrivingAt at = at_;
        for (std::size_t j = first_; j < light_.samples.size(); j += every_) {
            at.only = static_cast<int>(j);
            const Open one = open(at, t);
            for (int c = 0; c < 3; ++c) {
                sum.of[c] = sum.of[c] + one.of[c] * static_cast<float>(every_);
            }
        }
        return sum;
    }

    // What a sample sends to places past all but solids: of each as many numbers as colours are looked up. Where many
    // samples are dimmed each is looked up at every other place, by turns, and goes straight between.
    [[nodiscard]] int colours() const { return dimmed_ ? way_.colours : 1; }
    void past_solids(std::size_t sample, std::span<const Real> places, bool dims, std::vector<Real> &ends) const {
        const auto numbers = static_cast<std::size_t>(colours());
        const auto others = static_cast<float>(every_); // for which it stands, too
        if (!dims) {
            for (const Real &t : places) {
                ends.insert(ends.end(), numbers, others * sample_share(light_, sample, way_.place(t)));
            }
            return;
        }
        ArrivingAt at = at_;
        at.own = -1;
        at.only = static_cast<int>(sample);
        const std::size_t first = ends.size(), last = places.size() - 1;
        ends.resize(first + places.size() * numbers);
        const auto end = [&](std::size_t i) { return ends.begin() + static_cast<std::ptrdiff_t>(first + i * numbers); };
        const bool turns = way_.of_world() && light_.samples.size() >= 16;
        const auto looked_up = [&](std::size_t i) {
            return !turns || i == 0 || i == last || (i + sample / every_) % 2 == 0;
        };
        for (std::size_t i = 0; i <= last; ++i) {
            if (looked_up(i)) {
                const Open arrives = open(at, places[i]);
                std::transform(arrives.of, arrives.of + numbers, end(i), [&](Real x) { return others * x; });
            }
        }
        for (std::size_t i = 0; i <= last; ++i) {
            if (!looked_up(i)) {
                std::transform(end(i - 1), end(i), end(i + 1), end(i), [](Real a, Real b) { return 0.5F * (a + b); });
            }
        }
    }

    // Calls found(which, from, to, share) for the stretches that solids leave of one sample's light.
    template <typename Found>
    void for_lit(std::size_t sample, Real from, Real to, Mask asked, const Found &found) const {
        if (const LightMapView *const map = solids(sample)) {
            for_lit_sections(*map, way_.ray.origin, way_.ray.direction, from, to, asked, found);
        } else {
            found(asked, from, to, Real(1.0F));
        }
    }

    // Calls add(x0, x1, open, open) for sections of [0, 1], of the lanes that are asked for; one at whose ends what
    // gets through is not the same is cut again.
    template <typename Place, typename Add>
    void in_sections(Mask asked, int count, const Place &place, const Add &add) const {
        constexpr int PARTS = 8;
        constexpr float DIFFERENT = 0.03F;
        if (count == 0) {
            return;
        }
        const float step = 1.0F / static_cast<float>(count), part = step / PARTS;
        Open before = open_to_all(place(0.0F));
        for (int i = 0; i < count; ++i) {
            const float x = step * static_cast<float>(i);
            const Open after = open_to_all(place(x + step));
            const Real change = max(abs(after.of[0] - before.of[0]), abs(after.of[2] - before.of[2]));
            if (!xsimd::any(asked & (change > DIFFERENT))) {
                add(x, x + step, before, after);
                before = after;
                continue;
            }
            for (int k = 0; k < PARTS; ++k) {
                const float from = x + part * static_cast<float>(k);
                const Open next = k + 1 < PARTS ? open_to_all(place(from + part)) : after;
                add(from, from + part, before, next);
                before = next;
            }
        }
    }

    static bool any(const Open &a, const Open &b) {
        return xsimd::any(a.of[0] + a.of[1] + a.of[2] + b.of[0] + b.of[1] + b.of[2] > 0.0F);
    }

    // What the air scatters of an irradiance of 1, in a colour, by the squares of half the angle's sine and cosine.
    struct Phases {
        Real molecules, dust;
    };
    [[nodiscard]] Phases phases(Real half_sine2, Real half_cosine2) const {
        const AirView &air = way_.air;
        // Of what comes from all sides alike it sends as much everywhere; the samples of a part have their directions.
        const bool even = light_.surrounds() && light_.octant < 0;
        const Real g = even ? 0.0F : air.anisotropy;
        return {even ? Real(0.0795774715F) : AirText().rayleigh(half_cosine2 - half_sine2),
                air.cornette_shanks ? AirText().cornette_shanks(half_sine2, half_cosine2, g)
                                    : AirText().henyey_greenstein(half_sine2, half_cosine2, g)};
    }
    [[nodiscard]] Real scattered(const Phases &by, int colour) const {
        return (by.molecules * way_.air.rayleigh[colour] + by.dust * way_.air.mie[colour]) * light_.strength[colour];
    }

    const Way &way_;
    const LightView &light_;
    std::size_t bodies_;
    ArrivingAt at_;
    bool dimmed_ = false;               // by smoke or fog somewhere
    std::size_t first_ = 0, every_ = 1; // of its samples
};

} // namespace
} // namespace sfumato::SFUMATO_ISA
