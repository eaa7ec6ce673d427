// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of light maps and light volumes, and the plain views that they read.
#pragma once

#include "lights/light.hpp"
#include "maps/map_view.hpp"
#include "media/medium_view.hpp"
#include "text/dispatch.hpp"

#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

// One row of texels, slice by slice.
struct ProjectRow {
    GridView density;
    ClearanceView clearance;
    LightMapView map;          // coefficients and depths are not read
    Affine light_to_grid;      // from [0, 1]^3, or from the frame with the light at the origin
    float slice_length = 0.0F; // metres
    float extinction = 0.0F;   // of the strongest colour: what can be seen decides what range a ray needs
    int slices = 0;
    int y = 0;
    float *coefficients = nullptr; // of this row
    float *scratch = nullptr;      // MAX_LANES + 1 floats a slice, aligned for lanes
};

// The absorbers of as many rays of a row as there are lanes, from column `x` on: with ProjectRow::scratch, the number
// of the slice of each, and after those of all slices, for each the densities on the rays.
struct RowAbsorbers {
    int count = 0;
    alignas(64) float low[MAX_LANES], high[MAX_LANES]; // the ray's own range
    alignas(64) float total[MAX_LANES];                // column density
};

// Fills a box of cells of one light's volume: a slice, or a brick.
struct LightBox {
    const LightView *light = nullptr;
    std::span<const MediumView> media;
    int own = 0; // which of the media is being lit
    bool grey = true;
    Affine grid_to_world;
    glm::ivec3 first{0}, size{0};
    float *values = nullptr; // of the box alone
};

struct MapKernels {
    void (*project_row)(const ProjectRow &); // onto harmonics
    void (*march_row)(const ProjectRow &, int x, RowAbsorbers &);
    // Columns along the light, for a colour.
    void (*look_up)(const LightMapView &, const float *points, float *columns, int count, int colour);
    void (*light_box)(const LightBox &);
};

const MapKernels &map_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
