// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solids/surface_view.hpp"

#include <glm/vec3.hpp>

namespace sfumato {

// A box in the world.
struct FogBox {
    glm::vec3 low{0.0F}, high{0.0F};
};

// One fog as rays meet it. Owns nothing.
struct FogView {
    RayScene scene;
    const PlaceView *places = nullptr;
    const FogBox *boxes = nullptr; // around each place
    float outwards = 1.0F;         // -1 where the corners of its triangles run clockwise, seen from outside
};

// Where a ray is in one place of a fog, metres from where it starts.
struct FogStretch {
    int lane;
    float near, far;
};

} // namespace sfumato
