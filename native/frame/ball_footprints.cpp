// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/ball_footprints.hpp"

#include "scene/scene.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace sfumato {

BallFootprints::BallFootprints(const Camera &camera, int width, int height)
    : whole_{0.0F, static_cast<float>(width), 0.0F, static_cast<float>(height)} {
    const glm::dvec3 corner(camera.near[0]), across(camera.near[1]), up(camera.near[2]);
    const glm::dvec3 far_corner(camera.far[0]), far_across(camera.far[1]);
    const double wide = glm::length(across), high = glm::length(up), grows = glm::length(far_across) / wide;
    forward_ = glm::normalize(glm::cross(across, up));
    forward_ *= glm::dot(forward_, far_corner - corner) < 0.0 ? -1.0 : 1.0;
    perspective_ = grows > 1.0 + 1e-6;
    eye_ = perspective_ ? (grows * corner - far_corner) / (grows - 1.0) : corner;
    near_ = glm::dot(corner - eye_, forward_);
    // Rays that are slanted though they are parallel, or rows that are not at right angles to columns.
    const glm::dvec3 rays = glm::normalize(far_corner - corner);
    skewed_ =
        std::abs(glm::dot(across, up)) > 1e-4 * wide * high || (!perspective_ && glm::dot(rays, forward_) < 1.0 - 1e-6);
    x_ = {across / wide, glm::dot(corner - eye_, across / wide), width / wide};
    y_ = {up / high, glm::dot(corner - eye_, up / high), height / high};
}

void BallFootprints::span(const Axis &axis, const glm::dvec3 &from_eye, double depth, double radius, float &low,
                          float &high) const {
    const double x = glm::dot(from_eye, axis.along);
    double least = x - radius, most = x + radius;
    if (perspective_) {
        // The two lines through the eye that touch a circle, seen along the other axis.
        const double beyond = (depth - radius) * (depth + radius);
        const double root = radius * std::sqrt(std::max(x * x + beyond, 0.0));
        least = near_ * (x * depth - root) / beyond;
        most = near_ * (x * depth + root) / beyond;
    }
    low = static_cast<float>((least - axis.begin) * axis.pixels);
    high = static_cast<float>((most - axis.begin) * axis.pixels);
}

float BallFootprints::begin(const glm::vec3 &middle, float radius) const {
    return static_cast<float>(glm::dot(glm::dvec3(middle) - eye_, forward_) - double{radius});
}

Footprint BallFootprints::operator()(const glm::vec3 &middle, float radius) const {
    const glm::dvec3 from_eye = glm::dvec3(middle) - eye_;
    const double depth = glm::dot(from_eye, forward_), wide = double{radius} * (1.0 + 1e-5);
    if (depth + wide < near_) {
        return {1.0F, 0.0F, 1.0F, 0.0F};
    }
    if (skewed_ || (perspective_ && depth <= wide)) {
        return whole_;
    }
    Footprint out{};
    span(x_, from_eye, depth, wide, out.low_x, out.high_x);
    span(y_, from_eye, depth, wide, out.low_y, out.high_y);
    return out;
}

} // namespace sfumato
