// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of the first solids on a map's rays over squares of 2, 4, 8, ... texels: what a ray through the map is tested
// against, the largest square first (Tevs, Ihrke and Seidel, "Maximum mipmaps for fast, accurate, and scalable dynamic
// height field rendering", 2008).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfumato {

constexpr int MOST_TREE_LEVELS = 12; // beside the texels themselves

// Owns nothing.
struct DepthTreeView {
    const float *low = nullptr;          // of all levels; level 0 is the map itself
    const float *high = nullptr;         // likewise
    const std::int32_t *first = nullptr; // of each level, in both
    const std::int32_t *row = nullptr;   // squares of each level in a row
    int levels = 0;                      // beside level 0
    int width = 0, height = 0;           // texels
};

class DepthTree {
public:
    // Of width x height depths.
    DepthTree(const float *depth, int width, int height);
    [[nodiscard]] DepthTreeView view() const {
        return {low.data(), high.data(), first.data(), row.data(), levels, width, height};
    }

private:
    std::vector<float> low, high;
    std::array<std::int32_t, MOST_TREE_LEVELS + 1> first{}, row{};
    int levels = 0, width = 0, height = 0;
};

} // namespace sfumato
