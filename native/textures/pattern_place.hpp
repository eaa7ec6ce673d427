// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace sfumato {

// What patterns may ask for of one place of a shape. Owns nothing.
struct PatternPlace {
    const float *vertices = nullptr;
    const std::uint32_t *triangles = nullptr;
    const float *channels = nullptr; // of each corner, so many
    std::uint32_t channel_count = 0;
    const float *values = nullptr; // what is the same all over it
    float to_world[9];
};

} // namespace sfumato
