// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops, compiled once per instruction set, and the plain views that they read.
// Nothing here owns memory. All grids are cropped and have a border of empty cells (see medium.hpp), so that clamping
// a coordinate to the outermost cell centres reads zero, as outside.
#pragma once

#include "embree.hpp"

#include <array>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

constexpr int MAX_LANES = 16;

template <typename Number>
struct LightBatch; // area_light.hpp
template <typename Number>
struct MicrofacetBatch; // microfacet.hpp

// An affine map by its rows, (x, y, z, translation).
struct Affine {
    float rows[3][4];
};

Affine affine(const glm::dmat4 &m);

// A grid of `channels` interleaved floats a cell, x running fastest.
struct GridView {
    const float *values = nullptr;
    int channels = 1;
    int nx = 0, ny = 0, nz = 0;
};

// For each brick of BRICK^3 cells: negative where smoke may be met, else the number of cells, along the axis in which
// a ray moves fastest, that it may cross from anywhere in the brick without meeting any.
constexpr int BRICK = 4;
struct ClearanceView {
    const float *cells = nullptr;
    int nx = 0, ny = 0, nz = 0;
};

// A Fourier opacity map: `coefficients` floats a texel (a0, a1, b1, a2, b2, ...), and for each texel the depth of the
// first solid on the light ray (1 where there is none within the map's range). Texel centres are at (i + 1/2) / width.
struct LightMapView {
    const float *coefficients = nullptr;
    const float *solid_depth = nullptr;
    int count = 1;
    int width = 0, height = 0;
    Affine world_to_map;
};

// Projects one row of texels: coefficient c = sum over slices s of weights[s][c] * density(slice).
struct ProjectRow {
    GridView density;
    ClearanceView clearance;
    Affine texel_to_grid; // (x, y, s): texel centres and slice centres at whole numbers
    const float *weights = nullptr;
    int slices = 0;
    int count = 1; // coefficients
    int width = 0, y = 0;
    float *coefficients = nullptr; // of this row
};

// Fills one slice z of the lit volume: the column density between each cell centre and the sun, and the share of the
// sun that solids keep from it.
struct LightSlice {
    LightMapView map;
    ClearanceView clearance;
    Affine grid_to_map;
    float *lit = nullptr;       // the whole volume: density and column density, interleaved
    float *occlusion = nullptr; // the whole volume
    int nx = 0, ny = 0, nz = 0, z = 0;
};

// The triangles' attributes, indexed by Embree's primitive number.
struct SurfaceView {
    RTCScene scene = nullptr;
    const float *corner_normals = nullptr;  // nine floats a triangle
    const std::int32_t *material = nullptr; // one a triangle
    const float *albedo = nullptr;          // three floats a material
};

struct SunView {
    bool present = false;
    glm::vec3 towards{0.0F, 0.0F, 1.0F}; // from the scene to the sun
    glm::vec3 across{0.0F}, up{0.0F};    // tan(angle / 2) long, spanning the disk
    glm::vec3 irradiance{0.0F};
};

struct MediumView {
    bool present = false;
    GridView lit;
    ClearanceView clearance;
    Affine world_to_grid;
    float extinction[3] = {0.0F, 0.0F, 0.0F};
    bool grey = true; // all three alike: one march serves them
    float albedo[3] = {0.0F, 0.0F, 0.0F};
    float anisotropy = 0.0F;
    float step_length = 1.0F; // cells
};

struct FrameView {
    std::array<glm::vec3, 6> camera; // near0, near_u, near_v, far0, far_u, far_v
    SurfaceView surfaces;
    SunView sun;
    MediumView medium;
    LightMapView map; // of the medium; read only where there are a sun and a medium
    glm::vec3 background{0.0F};
    bool lit = true;   // surfaces: radiance, or the cosine of the sun, in red times its visibility
    bool smoke = true; // or the surfaces alone
};

// Samples in, light out; as many as the kernel has lanes.
struct Packet {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];         // where on the image, in [0, 1]
    alignas(64) float sun_x[MAX_LANES], sun_y[MAX_LANES]; // where on the sun's disk, in the unit disk
    alignas(64) float active[MAX_LANES];                  // 1, or 0 for lanes to spare
};

struct Light {
    alignas(64) float radiance[3][MAX_LANES];
    alignas(64) float alpha[MAX_LANES];
    alignas(64) float surface[MAX_LANES];  // mean radiance of the surface, were there no smoke
    alignas(64) float seen[MAX_LANES];     // the share of it that the smoke leaves
    alignas(64) float distance[MAX_LANES]; // to the first surface, or the ray's reach
};

struct Kernels {
    const char *name;
    int lanes;
    void (*project_row)(const ProjectRow &);
    void (*light_slice)(const LightSlice &);
    void (*look_up)(const LightMapView &, const float *points, float *columns, int count); // columns along the light
    void (*trace)(const FrameView &, const Packet &, Light &);
    void (*integrate_lights)(const LightBatch<float> &);
    void (*reflect_lights)(const MicrofacetBatch<float> &);
};

// Every set of kernels that this processor runs, the widest last.
std::span<const Kernels> available_kernels();

// The widest.
const Kernels &kernels();

} // namespace sfumato
