// SPDX-License-Identifier: GPL-3.0-or-later
// What light from a place sends to the eye through air: by x, which goes along a stretch of the ray as air.glsl has it,
// so that neither the light's falloff nor the peak of a phase function is left for a section.
#pragma once

#include "frame/shine_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

class LampShine : Shine {
public:
    LampShine(const Way &way, const LightView &light) : Shine(way, light) {
        const vec3 towards = broadcast(light.position) - way.ray.origin;
        foot_ = dot(towards, way.ray.direction);
        const vec3 across = towards - way.ray.direction * foot_;
        // A ray right through the light is one that passes it by a ten-millionth of the way.
        away2_ = max(dot(across, across), 1e-14F * foot_ * foot_ + 1e-18F);
        distance_ = sqrt(away2_ + light.size2);
    }

    void add() const {
        const std::vector<Stretch> stretches = this->stretches();
        if (stretches.empty()) {
            return;
        }
        const std::vector<Piece> pieces = this->pieces(stretches);
        if (const LightMapView *const map = with_sheets()) {
            add_by_look_ups(pieces, *map);
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
                int count = std::max(near || fades(stretch, own) ? 8 : 1, scale_heights(stretch, own));
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
    // How many of these a part of a stretch crosses, between where air is as dense as it can be and where it is next to
    // none.
    [[nodiscard]] int scale_heights(const Stretch &stretch, const vec3 *points) const {
        if (way_.air.even()) {
            return 1;
        }
        constexpr float DENSEST = -40.0F, THINNEST = 12.0F, MOST_HEIGHTS = 64.0F;
        const auto height = [&](const vec3 &place) { return clamp(height_of(way_.air, place), DENSEST, THINNEST); };
        const Real crossed = pick(stretch.asked, abs(height(points[2]) - height(points[0])), 0.0F);
        return static_cast<int>(std::ceil(std::min(highest(crossed), MOST_HEIGHTS)));
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
        if (shares_alike(light_)) {
            return false;
        }
        Real sent[3] = {0.0F, 0.0F, 0.0F};
        const std::size_t count = light_.samples.size(), step = count < 16 ? 1 : 5; // a part of them tells it, too
        for (std::size_t j = 0; j < count; j += step) {
            for (int i = 0; i < 3; ++i) {
                sent[i] = sent[i] + sample_share(light_, j, points[i]);
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
    // Of a light that shines into a cone, what lies in it, by distances from the foot. Where the light has a size, the
    // cone begins so far behind it that those of all its points are in it.
    void cut_at_cone(Real &begin, Real &end) const {
        const Beam beam = this->beam();
        if (beam.cosine < 0.0F) {
            return;
        }
        const float sine = std::sqrt(std::max(1.0F - beam.cosine * beam.cosine, 1e-12F));
        const vec3 axis = broadcast(light_.direction),
                   apex = broadcast(light_.position - light_.direction * (beam.size / sine));
        const Real foot = dot(apex - way_.ray.origin, way_.ray.direction);
        const vec3 nearest = way_.place(foot) - apex;
        const auto part = AirText().part_in_cone(sqrt(dot(nearest, nearest)), dot(nearest, axis),
                                                 dot(way_.ray.direction, axis), Real(beam.cosine));
        begin = max(begin, part.from + (foot - foot_));
        end = min(end, part.to + (foot - foot_));
    }
    // The cosine of half the angle that a light shines into, less than 0 where that is more than a half-space; and half
    // the light's own size.
    struct Beam {
        float cosine, size;
    };
    [[nodiscard]] Beam beam() const {
        if (light_.spread_cotangent > 0.0F) {
            const float across = glm::length(light_.across), up = glm::length(light_.up);
            return {light_.spread_cotangent / std::sqrt(light_.spread_cotangent * light_.spread_cotangent + 1.0F),
                    std::sqrt(across * across + up * up)};
        }
        if (light_.cone_cosine <= 0.0F || !light_.oval) {
            return {light_.cone_cosine, light_.radius};
        }
        // By way of its shorter axis an oval is wider.
        const float shorter = std::min(glm::length(light_.across), glm::length(light_.up));
        const float tangent = std::sqrt(1.0F - light_.cone_cosine * light_.cone_cosine) / light_.cone_cosine;
        const float widest = tangent / std::max(shorter, 1e-6F);
        return {1.0F / std::sqrt(widest * widest + 1.0F), light_.radius};
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

    void add_by_look_ups(const std::vector<Piece> &pieces, const LightMapView &map) const {
        for (const Piece &piece : pieces) {
            const Stretch &stretch = *piece.stretch;
            const float width = piece.x1 - piece.x0;
            in_sections(
                stretch.asked, std::max(piece.cut.count, sections(stretch, width, map, 2.0F)),
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
            const Real share = sample_share(light_, j, place);
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
