// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

struct RTCSceneTy; // Embree's

namespace sfumato {

// What rays of one kind meet. Owns nothing.
struct RayScene {
    RTCSceneTy *scene = nullptr; // null where there are no triangles
    bool instanced = false;      // whether any place is an instance to Embree
    float time = 0.5F;           // of what moves while the shutter is open: 0 as it opens, 1 as it closes
};

} // namespace sfumato
