// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/splat.hpp"

#include "maps/map_kernels.hpp"
#include "maps/splat_blocks.hpp"
#include "rays/bins.hpp"
#include "text/lights_text.hpp"
#include "text/media_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;
using MediaText = text::MediaText<float>;
using RaysText = text::RaysText<float>;

// A puff on a map, and the texels that it touches.
struct Projected {
    SplatPuff puff;
    Footprint footprint{1.0F, 0.0F, 1.0F, 0.0F};
};

// The radius that a map widens narrower puffs to: metres, and of a radial one, for each metre from its middle.
float least_radius(const LightMap &map) {
    // Texels are squares, all alike or those in the middle of the octahedron.
    const double across = map.radial
                              ? (map.high.x - map.low.x) / map.size.x
                              : 1.0 / (glm::length(glm::dvec3(glm::transpose(map.world_to_light)[0])) * map.size.x);
    return static_cast<float>(double{LEAST_RADIUS} * across);
}

// Widened to what texels can show, it takes as much light in all.
SplatPuff widened(const Puff &puff, const glm::vec3 &place, float radius, float least, float per_metre) {
    const float wide = std::max(radius, least), share = radius / wide;
    return {place.x, place.y, place.z, 1.0F / wide, puff.radius * per_metre, puff.depth * share * share};
}

class ParallelPlane {
public:
    explicit ParallelPlane(const LightMap &map)
        : to_texels_(glm::scale(glm::dmat4(1.0), glm::dvec3(map.size, 1.0)) * map.world_to_light),
          per_metre_(static_cast<float>(1.0 / map.length)) {
        texels_ = static_cast<float>(double{LEAST_RADIUS} / double{least_radius(map)});
    }

    [[nodiscard]] Projected project(const Puff &puff) const {
        const glm::vec3 place(to_texels_ * glm::dvec4(puff.middle, 1.0));
        Projected out{widened(puff, place, puff.radius * texels_, LEAST_RADIUS, per_metre_)};
        const float reach = 1.0F / out.puff.per_radius;
        out.footprint = {place.x - reach, place.x + reach, place.y - reach, place.y + reach};
        return out;
    }

private:
    glm::dmat4 to_texels_; // across; along, the map's depth
    float per_metre_, texels_;
};

// Of a map around a place.
class RadialPlane {
public:
    explicit RadialPlane(const LightMap &map)
        : to_light_(map.world_to_light), low_(map.low), high_(map.high), size_(map.size), least_(least_radius(map)) {}

    [[nodiscard]] Projected project(const Puff &puff) const {
        const glm::dvec3 place(to_light_ * glm::dvec4(puff.middle, 1.0));
        const double distance = glm::length(place);
        const glm::dvec3 towards = distance > 0.0 ? place / distance : glm::dvec3(0.0, 0.0, 1.0);
        // On a face of the octahedron texels see more the nearer they are to its middle.
        const double wider = std::pow(std::abs(towards.x) + std::abs(towards.y) + std::abs(towards.z), 1.5);
        const auto least = static_cast<float>(least_ * wider * distance);
        Projected out{widened(puff, glm::vec3(place), puff.radius, least, 1.0F)};
        out.footprint = footprint(towards, distance, 1.0 / double{out.puff.per_radius});
        return out;
    }

private:
    // Of a cap around a direction: the box of its rim, with room for what bends between the points that are looked at;
    // or everything, where a seam of the octahedron is near.
    [[nodiscard]] Footprint footprint(const glm::dvec3 &towards, double distance, double radius) const {
        constexpr double WIDEST = 0.9; // sine of half the cap's angle
        constexpr int POINTS = 8;
        constexpr double ROOM = 1.25; // of a circle's points the outermost may lie 8 % inside
        const double sine = ROOM * radius / std::max(distance, 1e-30);
        const bool seam =
            sine > WIDEST || (towards.z < sine && (std::abs(towards.x) < sine || std::abs(towards.y) < sine));
        if (seam) {
            return {0.0F, static_cast<float>(size_.x), 0.0F, static_cast<float>(size_.y)};
        }
        const double cosine = std::sqrt(1.0 - sine * sine);
        const glm::dvec3 helper = std::abs(towards.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
        const glm::dvec3 across = glm::normalize(glm::cross(helper, towards)), up = glm::cross(towards, across);
        constexpr float FAR = std::numeric_limits<float>::max();
        Footprint out{FAR, -FAR, FAR, -FAR};
        for (int i = 0; i < POINTS; ++i) {
            const double angle = 6.283185307179586 * i / POINTS;
            const glm::dvec3 rim = towards * cosine + (across * std::cos(angle) + up * std::sin(angle)) * sine;
            const LightsText::Octahedral at = LightsText().octahedral(glm::vec3(rim));
            const auto x = static_cast<float>((double{at.x} - low_.x) / (high_.x - low_.x) * size_.x);
            const auto y = static_cast<float>((double{at.y} - low_.y) / (high_.y - low_.y) * size_.y);
            out = {std::min(out.low_x, x), std::max(out.high_x, x), std::min(out.low_y, y), std::max(out.high_y, y)};
        }
        return out;
    }

    glm::dmat4 to_light_;
    glm::dvec3 low_, high_;
    glm::dvec2 size_;
    double least_;
};

// Puffs on a map, binned.
struct Splatted {
    std::vector<SplatPuff> puffs;
    std::vector<float> weights;
    Bins bins;
    Splat<SplatPuff> view;

    Splatted(const LightMap &map, std::span<const Puff> all) {
        puffs.resize(all.size());
        std::vector<Footprint> footprints(all.size());
        const auto project = [&](const auto &plane) {
            oneapi::tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
                const Projected projected = plane.project(all[i]);
                puffs[i] = projected.puff;
                footprints[i] = projected.footprint;
            });
        };
        map.radial ? project(RadialPlane(map)) : project(ParallelPlane(map));
        bins = Bins(footprints, {}, map.size.x, map.size.y);
        if (map.shared && !map.radial && map.harmonic() && map.series.name == FOURIER && map.series.count == 7) {
            weigh();
        }
        view.map = map.view();
        view.bins = bins.view();
        view.primitives = puffs.data();
        view.weights = weights.empty() ? nullptr : weights.data();
    }

private:
    // As shaders/viewport/splat_vertex.glsl does.
    void weigh() {
        constexpr std::size_t WEIGHTS = Splat<SplatPuff>::WEIGHTS;
        weights.resize(WEIGHTS * puffs.size());
        oneapi::tbb::parallel_for(std::size_t{0}, puffs.size(), [&](std::size_t i) {
            const SplatPuff &puff = puffs[i];
            float *weight = weights.data() + WEIGHTS * i;
            const RaysText::Harmonic first = RaysText().harmonic(1.0F, puff.z);
            RaysText::Harmonic here = first;
            *weight++ = puff.column;
            for (int k = 1; k <= 3; ++k) {
                const float number = 6.28318530717958648F * static_cast<float>(k);
                const float thick = RaysText().slab_factor(static_cast<float>(k), 2.0F * PUFF_SLAB * puff.half);
                *weight++ = RaysText().project_cosine(puff.column, here, thick) / number;
                *weight++ = RaysText().project_sine(puff.column, here, thick) / number;
                here = RaysText().next_harmonic(here, first);
            }
        });
    }
};

LightMap splatted(LightMap map, std::span<const Puff> puffs, const InstructionSet &with) {
    const Splatted splat(map, puffs);
    const MapKernels &kernels = map_kernels(with);
    return splatted(std::move(map), splat.view, kernels.splat_puffs, kernels.meet_puffs, with);
}

} // namespace

Body body_of(const std::shared_ptr<const Puffs> &puffs, std::size_t number) {
    const Puffs::Body &of = puffs->bodies[number];
    const glm::dvec3 extent(of.high - of.low);
    Body body;
    body.cell_size = of.detail;
    body.cells = extent / of.detail;
    body.cells_to_world = glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(of.low)), glm::dvec3(of.detail));
    body.extinction = of.extinction;
    body.anisotropy = of.anisotropy;
    body.visibility = of.visibility;
    body.identify = [content = of.content](Key &key) { key.number(content[0], content[1]); };
    body.project = [puffs, number](LightMap plan, const InstructionSet &with) {
        return splatted(std::move(plan), puffs->of(puffs->bodies[number]), with);
    };
    return body;
}

} // namespace sfumato
