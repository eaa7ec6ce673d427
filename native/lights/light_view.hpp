// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/light_kind.hpp"

#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

struct LightMapView; // maps/map_view.hpp

// A light, and the points that it is sampled at, as the kernels read them. Owns nothing.
struct LightView {
    LightKind kind = LightKind::SUN;
    glm::vec3 strength{0.0F};
    glm::vec3 position{0.0F};
    glm::vec3 direction{0.0F, 0.0F, -1.0F};
    glm::vec3 across{0.0F}, up{0.0F}; // half axes; of a sun sin(angle / 2) long, of a sphere not set
    float radius = 0.0F;
    float cone_cosine = -2.0F; // of a spot's edge; -2 for no spot
    float blend = 0.0F;
    bool spot_cosine = false;
    float facing2 = 0.0F; // radius^2 where a sphere looks like a disk, else 0
    float spread_cotangent = 0.0F;
    float area = 0.0F;                  // of rectangles, ellipses and polygons
    glm::vec3 corners[4];               // of polygons
    float size2 = 0.0F;                 // of falloff()
    std::span<const glm::vec3> samples; // points; of a sun, directions towards it
    const LightMapView *maps = nullptr; // for each sample and medium; the medium runs fastest
};

} // namespace sfumato
