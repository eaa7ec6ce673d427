// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke whose cells scatter each in a colour of their own.
#pragma once

#include "media/grid.hpp"

#include <array>
#include <span>

#include <glm/mat4x4.hpp>

namespace sfumato {

// Colours cell by cell, x fastest; outside they are 0. The channels may be one.
struct ColourCells {
    glm::ivec3 resolution{0};
    std::array<std::span<const float>, 3> channels;
    int stride = 1; // numbers from one cell to the next
};

// Gives the grid's cells colours, of which `to_colours` says where they lie: from the cells that the grid was cropped
// from to those. Whatever is negative counts as 0.
void tint(Grid &grid, const ColourCells &colours, const glm::dmat4 &to_colours);

// The highest value of each channel of a grid's colours; 1 where it has none, or there is no grid.
glm::vec3 brightest(const Grid *grid);

} // namespace sfumato
