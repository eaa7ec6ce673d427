// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/light_map.hpp"
#include "maps/map_kernels.hpp"
#include "solids/surfaces.hpp"
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::oblique_grid;
using reference::testing::parallelogram;
using reference::testing::random_medium;
using reference::testing::smooth_medium;
using reference::testing::uniform_medium;

// The ways that the light travels.
const glm::dvec3 along = glm::normalize(glm::dvec3(0.5, -0.3, -1.0));
const glm::dvec3 down(0.0, 0.0, -1.0);

LightMap map_of(const Medium &medium, int coefficients, double texels_per_cell) {
    return build_parallel_map(crop(medium), along, {coefficients, texels_per_cell});
}

// What the map says of points that it knows as (x, y, z), and what the reference says.
struct Compared {
    std::vector<float> map;
    std::vector<double> exact;

    [[nodiscard]] double error() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < map.size(); ++i) {
            sum += std::pow(double{map[i]} - exact[i], 2);
        }
        return std::sqrt(sum / double(map.size()));
    }
    [[nodiscard]] double largest() const { return *std::max_element(exact.begin(), exact.end()); }
};

Compared compare(const LightMap &map, const Medium &medium, const std::vector<glm::dvec3> &points) {
    const glm::dmat4 to_world = glm::inverse(map.world_to_light);
    std::vector<float> world;
    Compared compared;
    for (const glm::dvec3 &p : points) {
        const glm::vec3 at(to_world * glm::dvec4(p, 1.0));
        world.insert(world.end(), {at.x, at.y, at.z});
        compared.exact.push_back(reference::column(medium, glm::dvec3(at) - 100.0 * along, at));
    }
    compared.map.resize(points.size());
    map.look_up(world, compared.map);
    return compared;
}

std::vector<glm::dvec3> random_points(double low, double high) {
    std::mt19937 generator(31);
    std::uniform_real_distribution<double> across(0.0, 1.0), depth(low, high);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 1000; ++i) {
        const double x = across(generator), y = across(generator);
        points.emplace_back(x, y, depth(generator));
    }
    return points;
}

// Beyond the smoke nothing depends on the harmonics. At a texel's centre all that is left is the sum over slices.
TEST(LightMap, HasTheWholeColumnBeyondTheSmoke) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    const LightMap map = map_of(medium, 7, 1.0);
    std::vector<glm::dvec3> centres;
    for (int y = 0; y < map.size.y; ++y) {
        for (int x = 0; x < map.size.x; ++x) {
            centres.emplace_back((x + 0.5) / map.size.x, (y + 0.5) / map.size.y, (x + y) % 2 == 0 ? 1.0 : 3.0);
        }
    }
    const Compared compared = compare(map, medium, centres);
    EXPECT_LT(compared.error(), 2e-4 * compared.largest());
    EXPECT_GT(compared.largest(), 0.5);
}

// Between texels, bilinear interpolation's error falls fourfold when the texels are halved.
TEST(LightMap, ConvergesToTheSecondOrderAcrossTheLight) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    double last = 0.0;
    for (const double texels_per_cell : {0.5, 1.0, 2.0}) {
        const Compared compared = compare(map_of(medium, 1, texels_per_cell), medium, random_points(1.0, 2.0));
        if (last > 0.0) {
            EXPECT_NEAR(last / compared.error(), 4.0, 1.2) << texels_per_cell;
        }
        last = compared.error();
    }
    EXPECT_LT(last, 0.01);
}

TEST(LightMap, ConvergesAlongTheLightAsCoefficientsGrow) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    double last = 1.0, first = 0.0;
    for (const int coefficients : {1, 3, 7, 15}) {
        const Compared compared = compare(map_of(medium, coefficients, 2.0), medium, random_points(0.0, 1.0));
        const double error = compared.error() / compared.largest();
        EXPECT_LT(error, last) << coefficients;
        first = first > 0.0 ? first : error;
        last = error;
    }
    EXPECT_LT(last, 0.001);
    EXPECT_GT(first, 0.01); // the constant alone knows nothing of depth but the range
}

// Cells of noise, the roughest there are: nothing converges quickly, but nothing is biased either.
TEST(LightMap, OfNoiseIsRightOnAverage) {
    const Medium medium = random_medium({12, 14, 16}, oblique_grid(), 32);
    const Compared compared = compare(map_of(medium, 31, 2.0), medium, random_points(0.0, 1.0));
    double bias = 0.0;
    for (std::size_t i = 0; i < compared.map.size(); ++i) {
        bias += (double{compared.map[i]} - compared.exact[i]) / double(compared.map.size());
    }
    EXPECT_LT(compared.error(), 0.02 * compared.largest());
    EXPECT_LT(std::abs(bias), 0.003 * compared.largest());
}

TEST(LightMap, HasNoSmokeBeforeTheSmokeOrBesideIt) {
    const Medium medium = random_medium({12, 14, 16}, oblique_grid(), 33);
    for (const double texels_per_cell : {0.25, 1.0}) {
        const LightMap map = map_of(medium, 15, texels_per_cell);
        std::vector<glm::dvec3> points;
        for (const glm::dvec3 &p : random_points(0.0, 1.0)) {
            points.emplace_back(p.x, p.y, -p.z);      // before
            points.emplace_back(p.x + 1.0, p.y, p.z); // beside
            points.emplace_back(p.x, p.y - 1.0, p.z); // beside
            points.emplace_back(p.x, -50.0, 5.0);     // far away
        }
        const Compared compared = compare(map, medium, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_EQ(compared.map[i], 0.0F);
            EXPECT_EQ(compared.exact[i], 0.0);
        }
    }
}

// However coarse the map, its outermost texels are empty: they answer for the rest of the world.
TEST(LightMap, OfFewTexelsEndsAtTheSmokeToo) {
    const Medium medium = uniform_medium({6, 6, 4}, 1.0F, glm::mat4(1.0F));
    const LightMap map = build_parallel_map(crop(medium), down, {3, 0.25});
    for (const glm::vec3 &point : {glm::vec3(-50, 3, -1), glm::vec3(50, 3, -1), glm::vec3(3, -50, -1)}) {
        float column = -1.0F;
        map.look_up({&point.x, 3}, {&column, 1});
        EXPECT_EQ(column, 0.0F);
    }
}

// Few slices and many harmonics: smoke that is even along the light must not fall apart into the slices.
TEST(LightMap, OfEvenSmokeRisesEvenly) {
    const Medium medium = uniform_medium({6, 6, 4}, 1.0F, glm::mat4(1.0F));
    const LightMap map = build_parallel_map(crop(medium), down, {63, 1.0});
    for (float depth = 0.5F; depth <= 3.5F; depth += 0.05F) {
        const glm::vec3 point(3.0F, 3.0F, 4.0F - depth);
        float column = 0.0F;
        map.look_up({&point.x, 3}, {&column, 1});
        EXPECT_NEAR(column, depth, 0.03) << depth;
    }
}

// Seen from the sun, all smoke is there: columns times area are the integral of the density over space.
TEST(LightMap, HoldsTheMassOfTheSmoke) {
    for (const Medium &medium :
         {smooth_medium({16, 18, 20}, oblique_grid()), random_medium({12, 14, 16}, oblique_grid(), 34)}) {
        double expected = 0.0;
        for (const float value : medium.density) {
            expected += double{value} * std::abs(glm::determinant(glm::dmat4(medium.grid_to_world)));
        }
        for (const double texels_per_cell : {0.7, 1.0, 2.0}) {
            const LightMap map = map_of(medium, 3, texels_per_cell);
            const double texel = 0.11 / texels_per_cell; // the shortest edge of oblique_grid()
            double sum = 0.0;
            const auto stride = static_cast<std::size_t>(map.view().stride());
            for (std::size_t at = 0; at < map.coefficients.size(); at += stride) {
                sum += double{map.coefficients[at]} * texel * texel;
            }
            EXPECT_NEAR(sum, expected, 0.005 * expected) << texels_per_cell;
        }
    }
}

TEST(LightMap, TakesAnySun) {
    const Medium medium = uniform_medium({4, 4, 4}, 1.0F, glm::mat4(1.0F));
    for (const glm::vec3 &direction : {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0),
                                       glm::vec3(0.1F, -0.2F, 0.95F)}) {
        const glm::dvec3 any = glm::normalize(glm::dvec3(direction));
        const glm::dmat3 axes = axes_of(any);
        EXPECT_NEAR(glm::determinant(axes), 1.0, 1e-12); // right-handed, and so of unit length
        EXPECT_NEAR(glm::distance(axes * glm::transpose(axes) * glm::dvec3(1, 2, 3), glm::dvec3(1, 2, 3)), 0.0, 1e-12);
        EXPECT_NEAR(glm::distance(axes[2], any), 0.0, 1e-6);
        const LightMap map = build_parallel_map(crop(medium), any, {31, 2.0});
        const glm::vec3 points[] = {glm::vec3(2.0F), glm::vec3(2.0F) + 9.0F * glm::vec3(any)};
        float columns[2];
        map.look_up({&points[0].x, 6}, columns);
        EXPECT_NEAR(columns[0], 0.5F * columns[1], 0.01);
        const double whole = reference::column(medium, glm::dvec3(2.0) - 9.0 * any, glm::dvec3(2.0) + 9.0 * any);
        EXPECT_NEAR(columns[1], whole, 0.01 * whole);
    }
}

// Two and a half million texels of 65 floats are asked for.
TEST(LightMap, StaysWithinItsMemory) {
    const Medium medium = uniform_medium({200, 200, 2}, 1.0F, glm::mat4(1.0F));
    const LightMap map = build_parallel_map(crop(medium), down, {63, 8.0});
    EXPECT_LT(map.coefficients.size(), 69'000'000U);
    EXPECT_GT(map.coefficients.size(), 65'000'000U);
    const glm::vec3 below(100.0F, 100.0F, -1.0F);
    float column = 0.0F;
    map.look_up({&below.x, 3}, {&column, 1});
    EXPECT_NEAR(column, 2.0, 1e-3);
}

// Cells as thin as paper, seen from their flat side: the texels need not be as narrow as the cells are thin.
TEST(LightMap, OfThinCellsHasNoMoreTexelsThanTheyShow) {
    const glm::mat4 thin = glm::scale(glm::mat4(1.0F), glm::vec3(1.0F, 1.0F, 1e-3F));
    const Medium medium = uniform_medium({40, 40, 4}, 1.0F, thin);
    const LightMap map = build_parallel_map(crop(medium), down, {3, 1.0});
    EXPECT_LT(map.texels(), 40'000U);
    const glm::vec3 below(20.0F, 20.0F, -1.0F);
    float column = 0.0F;
    map.look_up({&below.x, 3}, {&column, 1});
    EXPECT_NEAR(column, 0.004, 1e-5);
}

// At texel centres the look-up is the series: total d + sum c_k sin(k pi d), within the ray's range and its total.
TEST(LightMap, LooksUpTheSeriesOnEveryInstructionSet) {
    constexpr int SIDE = 5, COUNT = 15, HEAD = 3, STRIDE = HEAD + COUNT - 1;
    std::mt19937 generator(5);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    std::vector<float> texels;
    for (int texel = 0; texel < SIDE * SIDE; ++texel) {
        texels.insert(texels.end(), {1.0F + uniform(generator), 0.4F * uniform(generator), 1.2F + uniform(generator)});
        for (int k = 1; k < COUNT; ++k) {
            texels.push_back((uniform(generator) - 0.5F) / float(k * k));
        }
    }
    std::vector<float> points;
    std::vector<double> expected;
    for (int i = 0; i < 203; ++i) { // no multiple of any number of lanes
        const int texel = (i * 7) % (SIDE * SIDE);
        const float z = 1.2F * float(i) / 202.0F - 0.1F;
        points.insert(points.end(), {(float(texel % SIDE) + 0.5F) / SIDE, (float(texel / SIDE) + 0.5F) / SIDE, z});
        const float *series = texels.data() + texel * STRIDE;
        const double d = std::clamp((double{z} - double{series[1]}) * double{series[2]}, 0.0, 1.0);
        double sum = double{series[0]} * d;
        for (int k = 1; k < COUNT; ++k) {
            sum += double{series[HEAD + k - 1]} * std::sin(k * std::numbers::pi * d);
        }
        expected.push_back(std::clamp(sum, 0.0, double{series[0]}));
    }
    LightMapView map;
    map.coefficients = texels.data();
    map.count = COUNT;
    map.width = map.height = SIDE;
    map.world_to_light = affine(glm::dmat4(1.0));
    for (const InstructionSet &set : instruction_sets()) {
        std::vector<float> columns(203, -1.0F);
        map_kernels(set).look_up(map, points.data(), columns.data(), 203, 0);
        for (std::size_t i = 0; i < 203; ++i) {
            EXPECT_NEAR(columns[i], expected[i], 1e-5) << set.name << ", point " << i;
        }
    }
}

TEST(Kernels, BuildTheSameMaps) {
    const Medium medium = random_medium({12, 14, 16}, oblique_grid(), 35);
    const LightMap map = map_of(medium, 31, 2.0);
    for (const InstructionSet &set : instruction_sets()) {
        const LightMap other = build_parallel_map(crop(medium), along, {31, 2.0}, set);
        ASSERT_EQ(other.coefficients.size(), map.coefficients.size());
        for (std::size_t i = 0; i < map.coefficients.size(); ++i) {
            EXPECT_NEAR(other.coefficients[i], map.coefficients[i], 1e-5) << set.name;
        }
    }
}

} // namespace
} // namespace sfumato
