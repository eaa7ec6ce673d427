// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.hpp"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

// Where places in the world are in a picture, of a camera whose near and far planes are parallel.
class PlacesInPicture {
public:
    PlacesInPicture(const Camera &camera, int width, int height)
        : near_(camera.near[0]), across_(camera.near[1]), up_(camera.near[2]),
          along_(glm::dvec3(camera.far[0]) - near_), along_u_(glm::dvec3(camera.far[1]) - across_),
          along_v_(glm::dvec3(camera.far[2]) - up_), normal_(glm::cross(across_, up_)), size_(width, height),
          growth_(glm::dot(along_u_, across_) / glm::dot(across_, across_)) {
        per_depth_ = 1.0 / glm::dot(along_, normal_);
        const double area = glm::dot(normal_, normal_);
        dual_u_ = glm::cross(up_, normal_) / area;
        dual_v_ = glm::cross(normal_, across_) / area;
        pixel_ = {glm::length(across_) / size_.x, glm::length(up_) / size_.y};
    }

    struct Place {
        glm::dvec2 pixel{0.0};
        double depth = 0.0;    // the size of a pixel there over that on the near plane; 0 at the eye
        double distance = 0.0; // from the near plane along the camera's ray, metres
    };

    // Share of the way from the near plane to the far one.
    [[nodiscard]] double along(const glm::dvec3 &world) const { return glm::dot(world - near_, normal_) * per_depth_; }
    // Of what lies before the eye.
    [[nodiscard]] Place place(const glm::dvec3 &world) const {
        const double t = along(world);
        Place out;
        out.depth = 1.0 + t * growth_;
        const glm::dvec3 aside = (world - near_ - t * along_) / out.depth;
        const glm::dvec2 uv(glm::dot(aside, dual_u_), glm::dot(aside, dual_v_));
        out.pixel = uv * size_;
        out.distance = t * glm::length(along_ + uv.x * along_u_ + uv.y * along_v_);
        return out;
    }
    // Pixels of a length across a direction in the picture.
    [[nodiscard]] double pixels(double metres, const glm::dvec2 &across, double depth) const {
        return metres / (depth * std::hypot(across.x * pixel_.x, across.y * pixel_.y));
    }

private:
    glm::dvec3 near_, across_, up_, along_, along_u_, along_v_, normal_, dual_u_, dual_v_;
    glm::dvec2 size_, pixel_;
    double growth_, per_depth_;
};

} // namespace sfumato
