// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of particles against what their definition fixes.
#include "reference/reference.hpp"
#include "support/particle_clouds.hpp"
#include "support/reference_scenes.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using testing::camera_at;
using testing::plume;
using testing::puff_at;
using testing::sun_light;

TEST(Particles, OneLetsThroughWhatItsOpacityLeavesAndLessOfItBesideItsMiddle) {
    const Particles puff = puff_at({1.0F, 2.0F, 3.0F}, 0.5F, 0.75F);
    for (const double q : {0.0, 0.3, 0.7, 0.99, 1.0, 2.0}) {
        const glm::dvec3 beside(1.0 + 0.5 * q, 2.0, 3.0);
        const glm::dvec3 along = glm::dvec3(0.0, 0.8, 0.6);
        const double left = transmittance(puff, beside - 4.0 * along, beside + 5.0 * along).x;
        // The column through a ball of density 1 - r^2, beside its middle.
        const double column = std::pow(std::max(1.0 - q * q, 0.0), 1.5);
        EXPECT_NEAR(left, std::pow(0.25, column), 1e-7) << q;
    }
}

TEST(Particles, DepthsAddAlongARayAndOverParticles) {
    Particles cloud = plume(40, 1);
    cloud.extinction = {1.0F, 0.5F, 0.25F};
    const glm::dvec3 from(-0.4, -0.5, 0.2), to(0.3, 0.6, 0.9), middle = 0.3 * from + 0.7 * to;
    const glm::dvec3 whole = optical_depth(cloud, from, to);
    EXPECT_GT(whole.x, 0.05);
    EXPECT_NEAR(optical_depth(cloud, from, middle).x + optical_depth(cloud, middle, to).x, whole.x, 1e-12);
    EXPECT_NEAR(whole.y, 0.5 * whole.x, 1e-12);
    EXPECT_NEAR(whole.z, 0.25 * whole.x, 1e-12);
    double sum = 0.0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        sum += optical_depth(puff_at(cloud.points[i], cloud.radius[i], cloud.opacity[i]), from, to).x;
    }
    EXPECT_NEAR(sum, whole.x, 1e-12);
    // By brute force.
    double steps = 0.0;
    constexpr int COUNT = 20000;
    for (int k = 0; k < COUNT; ++k) {
        for (std::size_t i = 0; i < cloud.points.size(); ++i) {
            steps += extinction(cloud, i, from + (to - from) * ((k + 0.5) / COUNT)) * glm::distance(from, to) / COUNT;
        }
    }
    EXPECT_NEAR(steps, whole.x, 1e-6);
}

// A thin puff in the light of a sun sends albedo p E tau, and a thick one with light from behind the eye the closed
// form of Chandrasekhar's for a cosine of 1 on both sides.
TEST(Particles, OneScattersAsTheClosedFormSays) {
    Scene scene;
    scene.lights = {sun_light({0.0F, 1.0F, 0.0F}, {4.0F, 4.0F, 4.0F})};
    const Camera eye = camera_at({0.0F, -3.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 1.0F);
    for (const float opacity : {0.01F, 0.9F}) {
        scene.particles = {puff_at({0.0F, 0.0F, 0.0F}, 0.5F, opacity)};
        const glm::dvec4 pixel = render(scene, eye, 1, 1, {}).at(0);
        const double tau = -std::log(1.0 - double{opacity}), phase = 0.25 / std::numbers::pi;
        EXPECT_NEAR(pixel.x, 0.8 * phase * 4.0 * 0.5 * (1.0 - std::exp(-2.0 * tau)), 1e-5);
        EXPECT_NEAR(pixel.w, double{opacity}, 1e-6);
    }
}

} // namespace
} // namespace sfumato::reference
