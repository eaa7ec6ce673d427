// SPDX-License-Identifier: GPL-3.0-or-later
// A light map: one body's column density along the rays of one point of a light; and where solids begin on them.
#pragma once

#include "maps/body.hpp"
#include "maps/map_view.hpp"
#include "media/medium.hpp"
#include "solids/ray_scene.hpp"
#include "text/dispatch.hpp"

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

namespace sfumato {

// Along each texel's ray, in the map's depth, where the first solid stands; huge where none does.
using SolidDepths = std::vector<float>;

struct SheetDepths; // maps/sheet_depths.hpp

struct LightMap {
    Series series{COSINE, 15, {}}; // a learned basis has its tables once it is projected
    bool shared = false;           // whether one range of depth serves all rays
    // Whether neighbouring rays may meet so different things that what they let through has to be filtered in look-ups.
    bool sharp = false;
    bool curved = false; // whether a texel has resolved curves in the place of the series
    double blur = 0.0;   // standard deviation of the filter that stands for the light's extent, texels
    glm::ivec2 size{0};
    bool radial = false;
    glm::dmat4 world_to_light{1.0};   // see LightMapView
    glm::dvec3 low{0.0}, high{1.0};   // radial: the rectangle of the octahedral square, and the distances
    int slices = 0;                   // into which a ray is cut when it is projected,
    double length = 0.0;              // and how long it is, metres
    std::vector<float> coefficients;  // of the column density, metres times density: see LightMapView; none in a plan
    std::vector<std::int32_t> curves; // in their place
    int colours = 1;                  // of the curves
    glm::vec3 extinction{0.0F};       // that they hold

    // With the depths of its solids and sheets, where they are known.
    [[nodiscard]] LightMapView view(const SolidDepths *solids = nullptr, const SheetDepths *sheets = nullptr) const;
    [[nodiscard]] std::size_t texels() const {
        return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    }
    // Whether it has harmonics, which have inner loops of their own.
    [[nodiscard]] bool harmonic() const { return !curved && (series.name == COSINE || series.name == FOURIER); }
    [[nodiscard]] std::size_t bytes() const { return 4 * (coefficients.size() + curves.size()); }
    // Column density between the light and each of `points` (x, y, z in turn), as light of a colour meets it: curves
    // are rounded for each, series are the same for all.
    void look_up(std::span<const float> points, std::span<float> columns, int colour = 0) const;
};

struct LightMapSettings {
    int coefficients = 15;        // of a series
    double texels_per_cell = 1.0; // against the shortest edge of the body's cells
    double most_floats = 1 << 26; // of one map: a quarter of a gibibyte; it has larger texels where it would need more
    BasisName basis = COSINE;
    bool curved = false; // resolved curves in the place of a series
    bool shared = false; // one range of depth for all rays of a series, so that it may be filtered:
    double blur = 0.0;   // by a bell of this standard deviation, metres at the middle of the smoke
};

// The rays of a map of light that travels in `direction` everywhere.
LightMap plan_parallel_map(const Body &body, const glm::dvec3 &direction, const LightMapSettings &settings);

// The rays of a map of light that leaves `position` in all directions. The position may lie in the body.
LightMap plan_radial_map(const Body &body, const glm::dvec3 &position, const LightMapSettings &settings);

// A plan with the coefficients, or the curves, of a grid's smoke, whose strongest colour has this extinction: what can
// be seen decides what range a ray needs. `ramp` may be none.
LightMap projected(LightMap plan, const Grid &grid, const MediumRamp *ramp, const glm::dmat4 &grid_to_world,
                   float extinction, const InstructionSet &with);

// A map's series with coefficients as project() of rays/basis.hpp makes them, and the range of each; none of curves.
struct MapSeries {
    std::vector<float> coefficients; // texel by texel
    std::vector<Range> ranges;
};
MapSeries series_of(const LightMap &map);

inline LightMap build_parallel_map(const CroppedMedium &medium, const glm::dvec3 &direction,
                                   const LightMapSettings &settings, const InstructionSet &with = instruction_set()) {
    const Body body = body_of(medium);
    return body.project(plan_parallel_map(body, direction, settings), with);
}

inline LightMap build_radial_map(const CroppedMedium &medium, const glm::dvec3 &position,
                                 const LightMapSettings &settings, const InstructionSet &with = instruction_set()) {
    const Body body = body_of(medium);
    return body.project(plan_radial_map(body, position, settings), with);
}

// Where solids stand on a map's rays; of light that has a place, from `nearest` metres around it on.
SolidDepths find_solids(const LightMap &map, const RayScene &solids, double nearest = 0.0);

} // namespace sfumato
