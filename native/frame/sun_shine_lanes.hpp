// SPDX-License-Identifier: GPL-3.0-or-later
// What parallel light sends to the eye through air. Along a straight ray air.glsl integrates it exactly, so that where
// nothing dims it but solids, sections are as long as these leave them.
#pragma once

#include "frame/shine_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

class SunShine : Shine {
public:
    SunShine(const Way &way, const LightView &light) : Shine(way, light) {
        Real all = 0.0F;
        for (std::size_t j = 0; j < light.samples.size(); ++j) {
            const glm::vec3 &sample = light.samples[j];
            const vec3 both = way.ray.direction + broadcast(sample), apart = way.ray.direction - broadcast(sample);
            const Phases one = phases(0.25F * dot(apart, apart), 0.25F * dot(both, both));
            const Real share = sample_share(light, j, way.ray.origin);
            by_.molecules = by_.molecules + share * one.molecules;
            by_.dust = by_.dust + share * one.dust;
            all = all + share;
        }
        by_.molecules = by_.molecules / all;
        by_.dust = by_.dust / all;
    }

    void add() const {
        if (const LightMapView *const map = with_sheets()) {
            add_by_look_ups(*map);
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
            const Real weight = static_cast<float>(every_) * sample_share(light_, j, way_.ray.origin);
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
        constexpr float THICK = 0.25F; // over which what a fog leaves of the light goes about straight
        const glm::vec3 &e = way_.air.extinction;
        const float thickest = way_.of_world() ? 0.0F : std::max({e.x, e.y, e.z});
        int count = std::max(static_cast<int>(std::min(highest(max(to - from, 0.0F)) * thickest / THICK, MOST)), 1);
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

    void add_by_look_ups(const LightMapView &map) const {
        for (std::size_t number = 0; number < way_.steps.size(); ++number) {
            const Step &step = way_.steps[number];
            const Mask asked = step.from < step.to;
            const Real to = pick(asked, step.to, step.from);
            const auto place = [&](float x) { return step.from + (to - step.from) * x; };
            in_sections(asked, std::max(sections(map, step.from, to, 2.0F), sections(step.from, to)), place,
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

    Phases by_{0.0F, 0.0F}; // the mean over the samples, by what each brings
};

} // namespace
} // namespace sfumato::SFUMATO_ISA
