// SPDX-License-Identifier: GPL-3.0-or-later
// Particles to test with, and the judge beside them.
#pragma once

#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <cmath>
#include <cstddef>
#include <random>

namespace sfumato::reference::testing {

inline Particles puff_at(const glm::vec3 &middle, float radius, float opacity) {
    Particles out;
    out.points = {middle};
    out.radius = {radius};
    out.opacity = {opacity};
    out.albedo = {glm::vec3(0.8F)};
    return out;
}

// A plume that widens and thins as it rises, 1 m high.
inline Particles plume(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    Particles out;
    out.albedo = {{0.9F, 0.8F, 0.7F}};
    for (std::size_t i = 0; i < count; ++i) {
        const float height = unit(generator), angle = 6.2831853F * unit(generator);
        const float away = (0.04F + 0.26F * height) * std::sqrt(unit(generator));
        out.points.emplace_back(away * std::cos(angle), away * std::sin(angle), height);
        out.radius.push_back(0.02F + 0.06F * height);
        out.opacity.push_back(0.4F - 0.3F * height);
    }
    return out;
}

} // namespace sfumato::reference::testing
