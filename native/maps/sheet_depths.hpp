// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets before each depth of a light map's rays.
#pragma once

#include "solids/surfaces.hpp"

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct LightMap; // maps/light_map.hpp

// On each texel's ray, near first, where sheets stand, in the map's depth; and what each and all before it let through.
struct SheetDepths {
    std::vector<std::uint32_t> first; // of each texel's; and where the last texel's end
    std::vector<float> depth;
    std::vector<glm::vec3> left;
};

// Of a map's rays; of light that has a place, from `nearest` metres around it on.
SheetDepths find_sheets(const LightMap &map, const SurfaceView &surfaces, const RayScene &sheets, double nearest);

} // namespace sfumato
