// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the air: what it scatters of all lights, emits and takes between the eye and the first opaque surface of
// each ray. Of a light, in one colour, on the ray x(t),
//     L = int sigma_s rho p E V exp(-D) dt
// where the irradiance E, the phase function p and the optical depth D of the air, before the eye and before the light,
// are smooth, and what is left of the light by all else, V, is not. So a ray is cut into sections that are short where
// V is looked up; over a section V goes straight from end to end, and the rest is integrated by air.glsl. A section at
// whose ends V differs is cut again.
#include "media/air_lanes.hpp"

#include "frame/layers.hpp"
#include "lights/lights_lanes.hpp"
#include "maps/arriving_lanes.hpp"
#include "maps/sections_lanes.hpp"
#include "media/fog_lanes.hpp"
#include "text/camera_text.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using CameraText = text::CameraText<Real, Isa>;
using Ray = CameraText::Ray;

// Where rays go through fogs: from wall to wall.
class Walls {
public:
    Walls(const FrameView &frame, const Ray &ray, Real end, Mask asked) : amounts_(frame.fogs.size() * LANES, 0.0F) {
        std::vector<Hit> hits;
        std::vector<FogStretch> found;
        for (std::size_t fog = 0; fog < frame.fogs.size(); ++fog) {
            fog_stretches(frame.fogs[fog], ray.origin, ray.direction, end, asked, hits, found);
            for (const FogStretch &stretch : found) {
                std::vector<Wall> &walls = walls_[static_cast<std::size_t>(stretch.lane)];
                walls.push_back({stretch.near, fog, 1.0F});
                walls.push_back({stretch.far, fog, -1.0F});
            }
        }
        for (std::vector<Wall> &walls : walls_) {
            std::sort(walls.begin(), walls.end(), [](const Wall &a, const Wall &b) { return a.distance < b.distance; });
        }
    }

    // Where each ray meets the next one; endless where there is none.
    [[nodiscard]] Real next() const {
        alignas(64) float distance[LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            distance[lane] = next_[lane] < walls_[lane].size() ? walls_[lane][next_[lane]].distance : 1e30F;
        }
        return Real::load_aligned(distance);
    }
    // Through that, where it is no further than `upto`.
    void pass(Real upto) {
        alignas(64) float reached[LANES];
        upto.store_aligned(reached);
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            for (; next_[lane] < walls_[lane].size() && walls_[lane][next_[lane]].distance <= reached[lane];
                 ++next_[lane]) {
                const Wall &wall = walls_[lane][next_[lane]];
                amounts_[wall.fog * LANES + lane] += wall.change;
            }
        }
    }
    // In how many places of a fog each ray is.
    [[nodiscard]] Real amount(std::size_t fog) const { return Real::load_unaligned(amounts_.data() + fog * LANES); }

private:
    struct Wall {
        float distance;
        std::size_t fog;
        float change;
    };
    std::array<std::vector<Wall>, LANES> walls_;
    std::array<std::size_t, LANES> next_{};
    std::vector<float> amounts_;
};

// What all air takes on the way to the eye. From `start` on fogs take so much a metre, up to the next wall.
struct Taken {
    Real start = 0.0F;
    Real before[3] = {0.0F, 0.0F, 0.0F}, by_metre[3] = {0.0F, 0.0F, 0.0F};

    void move(const FrameView &frame, const Walls &walls, Real to) {
        const std::size_t first = frame.air.size() - frame.fogs.size();
        for (int c = 0; c < 3; ++c) {
            before[c] = before[c] + by_metre[c] * (to - start);
            by_metre[c] = 0.0F;
            for (std::size_t fog = 0; fog < frame.fogs.size(); ++fog) {
                by_metre[c] = by_metre[c] + walls.amount(fog) * frame.air[first + fog].extinction[c];
            }
        }
        start = to;
    }
};

// Rays through air, of which one scatters here, the world's takes light everywhere, and fogs take some, too.
struct Way {
    const FrameView &frame;
    const Taken &fogs;
    const AirView &air; // that scatters
    int body;           // its own, on whose maps solids are looked up; or none
    Ray ray;
    int colours; // that the optical depths have

    [[nodiscard]] bool of_world() const { return &air == frame.world_air; }
    [[nodiscard]] vec3 place(Real t) const { return ray.origin + ray.direction * t; }
    // Of the air that scatters, metres as dense as at its ground.
    [[nodiscard]] Real column(Real t) const { return column_on(air, ray.origin, ray.direction, t); }
    // Towards the eye, in the first of the colours and in all.
    struct Depth {
        Real of[3];
    };
    [[nodiscard]] Depth to_eye(Real t) const {
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

// What one light sends along rays: what is the same for all kinds of them.
class Shine {
public:
    Shine(const Way &way, const LightView &light)
        : way_(way), light_(light), at_{&light, way.frame.extinctions, way.body, way.colours == 1} {}

protected:
    static constexpr float MOST = 1024.0F; // sections

    // The light's first map of what throws shadows in the air; null where it does not meet that.
    [[nodiscard]] const LightMapView *map() const {
        const LightMapView *const map = way_.body < 0 ? nullptr : light_.maps + way_.body;
        return map == nullptr || map->empty() ? nullptr : map;
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

    // Calls add(x0, x1, open, open) for sections of [0, 1], of the lanes that are asked for.
    template <typename Place, typename Add>
    void in_sections(const ArrivingAt &at, Mask asked, int count, const Place &place, const Add &add) const {
        constexpr int PARTS = 8;
        constexpr float DIFFERENT = 0.03F;
        if (count == 0) {
            return;
        }
        const float step = 1.0F / static_cast<float>(count), part = step / PARTS;
        Open before = open(at, place(0.0F));
        for (int i = 0; i < count; ++i) {
            const float x = step * static_cast<float>(i);
            const Open after = open(at, place(x + step));
            const Real change = max(abs(after.of[0] - before.of[0]), abs(after.of[2] - before.of[2]));
            if (!xsimd::any(asked & (change > DIFFERENT))) {
                add(x, x + step, before, after);
                before = after;
                continue;
            }
            for (int k = 0; k < PARTS; ++k) {
                const float from = x + part * static_cast<float>(k);
                const Open next = k + 1 < PARTS ? open(at, place(from + part)) : after;
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
    ArrivingAt at_;
};

// Of parallel light.
class SunShine : Shine {
public:
    SunShine(const Way &way, const LightView &light) : Shine(way, light) {
        const vec3 both = way.ray.direction - broadcast(light.direction),
                   apart = way.ray.direction + broadcast(light.direction);
        by_ = phases(0.25F * dot(apart, apart), 0.25F * dot(both, both));
    }

    void add(Real from, Real to, Real (&sum)[3]) const {
        const std::size_t bodies = way_.frame.extinctions.size();
        const bool followed = map() != nullptr && map()->sheets.first == nullptr;
        // Of several bodies no one's map says where the light changes.
        std::size_t shading = bodies;
        bool several = false;
        for (std::size_t m = 0; m < light_.samples.size() * bodies; ++m) {
            if (!(light_.maps[m].empty() || light_.maps[m].clear())) {
                several = several || (shading != bodies && shading != m % bodies);
                shading = m % bodies;
            }
        }
        if (!followed || several) {
            add_by_parts(map(), from, to, at_, sum);
            return;
        }
        // Of each point of the light solids leave stretches, and smoke some of the light in these.
        ArrivingAt past_solids = at_;
        past_solids.own = -1;
        for (std::size_t j = 0; j < light_.samples.size(); ++j) {
            const LightMapView *const smoke = shading == bodies || light_.maps[j * bodies + shading].empty()
                                                  ? nullptr
                                                  : light_.maps + j * bodies + shading;
            past_solids.only = static_cast<int>(j);
            const LightMapView &solids = light_.maps[j * bodies + static_cast<std::size_t>(way_.body)];
            const Real weight = sample_share(light_, light_.samples[j], way_.ray.origin);
            for_lit_sections(solids, way_.ray.origin, way_.ray.direction, from, to, to > from,
                             [&](Mask which, Real begin, Real end, Real share) {
                                 Real sent[3] = {0.0F, 0.0F, 0.0F};
                                 begin = pick(which, begin, 0.0F);
                                 end = pick(which, end, 0.0F);
                                 if (smoke == nullptr) {
                                     const Open all{{1.0F, 1.0F, 1.0F}};
                                     add_section(begin, end, all, all, sent);
                                     share = share * weight;
                                 } else {
                                     add_by_parts(smoke, begin, end, past_solids, sent);
                                 }
                                 for (int c = 0; c < 3; ++c) {
                                     sum[c] = sum[c] + pick(which, sent[c] * share, 0.0F);
                                 }
                             });
        }
    }

private:
    // Before a map's box, in it, and beside it or behind it are different.
    void add_by_parts(const LightMapView *map, Real from, Real to, const ArrivingAt &at, Real (&sum)[3]) const {
        if (map == nullptr) {
            add_part(map, from, to, at, sum);
            return;
        }
        const vec3 along = transform_vector(map->world_to_light, way_.ray.direction);
        const vec3 origin = transform_point(map->world_to_light, way_.ray.origin);
        Real first = from, last = to;
        clip(origin.x, along.x, 1.0F, first, last);
        clip(origin.y, along.y, 1.0F, first, last);
        const Mask beneath = first < last;
        first = pick(beneath, first, from);
        last = pick(beneath, last, from);
        Real enters = first, leaves = last;
        clip(origin.z, along.z, 1.0F, enters, leaves);
        const Mask within = enters < leaves;
        enters = pick(within, enters, first);
        leaves = pick(within, leaves, first);
        const Real ends[6] = {from, first, enters, leaves, last, to};
        for (int i = 0; i < 5; ++i) {
            add_part(map, ends[i], ends[i + 1], at, sum);
        }
    }

    // So many that a section crosses no more than two texels of the map; or, where solids are no concern of it, sixteen
    // of a fog's own, whose columns change slowly but at its walls.
    [[nodiscard]] int sections(const LightMapView *map, const ArrivingAt &at, Real from, Real to) const {
        constexpr float FEWEST = 1.0F, TEXELS = 2.0F, OF_FOG = 16.0F;
        const float texels_each = !way_.of_world() && at.own < 0 && map == this->map() ? OF_FOG : TEXELS;
        const Real length = max(to - from, 0.0F);
        Real count = FEWEST;
        if (map != nullptr) {
            const vec3 along = transform_vector(map->world_to_light, way_.ray.direction);
            const vec3 middle = transform_point(map->world_to_light, way_.place(0.5F * (from + to)));
            // Beside the map there is nothing, and behind it what changes across it changes no more along it.
            const Mask beside = (min(middle.x, middle.y) <= 0.0F) | (max(middle.x, middle.y) >= 1.0F);
            const Real across =
                max(abs(along.x) * static_cast<float>(map->width), abs(along.y) * static_cast<float>(map->height));
            const Real deep = abs(along.z) * static_cast<float>(std::max(map->width, map->height));
            const Real texels = length * pick(middle.z >= 1.0F, across, max(across, deep));
            count = pick(beside, count, max(texels * (1.0F / texels_each), count));
        }
        return static_cast<int>(std::ceil(std::min(highest(pick(length > 0.0F, count, 0.0F)), MOST)));
    }

    void add_part(const LightMapView *map, Real from, Real to, const ArrivingAt &at, Real (&sum)[3]) const {
        const Mask asked = to > from;
        const Real length = pick(asked, to - from, 0.0F);
        const auto place = [&](float x) { return from + length * x; };
        in_sections(at, asked, sections(map, at, from, to), place,
                    [&](float x0, float x1, const Open &before, const Open &after) {
                        if (any(before, after)) {
                            add_section(place(x0), place(x1), before, after, sum);
                        }
                    });
    }

    void add_section(Real from, Real to, const Open &before, const Open &after, Real (&sum)[3]) const {
        const Real column = way_.column(to) - way_.column(from);
        const Way::Depth front = way_.to_eye(from), back = way_.to_eye(to);
        const Way::Depth front_light = to_light(from), back_light = to_light(to);
        Real sent = 0.0F;
        for (int c = 0; c < 3; ++c) {
            if (c < way_.colours) {
                sent = AirText().lit_by_sun(column, front.of[c] + front_light.of[c], back.of[c] + back_light.of[c]);
            }
            sum[c] = sum[c] + sent * (0.5F * (before.of[c] + after.of[c])) * scattered(by_, c);
        }
    }

    [[nodiscard]] Way::Depth to_light(Real t) const { return way_.to_light(light_, -light_.direction, t); }

    Phases by_{};
};

// What of a light gets through along a stretch, as a share of its falloff: by sections that are equally long in x, the
// integrals of that and of u times that, over u from 0 to 1 in each.
class Through {
public:
    Through(int count, int colours)
        : count_(count), colours_(colours), moments_(static_cast<std::size_t>(count * colours) * 2, Real(0.0F)) {}

    // What gets through to both ends of each section, for each colour, where nothing but solids is in the way.
    using Ends = std::vector<Real>;

    // From x0 to x1, a share of that.
    void add(Mask which, Real x0, Real x1, Real share, const Ends &ends) {
        const Real from = pick(which, x0, 1.0F) * static_cast<float>(count_);
        const Real to = pick(which, x1, 0.0F) * static_cast<float>(count_);
        share = pick(which, share, 0.0F);
        const int first = std::clamp(static_cast<int>(lowest(from)), 0, count_ - 1);
        const int last = std::clamp(static_cast<int>(highest(to)), first, count_ - 1);
        for (int i = first; i <= last; ++i) {
            const auto number = static_cast<float>(i);
            const Real a = clamp(from - number, 0.0F, 1.0F), b = max(clamp(to - number, 0.0F, 1.0F), a);
            const Real w0 = share * (b - a), w1 = w0 * (0.5F * (a + b));
            const Real w2 = w0 * ((a * a + a * b + b * b) * (1.0F / 3.0F));
            for (int c = 0; c < colours_; ++c) {
                const Real front = ends[at(i, c)], change = ends[at(i + 1, c)] - front;
                moment(i, c)[0] = moment(i, c)[0] + front * w0 + change * w1;
                moment(i, c)[1] = moment(i, c)[1] + front * w1 + change * w2;
            }
        }
    }
    // By what a section's integrand counts at each of the two points of Gauss there.
    struct Factors {
        Real front, back;
    };
    [[nodiscard]] Factors factors(int section, int colour) const {
        const Real *const m = moment(section, std::min(colour, colours_ - 1));
        constexpr float APART = 2.0F / (GAUSS[1] - GAUSS[0]);
        return {(GAUSS[1] * m[0] - m[1]) * APART, (m[1] - GAUSS[0] * m[0]) * APART};
    }
    [[nodiscard]] bool any(int section) const {
        Real sum = 0.0F;
        for (int c = 0; c < colours_; ++c) {
            sum = sum + moment(section, c)[0];
        }
        return xsimd::any(sum > 0.0F);
    }
    [[nodiscard]] std::size_t at(int end, int colour) const {
        return static_cast<std::size_t>(end * colours_ + colour);
    }

    static constexpr float GAUSS[2] = {0.211324865F, 0.788675135F};

private:
    [[nodiscard]] Real *moment(int section, int colour) { return moments_.data() + 2 * at(section, colour); }
    [[nodiscard]] const Real *moment(int section, int colour) const {
        return moments_.data() + 2 * at(section, colour);
    }

    int count_, colours_;
    std::vector<Real> moments_;
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

    void add(Real from, Real to, Real (&sum)[3]) const {
        const Real squeeze = AirText().squeeze_of(Real(way_.air.anisotropy));
        // Where air ends with height, none is so thin that its end is known.
        const glm::vec3 &e = way_.air.extinction;
        const float least = way_.of_world() && way_.air.even() ? std::min({e.x, e.y, e.z}) : 0.0F;
        Real begin = from - foot_;
        Real end = min(to - foot_, AirText().lit_until(distance_, begin, least, squeeze));
        cut_at_cone(begin, end);
        const Mask asked = end > begin;
        if (!xsimd::any(asked)) {
            return;
        }
        end = max(end, begin);
        const Piece piece{asked, begin, end, AirText().lit_stretch(distance_, begin, end, squeeze)};
        const LightMapView *const map = this->map();
        if (map != nullptr && map->sheets.first != nullptr) {
            add_by_look_ups(piece, sum);
        } else {
            add_by_samples(piece, sum);
        }
    }

private:
    // Of the ray, by distances from the foot.
    struct Piece {
        Mask asked;
        Real begin, end;
        AirText::LitStretch stretch;

        // The ends of a stretch are known better than points near them.
        [[nodiscard]] Real place(float x) const {
            return x <= 0.0F ? begin : x >= 1.0F ? end : clamp(AirText().lit_point(stretch, x).place, begin, end);
        }
    };
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

    static constexpr float FEWEST = 12.0F; // sections

    // So many that a section crosses no more than two texels of a map, about; or so many more.
    [[nodiscard]] int sections(const Piece &piece, const LightMapView *map, float texels = 2.0F) const {
        Real count = FEWEST;
        if (map != nullptr) {
            // From the middle of the octahedron's square to its edge it is a quarter of a turn, of which the angle is
            // half.
            const float per_radian = static_cast<float>(map->width) * map->scale[0] * 0.6366F;
            count = max(count, piece.stretch.angle * (2.0F * per_radian / texels));
        }
        return static_cast<int>(std::ceil(std::min(highest(pick(piece.asked, count, 0.0F)), MOST)));
    }

    // Where sheets dim the light, which no tree knows.
    void add_by_look_ups(const Piece &piece, Real (&sum)[3]) const {
        in_sections(
            at_, piece.asked, sections(piece, map()), [&](float x) { return foot_ + piece.place(x); },
            [&](float x0, float x1, const Open &before, const Open &after) {
                if (any(before, after)) {
                    add_section(piece, x0, x1, sum, [&](int c) -> Through::Factors {
                        const Real change = after.of[c] - before.of[c];
                        return {before.of[c] + change * Through::GAUSS[0], before.of[c] + change * Through::GAUSS[1]};
                    });
                }
            });
    }

    // Of each point of the light solids leave stretches; in these it is dimmed by what it shines through, and fades as
    // the point is seen.
    void add_by_samples(const Piece &piece, Real (&sum)[3]) const {
        const std::size_t bodies = way_.frame.extinctions.size();
        int count = 0;
        bool dimmed = false;
        for (std::size_t m = 0; m < light_.samples.size() * bodies; ++m) {
            const LightMapView &map = light_.maps[m];
            if (!(map.empty() || map.clear())) {
                // A fog's own columns change slowly but at its walls.
                const bool own = m % bodies == static_cast<std::size_t>(way_.body);
                count = std::max(count, sections(piece, &map, own ? 16.0F : 2.0F));
                dimmed = true;
            }
        }
        count = std::max(count, sections(piece, nullptr) * (changes(piece) ? 8 : 1));
        ArrivingAt past_solids = at_;
        past_solids.own = -1;
        const int colours = dimmed ? way_.colours : 1;
        Through through(count, colours);
        std::vector<Real> places;
        for (int i = 0; i <= count; ++i) {
            places.push_back(foot_ + piece.place(static_cast<float>(i) / static_cast<float>(count)));
        }
        Through::Ends ends(through.at(count + 1, 0));
        for (std::size_t j = 0; j < light_.samples.size(); ++j) {
            past_solids.only = static_cast<int>(j);
            for (int i = 0; i <= count; ++i) {
                if (!dimmed) {
                    ends[through.at(i, 0)] =
                        sample_share(light_, light_.samples[j], way_.place(places[static_cast<std::size_t>(i)]));
                    continue;
                }
                const Open arrives = open(past_solids, places[static_cast<std::size_t>(i)]);
                for (int c = 0; c < colours; ++c) {
                    ends[through.at(i, c)] = arrives.of[c];
                }
            }
            const LightMapView *const solids =
                way_.body < 0 ? nullptr : light_.maps + j * bodies + static_cast<std::size_t>(way_.body);
            if (solids == nullptr || solids->empty()) {
                through.add(piece.asked, 0.0F, 1.0F, 1.0F, ends);
                continue;
            }
            const auto share = [&](Real t) {
                const Real place = t - foot_;
                return pick(place <= piece.begin, 0.0F,
                            pick(place >= piece.end, 1.0F, AirText().lit_share(piece.stretch, place)));
            };
            for_lit_sections(*solids, way_.ray.origin, way_.ray.direction, foot_ + piece.begin, foot_ + piece.end,
                             piece.asked, [&](Mask which, Real begin, Real end, Real lit) {
                                 through.add(which, share(begin), share(end), lit, ends);
                             });
        }
        const float step = 1.0F / static_cast<float>(count);
        for (int i = 0; i < count; ++i) {
            if (through.any(i)) {
                const float x = step * static_cast<float>(i);
                add_section(piece, x, x + step, sum, [&](int c) { return through.factors(i, c); });
            }
        }
    }

    // Whether the light fades too fast for a few sections, or its own size bends the way it does.
    [[nodiscard]] bool changes(const Piece &piece) const {
        constexpr float DIFFERENT = 0.03F, NEAR = 4.0F;
        const Mask meets = (piece.begin < 0.0F) & (piece.end > 0.0F);
        if (xsimd::any(piece.asked & meets & (away2_ < NEAR * light_.size2))) {
            return true;
        }
        const auto count = static_cast<int>(FEWEST);
        Real before = 0.0F;
        for (int i = 0; i <= count; ++i) {
            const vec3 place = way_.place(foot_ + piece.place(static_cast<float>(i) / FEWEST));
            Real here = 0.0F;
            for (const glm::vec3 &sample : light_.samples) {
                here = here + sample_share(light_, sample, place);
            }
            if (i > 0 && xsimd::any(piece.asked & (abs(here - before) > DIFFERENT))) {
                return true;
            }
            before = here;
        }
        return false;
    }

    // `factors` of a colour are what gets through, at the two points of Gauss.
    template <typename FactorsOf>
    void add_section(const Piece &piece, float x0, float x1, Real (&sum)[3], const FactorsOf &factors) const {
        const float width = x1 - x0;
        for (int node = 0; node < 2; ++node) {
            const auto point = AirText().lit_point(piece.stretch, x0 + width * Through::GAUSS[node]);
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
            if (light_.area > 0.0F && xsimd::any(piece.asked & (distance2 < FAR * FAR * light_.size2))) {
                by = phases_of_samples(place);
            }
            const Way::Depth to_eye = way_.to_eye(t), to_light = way_.to_light(light_, light_.position, t);
            const Real amount = pick(piece.asked, rate * (0.5F * width) * density(place), 0.0F);
            Real left = 0.0F;
            for (int c = 0; c < 3; ++c) {
                if (c < way_.colours) {
                    left = amount * exp(-min(to_eye.of[c] + to_light.of[c], 80.0F));
                }
                const Through::Factors open = factors(c);
                sum[c] = sum[c] + left * (node == 0 ? open.front : open.back) * scattered(by, c);
            }
        }
    }

    // On the mean over the light's samples, by what each brings.
    [[nodiscard]] Phases phases_of_samples(const vec3 &place) const {
        Phases sum{0.0F, 0.0F};
        Real all = 1e-20F;
        for (const glm::vec3 &sample : light_.samples) {
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

// What the air between two places sends to the eye.
void sent_between(const Way &way, Real from, Real to, Real (&sum)[3]) {
    const Real column = way.column(to) - way.column(from);
    const Way::Depth front = way.to_eye(from), back = way.to_eye(to);
    for (int c = 0; c < 3; ++c) {
        const int of = c < way.colours ? c : 0;
        sum[c] = sum[c] + AirText().lit_by_sun(column, front.of[of], back.of[of]) * way.air.emission[c];
    }
    if (way.air.rayleigh == glm::vec3(0.0F) && way.air.mie == glm::vec3(0.0F)) {
        return;
    }
    for (const LightView &light : way.frame.lights) {
        if (!light.reach.smoke || (light.reach.lights & way.air.lit_by) == 0 || light.samples.empty()) {
            continue;
        }
        if (light.parallel()) {
            SunShine(way, light).add(from, to, sum);
        } else {
            LampShine(way, light).add(from, to, sum);
        }
    }
}

// What all air on rays sends, and takes.
class AllAir {
public:
    AllAir(const FrameView &frame, const Ray &ray, Real end, Mask asked)
        : frame_(frame), ray_(ray), walls_(frame, ray, end, asked) {}

    // On to another place.
    void go(Real to) {
        for (bool met = true; met;) {
            const Real wall = walls_.next(), upto = min(wall, to);
            met = xsimd::any(wall <= to);
            add(upto);
            walls_.pass(upto);
            taken_.move(frame_, walls_, upto);
            at_ = upto;
        }
    }

    void leave_knot(AirKnots &knots) const;

private:
    void add(Real to) {
        const std::size_t first = frame_.air.size() - frame_.fogs.size();
        for (std::size_t i = 0; i < frame_.air.size(); ++i) {
            Real part[3] = {0.0F, 0.0F, 0.0F};
            if (i < first) {
                sent_between(way(i, frame_.air_body), at_, to, part);
                keep(part, 1.0F);
                continue;
            }
            const Real amount = walls_.amount(i - first);
            const Real end = pick(amount > 0.0F, to, at_);
            if (xsimd::any(end > at_)) {
                sent_between(way(i, frame_.first_fog + static_cast<int>(i - first)), at_, end, part);
                keep(part, amount);
            }
        }
    }
    void keep(const Real (&part)[3], Real amount) {
        for (int c = 0; c < 3; ++c) {
            radiance_[c] = radiance_[c] + part[c] * amount;
        }
    }
    [[nodiscard]] Way way(std::size_t air, int body) const {
        return {frame_, taken_, frame_.air[air], body, ray_, frame_.grey ? 1 : 3};
    }

    const FrameView &frame_;
    const Ray &ray_;
    Walls walls_;
    Taken taken_;
    Real at_ = 0.0F;
    Real radiance_[3] = {0.0F, 0.0F, 0.0F};
};

void AllAir::leave_knot(AirKnots &knots) const {
    const auto keep = [&knots](Real value) {
        knots.values.resize(knots.values.size() + MAX_LANES);
        value.store_unaligned(knots.values.data() + (knots.values.size() - MAX_LANES));
    };
    keep(at_);
    for (const Real &value : radiance_) {
        keep(value);
    }
    const Way any = way(0, -1);
    const Way::Depth depth = any.to_eye(at_);
    for (int c = 0; c < any.colours; ++c) {
        keep(depth.of[c]);
    }
    ++knots.count;
}

// From the first to the last of what else is met on any ray, in each lane within its own way; the whole way where
// nothing is met.
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
            const auto row = static_cast<std::size_t>(Knots::rows(colours)) * MAX_LANES;
            const float *const first = events.knots.values.data() + lane;
            const float *const last = first + (static_cast<std::size_t>(events.knots.count) - 1) * row;
            take(first[0] - first[static_cast<std::size_t>(4 + colours) * MAX_LANES], last[0]);
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
    Events &events = *out.events;
    AllAir air(frame, ray, end, Real::load_aligned(packet.active) > 0.0F);
    air.leave_knot(events.air);
    const auto go = [&](Real to) {
        air.go(to);
        air.leave_knot(events.air);
    };
    if (events.any() || events.knots.count > 0) {
        const Stretch stretch = met(events, end, frame.grey ? 1 : 3);
        for (int i = 0; i <= STEPS; ++i) {
            go(stretch.from + (stretch.to - stretch.from) * (static_cast<float>(i) * (1.0F / STEPS)));
        }
    }
    go(end);
}

} // namespace sfumato::SFUMATO_ISA
