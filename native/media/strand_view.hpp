// SPDX-License-Identifier: GPL-3.0-or-later
// Strands of hair as the kernels see them. Views own nothing.
#pragma once

#include "rays/bins.hpp"
#include "scene/visibility.hpp"

#include <cstdint>

namespace sfumato {

// A straight piece of a strand in a picture. Where it meets the next piece, both end on the line across the joint that
// halves their angle, so that a sample lies on one of them.
struct StrandSegment {
    float from[2], to[2];             // pixels
    float from_joint[2], to_joint[2]; // the direction of that line's normal along the strand; 0 at a free end
    float from_depth, to_depth;       // in the camera's depth, to which a pixel's size is proportional
    float from_distance, to_distance; // along the camera's rays, metres
    float from_radius, to_radius;     // pixels
    float from_tangent[3], to_tangent[3];
    float width[2];        // of the strand at both ends, metres
    std::int32_t material; // a row
};

struct StrandRow {
    bool dielectric;
    float absorption[3];
    float variance, primary, scale, tilt, index;
    float albedo[3], highlight[3], highlight_variance;
    LightSets lit_by;
    std::int32_t body; // which of the strands' bodies it belongs to
};

struct StrandsView {
    const StrandSegment *segments = nullptr;
    const StrandRow *rows = nullptr;
    BinsView bins;
    float width = 0.0F, height = 0.0F; // of the picture
    [[nodiscard]] bool empty() const { return bins.columns == 0; }
};

} // namespace sfumato
