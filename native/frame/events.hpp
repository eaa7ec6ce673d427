// SPDX-License-Identifier: GPL-3.0-or-later
// What lies before the first opaque surface on the rays of a packet: fragments and slices of particles, and what a
// march through grids, and air, leave where there are such. The merge (merge_lanes.cpp) composites all in order of
// depth.
#pragma once

#include "text/dispatch.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// Of what such a share is left, nothing is seen.
constexpr float OPAQUE_LEFT = 1e-5F;

// Of what has no extent along a ray.
struct Fragment {
    float distance = 0.0F;    // from where the ray starts, metres
    glm::vec3 radiance{0.0F}; // that it adds, by its own opacity
    glm::vec3 left{1.0F};     // the share that it leaves of what lies behind it
};

// Particles, whose densities add where they overlap. Each lane's slices are next to each other and equally thick.
struct Slices {
    int count = 0;                                        // 0: none on any of these rays
    alignas(64) float first[MAX_LANES], width[MAX_LANES]; // where a lane's begin, and the extent of one, metres
    std::vector<float> depth; // optical: slice by slice, in each colour (one where all is grey), MAX_LANES a row
    std::vector<float> sent;  // radiance, were there nothing in the slice to take any: likewise, in three colours
    // The particles' own notes: which are met, and what those of one body scatter.
    std::vector<std::int32_t> met;
    std::vector<float> scattered;

    // Empty ones.
    void reset(int slices, int colours) {
        count = slices;
        depth.assign(static_cast<std::size_t>(slices * colours) * MAX_LANES, 0.0F);
        sent.assign(static_cast<std::size_t>(slices) * 3 * MAX_LANES, 0.0F);
    }
};

// The smoke of grids from the eye up to the ends of a march's steps.
struct Knots {
    int count = 0;
    // Where a step ends, the radiance, the optical depth in each colour, the step's length; MAX_LANES a row.
    std::vector<float> values;

    static constexpr int rows(int colours) { return 5 + colours; }
};

// Air from the eye up to places of each lane, the first of which is the eye.
struct AirKnots {
    int count = 0;
    std::vector<float> values; // the place, the radiance, the optical depth in each colour; MAX_LANES a row

    // Of a knot, one of its rows.
    [[nodiscard]] const float *row(int knot, int number, int colours) const {
        return values.data() + static_cast<std::ptrdiff_t>(knot * (4 + colours) + number) * MAX_LANES;
    }
};

struct Events {
    std::array<std::vector<Fragment>, MAX_LANES> fragments; // of each lane, in any order
    Slices slices;
    Knots knots;
    AirKnots air;

    // A lane keeps so many at most: where there are more, those far behind are taken together.
    static constexpr std::size_t MOST = 512;
    void add(std::size_t lane, const Fragment &fragment);
    // Whether there are fragments or particles.
    [[nodiscard]] bool any() const;
    // Keeps its memory.
    void clear();
};

// In order of depth; what is behind an opaque one is gone.
void sort_fragments(std::vector<Fragment> &fragments);

} // namespace sfumato
