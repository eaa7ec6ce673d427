// SPDX-License-Identifier: GPL-3.0-or-later
// Which pixels of a picture are looked at, to tell how wrong it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sfumato {

// The mean of a picture's colours.
double brightness(std::span<const float> picture);

// Where a picture may be as wrong, by what it shows: pixels that are alike in that, of which some are looked at.
struct PixelClass {
    std::size_t count = 0;           // in the picture
    bool edges = false;              // whether they differ much from those around them
    std::vector<std::size_t> chosen; // their numbers, row by row
};

// About `count` pixels of a picture RGBA, most of them where it may be most wrong, none twice: in each class those
// whose numbers, mixed with the seed, are lowest. So a picture that hardly differs is looked at in the same places.
std::vector<PixelClass> measured_pixels(std::span<const float> picture, int width, int height, int count,
                                        std::uint64_t seed);

} // namespace sfumato
