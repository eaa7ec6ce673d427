// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame is made from: plain arrays in world space, metres, Z up, scene-linear RGB.
// A field enters here with its first reader. `reference` shares this file with the methods and nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

// Triangles that reflect diffusely. Every triangle has three corner normals, so flat, smooth and custom shading
// need no flag, and one row of `albedo`, so an object may carry several materials.
struct Mesh {
    std::vector<glm::vec3> vertices;
    std::vector<glm::uvec3> triangles;                    // indices into vertices
    std::vector<std::array<glm::vec3, 3>> corner_normals; // one triple per triangle, unit length
    std::vector<std::uint32_t> material;                  // one per triangle, index into albedo
    std::vector<glm::vec3> albedo;
};

// Smoke: a grid of densities, cell-centred, interpolated trilinearly and zero outside.
// Grid space is measured in cells: the cell (i, j, k) fills [i, i+1] x [j, j+1] x [k, k+1], its sample is at i + 1/2.
// Every cross-section is a colour times the one scalar density, so one scalar map serves coloured smoke too.
struct Medium {
    glm::uvec3 resolution{0};
    std::vector<float> density; // x runs fastest
    glm::mat4 grid_to_world{1.0F};
    glm::vec3 scattering{1.0F}; // sigma_s per metre and unit density
    glm::vec3 absorption{0.0F}; // sigma_a per metre and unit density
    float anisotropy = 0.0F;    // g of Henyey and Greenstein (1941), in (-1, 1)
};

struct Sun {
    glm::vec3 direction{0.0F, 0.0F, -1.0F}; // the way the light travels, unit length
    glm::vec3 irradiance{1.0F};             // W/m^2 on a surface that faces the sun
    float angle = 0.0F;                     // angular diameter, radians
};

struct Scene {
    std::vector<Mesh> meshes;
    std::optional<Medium> medium;
    std::optional<Sun> sun;
    glm::vec3 background{0.0F}; // radiance where no surface is; it lights nothing
};

// Rays of a camera, perspective or orthographic. (u, v) runs over [0, 1]^2 from the lower left corner of the image:
// the ray starts on the near plane at near[0] + u near[1] + v near[2], and its unnormalised direction, which is affine
// in (u, v) too, ends on the far plane: far[0] + u far[1] + v far[2].
struct Camera {
    std::array<glm::vec3, 3> near;
    std::array<glm::vec3, 3> far;
};

} // namespace sfumato
