// SPDX-License-Identifier: GPL-3.0-or-later
// How far a picture is from what it would be at converged settings, by a few of its pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sfumato {

// Of a picture the root of the mean squared error of all its pixels and colours, over the mean of its colours: an
// estimate, and where it is with a probability of 95 %.
struct Measured {
    double reported = 0.0, low = 0.0, high = 0.0;
    std::size_t pixels = 0;              // that were looked at,
    std::size_t frames = 0;              // of so many pictures
    double seconds = 0.0;                // that this took
    std::vector<std::string> unmeasured; // what of the picture counts as right
    // Of each group of pixels, which share what is random about lights: the mean squared error over the squared mean.
    std::vector<double> groups;
};

// Pixels of a picture, as many as `count` or a few more: one anywhere in each of as many equal parts of it. Depends on
// nothing else. x and y in turn.
std::vector<int> measured_pixels(int width, int height, int count, std::uint64_t seed);

// The estimate of all groups.
void summarise(Measured &measured);

} // namespace sfumato
