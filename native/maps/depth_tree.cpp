// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/depth_tree.hpp"

#include <algorithm>
#include <cstddef>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {

DepthTree::DepthTree(const float *depth, int across, int down) : width(across), height(down) {
    int w = width, h = height;
    std::int32_t size = 0;
    std::array<int, MOST_TREE_LEVELS + 1> rows{};
    for (levels = 0;; ++levels) {
        const auto level = static_cast<std::size_t>(levels);
        first[level] = size;
        row[level] = w;
        rows[level] = h;
        size += w * h;
        if (std::max(w, h) == 1 || levels == MOST_TREE_LEVELS) {
            break;
        }
        w = (w + 1) / 2;
        h = (h + 1) / 2;
    }
    low.resize(static_cast<std::size_t>(size));
    high.resize(low.size());
    oneapi::tbb::parallel_for(0, height, [&](int y) {
        const std::ptrdiff_t at = std::ptrdiff_t{y} * width;
        std::copy_n(depth + at, width, low.begin() + at);
        std::copy_n(depth + at, width, high.begin() + at);
    });
    for (std::size_t level = 1; level <= static_cast<std::size_t>(levels); ++level) {
        const int fine_rows = rows[level - 1], fine_row = row[level - 1];
        oneapi::tbb::parallel_for(0, rows[level], [&, level, fine_rows, fine_row](int y) {
            const int y1 = std::min(2 * y + 1, fine_rows - 1);
            const std::ptrdiff_t a = first[level - 1] + std::ptrdiff_t{2 * y} * fine_row;
            const std::ptrdiff_t b = first[level - 1] + std::ptrdiff_t{y1} * fine_row;
            const std::ptrdiff_t out = first[level] + std::ptrdiff_t{y} * row[level];
            const auto combine = [&](std::vector<float> &of, int x, const auto &better) {
                const int x0 = 2 * x, x1 = std::min(x0 + 1, fine_row - 1);
                const auto *const fine = of.data();
                of[static_cast<std::size_t>(out + x)] =
                    better(better(fine[a + x0], fine[a + x1]), better(fine[b + x0], fine[b + x1]));
            };
            for (int x = 0; x < row[level]; ++x) {
                combine(low, x, [](float p, float q) { return std::min(p, q); });
                combine(high, x, [](float p, float q) { return std::max(p, q); });
            }
        });
    }
}

} // namespace sfumato
