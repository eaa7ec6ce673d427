// SPDX-License-Identifier: GPL-3.0-or-later
// A medium's transfer functions as the kernels read them, and where they leave its grid empty.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

class TransferFunction;

constexpr std::size_t MOST_STOPS = 1024; // of one function of a medium: part_of() of ramp.glsl finds as many

struct MediumRamp {
    std::vector<float> rows;      // as RampView has them
    std::vector<float> clearance; // as Grid has it
    bool takes_light = false;     // anywhere; else it only glows
    double fineness = 1.0;        // by how much what is met is finer than cells, at most 3; so are texels of its maps

    [[nodiscard]] int parts() const;
    // All that a column of density along a light's ray depends on.
    [[nodiscard]] std::vector<float> densities() const;
};

// Of a grid whose bricks hold values in these ranges. `radiated` may be none.
MediumRamp ramp_of(const TransferFunction &transfer, const TransferFunction *radiated,
                   std::span<const glm::vec2> ranges, const glm::ivec3 &bricks);

} // namespace sfumato
