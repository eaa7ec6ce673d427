// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of light shafts (shafts.hpp), and the plain views that they read.
#pragma once

#include "maps/depth_tree.hpp"
#include "maps/map_view.hpp"
#include "scene/scene.hpp"
#include "text/dispatch.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// A picture's rays up to their surfaces, the air, and a sun.
struct ShaftView {
    Camera camera;
    int width = 0, height = 0;
    const float *distance = nullptr; // along each pixel's ray, rows from the bottom
    glm::vec3 rayleigh{0.0F}, mie{0.0F}, extinction{0.0F};
    float anisotropy = 0.0F;
    LightMapView map;
    DepthTreeView tree;
    glm::vec3 direction{0.0F}, irradiance{0.0F};

    // Colours that differ in how the air lets them through.
    [[nodiscard]] int colours() const { return extinction.x == extinction.y && extinction.y == extinction.z ? 1 : 3; }
};

// The slices that leave the screen by one border (shaders/frame/epipolar.glsl).
struct BorderView {
    int slices = 0, samples = 0;          // of each slice
    float along = 1.0F, deep = 1.0F;      // pixels between two of them
    std::size_t first = 0;                // sample
    const std::int32_t *as_one = nullptr; // of each sample: only one slice of so many has it
};

// What is found at a sample: A + share P(d) sends a surface at the distance d, with P of a stretch that begins at the
// eye.
struct SampleView {
    float *start[3] = {}; // A of each colour
    float *share = nullptr, *from = nullptr, *to = nullptr;
};

struct EpipolarView {
    float light[3] = {}; // x, y, w, pixels
    BorderView borders[4];
    SampleView samples;
};

// A slice's plane on the map: a line of columns (maps/sections_lanes.hpp).
struct SliceView {
    int border = 0, number = 0;
    float exit[2] = {}; // where it leaves the screen
    bool along_y = false, reversed = false;
    float m0 = 0.0F, n0 = 0.0F, slope = 0.0F;
};

struct SliceScratch {
    std::vector<float> low, high, weight;
};

struct ShaftKernels {
    // All add to `out`, three colours a pixel, and return how many texels or bounds of texels were looked at.
    std::size_t (*march_row)(const ShaftView &, int y, float most, float *out);
    std::size_t (*march_pixels)(const ShaftView &, std::span<const std::uint32_t> pixels, float *out);
    std::size_t (*march_slice)(const ShaftView &, const EpipolarView &, const SliceView &, SliceScratch &);
    // Pixels that no sample knows enough of come to `left`.
    void (*unwarp_row)(const ShaftView &, const EpipolarView &, int y, std::vector<std::uint32_t> &left, float *out);
};

const ShaftKernels &shaft_kernels(const InstructionSet &with = instruction_set());

} // namespace sfumato
