// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces send to each other: what rays from one bring of the next, and what is kept of it. Views own
// nothing.
#pragma once

#include "text/dispatch.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct FrameView; // frame/layers.hpp
struct LightView; // lights/light.hpp

// Around what of the cells is much brighter than most, of which few rays would find little: a ball, and what of light
// leaves it.
struct BrightPlace {
    glm::vec3 middle{0.0F};
    float radius = 0.0F, flux = 0.0F;
};

// What a white matt surface would send to all sides, of lights and of other surfaces, in cells of space for each of six
// ways to face. Cells are twice as large for each time that the distance to the eye doubles beyond `near`.
struct LightCacheView {
    const std::uint32_t *keys = nullptr; // of slots, where cell_slot() finds them; NO_CELL for none
    const glm::vec3 *direct = nullptr;   // of each slot: of lights
    const glm::vec3 *indirect = nullptr; // of surfaces, as what is met by a surface's last ray has it
    const glm::vec3 *settled = nullptr;  // the same with one bounce more, as what the eye sees has it
    std::uint32_t mask = 0;              // the number of slots, a power of two, less one
    glm::vec3 eye{0.0F};
    float size = 1.0F, near = 1.0F; // of the cells at the eye, metres
    static constexpr int MOST_BRIGHT = 8;
    std::array<BrightPlace, MOST_BRIGHT> bright{};
    int bright_count = 0;
};

constexpr std::uint32_t NO_CELL = 0xFFFFFFFFU;

// Of rays from a packet of surfaces, what they bring.
struct BounceRays {
    alignas(64) float origin[3][MAX_LANES], direction[3][MAX_LANES];
    alignas(64) float active[MAX_LANES];                      // 1, or 0 for lanes to spare
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES]; // as a Packet's
    // Whether the eye sees it as sharp as it is: what is met is shaded, and smoke stands before it. Else what is kept
    // of its light will do.
    bool closely = false;
    alignas(64) float radiance[3][MAX_LANES];
    alignas(64) float sky[3][MAX_LANES]; // of what meets nothing, for what is matt
};

// What rays meet first. The albedo is that of all layers together. Where nothing is hit, the emission is a sky's.
struct BouncePoint {
    bool hit = false;
    glm::vec3 position{0.0F}, normal{0.0F}, albedo{0.0F}, emission{0.0F};
};

struct BounceRay {
    glm::vec3 origin{0.0F}, direction{0.0F};
};

struct BounceKernels {
    void (*shine)(const FrameView &, BounceRays &);
    void (*meet)(const FrameView &, std::span<const BounceRay>, std::span<BouncePoint>);
    // Adds the places of which meet() does not tell, though the eye sees what comes to them: sheets before what rays
    // meet first, and the other sides of what light comes through. They send nothing to others.
    void (*meet_more)(const FrameView &, std::span<const BounceRay>, std::vector<BouncePoint> &);
    // What white matt surfaces at points, which are hit, send of lights. Each looks at them from its own place.
    void (*lit)(const FrameView &, std::span<const BouncePoint>, std::span<glm::vec3>);
};

struct BounceView {
    bool gloss = false, diffuse = false;     // if diffuse, light of a sky comes by the same way
    bool settled = false;                    // whether what is kept is all that is shown: while a view moves
    const LightCacheView *cache = nullptr;   // where diffuse
    const LightView *surroundings = nullptr; // white, of which gloss shows what it reflects of all
};

} // namespace sfumato
