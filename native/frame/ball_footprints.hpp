// SPDX-License-Identifier: GPL-3.0-or-later
// What balls touch of a camera's picture.
#pragma once

#include "rays/bins.hpp"

#include <glm/vec3.hpp>

namespace sfumato {

struct Camera; // scene/scene.hpp

// The footprints of balls on a picture of width x height pixels: of those before the near plane, nothing; of those that
// the eye is in or beside, everything.
class BallFootprints {
public:
    BallFootprints(const Camera &camera, int width, int height);

    [[nodiscard]] Footprint operator()(const glm::vec3 &middle, float radius) const;
    // Along the camera's axis, where a ball begins: along every ray this grows with the distance.
    [[nodiscard]] float begin(const glm::vec3 &middle, float radius) const;

private:
    // Across one axis of the picture: a unit vector, and where on it the picture begins, of how many pixels a metre: on
    // the near plane.
    struct Axis {
        glm::dvec3 along{0.0};
        double begin = 0.0, pixels = 0.0;
    };
    void span(const Axis &axis, const glm::dvec3 &from_eye, double depth, double radius, float &low, float &high) const;

    bool perspective_ = false, skewed_ = false;
    glm::dvec3 eye_{0.0}, forward_{0.0}; // of an orthographic camera, a point on the near plane
    double near_ = 0.0;
    Axis x_, y_;
    Footprint whole_;
};

} // namespace sfumato
