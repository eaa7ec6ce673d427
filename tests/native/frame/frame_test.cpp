// SPDX-License-Identifier: GPL-3.0-or-later
// Whole pictures, against the reference and against what physics fixes.
#include "support/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using namespace reference::testing;

// The qualities that the add-on offers, with the error allowed for a picture of smoke over a floor, of smoke alone, and
// of smoke in the shadow of a block. Measured: a third less.
struct Quality {
    const char *name;
    FrameSettings settings;
    double over_floor, alone, in_shadow;
};
constexpr Quality qualities[] = {{"draft", {7, 1.0, 0.5}, 0.0007, 0.0058, 0.017},
                                 {"preview", {15, 2.0, 1.0}, 0.00021, 0.0041, 0.0098},
                                 {"final", {31, 4.0, 2.0}, 0.00009, 0.0038, 0.0145}};

TEST(Picture, IsThatOfTheReference) {
    const Scene scene = smoke_over_floor();
    const auto expected = exact(scene);
    for (const Quality &quality : qualities) {
        const double off = error(render(scene, quality.settings), expected);
        EXPECT_LT(off, quality.over_floor) << quality.name;
    }
    Scene clear = scene;
    clear.media.clear();
    EXPECT_GT(error(render(clear), expected), 0.1); // there is something to get wrong
}

TEST(Picture, OfSmokeAloneIsThatOfTheReference) {
    Scene scene = smoke_over_floor();
    scene.meshes.clear();
    scene.background = glm::vec3(0.0F);
    const auto expected = exact(scene);
    for (const Quality &quality : qualities) {
        const double off = error(render(scene, quality.settings), expected);
        EXPECT_LT(off, quality.alone) << quality.name;
    }
}

// The lit volume has one sample a cell, so at no quality is the edge of a shadow in smoke sharper than that. A finer
// map is no better: the edge is then cut harder than the cells can show.
TEST(Picture, OfSmokeInTheShadowOfABlackBlockIsThatOfTheReference) {
    Scene scene = smoke_over_floor();
    const std::vector<Mesh> sides = block({-1.5F, -1.3F, 0.0F}, {0.7F, 0.7F, 2.0F}, glm::vec3(0.0F));
    scene.meshes.assign(sides.begin(), sides.end());
    scene.background = glm::vec3(0.0F);
    const auto expected = exact(scene);
    for (const Quality &quality : qualities) {
        const double off = error(render(scene, quality.settings), expected);
        EXPECT_LT(off, quality.in_shadow) << quality.name;
    }
    scene.meshes.clear();
    EXPECT_GT(error(render(scene), expected), 0.1);
}

TEST(Picture, OfRoughSmokeIsThatOfTheReference) {
    Scene scene = smoke_over_floor();
    scene.media = {random_medium({16, 16, 16}, glm::scale(scene.media[0].grid_to_world, glm::vec3(2.0F)), 41)};
    scene.media[0].scattering = glm::vec3(3.0F);
    EXPECT_LT(error(render(scene), exact(scene)), 0.0045);
}

TEST(Picture, OfColouredSmokeIsThatOfTheReferenceAndOfThreeGreyOnes) {
    Scene scene = smoke_over_floor();
    scene.media[0].scattering = {0.5F, 1.0F, 3.0F};
    scene.media[0].absorption = {1.0F, 0.0F, 0.5F};
    const std::vector<float> coloured = render(scene);
    EXPECT_LT(error(coloured, exact(scene)), 0.0002);
    for (int c = 0; c < 3; ++c) {
        Scene grey = scene;
        grey.media[0].scattering = glm::vec3(scene.media[0].scattering[c]);
        grey.media[0].absorption = glm::vec3(scene.media[0].absorption[c]);
        const std::vector<float> image = render(grey);
        for (auto i = std::size_t(c); i < image.size(); i += 4) {
            EXPECT_NEAR(coloured[i], image[i], 2e-5F) << "colour " << c;
        }
    }
}

TEST(Picture, FromInsideTheSmokeIsThatOfTheReference) {
    const Scene scene = smoke_over_floor();
    const Camera inside = camera_at({0.1F, -0.2F, 0.9F}, {-1.0F, -0.6F, 0.5F}, 16.0F / 9.0F);
    EXPECT_LT(error(render(scene, finest, 1, inside), exact(scene, inside)), 0.00025);
}

TEST(Picture, OfAnOrthographicCameraIsThatOfTheReference) {
    const Scene scene = smoke_over_floor();
    EXPECT_LT(error(render(scene, finest, 1, camera_from_above(3.0F)), exact(scene, camera_from_above(3.0F))), 0.00035);
}

// Chandrasekhar, Radiative Transfer, 1950, section 47: L = albedo p E m / (m + n) (1 - exp(-tau (1/m + 1/n))) for light
// at a cosine m to a slab's normal and an eye at a cosine n.
TEST(Picture, OfASlabIsTheClosedForm) {
    Scene scene;
    // Thin cells: the density has ramps of one cell at the slab's faces, which the formula does not know of.
    scene.media = {uniform_medium({64, 64, 64}, 1.0F,
                                  glm::scale(glm::translate(glm::mat4(1.0F), glm::vec3(-4.0F, -4.0F, -0.5F)),
                                             glm::vec3(0.125F, 0.125F, 1 / 64.0F)))};
    scene.media[0].scattering = {0.5F, 1.0F, 2.0F};
    scene.media[0].absorption = glm::vec3(0.5F, 0.0F, 0.0F);
    scene.media[0].anisotropy = 0.4F;
    scene.lights = {sun_light(glm::normalize(glm::vec3(0.5F, -1.0F, -2.0F)), glm::vec3(1.0F, 2.0F, 4.0F))};
    const glm::dvec3 way = glm::normalize(glm::dvec3(-2, 0, -4));
    const Camera pixel{{glm::vec3(1, 0, 2), glm::vec3(0), glm::vec3(0)},
                       {glm::vec3(-1, 0, -2), glm::vec3(0), glm::vec3(0)}};
    const double m = -double{scene.lights[0].direction.z}, n = -way.z;
    const double phase =
        reference::henyey_greenstein(glm::dot(glm::dvec3(scene.lights[0].direction), -way), double{0.4F});
    const std::vector<float> image = Frame(scene, finest).render(pixel, 1, 1, 1, {}).value();
    for (int c = 0; c < 3; ++c) {
        const double tau = double{scene.media[0].scattering[c]} + double{scene.media[0].absorption[c]};
        const double albedo = double{scene.media[0].scattering[c]} / tau;
        const double expected = albedo * phase * double{scene.lights[0].strength[c]} * (m / (m + n)) *
                                (1.0 - std::exp(-tau * (1.0 / m + 1.0 / n)));
        EXPECT_NEAR(image[std::size_t(c)], expected, 0.0003 * expected) << "colour " << c;
    }
}

// ---- What is left out ----

TEST(Picture, OfNothingIsTheBackground) {
    Scene scene;
    scene.background = {0.25F, 0.5F, 2.0F};
    scene.lights = {Light{}};
    for (const bool with_smoke : {false, true}) {
        if (with_smoke) {
            scene.media = {uniform_medium({4, 4, 4}, 0.0F, glm::mat4(1.0F))};
        }
        const std::vector<float> image = render(scene, finest, 16);
        for (std::size_t i = 0; i < image.size(); i += 4) {
            EXPECT_EQ(image[i], 0.25F);
            EXPECT_EQ(image[i + 1], 0.5F);
            EXPECT_EQ(image[i + 2], 2.0F);
            EXPECT_EQ(image[i + 3], 0.0F);
        }
    }
}

TEST(Picture, WithoutSmokeIsThatOfTheReference) {
    Scene scene = smoke_over_floor_and_block();
    scene.media.clear();
    EXPECT_LT(error(render(scene), exact(scene)), 1e-5);
}

// A sheet whose normals point away from the eye and lean, so that they shade it smoothly.
TEST(Picture, OfTheBackOfASmoothSheetIsThatOfTheReference) {
    Scene scene = smoke_over_floor();
    scene.media.clear();
    Mesh sheet = parallelogram({-1, -1, 0.7F}, {0, 2, 0}, {2, 0, 0.3F}, glm::vec3(0.7F)); // its normal points down
    for (auto &triangle : sheet.corner_normals) {
        triangle[0] = glm::normalize(triangle[0] + glm::vec3(0.6F, 0.2F, 0.0F));
        triangle[2] = glm::normalize(triangle[2] - glm::vec3(0.0F, 0.5F, 0.0F));
    }
    scene.meshes.push_back(sheet);
    EXPECT_LT(error(render(scene), exact(scene)), 1e-5);
}

TEST(Picture, WithoutASunIsTheBackgroundThroughTheSmoke) {
    Scene scene = smoke_over_floor();
    scene.lights.clear();
    scene.meshes.clear();
    EXPECT_LT(error(render(scene), exact(scene)), 1e-3);
    const std::vector<float> image = render(scene);
    for (std::size_t i = 0; i < image.size(); i += 4) {
        EXPECT_NEAR(image[i], 0.1F * (1.0F - image[i + 3]), 1e-6); // grey smoke
    }
}

// Between a roof and the sun's other side there is night: the smoke takes light away and sends none on.
TEST(Picture, OfSmokeUnderARoofIsTheBackgroundThroughTheSmoke) {
    Scene scene = smoke_over_floor();
    scene.meshes = {parallelogram({-50, -50, 4}, {100, 0, 0}, {0, 100, 0}, glm::vec3(0.5F))};
    const std::vector<float> shaded = render(scene);
    scene.lights.clear();
    EXPECT_EQ(largest_difference(shaded, render(scene)), 0.0);
}

TEST(Picture, TakesMeshesWithoutTrianglesAndTrianglesWithoutArea) {
    Scene scene = smoke_over_floor();
    const std::vector<float> plain = render(scene, finest, 16);
    scene.meshes.emplace_back(Mesh{});
    Mesh needle = parallelogram({0, 0, 0.5F}, {1, 0, 0}, {0, 1, 0}, glm::vec3(0.5F));
    needle.vertices[1] = needle.vertices[3] = needle.vertices[2];
    scene.meshes.push_back(needle);
    EXPECT_EQ(largest_difference(plain, render(scene, finest, 16)), 0.0);
    scene.meshes = {Mesh{}};
    for (const float value : render(scene, finest, 16)) {
        EXPECT_TRUE(std::isfinite(value));
    }
}

// ---- Bounds and repetition ----

// Smoke cannot send on more than it takes out of a ray: L <= albedo p_max E alpha.
TEST(Picture, HasNoMoreLightThanThereIs) {
    Scene scene = smoke_over_floor();
    scene.meshes.clear();
    scene.background = glm::vec3(0.0F);
    scene.media = {random_medium({16, 16, 16}, glm::scale(scene.media[0].grid_to_world, glm::vec3(2.0F)), 42)};
    scene.media[0].scattering = glm::vec3(40.0F);
    scene.media[0].absorption = glm::vec3(10.0F);
    scene.media[0].anisotropy = -0.3F;
    scene.lights[0].strength = glm::vec3(2.0F);
    const double bound = 0.8 * reference::henyey_greenstein(-1.0, double{-0.3F}) * 2.0;
    float brightest = 0.0F;
    for (const Quality &quality : qualities) {
        const std::vector<float> image = render(scene, quality.settings);
        for (std::size_t i = 0; i < image.size(); i += 4) {
            EXPECT_GE(image[i], 0.0F);
            EXPECT_LE(image[i], bound * double{image[i + 3]} * 1.001 + 1e-6) << quality.name;
            EXPECT_LE(image[i + 3], 1.0F);
            brightest = std::max(brightest, image[i]);
        }
    }
    EXPECT_GT(brightest, 0.1 * bound);
}

TEST(Picture, IsTheSameEachTimeAndOnEveryInstructionSet) {
    Scene scene = smoke_over_floor_and_block();
    scene.lights[0].angle = 0.1F;
    const std::vector<float> image = render(scene, {15, 1.0, 1.0}, 16);
    EXPECT_EQ(largest_difference(image, render(scene, {15, 1.0, 1.0}, 16)), 0.0);
    for (const InstructionSet &set : instruction_sets()) {
        EXPECT_LT(largest_difference(image, render(scene, {15, 1.0, 1.0}, 16, camera, set)), 1e-5) << set.name;
    }
}

TEST(Progress, RisesFromNothingAndStaysBelowOne) {
    const Frame frame(smoke_over_floor(), {7, 0.5, 0.5});
    std::vector<double> shares;
    EXPECT_TRUE(frame.render(camera, WIDTH, HEIGHT, 16, [&shares](double share) {
        shares.push_back(share);
        return true;
    }));
    ASSERT_GT(shares.size(), 4U);
    EXPECT_EQ(shares.front(), 0.0);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_LT(shares.back(), 1.0);
    EXPECT_GT(shares.back(), 0.8);
}

TEST(Progress, StopsTheWorkWhereverItIs) {
    const Frame frame(smoke_over_floor(), {7, 0.5, 0.5});
    for (const double limit : {0.0, 0.3, 0.6, 0.9}) {
        int calls_after = -1;
        EXPECT_FALSE(frame.render(camera, WIDTH, HEIGHT, 16, [&](double share) {
            calls_after += share >= limit ? 1 : 0;
            return share < limit;
        })) << limit;
        EXPECT_EQ(calls_after, 0) << limit;
    }
}

// ---- Film ----

// The part of a unit disk on one side of a line at a signed distance from its centre.
double disk_beyond(double distance) {
    const double d = std::clamp(distance, -1.0, 1.0);
    return (std::acos(d) - d * std::sqrt(1.0 - d * d)) / std::numbers::pi;
}

// Looks down past the edge x = 0 of a roof at a height of 2; the sun is overhead, and pixels are small beside its
// penumbra.
TEST(Film, SeesThePenumbraOfAHalfPlane) {
    Scene scene;
    scene.meshes = {parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, glm::vec3(1.0F)),
                    parallelogram({-50, -50, 2}, {50, 0, 0}, {0, 100, 0}, glm::vec3(1.0F))};
    scene.lights = {sun_light({0.0F, 0.0F, -1.0F}, glm::vec3(std::numbers::pi_v<float>), 0.2F)};
    const Camera under_the_roof{{glm::vec3(-0.32F, -0.16F, 1.0F), glm::vec3(0.64F, 0, 0), glm::vec3(0, 0.36F, 0)},
                                {glm::vec3(-0.32F, -0.16F, -1.0F), glm::vec3(0.64F, 0, 0), glm::vec3(0, 0.36F, 0)}};
    const std::vector<float> image = render(scene, finest, 256, under_the_roof);
    double sum = 0.0;
    for (int x = 0; x < WIDTH; ++x) {
        const double at = -0.32 + 0.64 * (x + 0.5) / WIDTH;
        const double expected = disk_beyond(-at / (2.0 * std::tan(0.1)));
        const auto value = double{image[std::size_t(4 * (WIDTH * 9 + x))]};
        // On the very rim all pixels around one may find the same: it is not refined.
        EXPECT_NEAR(value, expected, std::abs(expected - 0.5) < 0.3 ? 0.04 : 0.08) << "x = " << at;
        sum += value - expected;
    }
    EXPECT_NEAR(sum / WIDTH, 0.0, 0.01); // no side is favoured
}

// Refined, the channel `channel` of a picture from above is the filter's integral over one of 16 times as many pixels
// each way, all but on a rim.
void expect_filtered(const Scene &scene, std::size_t channel) {
    constexpr int FINER = 16;
    const Camera above = camera_from_above(4.0F);
    const Frame frame(scene, finest);
    const std::vector<float> fine = frame.render(above, FINER * WIDTH, FINER * HEIGHT, 1, {}).value();
    const std::vector<float> image = frame.render(above, WIDTH, HEIGHT, 64, {}).value();
    const auto weight = [](int i) {
        const double t = 2.0 * std::numbers::pi * (i + 0.5) / (3 * FINER);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) - 0.01168 * std::cos(3.0 * t);
    };
    double squares = 0.0, mean = 0.0;
    int edges = 0;
    for (int y = 1; y < HEIGHT - 1; ++y) {
        for (int x = 1; x < WIDTH - 1; ++x) {
            double sum = 0.0, weights = 0.0;
            for (int j = 0; j < 3 * FINER; ++j) {
                for (int i = 0; i < 3 * FINER; ++i) {
                    const int at = ((y - 1) * FINER + j) * FINER * WIDTH + (x - 1) * FINER + i;
                    sum += weight(i) * weight(j) * double{fine[std::size_t(4 * at) + channel]};
                    weights += weight(i) * weight(j);
                }
            }
            const double expected = sum / weights;
            const double off = double{image[std::size_t(4 * (y * WIDTH + x)) + channel]} - expected;
            EXPECT_NEAR(off, 0.0, 0.08) << x << ", " << y;
            squares += off * off;
            mean += off;
            edges += expected > 0.01 && expected < 0.99 ? 1 : 0;
        }
    }
    EXPECT_GT(edges, 20);
    EXPECT_LT(std::sqrt(squares / edges), 0.02);
    EXPECT_NEAR(mean / edges, 0.0, 0.003); // nothing is shifted
}

TEST(Film, FiltersTheEdgeOfATiltedPlate) {
    Scene scene;
    scene.lights = {Light{}};
    scene.meshes = {parallelogram({-3, -4, 0}, {3, 0.7F, 0}, {-1, 8, 0}, glm::vec3(1.0F))};
    expect_filtered(scene, 3);
}

// From behind the eye, by a light without extent: of it only shadows are looked at again.
TEST(Film, FiltersTheRimOfAHardShadow) {
    Scene scene;
    scene.lights = {sun_light({0.0F, 0.0F, -1.0F}, glm::vec3(1.0F))};
    const glm::vec3 aside(1.0F, 0.0F, 0.3F), up(0.0F, 1.0F, -0.2F);
    scene.meshes = {parallelogram(-10.0F * (aside + up), 20.0F * aside, 20.0F * up, glm::vec3(1.0F)),
                    parallelogram({-3, -4, 8}, {3, 0.7F, 0}, {-1, 8, 0}, glm::vec3(0.0F))};
    const glm::vec3 normal = glm::normalize(glm::cross(aside, up));
    scene.lights[0].strength = glm::vec3(std::numbers::pi_v<float> / normal.z);
    expect_filtered(scene, 0);
}

// ---- What the viewport asks for ----

// With smoke and without, everything that a viewport asks of a pixel's surface.
TEST(Surfaces, HaveTheDistanceTheLightAndTheShadowsOfTheFirstHit) {
    Scene scene = smoke_over_floor_and_block();
    int hits = 0, shaded = 0;
    double darkest = 1.0; // of the smoke's shadow
    for (const bool with_smoke : {true, false}) {
        scene.media.resize(with_smoke ? 1 : 0);
        const double tolerance = with_smoke ? 0.003 : 1e-5;
        const Frame frame(scene, finest);
        const std::vector<float> lit = frame.surfaces(camera, WIDTH, HEIGHT, Layer::RADIANCE, 1, {}).value();
        const std::vector<float> smoke = frame.surfaces(camera, WIDTH, HEIGHT, Layer::SMOKE_SHADOW, 1, {}).value();
        const std::vector<float> all = frame.surfaces(camera, WIDTH, HEIGHT, Layer::ALL_SHADOWS, 1, {}).value();
        for (int y = 0; y < HEIGHT; ++y) {
            for (int x = 0; x < WIDTH; ++x) {
                const auto pixel = std::size_t(4 * (y * WIDTH + x));
                const float u = (float(x) + 0.5F) / WIDTH, v = (float(y) + 0.5F) / HEIGHT;
                const glm::dvec3 from = camera.near[0] + u * camera.near[1] + v * camera.near[2];
                const glm::dvec3 to = camera.far[0] + u * camera.far[1] + v * camera.far[2];
                const glm::dvec3 direction = glm::normalize(to - from);
                const auto hit = reference::first_hit(scene, from, direction, glm::distance(from, to));
                const double distance = hit ? hit->distance : glm::distance(from, to);
                glm::dvec3 radiance(scene.background);
                double cosine = 0.0, visible = 0.0, through = 1.0; // `visible` is the cosine too, past solids
                if (hit) {
                    const glm::dvec3 towards = -glm::dvec3(scene.lights[0].direction);
                    radiance = reference::reflected(scene, *hit, 1);
                    cosine = std::max(glm::dot(hit->normal, towards), 0.0);
                    visible = reference::occluded(scene, hit->position, towards) ? 0.0 : cosine;
                    for (const Medium &medium : scene.media) {
                        through *= reference::transmittance_to_infinity(medium, hit->position, towards).x;
                    }
                    darkest = std::min(darkest, through);
                    ++hits;
                    shaded += visible == 0.0 ? 1 : 0;
                }
                EXPECT_NEAR(lit[pixel + 3], distance, 1e-5 * distance);
                EXPECT_EQ(smoke[pixel + 3], lit[pixel + 3]);
                EXPECT_EQ(all[pixel + 3], lit[pixel + 3]);
                for (std::size_t c = 0; c < 3; ++c) {
                    EXPECT_NEAR(lit[pixel + c], radiance[int(c)], tolerance);
                    EXPECT_NEAR(smoke[pixel + c], visible * (1.0 - through), tolerance);
                    EXPECT_NEAR(all[pixel + c], cosine - visible * through, tolerance);
                }
            }
        }
    }
    EXPECT_GT(hits, 200);
    EXPECT_GT(shaded, 20);
    EXPECT_LT(darkest, 0.3);
}

TEST(Transmittance, OfTheFrameIsThatOfTheReferenceForEachColour) {
    Scene scene = smoke_over_floor();
    scene.media[0].scattering = {0.5F, 1.0F, 3.0F};
    std::vector<float> points, shares;
    for (int i = 0; i < 100; ++i) {
        points.insert(points.end(), {-1.0F + 0.03F * float(i), 0.1F, 0.01F * float(i)});
    }
    shares.resize(points.size());
    Frame(scene, finest).transmittance(0, points, shares);
    float darkest = 1.0F;
    for (std::size_t i = 0; i < points.size(); i += 3) {
        const glm::dvec3 expected =
            reference::transmittance_to_infinity(scene.media[0], glm::dvec3(points[i], points[i + 1], points[i + 2]),
                                                 -glm::dvec3(scene.lights[0].direction));
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(shares[i + c], expected[int(c)], 0.003);
            darkest = std::min(darkest, shares[i + c]);
        }
    }
    EXPECT_LT(darkest, 0.3F);
    scene.media.clear();
    Frame(scene, finest).transmittance(0, points, shares);
    EXPECT_EQ(*std::min_element(shares.begin(), shares.end()), 1.0F);
}

} // namespace
} // namespace sfumato
