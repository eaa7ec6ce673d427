// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/film.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

// Harris, "On the use of windows for harmonic analysis", 1978: the four-term window, at x pixels from the centre.
double window(double x) {
    const double t = 2.0 * std::numbers::pi * (x / 3.0 + 0.5);
    return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) - 0.01168 * std::cos(3.0 * t);
}

// The integral of x^power times the window from its left end to `end`.
double moment(int power, double end) {
    const int count = 3000;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        const double x = -1.5 + (end + 1.5) * (i + 0.5) / count;
        sum += std::pow(x, power) * window(x) * (end + 1.5) / count;
    }
    return sum;
}

const double variance = moment(2, 1.5) / moment(0, 1.5);

TEST(FilterQuantile, IsTheInverseOfTheWindowsIntegral) {
    for (int i = 1; i < 100; ++i) {
        const float u = float(i) / 100.0F;
        const auto x = double{filter_quantile({}, u)};
        EXPECT_NEAR(moment(0, x) / moment(0, 1.5), u, 1e-5) << u;
    }
}

TEST(FilterQuantile, IsSymmetricAndRises) {
    EXPECT_NEAR(filter_quantile({}, 0.5F), 0.0F, 1e-6);
    EXPECT_NEAR(filter_quantile({}, 0.0F), -1.5F, 1e-2);
    float last = -1.6F;
    for (int i = 0; i <= 128; ++i) {
        const float u = float(i) / 128.0F, x = filter_quantile({}, u);
        EXPECT_GT(x, last);
        EXPECT_LE(std::abs(x), 1.5F);
        if (i > 0 && i < 128) {
            EXPECT_NEAR(x, -filter_quantile({}, 1.0F - u), 1e-5) << u;
        }
        last = x;
    }
}

TEST(FilterQuantile, HasCyclesShapesAndWidths) {
    const Filter box{Filter::Shape::BOX, 1.5F}, wide{Filter::Shape::BLACKMAN_HARRIS, 3.0F};
    const Filter gauss{Filter::Shape::GAUSSIAN, 1.5F}; // exp(-2 (6 x / 4.5)^2): a standard deviation of 3 / 8
    for (int i = 1; i < 32; ++i) {
        const float u = float(i) / 32.0F;
        EXPECT_NEAR(filter_quantile(box, u), u - 0.5F, 1e-6);
        EXPECT_NEAR(filter_quantile(wide, u), 2.0F * filter_quantile({}, u), 1e-6);
        const double x = double{filter_quantile(gauss, u)};
        EXPECT_NEAR(0.5 * std::erfc(-x / (0.375 * std::numbers::sqrt2)), double{u}, 1e-6);
    }
}

// No pixel's pattern pulls to a side, and its spread is the filter's, but for what the middles of shares leave out.
TEST(FilmSamples, FollowTheFilter) {
    for (const int count : {4, 16, 49, 64}) {
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            const std::vector<FilmSample> samples = film_samples(count, turn);
            ASSERT_EQ(samples.size(), std::size_t(count));
            double mean_x = 0.0, mean_y = 0.0, square_x = 0.0, square_y = 0.0;
            for (const FilmSample &s : samples) {
                mean_x += double{s.x} / count;
                mean_y += double{s.y} / count;
                square_x += double{s.x} * double{s.x} / count;
                square_y += double{s.y} * double{s.y} / count;
            }
            EXPECT_NEAR(mean_x, 0.0, 1e-6) << count << ", turn " << turn;
            EXPECT_NEAR(mean_y, 0.0, 1e-6) << count << ", turn " << turn;
            EXPECT_NEAR(square_x, variance, 1.1 * variance / count) << count << ", turn " << turn;
            EXPECT_NEAR(square_y, variance, 1.1 * variance / count) << count << ", turn " << turn;
        }
    }
}

// Neighbours ask in different places, so that what one misses the next may find.
TEST(FilmSamples, DifferFromTurnToTurn) {
    const std::vector<FilmSample> first = film_samples(16, 0);
    for (int turn = 1; turn < FILM_TURNS; ++turn) {
        double apart = 0.0;
        const std::vector<FilmSample> other = film_samples(16, turn);
        for (std::size_t i = 0; i < 16; ++i) {
            apart += std::abs(double{first[i].y} - double{other[i].y});
        }
        EXPECT_GT(apart, 1.0) << turn;
    }
}

// Strips of equal area, along either side of the lights' square, hold equal shares of the samples, whatever their
// number; so do the square's quarters, but for what a lattice leaves at their borders.
TEST(FilmSamples, FillTheLightsEvenly) {
    for (const int count : {7, 16, 49, 64, 256}) {
        for (const int turn : {0, 5}) {
            double x = 0.0, y = 0.0;
            std::array<std::vector<int>, 3> shares{std::vector<int>(4), std::vector<int>(4), std::vector<int>(4)};
            for (const FilmSample &s : film_samples(count, turn)) {
                ASSERT_GE(std::min(s.light_u, s.light_v), 0.0F);
                ASSERT_LT(std::max(s.light_u, s.light_v), 1.0F);
                ++shares[0][std::size_t(4.0F * s.light_u)];
                ++shares[1][std::size_t(4.0F * s.light_v)];
                ++shares[2][std::size_t(2.0F * s.light_u) + 2 * std::size_t(2.0F * s.light_v)];
                x += (2.0 * double{s.light_u} - 1.0) / count;
                y += (2.0 * double{s.light_v} - 1.0) / count;
            }
            EXPECT_LT(std::hypot(x, y), 0.6 / std::sqrt(count)) << count;
            for (const std::vector<int> &share : shares) {
                const int slack = &share == &shares[2] ? 2 : 1;
                EXPECT_LE(*std::max_element(share.begin(), share.end()), count / 4 + slack) << count;
                EXPECT_GE(*std::min_element(share.begin(), share.end()), count / 4 - slack) << count;
            }
        }
    }
}

// Which part of a light a sample asks for says nothing about where in the pixel it asks.
TEST(FilmSamples, DoNotPairThePixelWithTheLights) {
    for (const int count : {16, 49, 64}) {
        // Means of products, over all turns: of the position with the place on the light, and with its ring.
        std::array<double, 6> products{};
        for (int turn = 0; turn < FILM_TURNS; ++turn) {
            for (const FilmSample &s : film_samples(count, turn)) {
                const double x = double{s.x}, y = double{s.y}, a = 2.0 * double{s.light_u} - 1.0,
                             b = 2.0 * double{s.light_v} - 1.0;
                const double ring = 2.0 * std::max(a * a, b * b) - 1.0;
                const std::array<double, 6> values{x * a, x * b, y * a, y * b, x * ring, y * ring};
                for (std::size_t i = 0; i < 6; ++i) {
                    products[i] += values[i] / (double(count) * FILM_TURNS);
                }
            }
        }
        for (const double product : products) { // at most about the product of the spreads, 0.2
            EXPECT_LT(std::abs(product), 0.03) << count;
        }
    }
}

} // namespace
} // namespace sfumato
