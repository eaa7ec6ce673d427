// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of a grid wherever they lie in memory.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

namespace sfumato {

// A box of cells of a larger grid. Owns nothing.
struct CellBlock {
    const float *values = nullptr; // of its first cell
    glm::ivec3 first{0};           // where that one lies in the grid
    glm::ivec3 size{0};
    glm::vec<3, std::ptrdiff_t> strides{1, 0, 0}; // to the next cell along each axis; all 0 where the cells are equal
};

} // namespace sfumato
