// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of light maps and light volumes, and the plain views that they read.
#pragma once

#include "lights/light.hpp"
#include "maps/map_view.hpp"
#include "media/medium_view.hpp"
#include "rays/bins.hpp"
#include "text/dispatch.hpp"

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct AirView; // media/air.hpp

// One row of texels, slice by slice.
struct ProjectRow {
    GridView density;
    ClearanceView clearance;
    RampView ramp;
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

// A puff as the rays of a map meet it. Of parallel light, in texels across and in the map's depth along; of light from
// a place, in metres, with the light at the origin.
struct SplatPuff {
    float x, y, z;
    float per_radius; // one over its radius across, or the least that texels can show
    float half;       // its radius along
    float column;     // straight through the middle, less what that widening makes of it
};

// A straight piece of a strand as the rays of a map meet it. Of parallel light, in texels across and in the map's depth
// along; of light from a place, in metres, with the light at the origin.
struct SplatStrand {
    float from[3], to[3];
    float from_radius, to_radius; // as across
};

// What a map is made from of primitives that its texels' rays meet: a cell of the bins has those of a block of
// Bins::EDGE^2 texels, or of several.
template <typename Primitive>
struct Splat {
    LightMapView map; // coefficients and depths are not read
    BinsView bins;
    const Primitive *primitives = nullptr;
    float *coefficients = nullptr;
    // Of a shared range of the paper's seven: of each primitive the total and the numbers that it adds to a ray through
    // its middle, WEIGHTS of them; of other rays the same times their column.
    static constexpr int WEIGHTS = 8;
    const float *weights = nullptr;
};

// What the rays of a packet of a block's texels meet: of each primitive in turn, as many of each as there are lanes.
struct SplatAbsorbers {
    std::vector<float> depth, half, column; // 0 for rays that do not meet it
    std::size_t count = 0;
};

// In which of the bodies a light's arrival is asked for. Solids are those on that body's own maps.
struct ArrivingAt {
    const LightView *light = nullptr;
    std::span<const glm::vec3> extinctions; // of all bodies
    int own = 0;
    bool grey = true;             // all extinctions are
    const AirView *air = nullptr; // the world's; null where there is none
    int only = -1;                // this sample of the light; or all
};

// Fills a box of cells of one light's volume: a slice, or a brick.
struct LightBox {
    ArrivingAt at;
    ClearanceView clearance;
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
    // One block, by the numbers of its column and row: onto harmonics; or what its rays meet, a packet at a time.
    void (*splat_puffs)(const Splat<SplatPuff> &, int column, int row);
    void (*meet_puffs)(const Splat<SplatPuff> &, int column, int row, int packet, SplatAbsorbers &);
    void (*splat_strands)(const Splat<SplatStrand> &, int column, int row);
    void (*meet_strands)(const Splat<SplatStrand> &, int column, int row, int packet, SplatAbsorbers &);
};

const MapKernels &map_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
