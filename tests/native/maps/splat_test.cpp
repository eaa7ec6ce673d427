// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps of particles against the judge's optical depths.
#include "lights/light.hpp"
#include "maps/light_map.hpp"
#include "maps/splat.hpp"
#include "support/particle_clouds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::plume;
using reference::testing::puff_at;

struct Errors {
    double rms = 0.0, worst = 0.0; // of the transmittance
};

// Places in the box around particles, and as far behind it as it is wide.
std::vector<glm::vec3> places(const Particles &particles, const glm::vec3 &along, std::size_t count) {
    const auto puffs = puffs_of(std::span(&particles, 1));
    const glm::vec3 low = puffs->bodies[0].low, size = puffs->bodies[0].high - low;
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    std::vector<glm::vec3> out;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 share(unit(generator), unit(generator), unit(generator));
        out.push_back(low + share * size + (i % 4 == 0 ? glm::length(size) * along : glm::vec3(0.0F)));
    }
    return out;
}

LightMap map_of(const Particles &particles, const LightMapSettings &settings, const glm::dvec3 &light, bool radial,
                const InstructionSet &with = instruction_set()) {
    const Body body = body_of(puffs_of(std::span(&particles, 1)), 0);
    return body.project(radial ? plan_radial_map(body, light, settings) : plan_parallel_map(body, light, settings),
                        with);
}

Errors compare(const LightMap &map, const Particles &particles, const glm::dvec3 &light, bool radial) {
    const glm::vec3 along(radial ? glm::dvec3(0.0, 0.0, -1.0) : light);
    const std::vector<glm::vec3> points = places(particles, along, 1000);
    std::vector<float> columns(points.size());
    map.look_up(std::span<const float>(&points[0].x, 3 * points.size()), columns);
    Errors errors;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 at(points[i]), from = radial ? light : at - 1e3 * light;
        const double expected = reference::transmittance(particles, from, at).x;
        const double error = std::abs(std::exp(-double{columns[i]}) - expected);
        errors.rms += error * error / double(points.size());
        errors.worst = std::max(errors.worst, error);
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

const glm::dvec3 SLANTING = glm::normalize(glm::dvec3(0.3, -0.5, -0.8));

TEST(Splat, ALonePuffIsThatOfTheReference) {
    for (const float opacity : {0.3F, 0.9F}) {
        const Particles particles = puff_at({1.0F, 2.0F, 3.0F}, 0.5F, opacity);
        const Errors sun = compare(map_of(particles, {31, 4.0}, SLANTING, false), particles, SLANTING, false);
        EXPECT_LT(sun.rms, 0.003) << opacity;
        EXPECT_LT(sun.worst, 0.02) << opacity;
        const glm::dvec3 lamp(2.0, 1.0, 6.0);
        const Errors point = compare(map_of(particles, {31, 4.0}, lamp, true), particles, lamp, true);
        EXPECT_LT(point.rms, 0.003) << opacity;
        EXPECT_LT(point.worst, 0.02) << opacity;
    }
}

TEST(Splat, APlumeIsThatOfTheReference) {
    const Particles particles = plume(2000, 3);
    const Errors sun = compare(map_of(particles, {}, SLANTING, false), particles, SLANTING, false);
    EXPECT_LT(sun.rms, 0.01);
    EXPECT_LT(sun.worst, 0.08);
    for (const glm::dvec3 lamp : {glm::dvec3(2.0, -3.0, 5.0), glm::dvec3(0.1, 0.05, 0.6)}) { // the second inside
        const Errors point = compare(map_of(particles, {}, lamp, true), particles, lamp, true);
        EXPECT_LT(point.rms, 0.012) << lamp.x;
        EXPECT_LT(point.worst, 0.1) << lamp.x;
    }
}

} // namespace
} // namespace sfumato
