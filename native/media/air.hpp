// SPDX-License-Identifier: GPL-3.0-or-later
// Air in a frame, as the kernels read it.
#pragma once

#include "scene/visibility.hpp"

#include <glm/vec3.hpp>

namespace sfumato {

struct Air; // scene/scene.hpp

struct AirView {
    glm::vec3 rayleigh{0.0F}, mie{0.0F}; // what is scattered, with an artist's tint
    glm::vec3 extinction{0.0F};
    glm::vec3 emission{0.0F};
    float anisotropy = 0.0F;
    bool cornette_shanks = false;
    float per_height = 0.0F; // one over the scale height; 0: even
    float ground = 0.0F;
    LightSets lit_by = ~LightSets{0}; // Visibility's

    [[nodiscard]] bool even() const { return per_height == 0.0F; }
};

AirView view_of(const Air &air);

// Whether it takes all colours alike.
bool is_grey(const AirView &air);

} // namespace sfumato
