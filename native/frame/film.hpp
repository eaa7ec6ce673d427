// SPDX-License-Identifier: GPL-3.0-or-later
// Where in a pixel, and where on the lights, samples fall.
#pragma once

#include <array>
#include <vector>

namespace sfumato {

struct FilmSample {
    float x, y;             // pixels from the pixel's centre, distributed as the filter
    float light_u, light_v; // in [0, 1]^2, uniform: where on every light
};

// `count` well spread samples, for a pixel whose neighbours in a 4 x 4 tile take the other values of `turn`.
std::vector<FilmSample> film_samples(int count, int turn);

constexpr int FILM_TURNS = 16;

// For a first look of one sample a pixel, through the pixel's centre: where on the lights, so that a shadow's rim shows
// itself as a disagreement of neighbours. Repeats every 4 x 4 pixels.
FilmSample first_look(int x, int y);

// Blackman and Harris, over a diameter of 3 pixels: Cycles' default filter, "width 1.5".
// Returns the position whose share of the filter's weight is u.
float blackman_harris_quantile(float u);

} // namespace sfumato
