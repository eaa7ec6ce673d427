// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke made ready for marching: cropped to where there is any, with a map of the emptiness that is left.
#pragma once

#include "media/medium_view.hpp"

#include <vector>

#include <glm/mat4x4.hpp>

namespace sfumato {

struct Medium;

struct CroppedMedium {
    std::vector<float> density;
    std::vector<float> light; // of all lights in turn, see MediumView
    int light_channels = 0;
    glm::ivec3 resolution{0}; // with one empty cell on every side
    glm::dmat4 grid_to_world{1.0};
    std::vector<float> clearance;
    glm::ivec3 bricks{0};
    glm::vec3 extinction{0.0F}; // per metre and unit density
    glm::vec3 scattering{0.0F};
    float anisotropy = 0.0F;
    double cell_size = 0.0; // the shortest edge, metres

    [[nodiscard]] bool grey() const { return extinction.x == extinction.y && extinction.y == extinction.z; }
    [[nodiscard]] bool empty() const { return density.empty(); }
    [[nodiscard]] GridView density_grid() const;
    [[nodiscard]] ClearanceView clearances() const;
};

// Cells whose density could darken nothing by more than 1e-4 of optical depth along the grid's diagonal count as empty.
CroppedMedium crop(const Medium &medium);

} // namespace sfumato
