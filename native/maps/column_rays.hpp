// SPDX-License-Identifier: GPL-3.0-or-later
// From the absorbers on a map's rays to its texels, of whatever basis, or curves.
#pragma once

#include "maps/light_map.hpp"
#include "rays/basis.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace sfumato {

// What lies on one light ray, as column densities, and the range of depths that its series spans.
struct ColumnRay {
    std::vector<float> depth, column;
    float slice = 0.0F; // the extent in depth of each
    float total = 0.0F;
    Range range;

    [[nodiscard]] Absorbers absorbers() const { return {depth, column, slice}; }
};

// The rays of a map, in strips that may be asked for on any thread.
using UseRay = std::function<void(std::size_t texel, ColumnRay &ray)>;
struct ColumnRays {
    int strips = 0;
    int teachers = 1; // a learned basis learns from one strip of so many
    std::function<void(int strip, const UseRay &use)> for_rays;
};

// Fills a plan, of any kind. Filtered where the map asks for it.
void fill(LightMap &map, const ColumnRays &rays);

// The same filter for maps that were filled otherwise.
void blur(LightMap &map);

} // namespace sfumato
