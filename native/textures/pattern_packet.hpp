// SPDX-License-Identifier: GPL-3.0-or-later
// Between the lane files that share it: a packet of points on surfaces, and the patterns that are run for it.
#pragma once

#include "text/dispatch.hpp"
#include "textures/pattern.hpp"
#include "textures/pattern_place.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace sfumato {

// Of each point also two that are a pixel further, along its axes.
struct PatternPacket {
    alignas(64) float position[3][3][MAX_LANES];
    alignas(64) float u[3][MAX_LANES], v[3][MAX_LANES]; // on the triangle
    alignas(64) float normal[3][MAX_LANES], face[3][MAX_LANES], incoming[3][MAX_LANES], back[MAX_LANES];
    float stands_for = 1.0F; // the width of what each is a mean of, pixels
    const PatternPlace *place[MAX_LANES] = {};
    std::uint32_t triangle[MAX_LANES] = {};
    const float *row[MAX_LANES] = {}; // in place of the shape's channels, or null
};

struct PatternRegisters {
    alignas(64) float of[PATTERN_REGISTERS][MAX_LANES];
};

namespace SFUMATO_ISA {
// Fills the registers that some of a pattern's steps write.
void run_pattern(const Pattern &pattern, std::span<const PatternStep> steps, const PatternPacket &packet,
                 PatternRegisters &registers);
} // namespace SFUMATO_ISA

} // namespace sfumato
