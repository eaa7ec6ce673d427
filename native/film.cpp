// SPDX-License-Identifier: GPL-3.0-or-later
#include "film.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sfumato {
namespace {

constexpr double DIAMETER = 3.0;
constexpr double TURN = 2.0 * std::numbers::pi;

// The integral of the window from its left end, normalised to one.
double cumulative_weight(double x) {
    constexpr double A0 = 0.35875, A1 = 0.48829, A2 = 0.14128, A3 = 0.01168;
    const double t = x / DIAMETER + 0.5;
    return t - (A1 * std::sin(TURN * t) - A2 / 2.0 * std::sin(2.0 * TURN * t) + A3 / 3.0 * std::sin(3.0 * TURN * t)) /
                   (TURN * A0);
}

double radical_inverse(unsigned i) {
    double inverse = 0.0, digit = 0.5;
    for (; i != 0; i /= 2, digit /= 2.0) {
        inverse += digit * (i % 2);
    }
    return inverse;
}

} // namespace

float blackman_harris_quantile(float u) {
    double low = -0.5 * DIAMETER, high = 0.5 * DIAMETER;
    for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (low + high);
        (cumulative_weight(middle) < static_cast<double>(u) ? low : high) = middle;
    }
    return static_cast<float>(0.5 * (low + high));
}

std::vector<FilmSample> film_samples(int count, int turn) {
    std::vector<FilmSample> samples(static_cast<std::size_t>(count));
    const double shift = (turn + 0.5) / FILM_TURNS;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        // Hammersley points, shifted from pixel to pixel, for the pixel; a sunflower for the sun, walked in an order
        // that has nothing to do with the position in the pixel, and turned.
        const double u = std::fmod((i + 0.5) / count + shift, 1.0);
        const double v =
            std::fmod(radical_inverse(static_cast<unsigned>(i)) + radical_inverse(static_cast<unsigned>(turn)), 1.0);
        const int petal = (i * 7 + 3) % count;
        const double radius = std::sqrt((petal + 0.5) / count);
        const double angle = golden * petal + TURN * shift;
        samples[static_cast<std::size_t>(i)] = {
            blackman_harris_quantile(static_cast<float>(u)), blackman_harris_quantile(static_cast<float>(v)),
            static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))};
    }
    return samples;
}

} // namespace sfumato
