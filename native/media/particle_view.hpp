// SPDX-License-Identifier: GPL-3.0-or-later
// Particles as the rays of a picture meet them. Views own nothing.
#pragma once

#include "media/particles.hpp"
#include "rays/bins.hpp"

#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

struct ParticlesView {
    BinsView bins; // of a picture of so many pixels, by where puffs begin along its axis
    const float *begin = nullptr;
    float widest = 0.0F; // of the puffs, their diameter
    float width = 0.0F, height = 0.0F;
    const Puff *puffs = nullptr; // those that the camera sees
    const glm::vec3 *albedo = nullptr;
    std::span<const Puffs::Body> bodies;
    std::size_t first_body = 0; // among all that have light maps
};

} // namespace sfumato
