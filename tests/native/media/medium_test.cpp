// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/medium.hpp"
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>

#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::oblique_grid;
using reference::testing::random_medium;
using reference::testing::uniform_medium;

float density(const CroppedMedium &medium, const glm::ivec3 &cell) {
    return medium.grid->density[static_cast<std::size_t>(medium.grid->place_of(cell))];
}

template <typename Visit>
void for_each_cell(const glm::ivec3 &size, const Visit &visit) {
    for (int k = 0; k < size.z; ++k) {
        for (int j = 0; j < size.y; ++j) {
            for (int i = 0; i < size.x; ++i) {
                visit(glm::ivec3(i, j, k));
            }
        }
    }
}

double mass(const CroppedMedium &medium) {
    double sum = 0.0;
    for_each_cell(medium.grid->resolution, [&](const glm::ivec3 &cell) { sum += double{density(medium, cell)}; });
    return sum;
}

double mass(const Medium &medium) {
    return std::accumulate(medium.density.begin(), medium.density.end(), 0.0);
}

// A few lone cells in a large grid.
Medium sparse_medium(unsigned seed) {
    Medium medium = uniform_medium({30, 25, 41}, 0.0F, oblique_grid());
    std::mt19937 generator(seed);
    std::uniform_int_distribution<std::size_t> anywhere(0, medium.density.size() - 1);
    for (int i = 0; i < 4; ++i) {
        medium.density[anywhere(generator)] = 1.0F + float(i);
    }
    return medium;
}

TEST(Crop, KeepsAllSmokeWhereItIs) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Medium medium = sparse_medium(seed);
        const CroppedMedium cropped = crop(medium);
        EXPECT_EQ(mass(cropped), mass(medium));
        EXPECT_TRUE(glm::all(glm::lessThanEqual(cropped.grid->resolution, glm::ivec3(medium.resolution) + 2)));
        for_each_cell(cropped.grid->resolution, [&](const glm::ivec3 &cell) {
            const glm::dvec4 world = cropped.grid_to_world * glm::dvec4(glm::dvec3(cell) + 0.5, 1.0);
            EXPECT_NEAR(density(cropped, cell), reference::density(medium, world), 1e-5);
        });
    }
}

TEST(Crop, LeavesOneEmptyCellOnEverySide) {
    for (const CroppedMedium &medium : {crop(sparse_medium(1)), crop(random_medium({5, 6, 7}, oblique_grid(), 2))}) {
        glm::ivec3 low(1000), high(-1);
        for_each_cell(medium.grid->resolution, [&](const glm::ivec3 &cell) {
            if (density(medium, cell) > 0.0F) {
                low = glm::min(low, cell);
                high = glm::max(high, cell);
            }
        });
        EXPECT_EQ(low, glm::ivec3(1));
        EXPECT_EQ(high, medium.grid->resolution - 2);
    }
}

// 1e-4 of optical depth along the diagonal is what nobody sees.
TEST(Crop, ForgetsWhatDarkensNothing) {
    Medium medium = uniform_medium({3, 4, 12}, 0.0F, glm::mat4(1.0F)); // its diagonal is 13 m
    medium.scattering = {1.0F, 4.0F, 0.5F};
    medium.absorption = {0.0F, 1.0F, 0.5F};
    const float threshold = 1e-4F / (5.0F * 13.0F);
    medium.density[5 * 12] = 0.99F * threshold;
    EXPECT_TRUE(crop(medium).empty());
    medium.density[5 * 12] = 1.01F * threshold;
    EXPECT_EQ(crop(medium).grid->resolution, glm::ivec3(3));
    medium.density[0] = 0.99F * threshold;
    EXPECT_EQ(crop(medium).grid->resolution, glm::ivec3(3));
}

TEST(Crop, OfNothingIsNothing) {
    EXPECT_TRUE(crop(uniform_medium({3, 4, 5}, 0.0F, glm::mat4(1.0F))).empty());
    EXPECT_TRUE(crop(Medium{}).empty());
    Medium clear = uniform_medium({3, 4, 5}, 1.0F, glm::mat4(1.0F));
    clear.scattering = glm::vec3(0.0F);
    EXPECT_TRUE(crop(clear).empty());
    EXPECT_FALSE(crop(uniform_medium({1, 1, 1}, 1.0F, glm::mat4(1.0F))).empty());
}

TEST(Crop, TellsGreySmokeFromColoured) {
    Medium medium = uniform_medium({3, 4, 5}, 1.0F, glm::mat4(1.0F));
    medium.scattering = {1.0F, 0.5F, 0.0F};
    medium.absorption = {0.0F, 0.5F, 1.0F};
    const CroppedMedium grey = crop(medium); // coloured light, grey extinction
    EXPECT_TRUE(grey.grey());
    EXPECT_EQ(grey.scattering, glm::vec3(1.0F, 0.5F, 0.0F));
    medium.absorption = {0.0F, 0.0F, 0.0F};
    const CroppedMedium coloured = crop(medium);
    EXPECT_FALSE(coloured.grey());
    EXPECT_EQ(coloured.extinction, glm::vec3(1.0F, 0.5F, 0.0F));
    EXPECT_EQ(coloured.scattering, glm::vec3(1.0F, 0.5F, 0.0F));
    EXPECT_EQ(mass(coloured), 60.0);
}

TEST(Crop, KnowsItsShortestEdge) {
    EXPECT_NEAR(crop(random_medium({5, 6, 7}, oblique_grid(), 3)).cell_size, 0.11, 1e-6);
}

// From anywhere in a brick, as far as its clearance promises along every axis, there is no smoke; a brick that
// promises nothing has smoke in it or a neighbour that has.
TEST(Clearance, PromisesNoMoreThanThereIs) {
    for (unsigned seed = 0; seed < 30; ++seed) {
        const CroppedMedium medium = crop(sparse_medium(seed));
        float furthest = 0.0F;
        std::size_t index = 0;
        for_each_cell(medium.grid->bricks, [&](const glm::ivec3 &brick) {
            const float clear = medium.grid->clearance[index++];
            furthest = std::max(furthest, clear);
            // The samples that interpolation anywhere in this range reads.
            const glm::ivec3 low = brick * BRICK - 1, high = (brick + 1) * BRICK;
            const auto reach = glm::ivec3(int(std::max(clear, 0.0F)));
            float most = 0.0F;
            for_each_cell(high - low + 1 + 2 * reach, [&](const glm::ivec3 &offset) {
                const glm::ivec3 cell = low - reach + offset;
                if (glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
                    glm::all(glm::lessThan(cell, medium.grid->resolution))) {
                    most = std::max(most, density(medium, cell));
                }
            });
            EXPECT_EQ(most > 0.0F, clear < 0.0F) << "seed " << seed << ", clearance " << clear;
        });
        EXPECT_EQ(index, medium.grid->clearance.size());
        EXPECT_GT(furthest, 0.0F) << seed; // there is something to leap over
    }
}

} // namespace
} // namespace sfumato
