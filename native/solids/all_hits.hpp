// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that rays meet: no hit is lost, however near to another, and none comes twice.
#pragma once

#include "solids/embree.hpp"
#include "solids/surface_view.hpp"
#include "text/dispatch.hpp"

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Hit {
    int lane; // the ray's id
    float distance;
    std::uint32_t place, triangle;
    float u, v;
};

// Embree's filter: every hit is noted in the vector of hits that asks, and refused, so that the ray goes on.
void note_hits(const RTCFilterFunctionNArguments *arguments);

// Whether two hits on one ray, one right behind the other, are one: a ray through the edge between two triangles meets
// both.
bool is_same(const PlaceView *places, const Hit &a, const Hit &b);

// Lane by lane, near first; of each, one.
void settle(const PlaceView *places, std::vector<Hit> &hits);

// The row of properties of what is hit.
const float *properties_of(const SurfaceView &surfaces, const Hit &hit);

// The share of light, of each colour, that passes straight through each of what a ray or, where a hit's lane is the
// ray's number, rays hit.
void transmittances_of(const SurfaceView &surfaces, std::span<const Hit> hits, std::span<const glm::vec3> origins,
                       std::span<const glm::vec3> directions, std::vector<glm::vec3> &out,
                       const InstructionSet &with = instruction_set());

struct VaryingKernels {
    // The same, of those hits whose materials vary; of the others nothing is written.
    void (*transmittances)(const SurfaceView &, std::span<const Hit>, std::span<const glm::vec3> origins,
                           std::span<const glm::vec3> directions, std::span<glm::vec3> out);
    // What a pattern gives at hits on one place, each seen against its normal from so near that nothing is filtered:
    // of each in turn all outputs. Positions in the world are given.
    void (*outputs)(const Pattern &, const PlaceView &, std::span<const Hit>, std::span<const glm::vec3> positions,
                    std::span<float> out);
    // The same of `count` rows of numbers that stand for channels.
    void (*of_rows)(const Pattern &, std::span<const float> rows, std::size_t count, std::span<float> out);
};

const VaryingKernels &varying_kernels(const InstructionSet &with = instruction_set());

// All that one ray meets, near first.
void all_hits(const SurfaceView &surfaces, const RayScene &among, const glm::vec3 &origin, const glm::vec3 &direction,
              float far, std::vector<Hit> &hits);

} // namespace sfumato
