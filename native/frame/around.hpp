// SPDX-License-Identifier: GPL-3.0-or-later
// What pixels take from those around them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {

// Gives each pixel the best value of those up to `reach` pixels away in both directions; is_better(a, b).
template <typename Value, typename Better>
void take_from_around(int width, int height, int reach, const Better &is_better, std::vector<Value> &values) {
    const auto along = [&](int count, int others, auto at) {
        oneapi::tbb::parallel_for(0, others, [&](int other) {
            std::vector<Value> line(static_cast<std::size_t>(count));
            for (int i = 0; i < count; ++i) {
                Value best = values[at(i, other)];
                for (int j = std::max(i - reach, 0); j <= std::min(i + reach, count - 1); ++j) {
                    best = is_better(values[at(j, other)], best) ? values[at(j, other)] : best;
                }
                line[static_cast<std::size_t>(i)] = best;
            }
            for (int i = 0; i < count; ++i) {
                values[at(i, other)] = line[static_cast<std::size_t>(i)];
            }
        });
    };
    const auto at = [width](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    along(width, height, at);
    along(height, width, [&at](int y, int x) { return at(x, y); });
}

} // namespace sfumato
