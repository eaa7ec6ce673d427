// SPDX-License-Identifier: GPL-3.0-or-later
// Particles in their places: puffs, ready to be met by rays.
#pragma once

#include "scene/visibility.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct Particles; // scene/scene.hpp

struct Puff {
    glm::vec3 middle{0.0F};
    float radius = 0.0F;
    float depth = 0.0F;    // optical, straight through the middle, in the strongest colour
    std::int32_t body = 0; // of Puffs
};

// All of a scene's particle systems, or what can be seen of them.
struct Puffs {
    // One system: a range of the puffs.
    struct Body {
        std::size_t first = 0, count = 0;
        glm::vec3 low{0.0F}, high{0.0F}; // of the box around it
        double detail = 0.0;             // the size of the smallest thing that counts in its shadow, metres
        glm::vec3 extinction{1.0F};      // of each colour, for one of the strongest
        float anisotropy = 0.0F;
        Visibility visibility;
        std::array<std::uint64_t, 2> content{}; // differs wherever its puffs do
    };

    std::vector<Puff> puffs;
    std::vector<glm::vec3> albedo; // of each
    std::vector<Body> bodies;      // those that the camera sees come first
    std::size_t seen = 0;          // how many puffs it sees

    [[nodiscard]] std::span<const Puff> of(const Body &body) const {
        return std::span(puffs).subspan(body.first, body.count);
    }
    [[nodiscard]] bool grey() const;
};

// Null where nothing can be seen of any. What has no size or no opacity is left out.
std::shared_ptr<const Puffs> puffs_of(std::span<const Particles> particles);

} // namespace sfumato
