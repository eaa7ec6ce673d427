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
    [[nodiscard]] Real column(Real t) const { return column_on(air, ray.origin, ray.direction, t); }
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
    template <typename Column>
    [[nodiscard]] Depth in_world(const Column &column) const {
        Depth depth{{0.0F, 0.0F, 0.0F}};
        if (frame.world_air != nullptr) {
            const Real metres = column(*frame.world_air);
            for (int c = 0; c < colours; ++c) {
                depth.of[c] = min(metres * frame.world_air->extinction[c], 1e4F);
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
        return {(GAUSS[1] * m[0] - m[1]) * APART, (m[1] - GAUSS[0] * m[0]) * APART};
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
        for (std::size_t m = 0; m < light_.samples.size() * bodies_; ++m) {
            dimmed_ = dimmed_ || !(light_.maps[m].empty() || light_.maps[m].clear());
        }
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
    // Sheets dim the light, too, and no tree knows them.
    [[nodiscard]] bool sheets() const {
        const LightMapView *const map = solids(0);
        return map != nullptr && map->sheets.first != nullptr;
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
                ends.insert(ends.end(), numbers, others * sample_share(light_, light_.samples[sample], way_.place(t)));
            }
            return;
        }
        ArrivingAt at = at_;
        at.own = -1;
        at.only = static_cast<int>(sample);
        const std::size_t first = ends.size(), last = places.size() - 1;
        ends.resize(first + places.size() * numbers);
        const auto end = [&](std::size_t i) { return ends.begin() + static_cast<std::ptrdiff_t>(first + i * numbers); };
        const bool turns = light_.samples.size() >= 16;
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
        const Real g = air.anisotropy;
        return {AirText().rayleigh(half_cosine2 - half_sine2),
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

// Of parallel light.
class SunShine : Shine {
public:
    SunShine(const Way &way, const LightView &light) : Shine(way, light) {
        const vec3 both = way.ray.direction - broadcast(light.direction),
                   apart = way.ray.direction + broadcast(light.direction);
        by_ = phases(0.25F * dot(apart, apart), 0.25F * dot(both, both));
    }

    void add() const {
        if (sheets()) {
            add_by_look_ups();
            return;
        }
        std::vector<Piece> pieces = this->pieces();
        if (pieces.empty()) {
            return;
        }
        Through through(pieces.back().cut.first + pieces.back().cut.count, colours());
        std::vector<Real> ends, places;
        for (const Piece &piece : pieces) {
            for (int i = 0; piece.cut.count > 0 && i <= piece.cut.count; ++i) {
                places.push_back(piece.place(static_cast<float>(i) / static_cast<float>(piece.cut.count)));
            }
        }
        const Real first = pieces.front().from, last = pieces.back().to;
        for (std::size_t j = first_; j < light_.samples.size(); j += every_) {
            const Real weight = static_cast<float>(every_) * sample_share(light_, light_.samples[j], way_.ray.origin);
            ends.clear();
            std::span<const Real> left = places;
            for (const Piece &piece : pieces) {
                if (piece.cut.count > 0) {
                    const auto own = static_cast<std::size_t>(piece.cut.count + 1);
                    past_solids(j, left.first(own), true, ends);
                    left = left.subspan(own);
                }
            }
            for_lit(j, first, last, first < last, [&](Mask which, Real begin, Real end, Real share) {
                const Real *own = ends.data();
                for (Piece &piece : pieces) {
                    const Real from = max(begin, piece.from), to = min(end, piece.to);
                    const Mask met = which & (from < to);
                    if (piece.cut.count > 0) {
                        if (xsimd::any(met)) {
                            const Real per = 1.0F / max(piece.to - piece.from, 1e-30F);
                            through.add(piece.cut, met, (from - piece.from) * per, (to - piece.from) * per, share, own);
                        }
                        own += (piece.cut.count + 1) * colours();
                        continue;
                    }
                    const Mask whole = met & (from <= piece.from) & (to >= piece.to), part = met & !whole;
                    piece.lit = piece.lit + pick(whole, share * weight, 0.0F);
                    if (xsimd::any(part)) {
                        const Real sent = pick(part, share * weight, 0.0F);
                        add_section(piece.step, pick(part, from, 0.0F), pick(part, to, 0.0F),
                                    [&](int) { return sent; });
                    }
                }
            });
        }
        for (const Piece &piece : pieces) {
            if (xsimd::any(piece.lit > 0.0F)) {
                add_section(piece.step, piece.from, piece.to, [&](int) { return piece.lit; });
            }
            const float step = 1.0F / static_cast<float>(std::max(piece.cut.count, 1));
            for (int i = 0; i < piece.cut.count; ++i) {
                if (through.any(piece.cut.first + i)) {
                    const float x = step * static_cast<float>(i);
                    add_section(piece.step, piece.place(x), piece.place(x + step),
                                [&](int c) { return through.mean(piece.cut.first + i, c); });
                }
            }
        }
    }

private:
    // A part of a step. Where nothing dims the light it has no sections: what is lit of it is integrated as it is.
    struct Piece {
        std::size_t step;
        Real from, to;
        Cut cut;
        Real lit = 0.0F; // of all of it

        [[nodiscard]] Real place(float x) const { return from + (to - from) * x; }
    };

    // Where the rays are behind what dims the light, in any of its samples; nowhere if that ends before it begins.
    [[nodiscard]] Between dimmed() const {
        Between part{1e30F, -1e30F};
        for_dimming([&](const LightMapView &map, float) {
            const vec3 p = transform_point(map.world_to_light, way_.ray.origin);
            const vec3 d = transform_vector(map.world_to_light, way_.ray.direction);
            Real from = -1e30F, to = 1e30F;
            clip(p.x, d.x, 1.0F, from, to);
            clip(p.y, d.y, 1.0F, from, to);
            clip(p.z, d.z, 1e30F, from, to);
            part.low = min(part.low, pick(from < to, from, 1e30F));
            part.high = max(part.high, pick(from < to, to, -1e30F));
        });
        return part;
    }

    [[nodiscard]] std::vector<Piece> pieces() const {
        std::vector<Piece> out;
        const Between dim = dimmed();
        int sections = 0;
        for (std::size_t number = 0; number < way_.steps.size(); ++number) {
            const Step &step = way_.steps[number];
            const Real first = clamp(dim.low, step.from, step.to), last = clamp(dim.high, first, step.to);
            const auto put = [&](Real from, Real to, bool dims) {
                if (xsimd::any(from < to)) {
                    const int count = dims ? this->sections(from, to) : 0;
                    out.push_back({number, from, to, {sections, count}});
                    sections += count;
                }
            };
            put(step.from, first, false);
            put(first, last, true);
            put(last, step.to, false);
        }
        return out;
    }

    [[nodiscard]] int sections(Real from, Real to) const {
        int count = 1;
        for_dimming(
            [&](const LightMapView &map, float texels) { count = std::max(count, sections(map, from, to, texels)); });
        return count;
    }
    [[nodiscard]] int sections(const LightMapView &map, Real from, Real to, float texels) const {
        const Real length = max(to - from, 0.0F);
        const vec3 along = transform_vector(map.world_to_light, way_.ray.direction);
        const vec3 middle = transform_point(map.world_to_light, way_.place(0.5F * (from + to)));
        // Beside the map there is nothing, and behind it what changes across it changes no more along it.
        const Mask beside = (min(middle.x, middle.y) <= 0.0F) | (max(middle.x, middle.y) >= 1.0F);
        const Real across =
            max(abs(along.x) * static_cast<float>(map.width), abs(along.y) * static_cast<float>(map.height));
        const Real deep = abs(along.z) * static_cast<float>(std::max(map.width, map.height));
        const Real crossed = length * pick(middle.z >= 1.0F, across, max(across, deep));
        const Real count = pick(beside, 1.0F, max(crossed * (1.0F / texels), 1.0F));
        return static_cast<int>(std::ceil(std::min(highest(pick(length > 0.0F, count, 0.0F)), MOST)));
    }

    void add_by_look_ups() const {
        for (std::size_t number = 0; number < way_.steps.size(); ++number) {
            const Step &step = way_.steps[number];
            const Mask asked = step.from < step.to;
            const Real to = pick(asked, step.to, step.from);
            const auto place = [&](float x) { return step.from + (to - step.from) * x; };
            in_sections(asked, std::max(sections(*solids(0), step.from, to, 2.0F), sections(step.from, to)), place,
                        [&](float x0, float x1, const Open &before, const Open &after) {
                            if (any(before, after)) {
                                add_section(number, place(x0), place(x1),
                                            [&](int c) { return 0.5F * (before.of[c] + after.of[c]); });
                            }
                        });
        }
    }

    // Of which so much of each colour gets through.
    template <typename ShareOf>
    void add_section(std::size_t number, Real from, Real to, const ShareOf &share) const {
        const Taken &fogs = way_.steps[number].fogs;
        const Real column = way_.column(to) - way_.column(from);
        const Way::Depth front = way_.to_eye(fogs, from), back = way_.to_eye(fogs, to);
        const Way::Depth front_light = to_light(from), back_light = to_light(to);
        Colours &sum = way_.scatter[number];
        Real sent = 0.0F;
        for (int c = 0; c < 3; ++c) {
            if (c < way_.colours) {
                sent = AirText().lit_by_sun(column, front.of[c] + front_light.of[c], back.of[c] + back_light.of[c]);
            }
            sum.of[c] = sum.of[c] + sent * share(c) * scattered(by_, c);
        }
    }

    [[nodiscard]] Way::Depth to_light(Real t) const { return way_.to_light(light_, -light_.direction, t); }

    Phases by_{};
};

// Of light from a place.
class LampShine : Shine {
public:
    LampShine(const Way &way, const LightView &light) : Shine(way, light) {
        const vec3 towards = broadcast(light.position) - way.ray.origin;
        foot_ = dot(towards, way.ray.direction);
        const vec3 across = towards - way.ray.direction * foot_;
        away2_ = dot(across, across);
        distance_ = sqrt(away2_ + light.size2);
    }

    void add() const {
        const std::vector<Stretch> stretches = this->stretches();
        if (stretches.empty()) {
            return;
        }
        const std::vector<Piece> pieces = this->pieces(stretches);
        if (sheets()) {
            add_by_look_ups(pieces);
            return;
        }
        Through through(pieces.back().cut.first + pieces.back().cut.count, colours());
        std::vector<Real> ends, places;
        for (const Piece &piece : pieces) {
            for (int i = 0; i <= piece.cut.count; ++i) {
                places.push_back(foot_ + piece.place(piece.x_of(i)));
            }
        }
        Real first = 1e30F, last = -1e30F;
        for (const Stretch &stretch : stretches) {
            first = min(first, pick(stretch.asked, stretch.begin, 1e30F));
            last = max(last, pick(stretch.asked, stretch.end, -1e30F));
        }
        const Mask asked = first < last;
        first = foot_ + pick(asked, first, 0.0F);
        last = foot_ + pick(asked, last, 0.0F);
        for (std::size_t j = first_; j < light_.samples.size(); j += every_) {
            ends.clear();
            std::span<const Real> left = places;
            for (const Piece &piece : pieces) {
                const auto own = static_cast<std::size_t>(piece.cut.count + 1);
                past_solids(j, left.first(own), piece.dims, ends);
                left = left.subspan(own);
            }
            for_lit(j, first, last, asked, [&](Mask which, Real begin, Real end, Real share) {
                const Real *own = ends.data();
                const Real from = begin - foot_, to = end - foot_;
                for (std::size_t at = 0; at < pieces.size();) {
                    const Stretch &stretch = *pieces[at].stretch;
                    const Mask met = which & stretch.asked & (from < stretch.end) & (to > stretch.begin);
                    const bool any = xsimd::any(met);
                    const Real x0 = any ? stretch.share(met, from) : 0.0F, x1 = any ? stretch.share(met, to) : 0.0F;
                    for (; at < pieces.size() && pieces[at].stretch == &stretch; ++at) {
                        const Piece &piece = pieces[at];
                        if (any) {
                            through.add(piece.cut, met, piece.within(x0), piece.within(x1), share, own);
                        }
                        own += (piece.cut.count + 1) * colours();
                    }
                }
            });
        }
        for (const Piece &piece : pieces) {
            for (int i = 0; i < piece.cut.count; ++i) {
                const int section = piece.cut.first + i;
                if (through.any(section)) {
                    add_section(piece, piece.x_of(i), piece.x_of(i + 1),
                                [&](int c) { return through.factors(section, c); });
                }
            }
        }
    }

private:
    // What of a step is lit at all, by distances from the foot.
    struct Stretch {
        std::size_t step;
        Mask asked;
        Real begin, end;
        AirText::LitStretch lit;

        // The ends of a stretch are known better than points near them.
        [[nodiscard]] Real place(float x) const {
            return x <= 0.0F ? begin : x >= 1.0F ? end : clamp(AirText().lit_point(lit, x).place, begin, end);
        }
        // The x of a place, of those that are asked for.
        [[nodiscard]] Real share(Mask which, Real place) const {
            const Mask before = place <= begin, behind = place >= end;
            const Real ends = pick(before, 0.0F, 1.0F);
            return xsimd::all(before | behind | !which) ? ends
                                                        : pick(before | behind, ends, AirText().lit_share(lit, place));
        }
    };
    // A part of that, from x0 to x1, in which smoke or fog may dim the light.
    struct Piece {
        const Stretch *stretch;
        float x0, x1;
        bool dims;
        Cut cut;

        [[nodiscard]] Real place(float x) const { return stretch->place(x); }
        // Of its sections' ends.
        [[nodiscard]] float x_of(int end) const {
            return end == cut.count ? x1 : x0 + (x1 - x0) * (static_cast<float>(end) / static_cast<float>(cut.count));
        }
        [[nodiscard]] Real within(Real x) const { return clamp((x - x0) * (1.0F / (x1 - x0)), 0.0F, 1.0F); }
    };

    [[nodiscard]] std::vector<Stretch> stretches() const {
        const Real squeeze = AirText().squeeze_of(Real(way_.air.anisotropy));
        // Where air ends with height, none is so thin that its end is known.
        const glm::vec3 &e = way_.air.extinction;
        const float least = way_.of_world() && way_.air.even() ? std::min({e.x, e.y, e.z}) : 0.0F;
        Real low = way_.steps.front().from - foot_;
        Real high = AirText().lit_until(distance_, low, least, squeeze);
        cut_at_cone(low, high);
        std::vector<Stretch> out;
        for (std::size_t number = 0; number < way_.steps.size(); ++number) {
            const Step &step = way_.steps[number];
            const Real begin = max(step.from - foot_, low), end = min(step.to - foot_, high);
            const Mask asked = begin < end;
            if (xsimd::any(asked)) {
                const Real behind = max(end, begin);
                out.push_back({number, asked, begin, behind, AirText().lit_stretch(distance_, begin, behind, squeeze)});
            }
        }
        return out;
    }

    // Parts of stretches that are long enough for themselves, and of these more where the light fades fast, or is
    // dimmed.
    [[nodiscard]] std::vector<Piece> pieces(const std::vector<Stretch> &stretches) const {
        Real angle = 1e-30F;
        for (const Stretch &stretch : stretches) {
            angle = angle + pick(stretch.asked, stretch.lit.angle, 0.0F);
        }
        std::vector<Piece> out;
        int sections = 0;
        for (const Stretch &stretch : stretches) {
            const float share = highest(pick(stretch.asked, stretch.lit.angle / angle, 0.0F));
            const int parts = std::max(static_cast<int>(std::ceil(FEWEST * share)), 1);
            const bool near = meets_light(stretch);
            std::vector<vec3> points; // at the ends of parts, and between
            for (int i = 0; i <= 2 * parts; ++i) {
                points.push_back(
                    way_.place(foot_ + stretch.place(static_cast<float>(i) / static_cast<float>(2 * parts))));
            }
            for (int i = 0; i < parts; ++i) {
                const float x0 = static_cast<float>(i) / static_cast<float>(parts);
                const float x1 = static_cast<float>(i + 1) / static_cast<float>(parts);
                const vec3 *const own = points.data() + 2 * i;
                int count = near || fades(stretch, own) ? 8 : 1;
                bool dims = false;
                for_dimming([&](const LightMapView &map, float texels) {
                    if (meets(stretch, own, map)) {
                        dims = true;
                        count = std::max(count, this->sections(stretch, x1 - x0, map, texels));
                    }
                });
                out.push_back({&stretch, x0, x1, dims, {sections, count}});
                sections += count;
            }
        }
        return out;
    }
    // Whether the light's own size bends the way it falls off.
    [[nodiscard]] bool meets_light(const Stretch &stretch) const {
        constexpr float NEAR = 4.0F;
        return xsimd::any(stretch.asked & (stretch.begin < 0.0F) & (stretch.end > 0.0F) &
                          (away2_ < NEAR * light_.size2));
    }
    // Whether between three points all that the light sends is not on a straight line.
    [[nodiscard]] bool fades(const Stretch &stretch, const vec3 *points) const {
        constexpr float DIFFERENT = 0.004F;
        if (light_.kind == LightKind::SPHERE && light_.cone_cosine <= -1.0F) {
            return false;
        }
        Real sent[3] = {0.0F, 0.0F, 0.0F};
        const std::size_t count = light_.samples.size(), step = count < 16 ? 1 : 5; // a part of them tells it, too
        for (std::size_t j = 0; j < count; j += step) {
            for (int i = 0; i < 3; ++i) {
                sent[i] = sent[i] + sample_share(light_, light_.samples[j], points[i]);
            }
        }
        const Real bend = abs(sent[1] - 0.5F * (sent[0] + sent[2]));
        return xsimd::any(stretch.asked & (bend * static_cast<float>(step) > DIFFERENT));
    }
    // Whether between three points a map may be met. From octant to octant about the light a ray bends on it, so that
    // it lies half as far beside them as they lie apart.
    [[nodiscard]] static bool meets(const Stretch &stretch, const vec3 *points, const LightMapView &map) {
        const vec3 a = place_on(map, points[0]), b = place_on(map, points[1]), c = place_on(map, points[2]);
        const auto on = [](Real p, Real q, Real r) {
            const Real low = min(min(p, q), r), high = max(max(p, q), r), beside = 0.5F * (high - low);
            return (low - beside < 1.0F) & (high + beside > 0.0F);
        };
        return xsimd::any(stretch.asked & on(a.x, b.x, c.x) & on(a.y, b.y, c.y));
    }
    // Of a spot, what lies in its cone, by distances from the foot.
    void cut_at_cone(Real &begin, Real &end) const {
        if (light_.cone_cosine < 0.0F || light_.oval) {
            return;
        }
        const vec3 axis = broadcast(light_.direction);
        const Real foot = dot(way_.place(foot_) - broadcast(light_.position), axis);
        const auto part =
            AirText().part_in_cone(sqrt(away2_), foot, dot(way_.ray.direction, axis), Real(light_.cone_cosine));
        begin = max(begin, part.from);
        end = min(end, part.to);
    }

    static constexpr float FEWEST = 12.0F; // sections of all pieces

    // Of a share of a stretch so many that a section crosses no more than some texels of a map, about.
    [[nodiscard]] int sections(const Stretch &stretch, float share, const LightMapView &map, float texels) const {
        // From the middle of the octahedron's square to its edge it is a quarter of a turn, of which the angle is half.
        // In the middle of a stretch x goes half as fast again.
        const float per_radian = static_cast<float>(map.width) * map.scale[0] * 0.6366F;
        const Real count = stretch.lit.angle * (1.5F * share * 2.0F * per_radian / texels);
        return std::max(static_cast<int>(std::ceil(std::min(highest(pick(stretch.asked, count, 0.0F)), MOST))), 1);
    }

    void add_by_look_ups(const std::vector<Piece> &pieces) const {
        for (const Piece &piece : pieces) {
            const Stretch &stretch = *piece.stretch;
            const float width = piece.x1 - piece.x0;
            in_sections(
                stretch.asked, std::max(piece.cut.count, sections(stretch, width, *solids(0), 2.0F)),
                [&](float x) { return foot_ + stretch.place(piece.x0 + width * x); },
                [&](float x0, float x1, const Open &before, const Open &after) {
                    if (any(before, after)) {
                        add_section(piece, piece.x0 + width * x0, piece.x0 + width * x1,
                                    [&](int c) -> Through::Factors {
                                        const Real change = after.of[c] - before.of[c];
                                        return {before.of[c] + change * Through::GAUSS[0],
                                                before.of[c] + change * Through::GAUSS[1]};
                                    });
                    }
                });
        }
    }

    // `factors` of a colour are what gets through, at the two points of Gauss.
    template <typename FactorsOf>
    void add_section(const Piece &piece, float x0, float x1, const FactorsOf &factors) const {
        const Stretch &stretch = *piece.stretch;
        const float width = x1 - x0;
        Colours &sum = way_.scatter[stretch.step];
        for (int node = 0; node < 2; ++node) {
            const auto point = AirText().lit_point(stretch.lit, x0 + width * Through::GAUSS[node]);
            const Real t = foot_ + point.place;
            const vec3 place = way_.place(t);
            const Real distance2 = away2_ + point.place * point.place, distance = sqrt(distance2);
            // The light's own size, which the stretch takes for distance.
            const Real rate =
                point.weight * point.radius * point.radius * LightsText().falloff(distance2, light_.size2);
            // tan(psi / 2) away = r + s, without its cancellation.
            const Real turned =
                pick(point.place > 0.0F, distance + point.place, away2_ / max(distance - point.place, 1e-30F));
            const Real sine2 = turned * turned, whole = 1.0F / max(sine2 + away2_, 1e-30F);
            Phases by = phases(sine2 * whole, away2_ * whole);
            constexpr float FAR = 6.0F; // of the light's size: from there all of it lies in one direction
            if (light_.area > 0.0F && xsimd::any(stretch.asked & (distance2 < FAR * FAR * light_.size2))) {
                by = phases_of_samples(place);
            }
            const Way::Depth to_eye = way_.to_eye(way_.steps[stretch.step].fogs, t),
                             to_light = way_.to_light(light_, light_.position, t);
            const Real amount = pick(stretch.asked, rate * (0.5F * width) * density(place), 0.0F);
            Real left = 0.0F;
            for (int c = 0; c < 3; ++c) {
                if (c < way_.colours) {
                    left = amount * exp(-min(to_eye.of[c] + to_light.of[c], 80.0F));
                }
                const Through::Factors open = factors(c);
                sum.of[c] = sum.of[c] + left * (node == 0 ? open.front : open.back) * scattered(by, c);
            }
        }
    }

    // On the mean over the light's samples, by what each brings.
    [[nodiscard]] Phases phases_of_samples(const vec3 &place) const {
        Phases sum{0.0F, 0.0F};
        Real all = 1e-20F;
        for (std::size_t j = first_; j < light_.samples.size(); j += every_) {
            const glm::vec3 &sample = light_.samples[j];
            const Real share = sample_share(light_, sample, place);
            const vec3 way = place - broadcast(sample);
            const Real cosine = -dot(way, way_.ray.direction) * inversesqrt(max(dot(way, way), 1e-30F));
            const Phases by = phases(0.5F - 0.5F * cosine, 0.5F + 0.5F * cosine);
            sum.molecules = sum.molecules + share * by.molecules;
            sum.dust = sum.dust + share * by.dust;
            all = all + share;
        }
        return {sum.molecules / all, sum.dust / all};
    }

    [[nodiscard]] Real density(const vec3 &place) const {
        return way_.air.even() ? Real(1.0F) : exp(-max(height_of(way_.air, place), -40.0F));
    }

    Real foot_, away2_,
        distance_; // the light's foot on the ray; how far it is from there, its square and with its size
};

} // namespace
} // namespace sfumato::SFUMATO_ISA
