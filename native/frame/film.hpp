// SPDX-License-Identifier: GPL-3.0-or-later
// Where in a pixel, and where on the lights, samples fall.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sfumato {

struct FilmSample {
    float x, y;             // pixels from the pixel's centre, distributed as the filter
    float light_u, light_v; // in [0, 1]^2, uniform: where on every light
};

// What a pixel takes from around its middle, as Cycles' filters have it.
struct Filter {
    enum class Shape : std::uint8_t { BLACKMAN_HARRIS, GAUSSIAN, BOX };
    Shape shape = Shape::BLACKMAN_HARRIS;
    float width = 1.5F; // in pixels, as Cycles counts it: two make Blackman and Harris's diameter, three Gauss's

    [[nodiscard]] double diameter() const {
        return shape == Shape::BOX ? 1.0 : static_cast<double>(width) * (shape == Shape::GAUSSIAN ? 3.0 : 2.0);
    }
};

// How often the pixels are sampled in which surfaces or their shadows change, and where.
struct Film {
    int edge_samples = 16;
    Filter filter;
};

// `count` well spread samples, for a pixel whose neighbours in a 4 x 4 tile take the other values of `turn`.
std::vector<FilmSample> film_samples(int count, int turn, const Filter &filter = {});

constexpr int FILM_TURNS = 16;

// The same of every turn.
using FilmPatterns = std::vector<std::vector<FilmSample>>;
FilmPatterns film_patterns(int count, const Filter &filter = {});

// For a first look of one sample a pixel, through the pixel's centre: where on the lights, so that a shadow's rim shows
// itself as a disagreement of neighbours. Repeats every 4 x 4 pixels.
FilmSample first_look(int x, int y);

// The position whose share of the filter's weight is u.
float filter_quantile(const Filter &filter, float u);

} // namespace sfumato
