// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace sfumato::reference {
namespace {

double density(const Air &air, const glm::dvec3 &world) {
    if (air.shape) {
        return places_around(air, world);
    }
    return air.scale_height > 0.0F ? std::exp(-(world.z - double{air.ground}) / double{air.scale_height}) : 1.0;
}

glm::dvec3 extinction(const Air &air) {
    return glm::dvec3(air.rayleigh) + glm::dvec3(air.mie) + glm::dvec3(air.absorption);
}

} // namespace

glm::dvec3 transmittance(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to) {
    if (air.shape) {
        return glm::exp(-extinction(air) * way_inside(air, from, to));
    }
    double amount = glm::distance(from, to);
    if (air.scale_height > 0.0F) {
        // The mean of the density over a segment on which its exponent goes straight from 0 to x.
        const double x = (to.z - from.z) / double{air.scale_height};
        amount *= density(air, from) * (x == 0.0 ? 1.0 : -std::expm1(-x) / x);
    }
    return glm::exp(-extinction(air) * amount);
}

glm::dvec3 transmittance_to_infinity(const Air &air, const glm::dvec3 &from, const glm::dvec3 &towards) {
    if (air.shape) {
        double far = 0.0;
        for (const glm::mat4 &to_world : air.to_world) {
            for (const glm::vec3 &vertex : air.shape->vertices) {
                far = std::max(far, glm::distance(from, glm::dvec3(glm::dmat4(to_world) * glm::dvec4(vertex, 1.0))));
            }
        }
        return transmittance(air, from, from + (1.0 + far) * towards);
    }
    if (air.scale_height == 0.0F || extinction(air) == glm::dvec3(0.0)) {
        return glm::dvec3(1.0);
    }
    if (towards.z <= 0.0) {
        return glm::dvec3(0.0);
    }
    return glm::exp(-extinction(air) * (density(air, from) * double{air.scale_height} / towards.z));
}

glm::dvec3 scattered(const Air &air, const glm::dvec3 &world, double cos_theta) {
    const double g = double{air.anisotropy};
    const double of_dust = air.cornette_shanks
                               ? 1.5 * (1.0 + cos_theta * cos_theta) / (2.0 + g * g) * henyey_greenstein(cos_theta, g)
                               : henyey_greenstein(cos_theta, g);
    const double of_molecules = 3.0 / (16.0 * std::numbers::pi) * (1.0 + cos_theta * cos_theta);
    return density(air, world) * glm::dvec3(air.shaft_tint) *
           (glm::dvec3(air.rayleigh) * of_molecules + glm::dvec3(air.mie) * of_dust);
}

glm::dvec3 emission(const Air &air, const glm::dvec3 &world) {
    return density(air, world) * glm::dvec3(air.emission);
}

} // namespace sfumato::reference
