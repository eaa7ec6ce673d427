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
#include <glm/matrix.hpp>
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

TEST(Splat, OfEveryBasisIsThatOfTheReference) {
    const Particles particles = plume(300, 5);
    struct Way {
        const char *name;
        BasisName basis;
        int coefficients;
        bool curved, shared;
        double rms; // measured: two thirds
    };
    const Way ways[] = {
        {"fourier", FOURIER, 15, false, false, 0.02},     {"piecewise", PIECEWISE, 32, false, false, 0.02},
        {"learned", LEARNED, 9, false, false, 0.02},      {"curve", COSINE, 15, true, false, 0.02},
        {"published", FOURIER, 7, false, true, 0.08},     {"shared fourier", FOURIER, 15, false, true, 0.04},
        {"shared cosine", COSINE, 15, false, true, 0.04}, {"shared piecewise", PIECEWISE, 32, false, true, 0.03},
        {"shared learned", LEARNED, 7, false, true, 0.08}};
    for (const Way &way : ways) {
        LightMapSettings settings{way.coefficients};
        settings.basis = way.basis;
        settings.curved = way.curved;
        settings.shared = way.shared;
        EXPECT_LT(compare(map_of(particles, settings, SLANTING, false), particles, SLANTING, false).rms, way.rms)
            << way.name;
        const glm::dvec3 lamp(2.0, -3.0, 5.0);
        EXPECT_LT(compare(map_of(particles, settings, lamp, true), particles, lamp, true).rms, way.rms) << way.name;
    }
}

// However narrow it is against a texel, and wherever it lies between them, a puff takes as much light in all.
TEST(Splat, KeepsWhatANarrowPuffTakes) {
    Particles particles = puff_at({0.0F, 0.0F, 0.0F}, 0.5F, 0.5F);
    std::mt19937 generator(5);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (const float radius : {1e-4F, 0.01F, 0.05F}) {
        const double expected = std::log(2.0) * 0.4 * 3.14159265 * double{radius} * double{radius};
        for (int i = 0; i < 20; ++i) {
            Particles narrow = puff_at({unit(generator), unit(generator), unit(generator)}, radius, 0.5F);
            const auto puffs = puffs_of(std::span(&narrow, 1));
            Body body = body_of(puffs, 0);
            // A map that is much too coarse for it.
            Particles wide = puff_at(glm::vec3(0.0F), 2.0F, 0.5F);
            const LightMap plan = plan_parallel_map(body_of(puffs_of(std::span(&wide, 1)), 0), SLANTING, {});
            const LightMap map = body.project(plan, instruction_set());
            double sum = 0.0;
            for (std::size_t t = 0; t < map.texels(); ++t) {
                sum += double{map.coefficients[t * std::size_t(map.view().stride())]};
            }
            const double texel = 1.0 / (glm::length(glm::dvec3(glm::transpose(map.world_to_light)[0])) * map.size.x);
            EXPECT_NEAR(sum * texel * texel, expected, 0.05 * expected) << radius;
        }
    }
}

TEST(Splat, DoesNotDependOnTheInstructionSet) {
    const Particles particles = plume(300, 6);
    LightMapSettings published{7};
    published.basis = FOURIER;
    published.shared = true;
    for (const LightMapSettings &settings : {LightMapSettings{}, published}) {
        const LightMap map = map_of(particles, settings, SLANTING, false);
        for (const InstructionSet &with : instruction_sets()) {
            const LightMap other = map_of(particles, settings, SLANTING, false, with);
            for (std::size_t i = 0; i < map.coefficients.size(); ++i) {
                ASSERT_NEAR(other.coefficients[i], map.coefficients[i], 1e-4F * (1.0F + std::abs(map.coefficients[i])))
                    << with.name;
            }
        }
    }
}

} // namespace
} // namespace sfumato
