// SPDX-License-Identifier: GPL-3.0-or-later
// Textures that are formulas: what mathematics fixes, what Blender says, and that lanes say the same.
#define SFUMATO_ISA textures_test
#include "text/lanes.hpp"
#include "text/textures_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using Text = text::TexturesText<float>;
using glm::vec3;
using Rgb = std::array<float, 3>;

constexpr int LANES = textures_test::Isa::LANES;
constexpr std::array EDITIONS{VORONOI_3, VORONOI_4, VORONOI_5};
constexpr std::array FRACTALS{FRACTAL_SUM, FRACTAL_PRODUCT, FRACTAL_RIDGED, FRACTAL_HYBRID, FRACTAL_TERRAIN};

class Textures : public testing::Test {
protected:
    float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(generator); }
    vec3 anywhere() { return {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)}; }

    Text::Textured voronoi(int dimensions, int feature, int edition, vec3 p, float w, float randomness = 1.0F,
                           float smoothness = 1.0F) {
        return text.voronoi_texture(dimensions, feature, METRIC_EUCLIDEAN, edition, false, true, p, w, 0.0F, 0.5F, 2.0F,
                                    smoothness, 0.5F, randomness);
    }

    Text text;
    std::mt19937 generator{5};
};

float length_in(int dimensions, vec3 p, float w) {
    const float xy = dimensions > 1 ? p.x * p.x + p.y * p.y : 0.0F, z = dimensions > 2 ? p.z * p.z : 0.0F;
    return std::sqrt(xy + z + (dimensions == 1 || dimensions == 4 ? w * w : 0.0F));
}

TEST_F(Textures, HashesAreSpreadOverTheUnit) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        constexpr int COUNT = 20000;
        vec3 sum(0.0F), squares(0.0F);
        for (int k = 0; k < COUNT; ++k) {
            const vec3 c = text.white_noise_texture(dimensions, true, anywhere(), uniform(-5, 5)).colour;
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(c, vec3(0.0F))) && glm::all(glm::lessThanEqual(c, vec3(1.0F))));
            sum += c;
            squares += c * c;
        }
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(sum[i] / COUNT, 0.5F, 0.01F);
            EXPECT_NEAR(squares[i] / COUNT, 1.0F / 3.0F, 0.01F);
        }
    }
}

TEST_F(Textures, GradientNoiseIsNothingOnItsLatticeAndWithinOne) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        float most = 0.0F;
        for (int k = 0; k < 5000; ++k) {
            const vec3 p = anywhere();
            const float w = uniform(-5, 5);
            EXPECT_EQ(text.gradient_noise(dimensions, true, glm::floor(p), std::floor(w)), 0.0F);
            most = std::max(most, std::abs(text.gradient_noise(dimensions, true, p, w)));
        }
        EXPECT_GT(most, 0.5F);
        EXPECT_LE(most, 1.0F);
    }
}

TEST_F(Textures, GradientNoiseGoesOnSmoothlyFromCellToCell) {
    constexpr float STEP = 1e-3F;
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        for (int k = 0; k < 500; ++k) {
            const int axis = dimensions == 1 ? 3 : k % dimensions;
            std::array<float, 4> at{uniform(-5, 5), uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)};
            const auto noise = [&](float off) {
                std::array<float, 4> q = at;
                q[static_cast<std::size_t>(axis)] = std::floor(q[static_cast<std::size_t>(axis)]) + off;
                return text.gradient_noise(dimensions, true, {q[0], q[1], q[2]}, q[3]);
            };
            EXPECT_NEAR(noise(-1e-5F), noise(0.0F), 1e-4F);
            const float before = (noise(0.0F) - noise(-STEP)) / STEP, after = (noise(STEP) - noise(0.0F)) / STEP;
            EXPECT_NEAR(before, after, 0.02F);
        }
    }
}

TEST_F(Textures, NoiseRepeatsWhereItIsToldTo) {
    for (int k = 0; k < 100; ++k) {
        const vec3 p = glm::round(anywhere() * 64.0F) / 64.0F; // which a float still holds there
        const float here = text.gradient_noise(3, false, p, 0.0F);
        EXPECT_EQ(text.gradient_noise(3, true, p, 0.0F), here);
        EXPECT_EQ(text.gradient_noise(3, true, p + vec3(100000.0F, 0.0F, 0.0F) * (p.x > 0.0F ? 1.0F : -1.0F), 0.0F),
                  here);
    }
}

TEST_F(Textures, OctavesAddUp) {
    for (int k = 0; k < 200; ++k) {
        const vec3 p = anywhere();
        const auto value = [&](int type, bool normalise, float detail) {
            return text.noise_texture(3, type, true, normalise, false, p, 0.0F, detail, 0.6F, 2.5F, 0.4F, 1.3F, 0.0F)
                .value;
        };
        const float first = text.gradient_noise(3, true, p, 0.0F);
        const float second = text.gradient_noise(3, true, p * 2.5F, 0.0F);
        EXPECT_NEAR(value(FRACTAL_SUM, false, 0.0F), first, 1e-6F);
        EXPECT_NEAR(value(FRACTAL_SUM, false, 1.0F), first + 0.6F * second, 1e-6F);
        EXPECT_NEAR(value(FRACTAL_SUM, false, 0.25F), first + 0.15F * second, 1e-6F);
        EXPECT_NEAR(value(FRACTAL_SUM, true, 1.0F), 0.5F + 0.5F * (first + 0.6F * second) / 1.6F, 1e-6F);
        EXPECT_NEAR(value(FRACTAL_PRODUCT, false, 1.0F), (1.0F + first) * (1.0F + 0.6F * second), 1e-6F);
        EXPECT_NEAR(value(FRACTAL_TERRAIN, false, 1.0F), (0.4F + first) * (1.0F + 0.6F * (0.4F + second)), 1e-6F);
        EXPECT_NEAR(value(FRACTAL_RIDGED, false, 0.9F), std::pow(0.4F - std::abs(first), 2.0F), 1e-6F);
        for (const int type : FRACTALS) {
            if (type != FRACTAL_RIDGED) {
                EXPECT_NEAR(value(type, true, 2.9999F), value(type, true, 3.0F), 1e-3F);
            }
        }
        const float normalised = value(FRACTAL_SUM, true, uniform(0, 15));
        EXPECT_GE(normalised, 0.0F);
        EXPECT_LE(normalised, 1.0F);
    }
}

// Its dimension says what the roughness is, and its octaves are one more.
TEST_F(Textures, MusgraveIsNoiseByOtherWords) {
    for (const int type : FRACTALS) {
        for (int k = 0; k < 50; ++k) {
            const vec3 p = anywhere();
            EXPECT_NEAR(text.musgrave_texture(3, type, true, p, 0.0F, 3.5F, 0.7F, 2.2F, 0.3F, 1.5F),
                        text.noise_texture(3, type, true, false, false, p, 0.0F, 2.5F, std::pow(2.2F, -0.7F), 2.2F,
                                           0.3F, 1.5F, 0.0F)
                            .value,
                        1e-5F);
        }
    }
}

TEST_F(Textures, TheNearestPointIsWhereItIsSaidToBe) {
    for (const int edition : EDITIONS) {
        for (int dimensions = 1; dimensions <= 4; ++dimensions) {
            for (int k = 0; k < 300; ++k) {
                const vec3 p = anywhere();
                const float w = uniform(-5, 5), randomness = uniform(0, 1);
                const auto first = voronoi(dimensions, VORONOI_NEAREST, edition, p, w, randomness);
                const auto second = voronoi(dimensions, VORONOI_SECOND, edition, p, w, randomness);
                EXPECT_NEAR(first.value, length_in(dimensions, p - first.position, w - first.w), 2e-6F);
                EXPECT_NEAR(second.value, length_in(dimensions, p - second.position, w - second.w), 2e-6F);
                EXPECT_LE(first.value, second.value);
            }
        }
    }
}

TEST_F(Textures, WithoutRandomnessThePointsAreTheLattice) {
    for (int k = 0; k < 300; ++k) {
        const vec3 p = anywhere();
        EXPECT_NEAR(voronoi(3, VORONOI_NEAREST, VORONOI_5, p, 0.0F, 0.0F).value, glm::length(p - glm::round(p)), 2e-6F);
    }
}

TEST_F(Textures, SmoothnessLowersTheNearestDistance) {
    for (int dimensions = 1; dimensions <= 3; ++dimensions) {
        for (int k = 0; k < 100; ++k) {
            const vec3 p = anywhere();
            const float w = uniform(-5, 5);
            const float plain = voronoi(dimensions, VORONOI_NEAREST, VORONOI_5, p, w).value;
            EXPECT_LE(voronoi(dimensions, VORONOI_SMOOTH, VORONOI_5, p, w, 1.0F, 0.5F).value, plain + 1e-6F);
            EXPECT_NEAR(voronoi(dimensions, VORONOI_SMOOTH, VORONOI_5, p, w, 1.0F, 1e-4F).value, plain, 1e-4F);
        }
    }
}

// The border to a cell is the plane midway between both points, and no other border is nearer than half of what the
// second point is farther.
TEST_F(Textures, EdgesAreMidwayBetweenPoints) {
    for (int dimensions = 2; dimensions <= 4; ++dimensions) {
        int on_edges = 0;
        for (int k = 0; k < 300; ++k) {
            const vec3 p = anywhere();
            const float w = uniform(-5, 5);
            const auto first = voronoi(dimensions, VORONOI_NEAREST, VORONOI_5, p, w);
            const auto second = voronoi(dimensions, VORONOI_SECOND, VORONOI_5, p, w);
            const float edge = voronoi(dimensions, VORONOI_EDGE, VORONOI_5, p, w).value;
            const vec3 across = second.position - first.position;
            const float across_w = second.w - first.w, apart = length_in(dimensions, across, across_w);
            const float to_plane = (second.value * second.value - first.value * first.value) / (2.0F * apart);
            EXPECT_LE(edge, to_plane + 1e-5F);
            EXPECT_GE(edge, 0.5F * (second.value - first.value) - 1e-5F);

            const float go = to_plane / apart;
            const vec3 there = p + across * go;
            const float there_w = w + across_w * go;
            const float nearest = voronoi(dimensions, VORONOI_NEAREST, VORONOI_5, there, there_w).value;
            if (std::abs(voronoi(dimensions, VORONOI_SECOND, VORONOI_5, there, there_w).value - nearest) < 1e-5F) {
                EXPECT_NEAR(voronoi(dimensions, VORONOI_EDGE, VORONOI_5, there, there_w).value, 0.0F, 1e-5F);
                ++on_edges;
            }
        }
        EXPECT_GT(on_edges, 200);
    }
}

TEST_F(Textures, SpheresReachHalfwayToTheNextPoint) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        for (int k = 0; k < 100; ++k) {
            const vec3 p = anywhere();
            const float w = uniform(-5, 5);
            const auto at = voronoi(dimensions, VORONOI_NEAREST, VORONOI_5, p, w);
            const float next = voronoi(dimensions, VORONOI_SECOND, VORONOI_5, at.position, at.w).value;
            EXPECT_NEAR(voronoi(dimensions, VORONOI_SPHERE, VORONOI_5, p, w).value, 0.5F * next, 2e-6F);
        }
    }
}

TEST_F(Textures, MetricsAreOrdered) {
    for (int k = 0; k < 200; ++k) {
        const vec3 p = anywhere();
        const auto nearest = [&](int metric, float exponent, bool normalise) {
            return text
                .voronoi_texture(3, VORONOI_NEAREST, metric, VORONOI_5, normalise, false, p, 0.0F, 3.5F, 0.6F, 2.0F,
                                 1.0F, exponent, 1.0F)
                .value;
        };
        EXPECT_LE(nearest(METRIC_CHEBYCHEV, 1.0F, false), nearest(METRIC_EUCLIDEAN, 1.0F, false));
        EXPECT_LE(nearest(METRIC_EUCLIDEAN, 1.0F, false), nearest(METRIC_MANHATTAN, 1.0F, false));
        EXPECT_NEAR(nearest(METRIC_MINKOWSKI, 1.0F, false), nearest(METRIC_MANHATTAN, 1.0F, false), 1e-5F);
        EXPECT_NEAR(nearest(METRIC_MINKOWSKI, 2.0F, false), nearest(METRIC_EUCLIDEAN, 2.0F, false), 1e-5F);
        for (int metric = METRIC_EUCLIDEAN; metric <= METRIC_MINKOWSKI; ++metric) {
            EXPECT_GE(nearest(metric, 0.7F, true), 0.0F);
            EXPECT_LE(nearest(metric, 0.7F, true), 1.0F);
        }
    }
}

TEST_F(Textures, CheckersAlternate) {
    const vec3 white(1.0F), black(0.0F);
    for (int k = 0; k < 300; ++k) {
        const vec3 p = glm::floor(anywhere()) + vec3(uniform(0.1F, 0.9F), uniform(0.1F, 0.9F), uniform(0.1F, 0.9F));
        const vec3 cell = glm::floor(p);
        const bool odd = static_cast<int>(cell.x + cell.y + cell.z) % 2 != 0;
        EXPECT_EQ(text.checker_texture(p, white, black).value, odd ? 1.0F : 0.0F);
        EXPECT_EQ(text.checker_texture(p, white, black).colour.x, odd ? 1.0F : 0.0F);
    }
}

TEST_F(Textures, MortarCoversItsShare) {
    constexpr float WIDTH = 0.6F, HEIGHT = 0.3F, MORTAR = 0.04F;
    constexpr int COUNT = 100000;
    int covered = 0, moved = 0;
    for (int k = 0; k < COUNT; ++k) {
        const auto share = [&](float offset, float squash) {
            return text.brick_texture(vec3(uniform(0, 60 * WIDTH), uniform(0, 60 * HEIGHT), 0.0F), vec3(0.0F),
                                      vec3(0.0F), vec3(1.0F), MORTAR, 0.0F, 0.0F, WIDTH, HEIGHT, offset, 2, squash, 2);
        };
        covered += share(0.5F, 1.0F).value > 0.5F ? 1 : 0;
        moved += share(0.3F, 2.0F).colour.x > 0.5F ? 1 : 0;
    }
    const float plain = 1.0F - (WIDTH - 2.0F * MORTAR) * (HEIGHT - 2.0F * MORTAR) / (WIDTH * HEIGHT);
    const float wide = 1.0F - (2.0F * WIDTH - 2.0F * MORTAR) * (HEIGHT - 2.0F * MORTAR) / (2.0F * WIDTH * HEIGHT);
    EXPECT_NEAR(static_cast<float>(covered) / COUNT, plain, 0.01F);
    EXPECT_NEAR(static_cast<float>(moved) / COUNT, 0.5F * (plain + wide), 0.01F);
}

TEST_F(Textures, ProfilesOfWavesAreOfTheSameTurn) {
    for (int k = 0; k < 300; ++k) {
        const vec3 p = anywhere();
        const auto wave = [&](int profile) {
            return text.wave_texture(WAVE_RINGS, k % 4, profile, true, p * 0.3F, 2.0F, 1.5F, 1.0F, 0.5F, 0.7F);
        };
        const float turn = wave(PROFILE_SAW);
        EXPECT_GE(turn, 0.0F);
        EXPECT_LE(turn, 1.0F);
        EXPECT_NEAR(wave(PROFILE_SINE), 0.5F - 0.5F * std::cos(6.2831853F * turn), 1e-4F);
        EXPECT_NEAR(wave(PROFILE_TRIANGLE), 1.0F - std::abs(2.0F * turn - 1.0F), 1e-4F);
    }
}

// Blender's own values at (0.37, -1.21, 2.64), where w = -0.83 and all scales are 1: attributes of a mesh by Geometry
// Nodes. Noise that does not repeat, Musgrave and VORONOI_3 are 3.4.1's, VORONOI_4 is 4.5.4's, as is the sum of
// detail 1.5, and the rest is 5.0.1's.
const vec3 PLACE(0.37F, -1.21F, 2.64F);
constexpr float PLACE_W = -0.83F, NEAR = 1e-5F;

void expect_rgb(vec3 colour, const Rgb &measured, float near, const std::string &what) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(colour[i], measured[static_cast<std::size_t>(i)], near) << what << ", channel " << i;
    }
}

struct NoiseRow {
    int dimensions, type;
    bool repeats, normalise;
    float detail, roughness, lacunarity, offset, gain, distortion;
    float value;
    Rgb colour;
};
constexpr NoiseRow NOISES[] = {
    {1,
     FRACTAL_SUM,
     false,
     true,
     2.3F,
     0.6F,
     2.0F,
     0.0F,
     0.0F,
     0.8F,
     0.502396762F,
     {0.502396762F, 0.550245404F, 0.53544867F}},
    {2,
     FRACTAL_SUM,
     false,
     true,
     2.3F,
     0.6F,
     2.0F,
     0.0F,
     0.0F,
     0.8F,
     0.444430709F,
     {0.444430709F, 0.541988552F, 0.695807636F}},
    {3,
     FRACTAL_SUM,
     false,
     true,
     2.3F,
     0.6F,
     2.0F,
     0.0F,
     0.0F,
     0.8F,
     0.53238821F,
     {0.53238821F, 0.521542311F, 0.495186269F}},
    {4,
     FRACTAL_SUM,
     false,
     true,
     2.3F,
     0.6F,
     2.0F,
     0.0F,
     0.0F,
     0.8F,
     0.520633221F,
     {0.520633221F, 0.565485537F, 0.553017318F}},
    {3,
     FRACTAL_SUM,
     false,
     true,
     0.0F,
     0.5F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.485661477F,
     {0.485661477F, 0.515520871F, 0.608733356F}},
    {3,
     FRACTAL_SUM,
     false,
     true,
     15.0F,
     1.0F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.52339232F,
     {0.52339232F, 0.528946877F, 0.549798548F}},
    {3,
     FRACTAL_SUM,
     true,
     false,
     1.5F,
     0.4F,
     2.5F,
     0.0F,
     0.0F,
     -0.6F,
     -0.271908432F,
     {-0.271908432F, -0.251074791F, 0.552109778F}},
    {3,
     FRACTAL_SUM,
     true,
     false,
     3.4F,
     0.7F,
     1.8F,
     0.3F,
     1.5F,
     0.4F,
     0.129719466F,
     {0.129719466F, 0.523680866F, 0.130863115F}},
    {3,
     FRACTAL_PRODUCT,
     true,
     false,
     3.4F,
     0.7F,
     1.8F,
     0.3F,
     1.5F,
     0.4F,
     1.12322927F,
     {1.12322927F, 1.5994184F, 1.12385356F}},
    {3,
     FRACTAL_RIDGED,
     true,
     false,
     3.4F,
     0.7F,
     1.8F,
     0.3F,
     1.5F,
     0.4F,
     0.0882377476F,
     {0.0882377476F, 0.0716119185F, 0.0305468943F}},
    {3,
     FRACTAL_HYBRID,
     true,
     false,
     3.4F,
     0.7F,
     1.8F,
     0.3F,
     1.5F,
     0.4F,
     0.405831128F,
     {0.405831128F, 0.700967729F, 0.528666675F}},
    {3,
     FRACTAL_TERRAIN,
     true,
     false,
     3.4F,
     0.7F,
     1.8F,
     0.3F,
     1.5F,
     0.4F,
     0.538033724F,
     {0.538033724F, 0.774264693F, 0.676955283F}},
    {1,
     FRACTAL_SUM,
     true,
     true,
     2.0F,
     0.5F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.47531563F,
     {0.47531563F, 0.49612695F, 0.64739871F}},
    {1,
     FRACTAL_RIDGED,
     true,
     false,
     2.5F,
     0.6F,
     2.1F,
     0.8F,
     2.0F,
     0.0F,
     0.724380672F,
     {0.724380672F, 0.66370517F, 0.465042859F}},
    {2,
     FRACTAL_SUM,
     true,
     true,
     2.0F,
     0.5F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.473105967F,
     {0.473105967F, 0.577771723F, 0.565679073F}},
    {2,
     FRACTAL_RIDGED,
     true,
     false,
     2.5F,
     0.6F,
     2.1F,
     0.8F,
     2.0F,
     0.0F,
     0.286392242F,
     {0.286392242F, 0.98316741F, 0.912880182F}},
    {4,
     FRACTAL_SUM,
     true,
     true,
     2.0F,
     0.5F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.436646193F,
     {0.436646193F, 0.472435057F, 0.52662915F}},
    {4,
     FRACTAL_RIDGED,
     true,
     false,
     2.5F,
     0.6F,
     2.1F,
     0.8F,
     2.0F,
     0.0F,
     0.788556516F,
     {0.788556516F, 0.937344611F, 0.666855454F}},
    {3,
     FRACTAL_SUM,
     true,
     true,
     15.0F,
     1.0F,
     2.0F,
     0.0F,
     0.0F,
     0.0F,
     0.52339232F,
     {0.52339232F, 0.51974088F, 0.510137677F}},
};

TEST_F(Textures, NoiseIsBlenders) {
    for (const NoiseRow &row : NOISES) {
        const auto ours =
            text.noise_texture(row.dimensions, row.type, row.repeats, row.normalise, true, PLACE, PLACE_W, row.detail,
                               row.roughness, row.lacunarity, row.offset, row.gain, row.distortion);
        const std::string what = "row " + std::to_string(&row - NOISES);
        EXPECT_NEAR(ours.value, row.value, NEAR) << what;
        // The other channels are looked up 200 away, where a float has steps of 1.5e-5: distortions round otherwise.
        expect_rgb(ours.colour, row.colour, row.distortion == 0.0F ? NEAR : 6e-5F, what);
    }
}

struct MusgraveRow {
    int dimensions, type;
    float detail, dimension, lacunarity, offset, gain;
    float value;
};
constexpr MusgraveRow MUSGRAVES[] = {
    {3, FRACTAL_SUM, 3.4F, 0.4F, 1.8F, 0.2F, 2.0F, -0.348148286F},
    {3, FRACTAL_SUM, 0.6F, 0.7F, 2.1F, 0.6F, 1.2F, -0.0172062274F},
    {3, FRACTAL_PRODUCT, 3.4F, 0.4F, 1.8F, 0.2F, 2.0F, 0.665689826F},
    {3, FRACTAL_PRODUCT, 0.6F, 0.7F, 2.1F, 0.6F, 1.2F, 0.982793748F},
    {3, FRACTAL_RIDGED, 3.4F, 0.4F, 1.8F, 0.2F, 2.0F, 0.0309673436F},
    {3, FRACTAL_RIDGED, 0.6F, 0.7F, 2.1F, 0.6F, 1.2F, 0.326409936F},
    {3, FRACTAL_HYBRID, 3.4F, 0.4F, 1.8F, 0.2F, 2.0F, 0.121720538F},
    {3, FRACTAL_HYBRID, 0.6F, 0.7F, 2.1F, 0.6F, 1.2F, 0.342793792F},
    {3, FRACTAL_TERRAIN, 3.4F, 0.4F, 1.8F, 0.2F, 2.0F, 0.168910384F},
    {3, FRACTAL_TERRAIN, 0.6F, 0.7F, 2.1F, 0.6F, 1.2F, 0.695640981F},
    {1, FRACTAL_SUM, 4.0F, 1.0F, 2.0F, 0.0F, 0.0F, -0.10305763F},
    {1, FRACTAL_HYBRID, 2.0F, 0.3F, 2.0F, 0.7F, 1.0F, 0.837850869F},
    {2, FRACTAL_SUM, 4.0F, 1.0F, 2.0F, 0.0F, 0.0F, -0.0687364787F},
    {2, FRACTAL_HYBRID, 2.0F, 0.3F, 2.0F, 0.7F, 1.0F, 0.899166107F},
    {4, FRACTAL_SUM, 4.0F, 1.0F, 2.0F, 0.0F, 0.0F, -0.20680137F},
    {4, FRACTAL_HYBRID, 2.0F, 0.3F, 2.0F, 0.7F, 1.0F, 0.93085736F},
};

TEST_F(Textures, MusgraveIsBlenders) {
    for (const MusgraveRow &row : MUSGRAVES) {
        EXPECT_NEAR(text.musgrave_texture(row.dimensions, row.type, false, PLACE, PLACE_W, row.detail, row.dimension,
                                          row.lacunarity, row.offset, row.gain),
                    row.value, NEAR)
            << "row " << &row - MUSGRAVES;
    }
}

struct VoronoiRow {
    int dimensions, feature, metric, edition;
    bool normalise;
    float detail, roughness, lacunarity, smoothness, exponent, randomness;
    float value;
    Rgb colour, position;
    float w;
};
constexpr VoronoiRow VORONOIS[] = {
    {1,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.0225015134F,
     {0.163887233F, 0.294934273F, 0.905046403F},
     {0.0F, 0.0F, 0.0F},
     -0.852501512F},
    {1,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     1.10183144F,
     {0.0757429525F, 0.307109803F, 0.0346586555F},
     {0.0F, 0.0F, 0.0F},
     -1.93183136F},
    {1,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.0225015134F,
     {0.163887233F, 0.294934273F, 0.905046403F},
     {0.0F, 0.0F, 0.0F},
     -0.852501512F},
    {1,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.562166452F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {1,
     VORONOI_SPHERE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.539664924F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {2,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.321500748F,
     {0.0950352922F, 0.711331427F, 0.137978956F},
     {0.0855317637F, -1.35980177F, 0.0F},
     0.0F},
    {2,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.480333179F,
     {0.598608315F, 0.266350776F, 0.327369392F},
     {0.538747489F, -0.760284305F, 0.0F},
     0.0F},
    {2,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.287946403F,
     {0.173755005F, 0.58341676F, 0.148256674F},
     {0.153281555F, -1.26018143F, 0.0F},
     0.0F},
    {2,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.0847298428F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {2,
     VORONOI_SPHERE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.375774413F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.710894048F,
     {0.137978956F, 0.166523665F, 0.502711356F},
     {0.124181055F, -1.85012865F, 2.45244026F},
     0.0F},
    {3,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.789759398F,
     {0.700367689F, 0.570247114F, 0.713257313F},
     {-0.36966908F, -1.48677754F, 2.64193153F},
     0.0F},
    {3,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.612186432F,
     {0.249196947F, 0.318994313F, 0.422774732F},
     {0.00833041966F, -1.57839477F, 2.38219619F},
     0.0F},
    {3,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.0688608587F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {3,
     VORONOI_SPHERE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.177097023F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {4,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.740465581F,
     {0.138136297F, 0.705080688F, 0.805494487F},
     {0.124322668F, -1.47916627F, 3.10626984F},
     -1.27505493F},
    {4,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.806765258F,
     {0.286661208F, 0.16840598F, 0.350045264F},
     {0.257995069F, -0.426644444F, 2.70035195F},
     -0.684959292F},
    {4,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.645918071F,
     {0.225706637F, 0.419615358F, 0.478763223F},
     {0.173460439F, -1.27282476F, 2.77368903F},
     -1.08710015F},
    {4,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.0400676057F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {4,
     VORONOI_SPHERE,
     METRIC_EUCLIDEAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     0.8F,
     1.0F,
     0.9F,
     0.315612435F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_MANHATTAN,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     0.6F,
     1.0F,
     0.962642372F,
     {0.700367689F, 0.570247114F, 0.713257313F},
     {-0.299632311F, -1.42975283F, 2.71325731F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_CHEBYCHEV,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     0.6F,
     1.0F,
     0.623476267F,
     {0.137978956F, 0.166523665F, 0.502711356F},
     {0.137978956F, -1.83347631F, 2.5027113F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_MINKOWSKI,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     0.6F,
     1.0F,
     1.74666381F,
     {0.700367689F, 0.570247114F, 0.713257313F},
     {-0.299632311F, -1.42975283F, 2.71325731F},
     0.0F},
    {3,
     VORONOI_SMOOTH,
     METRIC_MINKOWSKI,
     VORONOI_3,
     false,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     0.25F,
     1.0F,
     8.0F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, -2.0F, 2.0F},
     0.0F},
    {2,
     VORONOI_NEAREST,
     METRIC_CHEBYCHEV,
     VORONOI_4,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.373609155F,
     {0.339299738F, 0.704675078F, 0.165391818F},
     {0.216838926F, -1.17396283F, 0.0F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_CHEBYCHEV,
     VORONOI_4,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.512836754F,
     {0.748908579F, 0.323043883F, 0.25455603F},
     {0.349137604F, -1.1337018F, 2.80824471F},
     0.0F},
    {4,
     VORONOI_NEAREST,
     METRIC_CHEBYCHEV,
     VORONOI_4,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.55778861F,
     {0.30336225F, 0.647584736F, 0.821164787F},
     {0.407012403F, -1.23888171F, 2.71973753F},
     -0.798603415F},
    {1,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.107130244F,
     {0.151987702F, 0.345818758F, 0.562498033F},
     {0.0F, 0.0F, 0.0F},
     -0.848426461F},
    {1,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.54029876F,
     {0.176439464F, 0.278234273F, 0.446768105F},
     {0.0F, 0.0F, 0.0F},
     -0.882998943F},
    {1,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.107129596F,
     {0.151995152F, 0.345770925F, 0.562493861F},
     {0.0F, 0.0F, 0.0F},
     -0.848456383F},
    {1,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.503370821F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {2,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.342670977F,
     {0.575246453F, 0.515564322F, 0.537513614F},
     {0.239197344F, -1.16915178F, 0.0F},
     0.0F},
    {2,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.292433262F,
     {0.298269331F, 0.607757986F, 0.402429223F},
     {0.632531762F, -1.12496734F, 0.0F},
     0.0F},
    {2,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.322179407F,
     {0.533182621F, 0.447443515F, 0.481841654F},
     {0.376277775F, -1.23312759F, 0.0F},
     0.0F},
    {2,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.158138588F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {3,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.345765769F,
     {0.506020367F, 0.396365643F, 0.494195521F},
     {0.470594883F, -1.08400249F, 2.46398902F},
     0.0F},
    {3,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.216803059F,
     {0.800509572F, 0.956836462F, 0.406907827F},
     {0.370005071F, -1.36784434F, 2.43800163F},
     0.0F},
    {3,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.325847328F,
     {0.49180308F, 0.45657441F, 0.445125133F},
     {0.402940661F, -1.15257013F, 2.46054769F},
     0.0F},
    {3,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.117820762F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {4,
     VORONOI_NEAREST,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.276469946F,
     {0.079079695F, 0.651324213F, 0.440091848F},
     {0.376611888F, -1.20027065F, 2.66222239F},
     -0.797127903F},
    {4,
     VORONOI_SECOND,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.22374396F,
     {0.463870376F, 0.694415748F, 0.366414756F},
     {0.457008958F, -1.20203543F, 2.91930008F},
     -1.05788636F},
    {4,
     VORONOI_SMOOTH,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.275490403F,
     {0.0879185125F, 0.651886284F, 0.426687002F},
     {0.372214973F, -1.20046222F, 2.66555214F},
     -0.79842639F},
    {4,
     VORONOI_EDGE,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     true,
     1.6F,
     0.7F,
     2.2F,
     0.6F,
     1.0F,
     0.8F,
     0.236272082F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
    {2,
     VORONOI_SECOND,
     METRIC_MANHATTAN,
     VORONOI_5,
     true,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     1.0F,
     1.0F,
     0.249752179F,
     {0.981901646F, 0.462999463F, 0.808353066F},
     {-0.446596563F, -1.39241219F, 0.0F},
     0.0F},
    {3,
     VORONOI_SMOOTH,
     METRIC_MINKOWSKI,
     VORONOI_5,
     true,
     2.0F,
     0.5F,
     2.0F,
     0.7F,
     1.7F,
     1.0F,
     0.24555181F,
     {0.459107876F, 0.300497353F, 0.436199158F},
     {0.475645214F, -1.11980402F, 2.62920165F},
     0.0F},
    {3,
     VORONOI_SPHERE,
     METRIC_EUCLIDEAN,
     VORONOI_5,
     false,
     0.0F,
     0.5F,
     2.0F,
     1.0F,
     1.0F,
     1.0F,
     0.24057287F,
     {0.0F, 0.0F, 0.0F},
     {0.0F, 0.0F, 0.0F},
     0.0F},
};

TEST_F(Textures, VoronoiIsBlenders) {
    for (const VoronoiRow &row : VORONOIS) {
        const auto ours = text.voronoi_texture(row.dimensions, row.feature, row.metric, row.edition, row.normalise,
                                               true, PLACE, PLACE_W, row.detail, row.roughness, row.lacunarity,
                                               row.smoothness, row.exponent, row.randomness);
        const std::string what = "row " + std::to_string(&row - VORONOIS);
        EXPECT_NEAR(ours.value, row.value, NEAR) << what;
        if (row.feature <= VORONOI_SMOOTH) {
            expect_rgb(ours.colour, row.colour, NEAR, what);
            expect_rgb(ours.position, row.position, NEAR, what + ", position");
            EXPECT_NEAR(ours.w, row.w, NEAR) << what;
        }
    }
}

struct MagicRow {
    int depth;
    float distortion;
    float value;
    Rgb colour;
};
constexpr MagicRow MAGICS[] = {
    {0, 1.0F, 0.556224287F, {0.293940753F, 0.814260423F, 0.560471594F}},
    {2, 1.5F, 0.473979294F, {0.266422093F, 0.595044136F, 0.560471594F}},
    {4, -0.7F, 0.784809053F, {0.841617703F, 0.899914145F, 0.61289525F}},
    {10, 1.2F, 0.640726089F, {0.972396255F, 0.0935457349F, 0.8562361F}},
    {3, 0.0F, 0.5F, {0.5F, 0.5F, 0.5F}},
};

TEST_F(Textures, MagicIsBlenders) {
    for (const MagicRow &row : MAGICS) {
        const auto ours = text.magic_texture(PLACE, row.depth, row.distortion);
        const std::string what = "row " + std::to_string(&row - MAGICS);
        EXPECT_NEAR(ours.value, row.value, NEAR) << what;
        expect_rgb(ours.colour, row.colour, NEAR, what);
    }
}

struct WaveRow {
    int type, direction, profile;
    float distortion, detail, detail_scale, detail_roughness, phase;
    float value;
};
constexpr WaveRow WAVES[] = {
    {WAVE_BANDS, WAVE_X, PROFILE_SINE, 0.0F, 2.0F, 1.0F, 0.5F, 0.0F, 0.280731857F},
    {WAVE_BANDS, WAVE_Y, PROFILE_SAW, 3.0F, 2.6F, 1.3F, 0.6F, 1.0F, 0.308238745F},
    {WAVE_BANDS, WAVE_Z, PROFILE_TRIANGLE, 0.0F, 2.0F, 1.0F, 0.5F, 0.4F, 0.934076309F},
    {WAVE_BANDS, WAVE_ALL, PROFILE_SINE, -2.0F, 1.0F, 0.7F, 0.4F, 0.0F, 0.0200244188F},
    {WAVE_RINGS, WAVE_X, PROFILE_SAW, 0.0F, 2.0F, 1.0F, 0.5F, 0.0F, 0.243976593F},
    {WAVE_RINGS, WAVE_Y, PROFILE_TRIANGLE, 1.5F, 0.0F, 2.0F, 0.5F, 0.0F, 0.839254379F},
    {WAVE_RINGS, WAVE_Z, PROFILE_SINE, 0.0F, 2.0F, 1.0F, 0.5F, 2.0F, 0.783373117F},
    {WAVE_RINGS, WAVE_ALL, PROFILE_SAW, 2.0F, 3.0F, 1.0F, 0.8F, 0.0F, 0.285944939F},
};

TEST_F(Textures, WaveIsBlenders) {
    for (const WaveRow &row : WAVES) {
        EXPECT_NEAR(text.wave_texture(row.type, row.direction, row.profile, true, PLACE, row.distortion, row.detail,
                                      row.detail_scale, row.detail_roughness, row.phase),
                    row.value, NEAR)
            << "row " << &row - WAVES;
    }
}

struct BrickRow {
    float mortar_size, mortar_smooth, bias, brick_width, row_height, offset;
    int offset_frequency;
    float squash;
    int squash_frequency;
    float value;
    Rgb colour;
};
constexpr BrickRow BRICKS[] = {
    {0.02F, 0.1F, 0.0F, 0.5F, 0.25F, 0.5F, 2, 1.0F, 2, 0.0F, {0.130552486F, 0.296180964F, 0.773266554F}},
    {0.3F, 0.9F, 0.3F, 0.7F, 0.5F, 0.3F, 3, 1.5F, 2, 0.740741074F, {0.219296515F, 0.590643644F, 0.390059859F}},
    {0.2F, 0.5F, -0.2F, 0.6F, 0.5F, 0.2F, 1, 0.7F, 4, 0.972000003F, {0.213284016F, 0.686789513F, 0.29992649F}},
    {0.2F, 0.0F, 0.0F, 0.5F, 0.25F, 0.5F, 2, 1.0F, 2, 1.0F, {0.200000003F, 0.699999988F, 0.300000012F}},
};

TEST_F(Textures, BrickIsBlenders) {
    for (const BrickRow &row : BRICKS) {
        const auto ours =
            text.brick_texture(PLACE, vec3(0.9F, 0.2F, 0.1F), vec3(0.1F, 0.3F, 0.8F), vec3(0.2F, 0.7F, 0.3F),
                               row.mortar_size, row.mortar_smooth, row.bias, row.brick_width, row.row_height,
                               row.offset, row.offset_frequency, row.squash, row.squash_frequency);
        const std::string what = "row " + std::to_string(&row - BRICKS);
        EXPECT_NEAR(ours.value, row.value, NEAR) << what;
        expect_rgb(ours.colour, row.colour, NEAR, what);
    }
}

struct WhiteNoiseRow {
    int dimensions;
    float value;
    Rgb colour;
};
constexpr WhiteNoiseRow WHITE_NOISES[] = {
    {1, 0.0040458506F, {0.0040458506F, 0.41632998F, 0.104360707F}},
    {2, 0.929100871F, {0.929100871F, 0.74803102F, 0.664809406F}},
    {3, 0.995239258F, {0.995239258F, 0.634710968F, 0.726525128F}},
    {4, 0.352512479F, {0.352512479F, 0.428570688F, 0.273302227F}},
};

TEST_F(Textures, WhiteNoiseIsBlenders) {
    for (const WhiteNoiseRow &row : WHITE_NOISES) {
        const auto ours = text.white_noise_texture(row.dimensions, true, PLACE, PLACE_W);
        EXPECT_NEAR(ours.value, row.value, NEAR);
        expect_rgb(ours.colour, row.colour, NEAR, "dimensions: " + std::to_string(row.dimensions));
    }
}

// Everything, of four coordinates and a number in [0, 1].
template <class Real, class Isa>
std::vector<Real> answers(const std::array<Real, 5> &n) {
    using T = text::TexturesText<Real, Isa>;
    using Vec3 = typename T::vec3;
    T text;
    std::vector<Real> out;
    const Vec3 p(n[0], n[1], n[2]), red(Real(0.9F), Real(0.2F), Real(0.1F)), blue(Real(0.1F), Real(0.3F), Real(0.8F));
    const Real w = n[3], some = n[4];
    const auto add = [&](const Vec3 &v) { out.insert(out.end(), {v.x, v.y, v.z}); };
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        for (const int type : FRACTALS) {
            const auto noise = text.noise_texture(dimensions, type, dimensions % 2 == 0, type == FRACTAL_SUM, true, p,
                                                  w, some * 3.0F, some * 0.7F, 2.0F, 0.4F, 1.3F, some - 0.5F);
            out.push_back(noise.value);
            add(noise.colour);
            out.push_back(text.musgrave_texture(dimensions, type, true, p, w, some * 4.0F, some, 2.2F, 0.4F, 1.2F));
        }
        for (int feature = VORONOI_NEAREST; feature <= VORONOI_SPHERE; ++feature) {
            for (const int edition : EDITIONS) {
                const auto cells = text.voronoi_texture(dimensions, feature, (feature + edition) % 4, edition, true,
                                                        true, p, w, some * 2.0F, 0.5F, 2.1F, some, 1.5F, 0.9F);
                out.push_back(cells.value);
                if (feature <= VORONOI_SMOOTH) {
                    add(cells.colour);
                    add(cells.position);
                    out.push_back(cells.w);
                }
            }
        }
        add(text.white_noise_texture(dimensions, true, p, w).colour);
    }
    out.push_back(text.checker_texture(p, red, blue).value);
    const auto brick =
        text.brick_texture(p, red, blue, Vec3(some, some, some), 0.1F, some, some - 0.5F, 0.6F, 0.3F, 0.4F, 2, 0.7F, 3);
    out.push_back(brick.value);
    add(brick.colour);
    add(text.magic_texture(p, 4, some).colour);
    for (int profile = PROFILE_SINE; profile <= PROFILE_TRIANGLE; ++profile) {
        out.push_back(
            text.wave_texture(profile % 2, profile, profile, true, p * Real(0.1F), some, 2.0F, 1.5F, 0.6F, some));
    }
    return out;
}

TEST_F(Textures, LanesSayTheSame) {
    std::size_t apart = 0, all = 0;
    for (int round = 0; round < 20; ++round) {
        alignas(64) float numbers[5][LANES];
        std::array<textures_test::Real, 5> of_lanes;
        for (int i = 0; i < 5; ++i) {
            for (float &number : numbers[i]) {
                number = i < 4 ? uniform(-5, 5) : uniform(0, 1);
            }
            of_lanes[static_cast<std::size_t>(i)] = textures_test::Isa::load(numbers[i]);
        }
        const auto lanes = answers<textures_test::Real, textures_test::Isa>(of_lanes);
        for (int lane = 0; lane < LANES; ++lane) {
            const auto single = answers<float, text::OneLane>(
                {numbers[0][lane], numbers[1][lane], numbers[2][lane], numbers[3][lane], numbers[4][lane]});
            ASSERT_EQ(single.size(), lanes.size());
            for (std::size_t k = 0; k < single.size(); ++k) {
                alignas(64) float of_lane[LANES];
                textures_test::Isa::store(lanes[k], of_lane);
                const bool near = std::abs(single[k] - of_lane[lane]) <= 6e-5F * (1.0F + std::abs(single[k]));
                apart += near ? 0 : 1;
                ++all;
            }
        }
    }
    // Of two points that are as near one may win here and the other there.
    EXPECT_LE(apart, all / 5000);
}

} // namespace
} // namespace sfumato
