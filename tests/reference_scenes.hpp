// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes whose light is known in closed form.
#pragma once

#include "reference.hpp"

#include <cstddef>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

namespace sfumato::reference::testing {

inline Medium uniform_medium(const glm::uvec3 &resolution, float density, const glm::mat4 &grid_to_world) {
    Medium medium;
    medium.resolution = resolution;
    medium.density.assign(std::size_t{resolution.x} * resolution.y * resolution.z, density);
    medium.grid_to_world = grid_to_world;
    return medium;
}

// Every cell independently, between 0 and 1: the roughest smoke that a grid can hold.
inline Medium random_medium(const glm::uvec3 &resolution, const glm::mat4 &grid_to_world, unsigned seed) {
    Medium medium = uniform_medium(resolution, 0.0F, grid_to_world);
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    for (float &density : medium.density) {
        density = uniform(generator);
    }
    return medium;
}

// Turned, stretched and moved, with no axis left in its place.
inline glm::mat4 oblique_grid() {
    glm::mat4 matrix = glm::translate(glm::mat4(1.0F), glm::vec3(0.3F, -1.2F, 0.7F));
    matrix = glm::rotate(matrix, 0.9F, glm::normalize(glm::vec3(1.0F, 2.0F, 3.0F)));
    return glm::scale(matrix, glm::vec3(0.11F, 0.17F, 0.23F));
}

// A parallelogram from `corner` along two edges; its normal is the normalised cross product of the edges.
inline Mesh parallelogram(const glm::vec3 &corner, const glm::vec3 &edge1, const glm::vec3 &edge2,
                          const glm::vec3 &albedo) {
    const glm::vec3 normal = glm::normalize(glm::cross(edge1, edge2));
    Mesh mesh;
    mesh.vertices = {corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.corner_normals = {{normal, normal, normal}, {normal, normal, normal}};
    mesh.material = {0, 0};
    mesh.albedo = {albedo};
    return mesh;
}

// Looks straight down on the square of the given size around the origin, from z = 5 to z = -5. Up in the image is +y.
inline Camera camera_from_above(float size) {
    const glm::vec3 u(size, 0.0F, 0.0F);
    const glm::vec3 v(0.0F, size, 0.0F);
    const glm::vec3 lower_left(-0.5F * size, -0.5F * size, 0.0F);
    return {{lower_left + glm::vec3(0.0F, 0.0F, 5.0F), u, v}, {lower_left - glm::vec3(0.0F, 0.0F, 5.0F), u, v}};
}

} // namespace sfumato::reference::testing
