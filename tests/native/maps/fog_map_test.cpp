// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps of fog against the judge's columns.
#include "maps/light_map.hpp"
#include "maps/project_fog.hpp"
#include "reference/reference.hpp"
#include "support/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::box_shape;
using reference::testing::torus_shape;

struct Errors {
    double rms = 0.0, worst = 0.0; // of the transmittance
};

// In the fog and behind it, where the wall that a ray just passes by is not within two texels.
Errors compare(const Air &air, const LightMapSettings &settings, const glm::dvec3 &light, bool radial,
               std::size_t &coefficients) {
    Solids solids;
    const auto fogs = fogs_of(std::span(&air, 1), solids);
    const Body body = body_of(fogs.at(0), 512);
    const LightMap map = body.project(
        radial ? plan_radial_map(body, light, settings) : plan_parallel_map(body, light, settings), instruction_set());
    coefficients = map.series.count;
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> unit(-2.2, 2.2);
    std::vector<glm::vec3> points;
    std::vector<double> expected;
    const double shift = 0.02;
    while (points.size() < 300) {
        const glm::dvec3 at(unit(generator), unit(generator), unit(generator));
        const auto column = [&](const glm::dvec3 &x) {
            return reference::way_inside(air, radial ? light : x - 20.0 * glm::normalize(light), x);
        };
        const double here = column(at);
        bool rim = false;
        for (int axis = 0; axis < 3 && !rim; ++axis) {
            glm::dvec3 aside(0.0);
            aside[axis] = shift;
            rim = std::abs(column(at + aside) - here) > 0.1 || std::abs(column(at - aside) - here) > 0.1;
        }
        if (!rim) {
            points.emplace_back(at);
            expected.push_back(std::exp(-here));
        }
    }
    std::vector<float> columns(points.size());
    map.look_up(std::span<const float>(&points[0].x, 3 * points.size()), columns);
    Errors errors;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double error = std::abs(std::exp(-double{columns[i]}) - expected[i]);
        errors.rms += error * error / double(points.size());
        errors.worst = std::max(errors.worst, error);
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

Air air_in(std::shared_ptr<const Shape> shape) {
    Air air;
    air.shape = std::move(shape);
    air.to_world = {glm::mat4(1.0F)};
    air.mie = glm::vec3(1.0F);
    return air;
}

const glm::dvec3 SLANTING = glm::normalize(glm::dvec3(0.3, -0.5, -0.8));

// A ray is in it once: one coefficient says where.
TEST(FogMap, OfABoxIsExact) {
    const Air air = air_in(box_shape({-1, -1, -1}, {1, 1, 1}));
    struct Case {
        glm::dvec3 light;
        bool radial;
    };
    for (const auto &[light, radial] :
         {Case{SLANTING, false}, Case{{0, 0, -1}, false}, Case{{2, 1, 3}, true}, Case{{0.3, 0.1, 0.2}, true}}) {
        std::size_t coefficients = 0;
        const Errors errors = compare(air, {}, light, radial, coefficients);
        EXPECT_EQ(coefficients, 1U);
        EXPECT_LT(errors.rms, 5e-4) << light.x << ", " << light.y << ", " << light.z;
        EXPECT_LT(errors.worst, 3e-3) << light.x << ", " << light.y << ", " << light.z;
    }
}

TEST(FogMap, OfARingIsThatOfTheJudge) {
    const Air air = air_in(torus_shape(1.5F, 0.5F, 24, 12));
    const glm::dvec3 across = glm::normalize(glm::dvec3(1.0, 0.4, 0.1));
    for (const bool radial : {false, true}) {
        std::size_t coefficients = 0;
        const Errors errors = compare(air, {}, radial ? glm::dvec3(4.0, 0.5, 0.5) : across, radial, coefficients);
        EXPECT_EQ(coefficients, 15U);
        EXPECT_LT(errors.rms, 4e-3) << radial;
        EXPECT_LT(errors.worst, 2e-2) << radial;
    }
}

} // namespace
} // namespace sfumato
