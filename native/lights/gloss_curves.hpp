// SPDX-License-Identifier: GPL-3.0-or-later
// What a layer of gloss does besides reflecting once: what it leaves to all that lies below it, and what comes of light
// that its facets send to each other.
#pragma once

#include "scene/scene.hpp"

#include <array>

namespace sfumato {

constexpr int CURVE_POINTS = 16;

struct GlossCurves {
    // At cosines to the eye from 0 to 1, in equal steps: the share of what is below that is left; and what the layer's
    // light is to be multiplied by, in each colour: its share of the surface, and more for what its facets lose.
    std::array<float, CURVE_POINTS> left{};
    std::array<std::array<float, CURVE_POINTS>, 3> gain{};
};

GlossCurves gloss_curves(const Gloss &gloss);

} // namespace sfumato
