// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance from all around, as a picture.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// Equirectangular: rows from the zenith down, columns from -x by way of +y, x and -y back, so that the middle one is
// +x. Between the centres of texels it is bilinear, over the poles too. Once shared it never changes.
struct SkyImage {
    int width = 0, height = 0;
    std::vector<glm::vec3> radiance; // W/(m^2 sr), row after row

    [[nodiscard]] const glm::vec3 &at(int column, int row) const {
        return radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(column)];
    }
};

} // namespace sfumato
