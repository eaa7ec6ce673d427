// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops, compiled once per instruction set, and the plain views that they read.
// Nothing here owns memory. All grids are cropped and have a border of empty cells (see medium.hpp), so that clamping
// a coordinate to the outermost cell centres reads zero, as outside.
#pragma once

#include "rays/ray_kernels.hpp"
#include "scene/scene.hpp"
#include "solids/embree.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

constexpr int MAX_LANES = 16;
constexpr std::size_t MAX_MEDIA = 5; // in one frame: what the viewport has textures for

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

// A light map: of each texel's ray the column density, as a series of `count` half-range cosines over the ray's own
// range of depths (shaders/rays/basis.glsl), and the depth of the first solid on it (infinite where there is none). A
// texel is HEAD_FLOATS + count - 1 floats: the total, where the range begins, one over its extent, and a_k / (pi k) for
// k = 1, ... Texel centres are at (i + 1/2) / width. A map of light from one direction is affine in the world. One of
// light from one point has a rectangle of the octahedral square across (shaders/lights/light.glsl) and the distance to
// the point along.
constexpr int HEAD_FLOATS = 3;
struct LightMapView {
    [[nodiscard]] int stride() const { return HEAD_FLOATS + count - 1; }
    const float *coefficients = nullptr; // null where the light cannot meet the medium
    const float *solid_depth = nullptr;
    int count = 1;
    int width = 0, height = 0;
    bool radial = false;
    Affine world_to_light;               // onto [0, 1]^3; radial: turned and moved, with the light at the origin
    float low[3] = {0.0F, 0.0F, 0.0F};   // radial: where the rectangle and the distances begin,
    float scale[3] = {1.0F, 1.0F, 1.0F}; // and one over their extent
};

// Projects one row of texels, slice by slice.
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

// A light, and the points that it is sampled at.
struct LightView {
    Light::Kind kind = Light::Kind::SUN;
    glm::vec3 strength{0.0F};
    glm::vec3 position{0.0F};
    glm::vec3 direction{0.0F, 0.0F, -1.0F};
    glm::vec3 across{0.0F}, up{0.0F}; // half axes; of a sun sin(angle / 2) long, of a sphere not set
    float radius = 0.0F;
    float cone_cosine = -2.0F; // of a spot's edge; -2 for no spot
    float blend = 0.0F;
    bool spot_cosine = false;
    float facing2 = 0.0F; // radius^2 where a sphere looks like a disk, else 0
    float spread_cotangent = 0.0F;
    float area = 0.0F;                  // of rectangles, ellipses and polygons
    glm::vec3 corners[4];               // of polygons
    float size2 = 0.0F;                 // of falloff()
    std::span<const glm::vec3> samples; // points; of a sun, directions towards it
    const LightMapView *maps = nullptr; // for each sample and medium; the medium runs fastest
};

// A body of smoke. Each light has a volume, of the grid's cells and of `light_channels` numbers a cell: the optical
// depth towards the light in each colour (in the only one, where all smoke is grey), and the share of the light's
// falloff() that gets past solids, and past the edges of its cone.
struct MediumView {
    GridView density;
    std::span<const float *const> light; // of each light
    int light_channels = 1;
    ClearanceView clearance;
    Affine world_to_grid;
    float extinction[3] = {0.0F, 0.0F, 0.0F}; // per metre and unit density
    float scattering[3] = {0.0F, 0.0F, 0.0F};
    float anisotropy = 0.0F;
    float step_length = 1.0F; // cells
};

// Fills one slice z of one light's volume.
struct LightSlice {
    const LightView *light = nullptr;
    std::span<const MediumView> media;
    int own = 0; // which of the media is being lit
    bool grey = true;
    Affine grid_to_world;
    float *volume = nullptr;
    int z = 0;
};

constexpr int MATERIAL_FLOATS = 15;

// One place of a shape: its arrays, as scene.hpp has them, null where it has none, and what takes its normals and
// tangents to the world, column by column.
struct PlaceView {
    const float *vertices = nullptr;
    const std::uint32_t *triangles = nullptr;
    const float *corner_normals = nullptr;
    const float *vertex_normals = nullptr;
    const float *corner_tangents = nullptr;
    const std::uint32_t *material = nullptr;
    std::int32_t first_material = 0; // of its rows among all properties
    float to_world[9];
    float normals_to_world[9];
};

struct SurfaceView {
    RTCScene scene = nullptr;          // of instances
    const PlaceView *places = nullptr; // by Embree's number of the instance
    // MATERIAL_FLOATS a material: albedo, reflectance, edge, alpha_x, alpha_y, apart, index, emission,
    // diffuse roughness (negative for none)
    const float *properties = nullptr;
    bool tangents = false; // whether any shape has tangents
};

struct FrameView {
    std::array<glm::vec3, 6> camera; // near0, near_u, near_v, far0, far_u, far_v
    SurfaceView surfaces;
    std::span<const LightView> lights;
    std::span<const MediumView> media;
    bool grey = true; // all extinctions are: one march serves all colours
    glm::vec3 background{0.0F};
};

// What trace() computes for a surface, and whether it marches through the smoke before it.
enum class Output : std::uint8_t {
    PICTURE,      // its radiance, behind the smoke
    SURFACES,     // its radiance, as if there were no smoke between it and the eye
    SMOKE_SHADOW, // the share of its light that smoke takes
    ALL_SHADOWS   // the share of its light that smoke and solids take
};

// Where on the image, and on every light, the shadows of solids are looked at: as Packet's, for each lane.
struct ShadowSample {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES];
};

// Samples in, light out; as many as the kernel has lanes.
struct Packet {
    alignas(64) float u[MAX_LANES], v[MAX_LANES];             // where on the image, in [0, 1]
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES]; // where on every light, in [0, 1]^2
    alignas(64) float active[MAX_LANES];                      // 1, or 0 for lanes to spare
    // Shadows of solids are averaged over these, as they fall on the plane of the surface that the ray itself meets.
    // Where there are none, from the ray itself, and light_u and light_v.
    std::span<const ShadowSample> shadows;
};

struct Traced {
    alignas(64) float radiance[3][MAX_LANES];
    alignas(64) float alpha[MAX_LANES];
    alignas(64) float surface[MAX_LANES]; // mean radiance of the surface, were there no smoke; or mean share in shadow
    alignas(64) float unshadowed[MAX_LANES]; // radiance, or irradiance, were there no shadows at all
    alignas(64) float seen[MAX_LANES];       // the share of it that the smoke leaves
    alignas(64) float distance[MAX_LANES];   // to the first surface, or the ray's reach
};

struct Kernels {
    const char *name;
    int lanes;
    void (*project_row)(const ProjectRow &);
    void (*light_slice)(const LightSlice &);
    void (*look_up)(const LightMapView &, const float *points, float *columns, int count); // columns along the light
    void (*trace)(const FrameView &, Output, const Packet &, Traced &);
    void (*integrate_lights)(const LightBatch<float> &);
    void (*harmonic_sums)(const HarmonicSums &);
    void (*weigh_rows)(const WeightedRows &);
    void (*look_up_series)(const SeriesLookUp &);
    void (*look_up_texels)(const TexelLookUp &);
    void (*reflect_lights)(const MicrofacetBatch<float> &);
};

// Every set of kernels that this processor runs, the widest last.
std::span<const Kernels> available_kernels();

// The widest.
const Kernels &kernels();

} // namespace sfumato
