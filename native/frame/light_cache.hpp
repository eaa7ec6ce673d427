// SPDX-License-Identifier: GPL-3.0-or-later
// The light that surfaces have of lights and of each other, kept at few places: those that a camera sees, and those
// that they see.
#pragma once

#include "frame/bounce.hpp"

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

class LightCache {
public:
    // Of so many bounces.
    LightCache(const FrameView &frame, const BounceKernels &kernels, int bounces);

    [[nodiscard]] const LightCacheView &view() const { return view_; }
    [[nodiscard]] std::size_t cells() const { return count_; }

private:
    LightCacheView view_;
    std::size_t count_ = 0;
    std::vector<std::uint32_t> keys_;
    std::vector<glm::vec3> direct_, indirect_, settled_; // of each slot
};

} // namespace sfumato
