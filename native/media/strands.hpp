// SPDX-License-Identifier: GPL-3.0-or-later
// Hair before a camera: strands cut into the straight pieces that its picture can show.
#pragma once

#include "media/strand_view.hpp"
#include "rays/bins.hpp"

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Camera; // scene/scene.hpp
struct Strands;
struct StrandShape;

struct SeenStrands {
    std::vector<StrandSegment> segments;
    std::vector<StrandRow> rows;
    Bins bins;
    float width = 0.0F, height = 0.0F;

    [[nodiscard]] StrandsView view() const;
};

// Of all strands those that are shown, in a picture of so many pixels whose samples see as far as `reach` pixels around
// them. On all threads.
SeenStrands seen_strands(std::span<const Strands> strands, const Camera &camera, int width, int height, double reach);

// A place on a strand.
struct StrandPoint {
    glm::dvec3 place{0.0}, tangent{0.0}; // of unit length
    double radius = 0.0;
};

// One strand of two points or more, with `pieces` straight ones between two of its keys where it is smooth.
void strand_points(const StrandShape &shape, std::size_t strand, int pieces, std::vector<StrandPoint> &out);

} // namespace sfumato
