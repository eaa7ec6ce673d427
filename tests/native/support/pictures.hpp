// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures, by a frame and by the reference, and how far they are apart.
#pragma once

#include "frame/frame.hpp"
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {

constexpr int WIDTH = 32, HEIGHT = 18;
inline const Camera camera = reference::testing::camera_at({2.5F, -4.5F, 2.2F}, {0.0F, 0.0F, 0.75F}, 16.0F / 9.0F);
inline const FrameSettings finest{63, 2.0, 4.0};

// An upright box without its bottom.
inline std::vector<Mesh> block(const glm::vec3 &corner, const glm::vec3 &size, const glm::vec3 &albedo) {
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    return {reference::testing::parallelogram(corner + z, x, y, albedo),
            reference::testing::parallelogram(corner, x, z, albedo),
            reference::testing::parallelogram(corner + y, z, x, albedo),
            reference::testing::parallelogram(corner, z, y, albedo),
            reference::testing::parallelogram(corner + x, y, z, albedo)};
}

// Waves of smoke over a floor. The smoke is 1.6 m across, its densest parts let through a tenth of the light.
inline Scene smoke_over_floor() {
    const glm::mat4 grid_to_world =
        glm::scale(glm::translate(glm::mat4(1.0F), glm::vec3(-0.8F, -0.8F, 0.2F)), glm::vec3(0.05F));
    Scene scene;
    scene.meshes = {reference::testing::parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, {0.8F, 0.6F, 0.4F})};
    scene.media = {reference::testing::smooth_medium({32, 32, 32}, grid_to_world)};
    scene.media[0].scattering = glm::vec3(2.0F);
    scene.media[0].absorption = glm::vec3(0.5F);
    scene.media[0].anisotropy = 0.3F;
    scene.lights = {reference::testing::sun_light(glm::normalize(glm::vec3(0.5F, 0.4F, -1.0F)), {4.0F, 3.5F, 3.0F})};
    scene.background = {0.1F, 0.2F, 0.4F};
    return scene;
}

inline Scene smoke_over_floor_and_block() {
    Scene scene = smoke_over_floor();
    for (const Mesh &side : block({-1.5F, -1.3F, 0.0F}, {0.7F, 0.7F, 2.0F}, {0.3F, 0.5F, 0.7F})) {
        scene.meshes.push_back(side);
    }
    return scene;
}

inline std::vector<float> render(const Scene &scene, const FrameSettings &settings = finest, int edge_samples = 1,
                                 const Camera &from = camera, const InstructionSet &with = instruction_set()) {
    return Frame(scene, settings, with).render(from, WIDTH, HEIGHT, edge_samples, {}).value();
}

inline std::vector<glm::dvec4> exact(const Scene &scene, const Camera &from = camera) {
    return reference::render(scene, from, WIDTH, HEIGHT, {8, 0.01});
}

// Root mean square difference of RGB, over the root mean square of the exact picture's; alpha must be as good.
inline double error(const std::vector<float> &image, const std::vector<glm::dvec4> &expected) {
    glm::dvec4 difference(0.0), sum(0.0);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double value = expected[i / 4][int(i % 4)];
        difference[int(i % 4)] += std::pow(double{image[i]} - value, 2);
        sum[int(i % 4)] += value * value;
    }
    const double rgb = std::sqrt((difference.x + difference.y + difference.z) / (sum.x + sum.y + sum.z));
    return std::max(rgb, sum.w > 0.0 ? std::sqrt(difference.w / sum.w) : 0.0);
}

inline double largest_difference(const std::vector<float> &a, const std::vector<float> &b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(double{a[i]} - double{b[i]}));
    }
    return largest;
}

} // namespace sfumato
