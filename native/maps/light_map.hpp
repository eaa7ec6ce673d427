// SPDX-License-Identifier: GPL-3.0-or-later
// A light map: one medium's column density along the rays of one point of a light; and where solids begin on them.
#pragma once

#include "maps/map_view.hpp"
#include "media/medium.hpp"
#include "solids/surface_view.hpp"
#include "text/dispatch.hpp"

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

namespace sfumato {

// Along each texel's ray, in the map's depth, where the first solid stands; huge where none does.
using SolidDepths = std::vector<float>;

struct LightMap {
    int count = 1; // coefficients a texel
    glm::ivec2 size{0};
    bool radial = false;
    glm::dmat4 world_to_light{1.0};  // see LightMapView
    glm::dvec3 low{0.0}, high{1.0};  // radial: the rectangle of the octahedral square, and the distances
    int slices = 0;                  // into which a ray is cut when it is projected,
    double length = 0.0;             // and how long it is, metres
    std::vector<float> coefficients; // of the column density, metres times density: see LightMapView; none in a plan

    // With the depths of its solids, where they are known.
    [[nodiscard]] LightMapView view(const SolidDepths *solids = nullptr) const;
    [[nodiscard]] std::size_t texels() const {
        return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    }
    // Column density between the light and each of `points` (x, y, z in turn).
    void look_up(std::span<const float> points, std::span<float> columns) const;
};

struct LightMapSettings {
    int coefficients = 15;
    double texels_per_cell = 1.0; // against the shortest edge of the medium's cells
    double most_floats = 1 << 26; // of one map: a quarter of a gibibyte; it has larger texels where it would need more
};

// The rays of a map of light that travels in `direction` everywhere.
LightMap plan_parallel_map(const CroppedMedium &medium, const glm::dvec3 &direction, const LightMapSettings &settings);

// The rays of a map of light that leaves `position` in all directions. The position may lie in the medium.
LightMap plan_radial_map(const CroppedMedium &medium, const glm::dvec3 &position, const LightMapSettings &settings);

// A plan with its coefficients.
LightMap projected(LightMap plan, const CroppedMedium &medium, const InstructionSet &with = instruction_set());

inline LightMap build_parallel_map(const CroppedMedium &medium, const glm::dvec3 &direction,
                                   const LightMapSettings &settings, const InstructionSet &with = instruction_set()) {
    return projected(plan_parallel_map(medium, direction, settings), medium, with);
}

inline LightMap build_radial_map(const CroppedMedium &medium, const glm::dvec3 &position,
                                 const LightMapSettings &settings, const InstructionSet &with = instruction_set()) {
    return projected(plan_radial_map(medium, position, settings), medium, with);
}

// Where solids stand on a map's rays; of light that has a place, from `nearest` metres around it on.
SolidDepths find_solids(const LightMap &map, const SurfaceView &surfaces, double nearest = 0.0);

} // namespace sfumato
