// SPDX-License-Identifier: GPL-3.0-or-later
// The light map of a sun: a Fourier opacity map of the column density along the light, and where solids begin.
#pragma once

#include "kernels.hpp"
#include "medium.hpp"
#include "scene.hpp"

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

namespace sfumato {

struct LightMap {
    int count = 1; // coefficients a texel, odd: a0, a1, b1, a2, b2, ...
    glm::ivec2 size{0};
    std::vector<float> coefficients; // of the column density: metres times density
    std::vector<float> solid_depth;
    glm::dmat4 world_to_map{1.0}; // (x, y) over the map and z along the light, all in [0, 1]

    [[nodiscard]] LightMapView view() const;
    [[nodiscard]] std::size_t texels() const {
        return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    }
    // Column density between the sun and each of `points` (x, y, z in turn).
    void look_up(std::span<const float> points, std::span<float> columns) const;
};

// The coordinate frame of a sun: columns are two axes across the light and the light's direction.
glm::dmat3 light_axes(const Sun &sun);

// `texels_per_cell` relates the map's texels to the shortest edge of the medium's cells, within 256 MiB a map.
LightMap build_light_map(const CroppedMedium &medium, const Sun &sun, const SurfaceView &surfaces, int count,
                         double texels_per_cell, const Kernels &with = kernels());

// Fills the medium's channel of column density, and adds one of occlusion where a solid shades the smoke.
void light_medium(CroppedMedium &medium, const LightMap &map, const Kernels &with = kernels());

} // namespace sfumato
