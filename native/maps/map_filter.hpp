// SPDX-License-Identifier: GPL-3.0-or-later
// Prefiltering of maps of coefficients. An absorber's coefficients are linear in its optical depth, so filtering
// coefficients is filtering density: soft shadows and smaller maps without going back to the absorbers (Jansen and
// Bavoil 2010, section 3). That holds where all texels within reach of the filter share one range of depth; where
// ranges differ, equal coefficients mean different depths, and only evaluated transmittance can be filtered.
#pragma once

#include "rays/basis.hpp"

namespace sfumato {

// height x width texels of `count` floats, row after row.
struct MapSize {
    std::size_t height = 0, width = 0, count = 1;

    [[nodiscard]] std::size_t floats() const { return height * width * count; }
};

enum class FilterKind : std::uint8_t { BOX, GAUSSIAN };
constexpr int BOXES = 3; // that a Gaussian is made of

// The map convolved along both axes: BOX with the mean over `width` texels, an odd number, GAUSSIAN with a bell of
// standard deviation `width` in texels. Outside of the map there is no smoke: what a texel within reach of a rim would
// see there counts as zero, so a map keeps its total only if its outermost texels, as far as the filter reaches, are
// empty. Takes the same time whatever the width.
void filter_map(std::span<const float> in, std::span<float> out, const MapSize &size, FilterKind kind, double width);

// Half the size, rounded down but never to 0: each texel the mean of the area that it covers. Of an even axis those are
// pairs; of 2 m + 1 texels each new one covers 2 + 1/m, so the mean of the map stays what it was.
MapSize half_size(const MapSize &size);
void halve_map(std::span<const float> in, std::span<float> out, const MapSize &size);

// One range for all the rays of each tile of tile x tile texels (0: for the whole map), which also holds the rays up to
// `reach` texels beside it. A filter or a bilinear look-up that reaches no further may then mix any of these rays,
// all projected into the range of the tile that asks. The count of `size` is not used.
std::vector<Range> shared_ranges(std::span<const Absorbers> rays, const MapSize &size, RangeKind kind, float q,
                                 std::size_t tile, std::size_t reach);

} // namespace sfumato
