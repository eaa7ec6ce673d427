// SPDX-License-Identifier: GPL-3.0-or-later
// What a GPU draws of a frame in whatever order it comes: puffs as sprites, strands and sheets as triangles, each with
// the light that it sends to the eye. In the frame's space, metres.
#pragma once

#include "media/particle_view.hpp"
#include "media/strand_view.hpp"

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct FrameView; // frame/layers.hpp

// One each: opacity through the middle, and radiance at an opacity of 1.
struct Sprites {
    std::vector<glm::vec3> points, colour;
    std::vector<float> radius, opacity;
};

// Three corners and colours each, and one opacity. Of a strand's, each corner also has how far it is from the strand's
// middle, and half of the strand's width, in pixels; a sheet's have 0.
struct Triangles {
    std::vector<glm::vec3> corners, colour;
    std::vector<glm::vec2> strip;
    std::vector<float> opacity;
};

// A point of a sheet as it is seen.
struct SheetPoint {
    glm::vec3 point, direction; // of the ray that ends there, of unit length
    float distance;
    std::uint32_t place, triangle; // as Embree numbers them
    float u, v;                    // on the triangle
};

// The light that things send to the eye, were they opaque.
struct DrawnKernels {
    // `past_smoke`: past what smoke and particles take of it, too; past solids in any case.
    void (*puffs)(const FrameView &, std::span<const Puff>, std::span<const glm::vec3> directions, bool past_smoke,
                  std::span<glm::vec3> out);
    // Of the middles of segments.
    void (*strands)(const FrameView &, std::span<const StrandSegment>, std::span<glm::vec3> out);
    void (*sheets)(const FrameView &, std::span<const SheetPoint>, std::span<glm::vec3> out);
};

} // namespace sfumato
