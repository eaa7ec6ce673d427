// SPDX-License-Identifier: GPL-3.0-or-later
// Grids in bricks hold what dense ones hold, and pictures of both are the same.
#include "frame/frame.hpp"
#include "support/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using namespace reference::testing;

// Balls of rough smoke here and there, with faint smoke between them that counts as empty.
Medium balls(unsigned seed, const glm::uvec3 &resolution = {61, 45, 70}, int count = 3) {
    Medium medium = random_medium(resolution, glm::scale(glm::mat4(1.0F), glm::vec3(0.05F)), seed);
    medium.scattering = glm::vec3(3.0F);
    std::mt19937 generator(seed);
    std::vector<glm::vec3> middles;
    for (int i = 0; i < count; ++i) {
        const auto share = [&] { return std::uniform_real_distribution<float>(0.1F, 0.9F)(generator); };
        middles.push_back(glm::vec3(share(), share(), share()) * glm::vec3(resolution));
    }
    std::size_t cell = 0;
    for (unsigned k = 0; k < resolution.z; ++k) {
        for (unsigned j = 0; j < resolution.y; ++j) {
            for (unsigned i = 0; i < resolution.x; ++i, ++cell) {
                const auto inside = [&](const glm::vec3 &m) { return glm::distance(m, glm::vec3(i, j, k)) < 6.0F; };
                medium.density[cell] *= std::any_of(middles.begin(), middles.end(), inside) ? 1.0F : 1e-8F;
            }
        }
    }
    return medium;
}

Medium stored(Medium medium, Layout layout) {
    const float threshold = emptiness(medium.resolution, medium.grid_to_world, medium.scattering + medium.absorption);
    medium.grid = crop(medium.density, glm::ivec3(medium.resolution), threshold, layout);
    return medium;
}

template <typename Visit>
void for_each_cell(const glm::ivec3 &n, const Visit &visit) {
    for (int z = 0; z < n.z; ++z) {
        for (int y = 0; y < n.y; ++y) {
            for (int x = 0; x < n.x; ++x) {
                visit(glm::ivec3(x, y, z));
            }
        }
    }
}

std::vector<float> all_cells(const Grid &grid, std::span<const float> values, int channels) {
    const glm::ivec3 n = grid.resolution;
    std::vector<float> out(std::size_t(n.x * n.y * n.z * channels), -1.0F);
    copy_cells(grid, values, channels, out);
    return out;
}

// As in Cycles: filters with negative lobes and signed fields hold them.
TEST(Bricks, OfNegativeCellsAreNone) {
    std::vector<float> density(20 * 20 * 20, -3.0F);
    const auto at = [](int x, int y, int z) { return std::size_t((z * 20 + y) * 20 + x); };
    density[at(5, 6, 7)] = density[at(7, 6, 7)] = 2.0F;
    for (const Layout layout : {Layout::DENSE, Layout::BEST}) {
        const auto grid = crop(density, glm::ivec3(20), 0.0F, layout);
        ASSERT_EQ(grid->resolution, glm::ivec3(5, 3, 3));
        EXPECT_EQ(grid->amount, 4.0);
        const std::vector<float> cells = all_cells(*grid, grid->density, 1);
        EXPECT_EQ(std::accumulate(cells.begin(), cells.end(), 0.0F), 4.0F);
        EXPECT_EQ(*std::min_element(cells.begin(), cells.end()), 0.0F);
    }
}

TEST(Bricks, HoldTheCellsOfTheDenseGrid) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        const glm::uvec3 resolution(17 + 11 * seed, 9 + 8 * seed, 64);
        const Medium medium = balls(seed, resolution);
        const auto dense = stored(medium, Layout::DENSE).grid, bricks = stored(medium, Layout::BRICKS).grid;
        ASSERT_TRUE(dense && bricks);
        EXPECT_TRUE(dense->stored.empty());
        EXPECT_FALSE(bricks->stored.empty());
        EXPECT_EQ(dense->resolution, bricks->resolution);
        EXPECT_EQ(dense->first, bricks->first);
        EXPECT_EQ(dense->clearance, bricks->clearance);
        EXPECT_EQ(dense->density, all_cells(*bricks, bricks->density, 1));
        for_each_cell(dense->resolution, [&](const glm::ivec3 &cell) {
            EXPECT_EQ(dense->density[std::size_t(dense->place_of(cell))],
                      bricks->density[std::size_t(bricks->place_of(cell))]);
        });
    }
}

// The layer that two bricks share is in both of them, so that one look-up reads one brick.
TEST(Bricks, EndWithTheLayerThatTheNextOnesBeginWith) {
    const auto bricks = stored(balls(5), Layout::BRICKS).grid;
    const std::vector<float> cells = all_cells(*bricks, bricks->density, 1);
    const glm::ivec3 n = bricks->resolution;
    int filled = 0;
    for (int number = 0; number < bricks->boxes(); ++number) {
        const Grid::Box box = bricks->box(number);
        const float *values = bricks->density.data() + box.begin;
        double most = 0.0;
        for_each_cell(box.size, [&](const glm::ivec3 &at) {
            const glm::ivec3 cell = box.first + at;
            const bool inside = cell.x < n.x && cell.y < n.y && cell.z < n.z;
            EXPECT_EQ(*values, inside ? cells[std::size_t((cell.z * n.y + cell.y) * n.x + cell.x)] : 0.0F);
            most = std::max(most, double{*values++});
            filled += at.x == STORED || at.y == STORED || at.z == STORED ? 0 : 1;
        });
        EXPECT_GT(most, 0.0); // none is stored for nothing
    }
    EXPECT_GT(filled, 1000);
    EXPECT_LT(bricks->density.size(), cells.size() / 2);
    EXPECT_TRUE(std::all_of(bricks->density.begin(), bricks->density.begin() + STORED_CELLS,
                            [](float value) { return value == 0.0F; }));
}

TEST(Bricks, AreForGridsThatAreHalfEmpty) {
    EXPECT_FALSE(stored(balls(1), Layout::BEST).grid->stored.empty());
    EXPECT_TRUE(stored(random_medium({40, 40, 40}, glm::mat4(1.0F), 2), Layout::BEST).grid->stored.empty());
    // A cell in two opposite corners: two of 4 x 1 x 1 bricks, and two of 3 x 1 x 1.
    for (const unsigned cells : {30U, 20U}) {
        Medium medium = uniform_medium({cells, 1, 1}, 0.0F, glm::mat4(1.0F));
        medium.density.front() = medium.density.back() = 1.0F;
        const auto grid = stored(medium, Layout::BEST).grid;
        EXPECT_EQ(grid->stored.empty(), cells == 20U);
        EXPECT_EQ(grid->density.size(), cells == 20U ? 22U * 9U : 3U * STORED_CELLS);
    }
}

// Parallel and radial maps, hard and soft light, grey and coloured smoke, light volumes and the march.
TEST(Bricks, MakeThePictureOfTheDenseGrid) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        Scene scene = smoke_over_floor();
        Medium medium = balls(seed);
        medium.grid_to_world =
            scene.media[0].grid_to_world *
            glm::scale(glm::mat4(1.0F), glm::vec3(scene.media[0].resolution) / glm::vec3(medium.resolution));
        if (seed % 2 == 1) {
            medium.absorption = {0.0F, 1.0F, 2.0F};
        }
        const glm::vec3 middle(medium.grid_to_world * glm::vec4(0.5F * glm::vec3(medium.resolution), 1.0F));
        scene.lights.push_back(point_light(middle + glm::vec3(1.0F, -3.0F, 2.0F), glm::vec3(5.0F), 0.2F));
        scene.lights.push_back(point_light(middle, glm::vec3(2.0F))); // inside
        for (const InstructionSet &set : instruction_sets()) {
            const auto picture = [&](Layout layout) {
                scene.media = {stored(medium, layout)};
                const Frame frame(scene, {7, 1.0, 1.0, 4}, set);
                EXPECT_EQ(frame.media()[0].grid->stored.empty(), layout == Layout::DENSE);
                return std::pair(
                    *frame.render(camera, 96, 64, 1, {}),
                    all_cells(*frame.media()[0].grid, *frame.media()[0].light[1], frame.media()[0].light_channels));
            };
            const auto [dense, dense_light] = picture(Layout::DENSE);
            const auto [bricks, bricks_light] = picture(Layout::BRICKS);
            float worst = 0.0F, brightest = 0.0F;
            for (std::size_t i = 0; i < dense.size(); ++i) {
                worst = std::max(worst, std::abs(dense[i] - bricks[i]));
                brightest = std::max(brightest, dense[i]);
            }
            EXPECT_LT(worst, 1e-6F * std::max(brightest, 1.0F)) << seed << ", " << set.name;
            // Cells in empty bricks are not lit: no look-up that meets smoke reads them.
            std::size_t lit = 0;
            for (std::size_t i = 0; i < dense_light.size(); ++i) {
                if (bricks_light[i] != 0.0F) {
                    EXPECT_NEAR(dense_light[i], bricks_light[i], 1e-5F);
                    ++lit;
                }
            }
            EXPECT_GT(lit, 1000U);
        }
    }
}

} // namespace
} // namespace sfumato
