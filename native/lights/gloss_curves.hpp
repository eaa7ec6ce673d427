// SPDX-License-Identifier: GPL-3.0-or-later
// What a glossy layer does besides reflecting once: what it leaves to the diffuse surface below, and what comes of
// light that its facets send to each other.
#pragma once

#include "scene/scene.hpp"

#include <array>

namespace sfumato {

constexpr int CURVE_POINTS = 16;

struct GlossCurves {
    // At cosines to the eye from 0 to 1, in equal steps: the share of what is diffuse that is left; and of light from
    // all sides, how much is lost between facets for each unit that is not.
    std::array<float, CURVE_POINTS> kept{};
    std::array<float, CURVE_POINTS> lost{};
    glm::vec3 again{0.0F}; // what comes out of each unit lost: gloss is to be multiplied by 1 + again lost
};

GlossCurves gloss_curves(const Gloss &gloss);

} // namespace sfumato
