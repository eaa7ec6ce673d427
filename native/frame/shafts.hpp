// SPDX-License-Identifier: GPL-3.0-or-later
// What even air scatters of suns to the eye, with the shadows that solids throw through it.
#pragma once

#include "maps/depth_tree.hpp"
#include "scene/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

// The first solids that a sun's light meets, and bounds of them, made once for all pictures.
class SolidMap {
public:
    // depth: rows x columns; world_to_map takes the world onto [0, 1]^3, the light along the third axis.
    SolidMap(std::vector<float> depth, int width, int height, const glm::dmat4 &world_to_map);

    [[nodiscard]] const std::vector<float> &depth() const { return depths; }
    [[nodiscard]] DepthTreeView tree() const { return bounds.view(); }
    [[nodiscard]] int columns() const { return width; }
    [[nodiscard]] int rows() const { return height; }
    [[nodiscard]] const glm::dmat4 &world_to_map() const { return onto; }

private:
    std::vector<float> depths;
    int width, height;
    glm::dmat4 onto;
    DepthTree bounds;
};

struct ShaftLight {
    const SolidMap *map = nullptr;
    glm::vec3 direction{0.0F}; // of its light, unit length
    glm::vec3 irradiance{0.0F};
};

struct ShaftAir {
    glm::vec3 rayleigh{0.0F}, mie{0.0F}, absorption{0.0F}; // per metre
    float anisotropy = 0.0F;                               // of mie
};

struct ShaftRays {
    Camera camera;
    int width = 0, height = 0;
    std::span<const float> distance; // along each pixel's ray up to its surface, rows from the bottom
};

enum class ShaftMethod : std::uint8_t {
    MARCH,         // every column of texels on every pixel's ray: Algorithm 1
    MINMAX,        // by the tree: Algorithm 2
    EPIPOLAR,      // on slices, with pixels between them
    EPIPOLAR_FINE, // with no pixel further than one pixel from its samples
};

struct Shafts {
    std::vector<float> radiance; // three colours a pixel
    std::size_t texels = 0;      // or bounds of some, that were looked at
    std::size_t rays = 0;        // that were followed
};

Shafts shafts(const ShaftRays &rays, std::span<const ShaftLight> lights, const ShaftAir &air, ShaftMethod method);

} // namespace sfumato
