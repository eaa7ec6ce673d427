// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/bins.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

namespace sfumato {
namespace {

constexpr std::int64_t MOST_RANKS = std::int64_t{1} << 26;

// The cells that a footprint touches, of both rows and columns the last one too; none where first is beyond last.
struct Touched {
    int first_x = 0, last_x = -1, first_y = 0, last_y = -1;

    [[nodiscard]] std::int64_t count() const {
        return std::int64_t{std::max(last_x - first_x + 1, 0)} * std::max(last_y - first_y + 1, 0);
    }
};

struct Plane {
    float width, height;
    int edge, columns, rows;

    Plane(int w, int h, int cell)
        : width(static_cast<float>(w)), height(static_cast<float>(h)), edge(cell), columns((w + cell - 1) / cell),
          rows((h + cell - 1) / cell) {}

    [[nodiscard]] Touched touched(const Footprint &footprint) const {
        constexpr float MARGIN = Bins::MARGIN;
        const Footprint &f = footprint;
        // Written so that no number counts as touching nothing.
        const bool any = f.low_x <= f.high_x && f.low_y <= f.high_y && f.high_x > -MARGIN && f.low_x < width + MARGIN &&
                         f.high_y > -MARGIN && f.low_y < height + MARGIN;
        if (!any) {
            return {};
        }
        return {cell(f.low_x, columns), cell(f.high_x, columns), cell(f.low_y, rows), cell(f.high_y, rows)};
    }

private:
    [[nodiscard]] int cell(float place, int count) const {
        const float most = static_cast<float>(count) - 1.0F;
        return static_cast<int>(std::clamp(std::floor(place / static_cast<float>(edge)), 0.0F, most));
    }
};

// Primitives in the order of their depths; of equal ones, and where there are none, in that of their numbers.
std::vector<std::int32_t> by_depth(std::span<const float> depths, std::size_t count) {
    std::vector<std::int32_t> numbers(count);
    if (depths.empty()) {
        std::iota(numbers.begin(), numbers.end(), 0);
        return numbers;
    }
    // A float's bits, turned so that they sort as it does, before the number.
    std::vector<std::uint64_t> keys(count);
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const auto bits = std::bit_cast<std::uint32_t>(depths[i]);
        const std::uint32_t turned = (bits >> 31U) != 0 ? ~bits : bits | 0x80000000U;
        keys[i] = std::uint64_t{turned} << 32U | i;
    });
    oneapi::tbb::parallel_sort(keys.begin(), keys.end());
    for (std::size_t rank = 0; rank < count; ++rank) {
        numbers[rank] = static_cast<std::int32_t>(keys[rank] & 0xFFFFFFFFU);
    }
    return numbers;
}

} // namespace

Bins::Bins(std::span<const Footprint> footprints, std::span<const float> depths, int width, int height)
    : numbers_(by_depth(depths, footprints.size())) {
    // Each part of the ranks counts what it puts into each cell, so that it knows where to put it.
    constexpr std::size_t SHARE = 4096, MOST_PARTS = 16;
    const std::size_t count = footprints.size(), parts = std::clamp(count / SHARE, std::size_t{1}, MOST_PARTS);
    const auto for_parts = [&](const auto &body) {
        oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
            for (std::size_t rank = count * part / parts; rank < count * (part + 1) / parts; ++rank) {
                body(part, rank, footprints[static_cast<std::size_t>(numbers_[rank])]);
            }
        });
    };
    for (const int largest = std::max(width, height); edge_ < largest; edge_ *= 2) {
        std::vector<std::int64_t> touched(parts, 0);
        const Plane plane(width, height, edge_);
        for_parts(
            [&](std::size_t part, std::size_t, const Footprint &f) { touched[part] += plane.touched(f).count(); });
        if (std::accumulate(touched.begin(), touched.end(), std::int64_t{0}) <= MOST_RANKS) {
            break;
        }
    }
    const Plane plane(width, height, edge_);
    columns_ = plane.columns;
    rows_ = plane.rows;
    const std::size_t cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
    const auto for_cells = [&](const Footprint &footprint, const auto &body) {
        const Touched touched = plane.touched(footprint);
        for (int y = touched.first_y; y <= touched.last_y; ++y) {
            for (int x = touched.first_x; x <= touched.last_x; ++x) {
                body(static_cast<std::size_t>(y * columns_ + x));
            }
        }
    };
    std::vector<std::uint32_t> next(parts * cells, 0); // of each part, for each cell
    for_parts([&](std::size_t part, std::size_t, const Footprint &footprint) {
        for_cells(footprint, [&](std::size_t cell) { ++next[part * cells + cell]; });
    });
    begin_.resize(cells + 1);
    std::uint32_t sum = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        begin_[cell] = sum;
        for (std::size_t part = 0; part < parts; ++part) {
            const std::uint32_t here = next[part * cells + cell];
            next[part * cells + cell] = sum;
            sum += here;
        }
    }
    begin_[cells] = sum;
    ranks_.resize(sum);
    for_parts([&](std::size_t part, std::size_t rank, const Footprint &footprint) {
        for_cells(footprint,
                  [&](std::size_t cell) { ranks_[next[part * cells + cell]++] = static_cast<std::int32_t>(rank); });
    });
}

BinsView Bins::view() const {
    BinsView view;
    view.columns = columns_;
    view.rows = rows_;
    view.per_edge = 1.0F / static_cast<float>(edge_);
    view.begin = begin_.data();
    view.ranks = ranks_.data();
    view.numbers = numbers_.data();
    return view;
}

} // namespace sfumato
