// SPDX-License-Identifier: GPL-3.0-or-later
// Closed shapes, whose corners run counterclockwise, seen from outside.
#pragma once

#include "scene/scene.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include <glm/vec3.hpp>

namespace sfumato::reference::testing {

// A box, added to a shape.
inline void add_box(Shape &shape, const glm::vec3 &low, const glm::vec3 &high) {
    const auto first = static_cast<unsigned>(shape.vertices.size());
    for (unsigned i = 0; i < 8; ++i) {
        shape.vertices.emplace_back((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y,
                                    (i & 4U) != 0 ? high.z : low.z);
    }
    constexpr std::array<std::array<unsigned, 4>, 6> FACES = {
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto &[a, b, c, d] : FACES) {
        shape.triangles.emplace_back(first + a, first + b, first + c);
        shape.triangles.emplace_back(first + a, first + c, first + d);
    }
}

inline std::shared_ptr<Shape> box_shape(const glm::vec3 &low, const glm::vec3 &high) {
    auto shape = std::make_shared<Shape>();
    add_box(*shape, low, high);
    return shape;
}

// Around the z axis.
inline std::shared_ptr<Shape> torus_shape(float radius, float thickness, unsigned around, unsigned across) {
    auto shape = std::make_shared<Shape>();
    for (unsigned i = 0; i < around; ++i) {
        for (unsigned j = 0; j < across; ++j) {
            const float u = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(around);
            const float v = 2.0F * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(across);
            const float out = radius + thickness * std::cos(v);
            shape->vertices.emplace_back(out * std::cos(u), out * std::sin(u), thickness * std::sin(v));
            const unsigned next = (i + 1) % around, up = (j + 1) % across;
            const unsigned a = i * across + j, b = next * across + j, c = next * across + up, d = i * across + up;
            shape->triangles.emplace_back(a, b, c);
            shape->triangles.emplace_back(a, c, d);
        }
    }
    return shape;
}

} // namespace sfumato::reference::testing
