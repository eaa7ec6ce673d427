// SPDX-License-Identifier: GPL-3.0-or-later
// Densities made ready for marching: cropped to where there is smoke, in bricks where most of that is empty, with a map
// of the emptiness that is left.
#pragma once

#include "media/medium_view.hpp"
#include "scene/cell_block.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct Grid {
    std::vector<float> density; // as GridView has it; in bricks the first one is empty
    glm::ivec3 resolution{0};   // with one empty cell on every side
    glm::ivec3 first{0};        // where the cell (0, 0, 0) lies in what it was cropped from
    double amount = 0.0;        // the sum of all densities
    std::vector<float> clearance;
    glm::ivec3 bricks{0};             // of the clearance
    std::vector<std::int32_t> stored; // where each brick of STORED^3 cells begins; none where the grid is dense
    glm::ivec3 stored_bricks{0};
    std::vector<glm::ivec3> corners; // of the bricks that are stored
    // Density times the colour in which it scatters, three numbers for each of `density`; or none: white.
    std::vector<float> tint;
    std::vector<float> glow; // Medium::glow, one number for each of `density`; or none

    [[nodiscard]] GridView view() const;
    [[nodiscard]] ClearanceView clearances() const { return {clearance.data(), bricks.x, bricks.y, bricks.z}; }

    // What is stored, box by box, x fastest: the slices of a dense grid, or its bricks but the empty one.
    struct Box {
        glm::ivec3 first{0}, size{0};
        std::ptrdiff_t begin = 0; // cells
    };
    [[nodiscard]] int boxes() const;
    [[nodiscard]] Box box(int number) const;
    // Where a cell is stored.
    [[nodiscard]] std::ptrdiff_t place_of(const glm::ivec3 &cell) const;
};

// As Grid::clearance has it, of bricks that are occupied where their flags are not 0.
std::vector<float> clearances_of(std::span<const std::uint8_t> occupied, const glm::ivec3 &bricks);

// For each of the clearance's bricks the lowest and the highest density that interpolation in it can give.
std::vector<glm::vec2> brick_ranges(const Grid &grid);

// All cells of a grid, x fastest, of what is stored as the densities are: `channels` numbers a cell.
void copy_cells(const Grid &grid, std::span<const float> stored, int channels, std::span<float> out);

// BEST: dense where more than half of the bricks are filled.
enum class Layout { BEST, DENSE, BRICKS };

// The cells above a threshold, or that glow, and all others between them; null where there is none. Cells up to the
// threshold are empty, and so is what no block covers. No cell is in two blocks of one kind. The blocks are read three
// times.
std::shared_ptr<Grid> crop(std::span<const CellBlock> blocks, float threshold, Layout layout = Layout::BEST,
                           std::span<const CellBlock> glow = {});

// The same of cells in turn, x fastest.
std::shared_ptr<Grid> crop(std::span<const float> density, const glm::ivec3 &resolution, float threshold,
                           Layout layout = Layout::BEST, std::span<const float> glow = {});

} // namespace sfumato
