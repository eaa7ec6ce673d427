// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/film.hpp"

#include "text/camera_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace sfumato {
namespace {

// The integral of a filter from its left end, normalised to one, up to a share t of its diameter.
double cumulative_weight(Filter::Shape shape, double t) {
    if (shape == Filter::Shape::BOX) {
        return t;
    }
    if (shape == Filter::Shape::GAUSSIAN) { // Cycles cuts it at six standard deviations
        return 0.5 + 0.5 * std::erf(6.0 * std::numbers::sqrt2 * (t - 0.5));
    }
    return text::CameraText<double>().filter_share(t);
}

double radical_inverse(unsigned i) {
    double inverse = 0.0, digit = 0.5;
    for (; i != 0; i /= 2, digit /= 2.0) {
        inverse += digit * (i % 2);
    }
    return inverse;
}

// The place of each i in the order of key(i): a permutation that spreads as the key does, whatever the count.
template <typename Key>
std::vector<int> ranks(int count, const Key &key) {
    std::vector<int> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&key](int a, int b) { return key(a) < key(b); });
    std::vector<int> rank(order.size());
    for (int place = 0; place < count; ++place) {
        rank[static_cast<std::size_t>(order[static_cast<std::size_t>(place)])] = place;
    }
    return rank;
}

} // namespace

float filter_quantile(const Filter &filter, float u) {
    const double diameter = filter.diameter();
    double low = -0.5 * diameter, high = 0.5 * diameter;
    for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (low + high);
        (cumulative_weight(filter.shape, middle / diameter + 0.5) < static_cast<double>(u) ? low : high) = middle;
    }
    return static_cast<float>(0.5 * (low + high));
}

FilmSample first_look(int x, int y) {
    // A pixel and its eight neighbours take nine cells of a 4 x 4 grid. In this order, found by annealing, no straight
    // edge over a disk hides more than 0.18 of it from all nine, wherever they are; in Bayer's it is 0.26.
    constexpr std::array<int, 16> ORDER = {4, 13, 11, 2, 14, 1, 5, 8, 3, 10, 0, 15, 9, 7, 12, 6};
    const int cell = ORDER[static_cast<std::size_t>((y % 4) * 4 + x % 4)];
    const auto middle = [](int share) { return (static_cast<float>(share) + 0.5F) / 4.0F; };
    return {0.0F, 0.0F, middle(cell % 4), middle(cell / 4)};
}

std::vector<FilmSample> film_samples(int count, int turn, const Filter &filter) {
    std::vector<FilmSample> samples(static_cast<std::size_t>(count));
    const double golden = (std::sqrt(5.0) - 1.0) / 2.0;
    // Hammersley's points, scrambled from pixel to pixel, for the pixel; a lattice of the golden ratio for the lights,
    // walked in an order that has nothing to do with the position in the pixel. Lattice and walk are turned from pixel
    // to pixel. Every coordinate takes the middle of each of `count` equal shares once, so no pattern pulls to a side.
    const auto scrambled = [turn](int i) { return radical_inverse(static_cast<unsigned>(i) ^ unsigned(turn)); };
    const auto turned = [golden](int i, int by) { return std::fmod(golden * i + (by + 0.5) / FILM_TURNS, 1.0); };
    const std::vector<int> rows = ranks(count, scrambled);
    const std::vector<int> walk = ranks(count, [&](int i) { return turned(i, 5 * turn % FILM_TURNS); });
    const std::vector<int> lattice = ranks(count, [&](int i) { return turned(i, turn); });
    const auto middle = [count](int share) { return (share + 0.5) / count; };
    for (int i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        samples[at] = {filter_quantile(filter, static_cast<float>(middle(i))),
                       filter_quantile(filter, static_cast<float>(middle(rows[at]))),
                       static_cast<float>(middle(walk[at])),
                       static_cast<float>(middle(lattice[static_cast<std::size_t>(walk[at])]))};
    }
    return samples;
}

FilmPatterns film_patterns(int count, const Filter &filter) {
    FilmPatterns patterns;
    for (int turn = 0; turn < FILM_TURNS; ++turn) {
        patterns.push_back(film_samples(count, turn, filter));
    }
    return patterns;
}

} // namespace sfumato
