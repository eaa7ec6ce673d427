// SPDX-License-Identifier: GPL-3.0-or-later
// The primitives that a packet of rays may meet.
#pragma once

#include "rays/bins.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace sfumato::SFUMATO_ISA {
namespace {

// Calls visit(number) for each primitive that touches a cell in which a lane lies, once, near ones first, until it
// returns false. x and y are pixels; lanes that are not `active` are left out.
template <typename Visit>
inline void for_primitives(const BinsView &bins, Real x, Real y, Mask active, const Visit &visit) {
    if (bins.columns == 0 || !xsimd::any(active)) {
        return;
    }
    const auto cell = [&bins](Real place, int count) {
        return clamp(floor(place * bins.per_edge), 0.0F, static_cast<float>(count - 1));
    };
    alignas(64) float columns[LANES], rows[LANES], asked[LANES];
    cell(x, bins.columns).store_aligned(columns);
    cell(y, bins.rows).store_aligned(rows);
    pick(active, 1.0F, 0.0F).store_aligned(asked);
    int cells[LANES];
    const std::int32_t *next[LANES], *end[LANES];
    int lists = 0;
    for (int lane = 0; lane < LANES; ++lane) {
        const int here = static_cast<int>(rows[lane]) * bins.columns + static_cast<int>(columns[lane]);
        if (asked[lane] == 0.0F || std::find(cells, cells + lists, here) != cells + lists) {
            continue;
        }
        cells[lists] = here;
        next[lists] = bins.ranks + bins.begin[here];
        end[lists] = bins.ranks + bins.begin[here + 1];
        lists += next[lists] < end[lists] ? 1 : 0;
    }
    while (lists > 0) {
        std::int32_t rank = *next[0];
        for (int i = 1; i < lists; ++i) {
            rank = std::min(rank, *next[i]);
        }
        if (!visit(bins.numbers[rank])) {
            return;
        }
        for (int i = 0; i < lists;) {
            next[i] += *next[i] == rank ? 1 : 0;
            if (next[i] < end[i]) {
                ++i;
                continue;
            }
            --lists;
            next[i] = next[lists];
            end[i] = end[lists];
        }
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
