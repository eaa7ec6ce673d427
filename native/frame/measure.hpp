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
    double seconds = 0.0;                // that the last of them took
    std::vector<std::string> unmeasured; // what of the picture counts as right
    // Of the squared error: its mean, the variance of that, and the degrees of freedom by which this is known.
    double mean = 0.0, variance = 0.0, freedom = 1.0;

    // Counts what was found of other pictures, too.
    void add(const Measured &earlier);
    void summarise();
};

} // namespace sfumato
