// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

double depth_through(const Particles &particles, std::size_t index) {
    return -std::log(1.0 - std::min(double{particles.opacity[index]}, 1.0 - std::pow(2.0, -20)));
}

// The shares of a segment at which it enters a ball and leaves it; both the same where it does not meet it.
std::array<double, 2> inside(const Particles &particles, std::size_t index, const glm::dvec3 &from,
                             const glm::dvec3 &to) {
    const glm::dvec3 along = to - from, towards = glm::dvec3(particles.points[index]) - from;
    const double length = glm::length(along);
    if (!(length > 0.0)) {
        return {0.0, 0.0};
    }
    const double middle = glm::dot(towards, along) / length, radius = double{particles.radius[index]};
    const double away = glm::length(towards - along * (middle / length));
    if (!(away < radius)) {
        return {0.0, 0.0};
    }
    const double half = std::sqrt((radius - away) * (radius + away));
    return {std::clamp((middle - half) / length, 0.0, 1.0), std::clamp((middle + half) / length, 0.0, 1.0)};
}

} // namespace

double extinction(const Particles &particles, std::size_t index, const glm::dvec3 &world) {
    const double radius = double{particles.radius[index]};
    const double q = glm::distance(world, glm::dvec3(particles.points[index])) / radius;
    return q < 1.0 ? depth_through(particles, index) * 0.75 / radius * (1.0 - q * q) : 0.0;
}

glm::dvec3 scattering(const Particles &particles, const glm::dvec3 &world) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < particles.points.size(); ++i) {
        sum += extinction(particles, i, world) * glm::dvec3(particles.albedo[particles.albedo.size() > 1 ? i : 0]);
    }
    return sum * glm::dvec3(particles.extinction);
}

std::vector<double> crossings(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to) {
    std::vector<double> out;
    for (std::size_t i = 0; i < particles.points.size(); ++i) {
        const auto [enters, leaves] = inside(particles, i, from, to);
        if (enters < leaves) {
            out.insert(out.end(), {enters, leaves});
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

glm::dvec3 optical_depth(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to) {
    double sum = 0.0;
    for (std::size_t i = 0; i < particles.points.size(); ++i) {
        const auto [enters, leaves] = inside(particles, i, from, to);
        // A parabola: Gauss and Legendre's rule with two points is exact.
        for (const double node : {-1.0 / std::numbers::sqrt3, 1.0 / std::numbers::sqrt3}) {
            const double at = 0.5 * (enters + leaves) + 0.5 * node * (leaves - enters);
            sum += 0.5 * (leaves - enters) * extinction(particles, i, from + at * (to - from));
        }
    }
    return sum * glm::distance(from, to) * glm::dvec3(particles.extinction);
}

glm::dvec3 transmittance(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to) {
    return glm::exp(-optical_depth(particles, from, to));
}

glm::dvec3 transmittance(const Scene &scene, const glm::dvec3 &from, const glm::dvec3 &to) {
    glm::dvec3 product = transmittance(std::span(scene.media), from, to);
    for (const Particles &particles : scene.particles) {
        product *= transmittance(particles, from, to);
    }
    for (const Air &air : scene.air) {
        product *= transmittance(air, from, to);
    }
    return product;
}

} // namespace sfumato::reference
