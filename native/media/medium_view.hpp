// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke as the kernels read it. Views own nothing. All grids are cropped and have a border of empty cells (see
// medium.hpp), so that clamping a coordinate to the outermost cell centres reads zero, as outside.
#pragma once

#include "scene/affine.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace sfumato {

constexpr std::size_t MAX_MEDIA = 64; // in one frame
constexpr int EMISSION_ROWS = 128;    // at most, of a medium: they are in the viewport's uniforms

// Where less than half of a grid is filled, it is stored in bricks of STORED^3 cells and one more layer on the upper
// sides, which the next bricks begin with: so interpolation reads one brick alone.
constexpr int STORED_BITS = 3, STORED = 1 << STORED_BITS, STORED_ROW = STORED + 1;
constexpr int STORED_CELLS = STORED_ROW * STORED_ROW * STORED_ROW;

// A grid of `channels` interleaved floats a cell, x running fastest.
struct GridView {
    const float *values = nullptr;
    int channels = 1;
    int nx = 0, ny = 0, nz = 0;
    int row = 0, slice = 0; // cells from one row, and from one slice, to the next: of the grid or of each brick
    // Where each brick begins in the values, cells; all that are empty share the first. Null where the grid is dense.
    const std::int32_t *bricks = nullptr;
    int bricks_x = 0, bricks_y = 0;
};

// For each brick of BRICK^3 cells: negative where smoke may be met, else the number of cells, along the axis in which
// a ray moves fastest, that it may cross from anywhere in the brick without meeting any.
constexpr int BRICK = 4;
struct ClearanceView {
    const float *cells = nullptr;
    int nx = 0, ny = 0, nz = 0;
};

// A medium's transfer function: for each part between two stops the rows of shaders/media/ramp.glsl's Part, of three
// numbers each. Null where the grid holds the density itself.
constexpr int PART_ROWS = 7, PART_FLOATS = 3 * PART_ROWS;
struct RampView {
    const float *rows = nullptr;
    int parts = 0;
};

// A body of smoke. Each light has a volume, of the grid's cells and of `light_channels` numbers a cell: the optical
// depth towards the light in each colour (in the only one, where all smoke is grey), and the share of the light's
// falloff() that gets past solids, and past the edges of its cone.
struct MediumView {
    GridView density;
    const float *tint = nullptr; // density times colour, three numbers for each of the density's; or null: white
    // What glows, one number for each of the density's, and the rows that say how: Medium::glow. Null where nothing
    // does.
    const float *glow = nullptr;
    std::span<const float> emission;     // three numbers a row
    std::span<const float *const> light; // of each light
    int light_channels = 1;
    ClearanceView clearance;
    Affine world_to_grid;
    float extinction[3] = {0.0F, 0.0F, 0.0F}; // per metre and unit density
    float scattering[3] = {0.0F, 0.0F, 0.0F};
    float anisotropy = 0.0F;
    float step_length = 1.0F; // cells
    RampView ramp;
    bool split = true; // whether steps end at the planes through cells' centres; of a ramp
};

} // namespace sfumato
