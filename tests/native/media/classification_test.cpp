// SPDX-License-Identifier: GPL-3.0-or-later
// Rays through smoke under transfer functions, against the judge's straight lines between 256 points a cell.
#include "../support/ramps.hpp"
#include "../support/reference_scenes.hpp"
#include "media/classification.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using testing::cliffs;
using testing::edges;
using testing::judged;
using testing::peaks;
using testing::smooth_ramp;
using testing::steps;

// The roughest smoke: every cell by itself.
const Medium &rough() {
    static const Medium medium = reference::testing::random_medium({12, 9, 10}, glm::mat4(1.0F), 31);
    return medium;
}

// A cloud that each cell sees a tenth of.
const Medium &soft() {
    static const Medium medium = [] {
        Medium cloud = reference::testing::uniform_medium({24, 24, 24}, 0.0F, glm::mat4(1.0F));
        for (std::size_t i = 0; i < cloud.density.size(); ++i) {
            const glm::dvec3 cell(i % 24, i / 24 % 24, i / (24 * 24));
            const double out = glm::distance(cell, glm::dvec3(11.5)) / 11.0;
            cloud.density[i] = static_cast<float>(std::max(0.0, 1.0 - out * out * (1.0 + 0.2 * std::sin(cell.x))));
        }
        return cloud;
    }();
    return medium;
}

DenseCells cells_of(const Medium &medium) {
    return {medium.density.data(), glm::ivec3(medium.resolution)};
}

std::vector<CellRay> rays_through(const Medium &medium, int count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(0.1, 0.9);
    const glm::dvec3 size(medium.resolution);
    std::vector<CellRay> rays;
    for (int i = 0; i < count; ++i) {
        const auto any = [&] { return size * glm::dvec3(uniform(generator), uniform(generator), uniform(generator)); };
        const glm::dvec3 inside = any(), along = 2.0 * glm::normalize(any() - inside) * size.x;
        rays.push_back({inside - along, inside + along});
    }
    rays[0] = {{-3.0, 5.5, 4.5}, {20.0, 5.5, 4.5}}; // through centres of cells, along an axis
    rays[1] = {{-1.0, -1.0, -1.0}, {13.0, 13.0, 13.0}};
    rays[2] = {{4.2, 3.1, 5.0}, {4.3, 3.3, 5.1}}; // within a cell
    return rays;
}

// By the mean radiance.
double error_of(const Medium &medium, const Ramp &ramp, Classification how, double step,
                std::span<const CellRay> rays) {
    const TransferFunction transfer(ramp);
    const PreintegratedTable table = table_for(cells_of(medium), ramp, step, 256);
    double squares = 0.0, sum = 0.0;
    for (const CellRay &ray : rays) {
        const glm::dvec3 sent(classify(cells_of(medium), ray, transfer, how, step, &table).sent);
        const glm::dvec3 exact(reference::sent_along(judged(ramp), medium, ray.from, ray.to));
        squares += glm::dot(sent - exact, sent - exact);
        sum += exact.x + exact.y + exact.z;
    }
    const double count = 3.0 * double(rays.size());
    return std::sqrt(squares / count) / (sum / count);
}

TEST(Cubic, GoesThroughItsFourValuesAndTurnsWhereItsSlopeIsZero) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    using Text = text::PreintegrationText<double>;
    int turning = 0;
    for (int n = 0; n < 200; ++n) {
        double s[4];
        for (double &value : s) {
            value = n == 0 ? 0.3 : uniform(generator);
        }
        const Text::Cubic cubic = Text().cubic_through(s[0], s[1], s[2], s[3]);
        for (int i = 0; i < 4; ++i) {
            EXPECT_NEAR(Text().cubic_at(cubic, i / 3.0), s[i], 1e-14);
        }
        const Text::Turns turns = Text().turns_of(cubic);
        EXPECT_LE(turns.first, turns.second);
        double wanted[2] = {1.0, 1.0}, slope = cubic.c1;
        int found = 0;
        for (int i = 1; i <= 10'000; ++i) {
            const double u = i / 10'000.0, next = cubic.c1 + u * (2.0 * cubic.c2 + 3.0 * u * cubic.c3);
            if ((next > 0.0) != (slope > 0.0) && found < 2 && u < 1.0) {
                wanted[found++] = u - 0.5e-4;
            }
            slope = next;
        }
        EXPECT_NEAR(turns.first, wanted[0], 1e-4);
        EXPECT_NEAR(turns.second, wanted[1], 1e-4);
        turning += found;
        const double value = s[0] + 0.37 * (Text().cubic_at(cubic, turns.first) - s[0]);
        EXPECT_NEAR(Text().cubic_at(cubic, Text().cubic_crossing(cubic, 0.0, turns.first, value)), value, 1e-6);
    }
    EXPECT_GT(turning, 100);
}

TEST(Split, IsExactInTheRoughestSmoke) {
    const auto rays = rays_through(rough(), 40, 5);
    EXPECT_LT(error_of(rough(), smooth_ramp(), Classification::SPLIT, 1.0, rays), 2e-4);
    EXPECT_LT(error_of(rough(), peaks(), Classification::SPLIT, 1.0, rays), 3e-4);
    EXPECT_LT(error_of(rough(), steps(), Classification::SPLIT, 1.0, rays), 3e-4);
    EXPECT_LT(error_of(rough(), edges(), Classification::SPLIT, 1.0, rays), 3e-4);
    EXPECT_LT(error_of(rough(), cliffs(), Classification::SPLIT, 1.0, rays), 3e-4);
}

TEST(Split, TakesThreeSamplesACell) {
    const CellRay ray{{-3.0, 5.5, 4.5}, {20.0, 5.5, 4.5}};
    const Classified found =
        classify(cells_of(rough()), ray, TransferFunction(peaks()), Classification::SPLIT, 1.0, nullptr);
    EXPECT_EQ(found.samples, 1U + 3U * 24U); // 22 whole cells and two halves
}

// Smoke where there is none: a ramp may begin above zero.
TEST(Split, GoesOnOutsideOfTheGrid) {
    const Ramp ramp{{0.5}, {0.1}, {glm::dvec3(1.0)}, true, false};
    for (const Classification how : {Classification::POST, Classification::MEAN_SOURCE, Classification::SPLIT}) {
        const Classified found = classify(cells_of(rough()), {{-9.0, 2.0, 2.2}, {30.5, 5.0, 2.1}},
                                          TransferFunction(ramp), how, 1.0, nullptr);
        const double length = glm::distance(glm::dvec3(-9.0, 2.0, 2.2), glm::dvec3(30.5, 5.0, 2.1));
        EXPECT_NEAR(found.sent.w, std::exp(-0.1 * length), 1e-9); // the text's literals are floats
        EXPECT_NEAR(found.sent.x, 1.0 - found.sent.w, 1e-9);
    }
}

// Where a step's number goes straight, the table is exact, and the others are not.
TEST(Steps, ApproachTheTruth) {
    const auto rays = rays_through(soft(), 25, 6);
    for (const Ramp &ramp : {smooth_ramp(), peaks(), steps()}) {
        for (const Classification how : {Classification::POST, Classification::MEAN_SOURCE, Classification::FULL}) {
            const double coarse = error_of(soft(), ramp, how, 1.0, rays),
                         fine = error_of(soft(), ramp, how, 0.25, rays);
            EXPECT_LT(fine, 0.4 * coarse) << static_cast<int>(how) << " of the ramp with " << ramp.stops.size();
        }
    }
    EXPECT_LT(error_of(soft(), peaks(), Classification::FULL, 1.0, rays),
              0.5 * error_of(soft(), peaks(), Classification::POST, 1.0, rays));
}

TEST(Chosen, IsTheCheapestThatMeetsTheErrorAndNoWorseThanTheBest) {
    const auto rays = rays_through(soft(), 30, 7), others = rays_through(soft(), 30, 8);
    for (const Ramp &ramp : {smooth_ramp(), peaks(), steps()}) {
        const TransferFunction transfer(ramp);
        const auto any = choose_classification(cells_of(soft()), rays, transfer, 1.0, 10.0, 256);
        EXPECT_NE(any.how, Classification::SPLIT);
        const auto none = choose_classification(cells_of(soft()), rays, transfer, 1.0, 1e-9, 256);
        EXPECT_EQ(none.how, Classification::SPLIT);
        double least = 1.0;
        for (std::size_t i = 0; i < STEPPED; ++i) {
            EXPECT_NEAR(any.errors[i], error_of(soft(), ramp, static_cast<Classification>(i), 1.0, rays), 2e-3);
            least = std::min(least, error_of(soft(), ramp, static_cast<Classification>(i), 1.0, others));
        }
        EXPECT_LE(error_of(soft(), ramp, any.how, 1.0, others), 1.05 * least) << ramp.stops.size();
    }
}

} // namespace
} // namespace sfumato
