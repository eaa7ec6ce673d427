// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/lights/light.glsl: how lights fade, and the square of all directions.
#include "support/reference_scenes.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

using namespace reference::testing;

float distance(const LightsText::Octahedral &a, const LightsText::Octahedral &b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

// Directions everywhere, and where the octahedron has its edges and corners.
std::vector<glm::vec3> directions() {
    std::mt19937 generator(61);
    std::normal_distribution<float> normal;
    std::vector<glm::vec3> all;
    for (int i = 0; i < 5000; ++i) {
        const float x = normal(generator), y = normal(generator);
        all.push_back(glm::normalize(glm::vec3(x, y, normal(generator))));
    }
    for (int i = 0; i < 27; ++i) {
        const glm::vec3 lattice(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (lattice != glm::vec3(0.0F)) {
            all.push_back(glm::normalize(lattice));
        }
    }
    return all;
}

TEST(Octahedral, HasADirectionForEachPlaceAndAPlaceForEachDirection) {
    for (const glm::vec3 &direction : directions()) {
        const LightsText::Octahedral place = LightsText().octahedral(3.0F * direction); // of any length
        EXPECT_LE(std::max(std::abs(place.x), std::abs(place.y)), 1.0F);
        EXPECT_LT(glm::distance(LightsText().octahedral_direction(place), direction), 1e-6F);
    }
    for (float x = -0.995F; x < 1.0F; x += 0.01F) {
        for (float y = -0.995F; y < 1.0F; y += 0.01F) {
            const glm::vec3 direction = LightsText().octahedral_direction({x, y});
            EXPECT_NEAR(glm::length(direction), 1.0F, 1e-6F);
            EXPECT_LT(distance(LightsText().octahedral(direction), {x, y}), 1e-6F);
        }
    }
    EXPECT_EQ(LightsText().octahedral({0, 0, 1}).x, 0.0F);
    EXPECT_EQ(std::abs(LightsText().octahedral({0, 0, -1}).x), 1.0F);
    EXPECT_EQ(std::abs(LightsText().octahedral({0, 0, -1}).y), 1.0F);
}

// Neighbours on the square are neighbours in space; neighbours in space are neighbours on the square, or both of them
// lie at its border, where it is folded together.
TEST(Octahedral, KeepsNeighboursTogether) {
    std::mt19937 generator(62);
    std::normal_distribution<float> normal(0.0F, 0.01F);
    int apart = 0;
    for (const glm::vec3 &direction : directions()) {
        const glm::vec3 beside =
            glm::normalize(direction + glm::vec3(normal(generator), normal(generator), normal(generator)));
        const LightsText::Octahedral a = LightsText().octahedral(direction), b = LightsText().octahedral(beside);
        const float angle = glm::distance(direction, beside);
        if (distance(a, b) > 2.0F * angle) {
            const auto border = [](const LightsText::Octahedral &p) {
                return 1.0F - std::max(std::abs(p.x), std::abs(p.y));
            };
            EXPECT_LT(std::max(border(a), border(b)), 2.0F * angle);
            ++apart;
        }
        const LightsText::Octahedral moved{std::clamp(a.x + normal(generator), -1.0F, 1.0F),
                                           std::clamp(a.y + normal(generator), -1.0F, 1.0F)};
        EXPECT_LT(glm::distance(LightsText().octahedral_direction(moved), direction),
                  3.0F * distance(moved, a) + 1e-6F);
    }
    EXPECT_LT(apart, 200);
}

TEST(Falloff, IsTheInverseSquareFarAwayAndFiniteNearby) {
    EXPECT_NEAR(LightsText().falloff(100.0F, 0.01F), 0.01F, 2e-6F);
    EXPECT_EQ(LightsText().falloff(4.0F, 0.0F), 0.25F);
    EXPECT_EQ(LightsText().falloff(0.0F, 0.25F), 8.0F); // 2 pi times its radiance, 1 / (pi radius^2)
    EXPECT_GT(LightsText().falloff(1.0F, 0.1F), LightsText().falloff(1.1F, 0.1F));
}

TEST(SpotFade, RisesFromTheEdgeToTheAxis) {
    const float edge = std::cos(0.5F);
    for (const float blend : {0.0F, 0.15F, 0.5F, 1.0F}) {
        EXPECT_EQ(LightsText().spot_fade(1.0F, edge, blend), 1.0F) << blend;
        EXPECT_EQ(LightsText().spot_fade(edge, edge, blend), 0.0F) << blend;
        EXPECT_EQ(LightsText().spot_fade(-1.0F, edge, blend), 0.0F) << blend;
        const float inner = edge + blend * (1.0F - edge);
        EXPECT_NEAR(LightsText().spot_fade(inner + 1e-5F, edge, blend), 1.0F, 1e-5F) << blend;
        EXPECT_NEAR(LightsText().spot_fade(0.5F * (edge + inner), edge, blend), blend > 0.0F ? 0.5F : 0.0F, 1e-4F)
            << blend;
        float last = 0.0F;
        for (float cosine = -1.0F; cosine <= 1.0F; cosine += 1e-3F) {
            const float fade = LightsText().spot_fade(cosine, edge, blend);
            EXPECT_GE(fade, last) << blend;
            last = fade;
        }
    }
}

TEST(SpotFade, IsThatOfTheReference) {
    Light spot = point_light({0, 0, 0}, glm::vec3(1.0F));
    for (const float cone : {0.4F, 1.5F, 3.5F, 6.0F}) {
        for (const float blend : {0.01F, 0.15F, 1.0F}) {
            spot.cone = cone;
            spot.blend = blend;
            for (float angle = 0.01F; angle < 3.14F; angle += 0.01F) {
                const glm::dvec3 at(std::sin(angle), 0.0, -std::cos(angle));
                const double expected = reference::light_samples(spot, at, 1).at(0).irradiance.x;
                const float fade = LightsText().spot_fade(std::cos(angle), std::cos(0.5F * cone), blend);
                EXPECT_NEAR(fade, expected, 2e-3) << cone << ", " << blend << ", " << angle; // blend 0.01 is steep
            }
        }
    }
}

// As many points in each part as its area asks for, counted by which side of lines through the polygon they lie on.
TEST(PointOnQuad, SharesTheAreaEvenly) {
    const Light panel = area_light(Light::Kind::RECTANGLE, {1, 2, 3}, {2, 0, 0}, {0, 1, 0.5F}, glm::vec3(1.0F));
    const std::array<glm::vec2, 4> sliver = {{{-1, 0}, {1, -1e-3F}, {1, 0}, {1, 0}}};
    for (const auto &corners : {WHOLE, KITE, TRIANGLE, sliver}) {
        const auto &c = polygon_in(panel, corners).corners;
        constexpr int SIDE = 400;
        const std::vector<reference::LightSample> exact =
            reference::light_samples(polygon_in(panel, corners), {0, 0, 0}, SIDE);
        for (const glm::vec2 &line : {glm::vec2(1, 0), glm::vec2(0, 1), glm::vec2(0.6F, -0.8F)}) {
            for (const float offset : {-0.7F, -0.2F, 0.0F, 0.3F}) {
                const auto inside = [&](const glm::vec3 &p) {
                    const glm::vec3 from = p - panel.position;
                    const float x = glm::dot(from, panel.across) / 4.0F, y = glm::dot(from, panel.up) / 1.25F;
                    return line.x * x + line.y * y < offset;
                };
                double share = 0.0, expected = 0.0, all = 0.0;
                for (int i = 0; i < SIDE * SIDE; ++i) {
                    const float u = (float(i % SIDE) + 0.5F) / SIDE, v = (float(i / SIDE) + 0.5F) / SIDE;
                    share +=
                        inside(LightsText().point_on_quad(c[0], c[1], c[2], c[3], u, v)) ? 1.0 / (SIDE * SIDE) : 0.0;
                }
                for (const reference::LightSample &sample : exact) {
                    const glm::dvec3 at = sample.towards * sample.distance;
                    const glm::dvec3 normal =
                        glm::normalize(glm::cross(glm::dvec3(panel.across), glm::dvec3(panel.up)));
                    const double part = sample.irradiance.x * sample.distance * sample.distance /
                                        std::abs(glm::dot(normal, sample.towards));
                    all += part;
                    expected += inside(glm::vec3(at)) ? part : 0.0;
                }
                EXPECT_NEAR(share, expected / all, 4e-3) << corners[2].x << ", " << line.x << ", " << offset;
            }
        }
        EXPECT_LT(glm::distance(LightsText().point_on_quad(c[0], c[1], c[2], c[3], 0, 0), c[0]), 1e-6F);
        EXPECT_LT(glm::distance(LightsText().point_on_quad(c[0], c[1], c[2], c[3], 1, 0), c[1]), 1e-6F);
        EXPECT_LT(
            glm::distance(LightsText().point_on_quad(c[0], c[1], c[2], c[3], 0.3F, 1), c[3] + 0.3F * (c[2] - c[3])),
            0.3F);
    }
    EXPECT_EQ(LightsText().linear_quantile(0.25F, 1.0F, 1.0F), 0.25F);
    EXPECT_EQ(LightsText().linear_quantile(0.25F, 0.0F, 1.0F), 0.5F);
    EXPECT_EQ(LightsText().linear_quantile(0.0F, 0.0F, 1.0F), 0.0F);
}

// By the triangles under it: what a tent's share below a place is of that between two ends.
TEST(TentPoint, ReachesEachShareOfATent) {
    const auto below = [](double place, double middle, double radius) {
        const double s = std::clamp((place - middle) / radius, -1.0, 1.0);
        return s < 0.0 ? 0.5 * (1.0 + s) * (1.0 + s) : 1.0 - 0.5 * (1.0 - s) * (1.0 - s);
    };
    for (const float middle : {-1.4F, -1.0F, -0.3F, 0.0F, 0.7F, 1.9F}) {
        for (const float radius : {0.25F, 1.0F, 40.0F}) {
            const double first = below(-1.0, middle, radius), whole = below(0.8, middle, radius) - first;
            for (float u = 0.05F; u < 1.0F; u += 0.1F) {
                const auto point = LightsText().tent_point(u, -1.0F, 0.8F, middle, radius);
                EXPECT_TRUE(point.place >= -1.0001F && point.place <= 0.8001F) << point.place;
                if (whole <= 0.0) {
                    EXPECT_NEAR(point.place, -1.0F + 1.8F * u, 1e-6F);
                    EXPECT_NEAR(point.length, 1.8F, 1e-6F);
                    continue;
                }
                const double share = (below(point.place, middle, radius) - first) / whole;
                // From one side or from the other.
                EXPECT_NEAR(std::min(std::abs(share - u), std::abs(1.0 - share - u)), 0.0, 2e-3) << middle;
                const double height = 1.0 - std::abs(double{point.place} - middle) / radius;
                EXPECT_NEAR(point.length * height / (whole * radius), 1.0, 2e-3) << middle << ", " << radius;
            }
        }
    }
}

TEST(SpreadFade, LeavesAllWithoutAGridAndNothingBeyondIt) {
    for (float angle = 0.0F; angle < 3.14F; angle += 0.01F) {
        const float cosine = std::cos(angle);
        EXPECT_EQ(LightsText().spread_fade(cosine, 0.0F), cosine > 0.0F ? 1.0F : 0.0F) << angle;
        const float half = 0.4F, fade = LightsText().spread_fade(cosine, 1.0F / std::tan(half));
        EXPECT_NEAR(fade, angle < half ? 1.0F - std::tan(angle) / std::tan(half) : 0.0F, 1e-3F) << angle;
    }
    EXPECT_EQ(LightsText().spread_fade(1.0F, 1.0F / std::tan(0.4F)), 1.0F);
}

TEST(SpreadFade, IsThatOfTheReference) {
    Light lamp = area_light(Light::Kind::RECTANGLE, {0, 0, 0}, {0.001F, 0, 0}, {0, 0.001F, 0}, glm::vec3(1.0F));
    for (const float spread : {0.3F, 1.5F, 3.0F, std::numbers::pi_v<float>}) {
        lamp.spread = spread;
        const float cotangent = spread < 3.14F ? 1.0F / std::tan(0.5F * spread) : 0.0F;
        for (float angle = 0.005F; angle < 3.14F; angle += 0.01F) {
            const glm::dvec3 at(std::sin(angle), 0.0, -std::cos(angle));
            const double expected = reference::light_samples(lamp, at, 1).at(0).irradiance.x / 4e-6;
            const float cosine = std::cos(angle);
            // A cosine in single precision knows a small angle to 3e-4 only.
            EXPECT_NEAR(std::max(cosine, 0.0F) * LightsText().spread_fade(cosine, cotangent), expected, 1e-4)
                << spread << ", " << angle;
        }
    }
}

} // namespace
} // namespace sfumato
