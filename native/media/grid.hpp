// SPDX-License-Identifier: GPL-3.0-or-later
// Densities made ready for marching: cropped to where there is smoke, with a map of the emptiness that is left.
#pragma once

#include "media/medium_view.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Grid {
    std::vector<float> density; // x runs fastest
    glm::ivec3 resolution{0};   // with one empty cell on every side
    glm::ivec3 first{0};        // where the cell (0, 0, 0) lies in what it was cropped from
    std::vector<float> clearance;
    glm::ivec3 bricks{0};

    [[nodiscard]] GridView view() const { return {density.data(), 1, resolution.x, resolution.y, resolution.z}; }
    [[nodiscard]] ClearanceView clearances() const { return {clearance.data(), bricks.x, bricks.y, bricks.z}; }
};

// The cells of `density` (x fastest) that are above a threshold, and all others between them; null where there is none.
// Cells up to the threshold count as empty. `density` is read once for the bounds and once for the copy.
std::shared_ptr<const Grid> crop(std::span<const float> density, const glm::ivec3 &resolution, float threshold);

} // namespace sfumato
