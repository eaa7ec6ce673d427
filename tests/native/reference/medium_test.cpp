// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_scenes.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <glm/exponential.hpp>
#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using namespace testing;

glm::dvec3 world(const Medium &medium, const glm::dvec3 &grid) {
    return glm::dvec3(glm::dmat4(medium.grid_to_world) * glm::dvec4(grid, 1.0));
}

// Points in and around a grid, in grid space.
class Points {
public:
    Points(const Medium &medium, unsigned seed) : medium_(medium), generator_(seed) {}

    glm::dvec3 next() {
        std::uniform_real_distribution<double> uniform(-0.3, 1.3);
        const glm::dvec3 size(medium_.resolution);
        const double x = uniform(generator_);
        const double y = uniform(generator_);
        const double z = uniform(generator_);
        return world(medium_, size * glm::dvec3(x, y, z));
    }

private:
    const Medium &medium_;
    std::mt19937 generator_;
};

TEST(Density, IsTheSampleAtACellCentreAndTheMeanBetweenTwo) {
    const Medium medium = random_medium({3, 4, 5}, oblique_grid(), 1);
    const auto sample = [&](unsigned i, unsigned j, unsigned k) { return double{medium.density[(k * 4 + j) * 3 + i]}; };
    EXPECT_NEAR(density(medium, world(medium, {1.5, 2.5, 3.5})), sample(1, 2, 3), 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {1.0, 2.5, 3.5})), 0.5 * (sample(0, 2, 3) + sample(1, 2, 3)), 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {1.5, 2.0, 3.5})), 0.5 * (sample(1, 1, 3) + sample(1, 2, 3)), 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {1.5, 2.5, 3.25})), 0.25 * sample(1, 2, 2) + 0.75 * sample(1, 2, 3),
                1e-12);
}

TEST(Density, FadesToZeroAcrossTheFacesOfTheGrid) {
    const Medium medium = uniform_medium({4, 4, 4}, 2.0F, oblique_grid());
    EXPECT_NEAR(density(medium, world(medium, {0.5, 2.0, 2.0})), 2.0, 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {0.0, 2.0, 2.0})), 1.0, 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {2.0, 4.25, 2.0})), 0.5, 1e-12);
    EXPECT_NEAR(density(medium, world(medium, {4.0, 4.0, 2.0})), 0.5, 1e-12); // an edge: half of a half
    EXPECT_EQ(density(medium, world(medium, {-0.51, 2.0, 2.0})), 0.0);
    EXPECT_EQ(density(medium, world(medium, {2.0, 2.0, 4.51})), 0.0);
    EXPECT_EQ(density(medium, world(medium, {1e6, 0.0, 0.0})), 0.0);
}

TEST(Column, OfConstantDensityIsLengthTimesDensity) {
    const Medium medium = uniform_medium({6, 7, 8}, 1.7F, oblique_grid());
    const glm::dvec3 from = world(medium, {0.6, 6.3, 1.1});
    const glm::dvec3 to = world(medium, {5.4, 0.7, 7.2});
    EXPECT_NEAR(column(medium, from, to), double{1.7F} * glm::distance(from, to), 1e-12);
}

// What is lost to the fade inside a face is found again outside it.
TEST(Column, AcrossAUniformGridIsItsThicknessTimesItsDensity) {
    const Medium medium = uniform_medium({6, 7, 8}, 1.7F, oblique_grid());
    const glm::dvec3 from = world(medium, {2.2, -100.0, 3.9});
    const glm::dvec3 to = world(medium, {2.2, 100.0, 3.9});
    const double thickness = glm::distance(world(medium, {0, 0, 0}), world(medium, {0, 7, 0}));
    EXPECT_NEAR(column(medium, from, to), double{1.7F} * thickness, 1e-12);
}

TEST(Column, IsZeroBesideTheGridAndAlongNothing) {
    const Medium medium = uniform_medium({4, 4, 4}, 1.0F, oblique_grid());
    EXPECT_EQ(column(medium, world(medium, {-9, 4.6, 2}), world(medium, {9, 4.6, 2})), 0.0);
    EXPECT_EQ(column(medium, world(medium, {5, 2, 2}), world(medium, {9, 2, 2})), 0.0);
    EXPECT_EQ(column(medium, world(medium, {2, 2, 2}), world(medium, {2, 2, 2})), 0.0);
}

// The density x y z is trilinear, so the grid holds it exactly. Along (t, t, t) it is t^3, the most that two points of
// Gauss and Legendre's rule can do.
TEST(Column, OfAProductOfRampsIsTheClosedForm) {
    Medium medium = uniform_medium({5, 5, 5}, 0.0F, glm::mat4(1.0F));
    for (unsigned k = 0; k < 5; ++k) {
        for (unsigned j = 0; j < 5; ++j) {
            for (unsigned i = 0; i < 5; ++i) {
                medium.density[(k * 5 + j) * 5 + i] = (float(i) + 0.5F) * (float(j) + 0.5F) * (float(k) + 0.5F);
            }
        }
    }
    const double cubic = std::numbers::sqrt3 * (std::pow(4.3, 4) - std::pow(0.7, 4)) / 4.0;
    EXPECT_NEAR(column(medium, glm::dvec3(0.7), glm::dvec3(4.3)), cubic, 1e-11);
    const double linear = 2.5 * 1.25 * (4.3 * 4.3 - 0.7 * 0.7) / 2.0;
    EXPECT_NEAR(column(medium, {0.7, 2.5, 1.25}, {4.3, 2.5, 1.25}), linear, 1e-11);
}

TEST(Column, IsTheLimitOfTheMidpointSum) {
    const Medium medium = random_medium({6, 5, 7}, oblique_grid(), 2);
    Points points(medium, 3);
    for (int segment = 0; segment < 8; ++segment) {
        const glm::dvec3 from = points.next();
        const glm::dvec3 to = points.next();
        const int count = 100'000;
        double sum = 0.0;
        for (int i = 0; i < count; ++i) {
            sum += density(medium, from + (to - from) * ((i + 0.5) / count));
        }
        EXPECT_NEAR(column(medium, from, to), sum / count * glm::distance(from, to), 1e-6);
    }
}

TEST(Column, AddsUpAndRunsBothWays) {
    const Medium medium = random_medium({6, 5, 7}, oblique_grid(), 4);
    Points points(medium, 5);
    for (int segment = 0; segment < 100; ++segment) {
        const glm::dvec3 from = points.next();
        const glm::dvec3 to = points.next();
        const glm::dvec3 between = from + (to - from) * (segment / 99.0);
        const double whole = column(medium, from, to);
        EXPECT_NEAR(column(medium, from, between) + column(medium, between, to), whole, 1e-12);
        EXPECT_NEAR(column(medium, to, from), whole, 1e-12);
    }
}

// Turning and moving the smoke with the segment changes nothing; making both twice as large doubles the way.
TEST(Column, FollowsTheGridThroughTheWorld) {
    const Medium medium = random_medium({6, 5, 7}, glm::mat4(1.0F), 6);
    Medium moved = medium;
    moved.grid_to_world = glm::translate(glm::mat4(1.0F), glm::vec3(3.0F, -4.0F, 5.0F)) *
                          glm::rotate(glm::mat4(1.0F), 2.1F, glm::normalize(glm::vec3(-1.0F, 1.0F, 0.4F))) *
                          glm::scale(glm::mat4(1.0F), glm::vec3(2.0F));
    const glm::dvec3 from(-0.4, 1.3, 6.9);
    const glm::dvec3 to(6.2, 3.9, 0.2);
    // Single precision in the rotation leaves lengths off by parts in 1e7.
    EXPECT_NEAR(column(moved, world(moved, from), world(moved, to)), 2.0 * column(medium, from, to), 1e-6);
    EXPECT_GT(column(medium, from, to), 1.0);
}

TEST(Transmittance, IsBeerAndLambertForEachColour) {
    Medium medium = uniform_medium({4, 4, 4}, 2.0F, glm::mat4(1.0F));
    medium.scattering = {0.5F, 0.25F, 0.0F};
    medium.absorption = {0.0F, 0.5F, 0.125F};
    const glm::dvec3 expected = glm::exp(-glm::dvec3(0.5, 0.75, 0.125) * 8.0);
    const glm::dvec3 between = transmittance(medium, {2, 2, -3}, {2, 2, 9});
    const glm::dvec3 endless = transmittance_to_infinity(medium, {2, 2, 70}, {0, 0, -1});
    for (int colour = 0; colour < 3; ++colour) {
        EXPECT_NEAR(between[colour], expected[colour], 1e-12);
        EXPECT_NEAR(endless[colour], expected[colour], 1e-12);
    }
    EXPECT_EQ(transmittance_to_infinity(medium, {2, 2, 70}, {0, 0, 1}), glm::dvec3(1.0));
}

TEST(Transmittance, OfFragmentsIsTheProductUpToADepth) {
    const std::array<Fragment, 3> fragments{{{0.7, 0.5}, {0.2, 0.25}, {0.4, 0.1}}};
    EXPECT_EQ(transmittance(fragments, 0.1), 1.0);
    EXPECT_NEAR(transmittance(fragments, 0.2), 0.75, 1e-15); // a fragment counts at its own depth
    EXPECT_NEAR(transmittance(fragments, 0.5), 0.75 * 0.9, 1e-15);
    EXPECT_NEAR(transmittance(fragments, 1.0), 0.75 * 0.9 * 0.5, 1e-15);
}

TEST(HenyeyGreenstein, IsNormalisedAndItsMeanCosineIsG) {
    for (const double g : {-0.7, 0.0, 0.3, 0.85}) {
        const int count = 100'000;
        double total = 0.0;
        double mean = 0.0;
        for (int i = 0; i < count; ++i) {
            const double cosine = -1.0 + 2.0 * (i + 0.5) / count;
            const double ring = 2.0 * std::numbers::pi * (2.0 / count) * henyey_greenstein(cosine, g);
            total += ring;
            mean += ring * cosine;
        }
        EXPECT_NEAR(total, 1.0, 1e-6) << "g = " << g;
        EXPECT_NEAR(mean, g, 1e-6) << "g = " << g;
    }
}

} // namespace
} // namespace sfumato::reference
