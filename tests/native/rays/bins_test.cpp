// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/bins.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#define SFUMATO_ISA bins_test
#include "rays/bins_lanes.hpp"

namespace sfumato {
namespace {

using bins_test::LANES;
using bins_test::Mask;
using bins_test::Real;

struct Primitives {
    std::vector<Footprint> footprints;
    std::vector<float> depths;

    [[nodiscard]] bool touch(std::size_t i, float low_x, float high_x, float low_y, float high_y) const {
        const Footprint &f = footprints[i];
        return f.low_x <= high_x && f.high_x >= low_x && f.low_y <= high_y && f.high_y >= low_y;
    }
};

// Of all sizes, some of them outside.
Primitives random_primitives(std::size_t count, int width, int height, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    Primitives out;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = (1.4F * unit(generator) - 0.2F) * float(width);
        const float y = (1.4F * unit(generator) - 0.2F) * float(height);
        const float w = 0.3F * float(width) * std::pow(unit(generator), 4.0F), h = w * unit(generator);
        out.footprints.push_back({x - w, x + w, y - h, y + h});
        out.depths.push_back(10.0F * unit(generator) - 5.0F);
    }
    return out;
}

// What is visited for lanes at x and y, of which those with an even number are asked for.
std::vector<std::int32_t> visited(const Bins &bins, const std::vector<float> &x, const std::vector<float> &y,
                                  std::size_t most = std::numeric_limits<std::size_t>::max()) {
    alignas(64) float px[LANES], py[LANES], active[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        px[lane] = x[static_cast<std::size_t>(lane) % x.size()];
        py[lane] = y[static_cast<std::size_t>(lane) % y.size()];
        active[lane] = lane % 2 == 0 ? 1.0F : 0.0F;
    }
    const Mask even = Real::load_aligned(active) > 0.0F;
    std::vector<std::int32_t> out;
    bins_test::for_primitives(bins.view(), Real::load_aligned(px), Real::load_aligned(py), even,
                              [&](std::int32_t number) {
                                  out.push_back(number);
                                  return out.size() < most;
                              });
    return out;
}

TEST(Bins, HoldsWhatTouchesACell) {
    const int width = 100, height = 61;
    const Primitives all = random_primitives(9000, width, height, 1);
    const Bins bins(all.footprints, all.depths, width, height);
    for (int y = 0; y < height; y += 7) {
        for (int x = 0; x < width; x += 5) {
            std::vector<std::int32_t> found = visited(bins, {float(x) + 0.5F}, {float(y) + 0.5F});
            std::sort(found.begin(), found.end());
            for (std::size_t i = 0; i < all.footprints.size(); ++i) {
                const bool is = std::binary_search(found.begin(), found.end(), static_cast<std::int32_t>(i));
                const auto left = float(x / Bins::EDGE * Bins::EDGE), low = float(y / Bins::EDGE * Bins::EDGE);
                const bool inside = all.touch(i, float(x), float(x + 1), float(y), float(y + 1));
                const bool near = all.touch(i, left, left + Bins::EDGE, low, low + Bins::EDGE);
                ASSERT_TRUE(is || !inside) << x << " " << y << " " << i;
                // At the rim are those of the margin, too.
                const bool rim =
                    x + Bins::EDGE >= width || y + Bins::EDGE >= height || x < Bins::EDGE || y < Bins::EDGE;
                ASSERT_TRUE(!is || near || rim) << x << " " << y << " " << i;
            }
        }
    }
}

TEST(Bins, VisitsEachOfSeveralCellsOnceInOrderOfDepth) {
    const int width = 200, height = 40;
    const Primitives all = random_primitives(5000, width, height, 2);
    const Bins bins(all.footprints, all.depths, width, height);
    const std::vector<std::int32_t> found = visited(bins, {2.0F, 0.0F, 30.0F, 0.0F}, {3.0F, 0.0F, 33.0F, 0.0F});
    ASSERT_GT(found.size(), 100U);
    for (std::size_t i = 1; i < found.size(); ++i) {
        ASSERT_LT(all.depths[static_cast<std::size_t>(found[i - 1])], all.depths[static_cast<std::size_t>(found[i])]);
    }
    std::vector<std::int32_t> both = visited(bins, {2.0F}, {3.0F});
    const std::vector<std::int32_t> other = visited(bins, {30.0F}, {33.0F});
    both.insert(both.end(), other.begin(), other.end());
    std::sort(both.begin(), both.end());
    both.erase(std::unique(both.begin(), both.end()), both.end());
    std::vector<std::int32_t> sorted = found;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, both);
    // A lane that is not asked for brings nothing.
    EXPECT_EQ(visited(bins, {2.0F, 30.0F}, {3.0F, 33.0F}), visited(bins, {2.0F}, {3.0F}));
    EXPECT_EQ(visited(bins, {2.0F}, {3.0F}, 3).size(), 3U);
}

TEST(Bins, WithoutDepthsKeepTheirOrder) {
    const Primitives all = random_primitives(3000, 64, 64, 3);
    const std::vector<std::int32_t> found = visited(Bins(all.footprints, {}, 64, 64), {20.0F}, {20.0F});
    ASSERT_GT(found.size(), 10U);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
}

TEST(Bins, WhatIsNoNumberOrEmptyTouchesNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const std::vector<Footprint> footprints = {
        {nan, 10.0F, 0.0F, 10.0F}, {0.0F, 10.0F, 0.0F, nan}, {1.0F, 0.0F, 0.0F, 1.0F}, {-inf, inf, -inf, inf}};
    const std::vector<float> depths = {nan, 0.0F, -1.0F, 2.0F};
    const Bins bins(footprints, depths, 20, 20);
    EXPECT_EQ(visited(bins, {1.0F}, {1.0F}), std::vector<std::int32_t>{3});
    EXPECT_TRUE(visited(Bins({}, {}, 20, 20), {1.0F}, {1.0F}).empty());
    EXPECT_TRUE(visited(Bins(), {1.0F}, {1.0F}).empty());
}

TEST(Bins, StayWithinMemoryWhereAllCoverEverything) {
    const std::vector<Footprint> footprints(1U << 16U, {0.0F, 1024.0F, 0.0F, 1024.0F});
    const Bins bins(footprints, {}, 1024, 1024);
    EXPECT_GE(bins.edge(), 32); // 2^16 times (1024 / 32)^2 are 2^26
    EXPECT_LE(bins.edge(), 64);
    EXPECT_EQ(visited(bins, {512.0F}, {9.0F}).size(), footprints.size());
}

} // namespace
} // namespace sfumato
