// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many small primitives a ray may meet, by where they lie on a plane that all rays cross: a camera's picture,
// or a light map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sfumato {

// What a primitive touches of a plane, in pixels from its lower left corner. Nothing where low is beyond high, and
// where either is no number.
struct Footprint {
    float low_x, high_x, low_y, high_y;
};

// Cells of `edge` x `edge` pixels, row by row, and of each the primitives that touch it, near ones first: what
// for_primitives() of rays/bins_lanes.hpp walks along. Owns nothing.
struct BinsView {
    int columns = 0, rows = 0;
    float per_edge = 0.0F;                // one over a cell's edge, pixels
    const std::uint32_t *begin = nullptr; // where each cell's list begins among the ranks, and where the last one ends
    const std::int32_t *ranks = nullptr;  // in the order of depth, which the primitives' numbers follow
    const std::int32_t *numbers = nullptr;
};

class Bins {
public:
    static constexpr int EDGE = 8;
    // What a filter asks of up to so many pixels outside is answered by the cells at the rim.
    static constexpr float MARGIN = 4.0F;

    Bins() = default;
    // Of each primitive its footprint and its depth; without depths, their own order counts. On all threads; of every
    // cell that a primitive touches it takes 4 bytes, and cells are larger where that would come to more than 256 MB.
    Bins(std::span<const Footprint> footprints, std::span<const float> depths, int width, int height);

    [[nodiscard]] BinsView view() const;
    [[nodiscard]] int edge() const { return edge_; }

private:
    int edge_ = EDGE, columns_ = 0, rows_ = 0;
    std::vector<std::uint32_t> begin_;
    std::vector<std::int32_t> ranks_, numbers_;
};

} // namespace sfumato
