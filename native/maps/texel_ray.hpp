// SPDX-License-Identifier: GPL-3.0-or-later
// The rays of a light map, one by one.
#pragma once

#include "maps/light_map.hpp"

namespace sfumato {

// The ray of a texel in the world: from depth 0 of the map, one depth long.
struct TexelRay {
    glm::dvec3 origin, along;
};

TexelRay texel_ray(const LightMap &map, const glm::dmat4 &light_to_world, int x, int y); // solid_depths.cpp

} // namespace sfumato
