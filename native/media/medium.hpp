// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke in its place: a grid, what its material makes of it, and the light that reaches it.
#pragma once

#include "media/grid.hpp"
#include "media/ramp.hpp"
#include "scene/visibility.hpp"

#include <memory>
#include <vector>

#include <glm/mat4x4.hpp>

namespace sfumato {

struct Medium; // scene/scene.hpp

// One light's: the cells of the grid, x fastest, `light_channels` numbers each, see MediumView.
using LightVolume = std::vector<float>;

struct CroppedMedium {
    std::shared_ptr<const Grid> grid; // null where there is no smoke
    glm::dmat4 grid_to_world{1.0};
    glm::vec3 extinction{0.0F}; // per metre and unit density
    glm::vec3 scattering{0.0F};
    std::vector<glm::vec3> emission;        // as Medium has it; none where nothing glows
    std::shared_ptr<const MediumRamp> ramp; // null where the grid holds the density itself
    float anisotropy = 0.0F;
    Visibility visibility;
    double cell_size = 0.0; // the shortest edge, metres
    int light_channels = 0;
    std::vector<std::shared_ptr<const LightVolume>> light; // of each light

    [[nodiscard]] bool grey() const { return extinction.x == extinction.y && extinction.y == extinction.z; }
    [[nodiscard]] bool empty() const { return grid == nullptr; }
    // Whether it does more than glow: else no light is asked about it.
    [[nodiscard]] bool takes_light() const {
        return grid->amount > 0.0 && strongest() > 0.0F && (ramp == nullptr || ramp->takes_light);
    }
    [[nodiscard]] ClearanceView clearances() const;
    // Of the strongest colour, per metre and unit density.
    [[nodiscard]] float strongest() const;
};

// What a medium's transfer functions make of its grid, whose bricks hold these ranges (brick_ranges); or nothing, where
// there are none.
void classify(CroppedMedium &cropped, const Medium &medium, std::span<const glm::vec2> ranges);

// The density that could darken nothing by more than 1e-4 of optical depth along the grid's diagonal: cells up to it
// count as empty. Infinite for a material that takes no light.
float emptiness(const glm::uvec3 &resolution, const glm::mat4 &grid_to_world, const glm::vec3 &extinction);

// Crops the density and what glows, unless the medium brings its grid.
CroppedMedium crop(const Medium &medium);

} // namespace sfumato
