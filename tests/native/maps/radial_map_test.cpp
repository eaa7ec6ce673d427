// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps around a point, against the reference.
#include "maps/light_map.hpp"
#include "solids/surfaces.hpp"
#include "support/reference_scenes.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

using reference::testing::oblique_grid;
using reference::testing::parallelogram;
using reference::testing::smooth_medium;
using reference::testing::uniform_medium;

// A point given in shares of the medium's grid.
glm::dvec3 in_world(const Medium &medium, const glm::dvec3 &share) {
    return {glm::dmat4(medium.grid_to_world) * glm::dvec4(share * glm::dvec3(medium.resolution), 1.0)};
}

// Where a light can be, in shares of the grid, with the error allowed at 31 coefficients and 2 texels a cell, as a
// share of the largest column. Measured: a third less. Around a light in the smoke the density begins with a jump,
// which a Fourier series follows slowly: the error halves when the coefficients double.
struct Place {
    const char *name;
    glm::dvec3 of_grid;
    double error;
};
constexpr Place OUTSIDE[] = {{"far", {6.0, -5.0, 9.0}, 0.0011},
                             {"beside", {2.0, 0.4, 0.6}, 0.0014},
                             {"by a corner", {-0.2, 1.2, 1.2}, 0.0015},
                             {"by a face", {0.5, 0.5, 1.1}, 0.0024},
                             {"touching", {0.5, 0.0, 0.5}, 0.0044}};
constexpr Place INSIDE[] = {{"off the middle", {0.4, 0.55, 0.6}, 0.0105}, {"in the middle", {0.5, 0.5, 0.5}, 0.0132}};

// All around the smoke, and in it.
std::vector<glm::dvec3> points_around(const Medium &medium) {
    std::mt19937 generator(51);
    std::uniform_real_distribution<double> uniform(-0.5, 1.5);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 2000; ++i) {
        const double x = uniform(generator), y = uniform(generator);
        points.push_back(in_world(medium, {x, y, uniform(generator)}));
    }
    return points;
}

// What the map says of points, and what the reference says.
struct Compared {
    std::vector<float> map;
    std::vector<double> exact;

    // Root mean square, as a share of the largest column.
    [[nodiscard]] double error() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < map.size(); ++i) {
            sum += std::pow(double{map[i]} - exact[i], 2);
        }
        return std::sqrt(sum / double(map.size())) / *std::max_element(exact.begin(), exact.end());
    }
};

Compared compare(const Medium &medium, const glm::dvec3 &light, const LightMapSettings &settings,
                 const std::vector<glm::dvec3> &points) {
    std::vector<float> world;
    Compared compared;
    for (const glm::dvec3 &point : points) {
        const glm::vec3 at(point);
        world.insert(world.end(), {at.x, at.y, at.z});
        compared.exact.push_back(reference::column(medium, light, at));
    }
    compared.map.resize(points.size());
    build_radial_map(crop(medium), light, settings).look_up(world, compared.map);
    return compared;
}

TEST(RadialMap, IsTheColumnToAnyPointFromAnyLight) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    for (const Place &place : OUTSIDE) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        EXPECT_LT(compare(medium, light, {31, 2.0}, points_around(medium)).error(), place.error) << place.name;
    }
    for (const Place &place : INSIDE) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        EXPECT_LT(compare(medium, light, {31, 2.0}, points_around(medium)).error(), place.error) << place.name;
    }
}

TEST(RadialMap, ConvergesAsCoefficientsGrow) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    for (const Place &place : {OUTSIDE[0], OUTSIDE[1], INSIDE[0]}) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        double last = 1.0, first = 0.0;
        for (const int coefficients : {1, 3, 7, 15}) {
            const double error = compare(medium, light, {coefficients, 4.0}, points_around(medium)).error();
            EXPECT_LT(error, std::max(0.6 * last, 0.0015)) << place.name << ", " << coefficients;
            first = first > 0.0 ? first : error;
            last = error;
        }
        EXPECT_GT(first, 0.01) << place.name;
        EXPECT_LT(last, 0.017) << place.name;
    }
}

// The harmonics are spent on the smoke, not on the air before it.
TEST(RadialMap, IsAsGoodFromAfarAsFromNearby) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    for (const double distance : {1.0, 10.0, 100.0}) {
        const glm::dvec3 light = in_world(medium, distance * glm::dvec3(6.0, -5.0, 9.0));
        EXPECT_LT(compare(medium, light, {15, 2.0}, points_around(medium)).error(), 0.0012) << distance;
    }
}

// Bilinear interpolation between directions: the error falls fourfold when the texels are halved.
TEST(RadialMap, ConvergesToTheSecondOrderAroundTheLight) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    for (const Place &place : OUTSIDE) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        std::vector<glm::dvec3> beyond;
        for (const glm::dvec3 &point : points_around(medium)) {
            beyond.push_back(light + 100.0 * glm::normalize(point - light));
        }
        double last = 0.0;
        for (const double texels_per_cell : {0.5, 1.0, 2.0}) {
            const double error = compare(medium, light, {1, texels_per_cell}, beyond).error();
            if (last > 0.0) {
                EXPECT_NEAR(last / error, 4.0, 1.2) << place.name << ", " << texels_per_cell;
            }
            last = error;
        }
        EXPECT_LT(last, 0.01) << place.name;
    }
}

TEST(RadialMap, HasNoSmokeBeforeTheSmokeAndAllOfItBeyond) {
    const Medium medium = smooth_medium({16, 18, 20}, oblique_grid());
    for (const Place &place : {OUTSIDE[0], OUTSIDE[1], OUTSIDE[2]}) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        std::vector<glm::dvec3> before, further, furthest;
        for (const glm::dvec3 &point : points_around(medium)) {
            const glm::dvec3 direction = glm::normalize(point - light);
            before.push_back(light + 0.1 * direction);
            further.push_back(light + 60.0 * direction);
            furthest.push_back(light + 600.0 * direction);
        }
        for (const float column : compare(medium, light, {15, 1.0}, before).map) {
            EXPECT_EQ(column, 0.0F) << place.name;
        }
        const Compared near = compare(medium, light, {15, 1.0}, further),
                       far = compare(medium, light, {15, 1.0}, furthest);
        for (std::size_t i = 0; i < near.map.size(); ++i) {
            EXPECT_NEAR(near.map[i], far.map[i], 1e-3) << place.name; // the places on the map differ by rounding
        }
    }
}

// A map that does not look around at everything answers with its rim for the rest of the world.
TEST(RadialMap, EndsBesideTheSmoke) {
    for (const glm::vec3 &cell : {glm::vec3(0.1F, 0.1F, 1.0F), glm::vec3(1, 1, 0.05F), glm::vec3(1.0F)}) {
        const Medium box = uniform_medium({8, 8, 8}, 1.0F, glm::scale(glm::mat4(1.0F), cell));
        std::mt19937 generator(52);
        std::uniform_real_distribution<double> uniform(-1.0, 2.0);
        int parts = 0;
        for (int i = 0; i < 200; ++i) {
            const double x = uniform(generator), y = uniform(generator);
            const glm::dvec3 light = in_world(box, {x, y, uniform(generator)});
            const LightMap map = build_radial_map(crop(box), light, {1, i % 2 == 0 ? 0.25 : 1.0});
            if (map.high.x - map.low.x == 2.0 || map.high.y - map.low.y == 2.0) {
                continue;
            }
            ++parts;
            for (int v = 0; v < map.size.y; ++v) {
                for (int u = 0; u < map.size.x; ++u) {
                    const bool rim = u == 0 || v == 0 || u == map.size.x - 1 || v == map.size.y - 1;
                    EXPECT_TRUE(!rim ||
                                map.coefficients[std::size_t((v * map.size.x + u) * map.view().stride())] == 0.0F)
                        << i;
                }
            }
        }
        EXPECT_GT(parts, 50);
    }
}

// Cells as thin as paper, seen from their flat side, ask for no more texels than they show.
TEST(RadialMap, OfThinCellsHasNoMoreTexelsThanTheyShow) {
    const Medium medium = uniform_medium({40, 40, 4}, 1.0F, glm::scale(glm::mat4(1.0F), glm::vec3(1.0F, 1.0F, 1e-3F)));
    const glm::dvec3 light(20.0, 20.0, 40.0);
    const LightMap map = build_radial_map(crop(medium), light, {31, 1.0});
    EXPECT_LT(map.texels(), 40'000U);
    const glm::vec3 below(20.0F, 20.0F, -20.0F);
    float column = 0.0F;
    map.look_up({&below.x, 3}, {&column, 1});
    EXPECT_NEAR(column, 0.004, 1e-4);
}

// In front of the smoke, in it and behind it, for lights of all places.
TEST(RadialMap, KnowsTheFirstSolidOnEachOfItsRays) {
    const Medium medium = smooth_medium({8, 9, 10}, oblique_grid());
    for (const Place &place : {OUTSIDE[0], OUTSIDE[2], OUTSIDE[4], INSIDE[0]}) {
        const glm::dvec3 light = in_world(medium, place.of_grid);
        const glm::dvec3 middle = in_world(medium, glm::dvec3(0.5));
        Scene scene;
        for (const double share : {0.3, 0.9, 1.7}) { // of the way to the smoke's middle
            const glm::vec3 at(glm::mix(light, middle, share) - glm::dvec3(0.21, 0.33, 0.13));
            scene.meshes.push_back(parallelogram(at, {0.7F, 0.2F, 0.1F}, {-0.1F, 0.8F, 0.3F}, glm::vec3(0.5F)));
        }
        Solids embree;
        const Surfaces surfaces(scene.meshes, {}, embree);
        const LightMap map = build_radial_map(crop(medium), light, {1, 2.0});
        const SolidDepths solids = find_solids(map, surfaces.view().all);
        ASSERT_EQ(solids.size(), map.texels());
        const glm::dmat3 to_world = glm::transpose(glm::dmat3(map.world_to_light));
        int hits = 0;
        for (std::size_t i = 0; i < map.texels(); ++i) {
            const int x = int(i) % map.size.x, y = int(i) / map.size.x;
            const glm::dvec2 share((x + 0.5) / map.size.x, (y + 0.5) / map.size.y);
            const glm::dvec2 at = glm::mix(glm::dvec2(map.low), glm::dvec2(map.high), share);
            const glm::dvec3 direction =
                to_world * glm::dvec3(LightsText().octahedral_direction({float(at.x), float(at.y)}));
            const auto hit = reference::first_hit(scene, light, glm::normalize(direction), 1e6);
            if (hit) {
                const double depth = (hit->distance - map.low.z) / (map.high.z - map.low.z);
                EXPECT_NEAR(solids[i], depth, 1e-5 * std::max(1.0, std::abs(depth))) << place.name;
                ++hits;
            } else {
                EXPECT_GT(solids[i], 1e30F) << place.name;
            }
        }
        EXPECT_GT(hits, 5) << place.name;
    }
}

TEST(RadialMap, IsTheSameOnEveryInstructionSet) {
    const CroppedMedium medium = crop(smooth_medium({16, 18, 20}, oblique_grid()));
    for (const glm::dvec3 &light : {glm::dvec3(3.0, 2.0, 9.0), glm::dvec3(0.9, 0.2, 2.5)}) {
        const LightMap map = build_radial_map(medium, light, {31, 1.0});
        for (const InstructionSet &set : instruction_sets()) {
            const LightMap other = build_radial_map(medium, light, {31, 1.0}, set);
            ASSERT_EQ(other.coefficients.size(), map.coefficients.size());
            // Rays that graze smoke may differ in their range, which says nothing about what they hold.
            const auto stride = static_cast<std::size_t>(map.view().stride());
            for (std::size_t i = 0; i < map.coefficients.size(); i += stride) {
                EXPECT_NEAR(other.coefficients[i], map.coefficients[i], 1e-5) << set.name;
            }
            std::vector<float> points, columns, others;
            std::mt19937 generator(17);
            std::uniform_real_distribution<float> uniform(-2.0F, 4.0F);
            for (int i = 0; i < 3000; ++i) {
                points.push_back(uniform(generator));
            }
            columns.resize(points.size() / 3);
            others.resize(points.size() / 3);
            map.look_up(points, columns);
            other.look_up(points, others);
            for (std::size_t i = 0; i < columns.size(); ++i) {
                EXPECT_NEAR(others[i], columns[i], 1e-4) << set.name;
            }
        }
    }
}

} // namespace
} // namespace sfumato
