// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/tint.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

// Trilinear interpolation is exact of what is linear, wherever the colours lie and however far apart: here half as
// dense, turned by a quarter, in a box that reaches beyond the smoke.
TEST(Tint, ColoursAreFoundWhereTheyLie) {
    const glm::ivec3 smoke(12, 14, 16), colours(14, 12, 14);
    const glm::dmat4 to_colours =
        glm::translate(glm::dmat4(1.0), glm::dvec3(9.0, 2.0, 1.5)) * glm::scale(glm::dmat4(1.0), glm::dvec3(0.5)) *
        glm::dmat4(glm::dvec4(0, 1, 0, 0), glm::dvec4(-1, 0, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, 0, 0, 1));
    std::vector<float> channels[3];
    for (int z = 0; z < colours.z; ++z) {
        for (int y = 0; y < colours.y; ++y) {
            for (int x = 0; x < colours.x; ++x) {
                channels[0].push_back(static_cast<float>(x) + 0.5F);
                channels[1].push_back(static_cast<float>(y) + 0.5F);
                channels[2].push_back(2.0F - static_cast<float>(z)); // negative from the third on: none
            }
        }
    }
    for (const Layout layout : {Layout::DENSE, Layout::BRICKS}) {
        std::vector<float> density(static_cast<std::size_t>(smoke.x * smoke.y * smoke.z), 0.0F);
        for (std::size_t i = 0; i < density.size(); i += 5) {
            density[i] = 0.25F * static_cast<float>(1 + i % 7);
        }
        const auto grid = crop(density, smoke, 0.0F, layout);
        tint(*grid, {colours, {channels[0], channels[1], channels[2]}, 1}, to_colours);
        glm::dvec3 most(0.0);
        for (int z = 0; z < smoke.z; ++z) {
            for (int y = 0; y < smoke.y; ++y) {
                for (int x = 0; x < smoke.x; ++x) {
                    const glm::ivec3 cell(x, y, z);
                    const auto at = static_cast<std::size_t>(grid->place_of(cell - grid->first));
                    const float here = grid->density[at];
                    const glm::dvec3 place(to_colours * glm::dvec4(glm::dvec3(cell) + 0.5, 1.0));
                    const glm::dvec3 expected(place.x, place.y, std::max(2.5 - place.z, 0.0));
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_NEAR(grid->tint[3 * at + static_cast<std::size_t>(c)], here * expected[c], 1e-5);
                    }
                    most = here > 0.0F ? glm::max(most, expected) : most;
                }
            }
        }
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(brightest(grid.get())[c], most[c], 1e-4);
        }
    }
}

TEST(Tint, OutsideThereIsNoColour) {
    const std::vector<float> density(8, 1.0F), colours(8, 2.0F);
    const auto grid = crop(density, glm::ivec3(2), 0.0F);
    tint(*grid, {glm::ivec3(2), {colours, colours, colours}, 1}, glm::translate(glm::dmat4(1.0), glm::dvec3(1, 0, 0)));
    const auto red = [&](int x) { return grid->tint[3 * static_cast<std::size_t>(grid->place_of({x, 1, 1}))]; };
    EXPECT_EQ(red(1), 2.0F); // the first cell lies where the colours' second does
    EXPECT_EQ(red(2), 0.0F);
}

} // namespace
} // namespace sfumato
