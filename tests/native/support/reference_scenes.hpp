// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes whose light is known in closed form.
#pragma once

#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

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

// A ball of smoke in the middle of its grid: cos^2 of the distance from the middle, with waves, and nothing at the
// faces.
inline Medium smooth_medium(const glm::uvec3 &resolution, const glm::mat4 &grid_to_world) {
    Medium medium = uniform_medium(resolution, 0.0F, grid_to_world);
    std::size_t cell = 0;
    for (unsigned k = 0; k < resolution.z; ++k) {
        for (unsigned j = 0; j < resolution.y; ++j) {
            for (unsigned i = 0; i < resolution.x; ++i) {
                const glm::vec3 p = (glm::vec3(i, j, k) + 0.5F) / glm::vec3(resolution) * 2.0F - 1.0F;
                const float inside = std::cos(0.5F * std::numbers::pi_v<float> * std::min(glm::length(p), 1.0F));
                const float waves = 1.0F + 0.5F * std::sin(7.0F * p.x + 3.0F * p.y) * std::cos(5.0F * p.z - 2.0F * p.x);
                medium.density[cell++] = inside * inside * waves;
            }
        }
    }
    return medium;
}

inline Light sun_light(const glm::vec3 &direction, const glm::vec3 &irradiance, float angle = 0.0F) {
    Light light;
    light.strength = irradiance;
    light.direction = direction;
    light.angle = angle;
    return light;
}

inline Light point_light(const glm::vec3 &position, const glm::vec3 &intensity, float radius = 0.0F) {
    Light light;
    light.kind = Light::Kind::SPHERE;
    light.strength = intensity;
    light.position = position;
    light.radius = radius;
    return light;
}

// A rectangle or an ellipse that shines along -cross(across, up).
inline Light area_light(Light::Kind kind, const glm::vec3 &position, const glm::vec3 &across, const glm::vec3 &up,
                        const glm::vec3 &radiance) {
    Light light;
    light.kind = kind;
    light.strength = radiance;
    light.position = position;
    light.across = across;
    light.up = up;
    light.direction = -glm::normalize(glm::cross(across, up));
    return light;
}

// A part of a mesh that glows: a polygon in the rectangle of another light, its corners in half axes.
inline Light polygon_in(const Light &rectangle, const std::array<glm::vec2, 4> &corners) {
    Light light;
    light.kind = Light::Kind::POLYGON;
    light.strength = rectangle.strength;
    for (std::size_t i = 0; i < 4; ++i) {
        light.corners[i] = rectangle.position + corners[i].x * rectangle.across + corners[i].y * rectangle.up;
    }
    return light;
}

constexpr std::array<glm::vec2, 4> WHOLE = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
constexpr std::array<glm::vec2, 4> KITE = {{{-1.0F, 0.1F}, {0.3F, -1.0F}, {1.0F, 0.6F}, {-0.2F, 1.0F}}};
constexpr std::array<glm::vec2, 4> TRIANGLE = {{{-1, -1}, {1, -0.5F}, {0.2F, 1}, {0.2F, 1}}};

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

// A perspective camera at `eye` that looks at `target` with a field of view of 40 degrees from bottom to top.
inline Camera camera_at(const glm::vec3 &eye, const glm::vec3 &target, float aspect) {
    const glm::vec3 forward = glm::normalize(target - eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0.0F, 0.0F, 1.0F)));
    const glm::vec3 up = glm::cross(right, forward);
    const float half = std::tan(glm::radians(20.0F));
    const auto plane = [&](float distance) -> std::array<glm::vec3, 3> {
        const glm::vec3 u = right * (half * aspect * distance), v = up * (half * distance);
        return {eye + forward * distance - u - v, 2.0F * u, 2.0F * v};
    };
    return {plane(0.1F), plane(100.0F)};
}

} // namespace sfumato::reference::testing
