// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that rays meet: no hit is lost, however near to another, and none comes twice.
#pragma once

#include "solids/embree.hpp"
#include "solids/surface_view.hpp"

#include <cstdint>
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

// The share of light, of each of three colours, that passes straight through what is hit.
const float *transmittance_of(const SurfaceView &surfaces, const Hit &hit);

// All that one ray meets, near first.
void all_hits(const SurfaceView &surfaces, const RayScene &among, const glm::vec3 &origin, const glm::vec3 &direction,
              float far, std::vector<Hit> &hits);

} // namespace sfumato
