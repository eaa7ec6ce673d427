// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sfumato {

// What a pattern may ask for of a point on a surface, each a number of a vector's from the first on.
namespace pattern_input {
enum {
    POSITION = 0,    // in the world, metres
    OWN = 3,         // in the shape's own space
    NORMAL = 6,      // shading normal in the world, towards the eye
    FACE = 9,        // the triangle's, likewise
    INCOMING = 12,   // from the point to the eye
    BACK = 15,       // 1 where the eye sees the back
    TO_WORLD = 16,   // nine, column by column
    STANDS_FOR = 25, // how far a sample stands for what is around it, pixels
    PLACE = 26,      // what is the same all over one place of a shape
    CHANNEL = 64     // what a shape has at its corners, interpolated
};
constexpr int MOST_PLACE_VALUES = CHANNEL - PLACE, MOST_CHANNELS = 64;
} // namespace pattern_input

} // namespace sfumato
