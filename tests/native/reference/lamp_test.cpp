// SPDX-License-Identifier: GPL-3.0-or-later
// Images of smoke in the light of lamps, several lights and several bodies of smoke.
#include "support/reference_scenes.hpp"

#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/exponential.hpp>
#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using namespace testing;
using std::numbers::pi;

glm::dvec4 pixel(const Scene &scene, const glm::vec3 &from, const glm::vec3 &to, const Settings &settings = {4, 0.01}) {
    const glm::vec3 none(0.0F);
    return render(scene, {{from, none, none}, {to, none, none}}, 1, 1, settings).at(0);
}

void expect_colour(const glm::dvec4 &actual, const glm::dvec3 &expected, double relative) {
    for (int colour = 0; colour < 3; ++colour) {
        EXPECT_NEAR(actual[colour], expected[colour], relative * expected[colour]) << "colour " << colour;
    }
}

// A cube of smoke from -4 to 4 m, so that what happens within 3.5 m of the origin happens at a density of `density`.
Scene cube(float density) {
    const glm::mat4 grid_to_world = glm::translate(glm::mat4(1.0F), glm::vec3(-4.0F));
    Scene scene;
    scene.media = {uniform_medium({8, 8, 8}, density, grid_to_world)};
    return scene;
}

// In smoke so thin that it dims nothing, L = sigma_s I / (4 pi) int ds / (h^2 + s^2), however close to the lamp the ray
// passes by and however long the steps may be elsewhere.
TEST(Lamp, GlowsInThinSmoke) {
    Scene scene = cube(1e-6F);
    scene.lights = {point_light({0.0F, 0.0F, 0.0F}, {1.0F, 2.0F, 4.0F})};
    for (const float h : {1.0F, 0.1F, 0.003F}) {
        const double angle = std::atan(3.0 / double{h}) + std::atan(2.0 / double{h});
        const glm::dvec3 expected = 1e-6 / (4.0 * pi) * angle / double{h} * glm::dvec3(1, 2, 4);
        expect_colour(pixel(scene, {h, 0, 3}, {h, 0, -2}, {1, 0.5}), expected, 5e-5);
    }
}

// Dense, coloured and anisotropic: the same integral, by midpoints.
TEST(Lamp, GlowsInDenseSmoke) {
    Scene scene = cube(0.5F);
    scene.media[0].scattering = {0.5F, 1.0F, 1.5F};
    scene.media[0].absorption = {0.5F, 0.25F, 0.0F};
    scene.media[0].anisotropy = 0.4F;
    scene.lights = {point_light({0.5F, 0.0F, 0.0F}, {1.0F, 2.0F, 4.0F})};
    const glm::dvec3 extinction = 0.5 * glm::dvec3(1.0, 1.25, 1.5);
    glm::dvec3 expected(0.0);
    const int count = 100'000;
    for (int i = 0; i < count; ++i) {
        const double s = 5.0 * (i + 0.5) / count;
        const glm::dvec3 from_lamp = glm::dvec3(0, 0, 3.0 - s) - glm::dvec3(0.5, 0, 0);
        const double distance = glm::length(from_lamp);
        const double phase = henyey_greenstein(from_lamp.z / distance, double{0.4F}); // the eye is up at z = 3
        expected += 5.0 / count * phase / (distance * distance) * glm::exp(-extinction * (s + distance));
    }
    expected *= 0.5 * glm::dvec3(0.5, 1.0, 1.5) * glm::dvec3(1, 2, 4);
    expect_colour(pixel(scene, {0, 0, 3}, {0, 0, -2}), expected, 1e-6);
}

// The fluence is the radiance times the solid angle, which is everything inside the lamp itself.
TEST(Lamp, WithARadiusGlowsBySolidAngle) {
    Scene scene = cube(1e-6F);
    scene.lights = {point_light({0.0F, 0.0F, 0.0F}, glm::vec3(1.0F), 0.5F)};
    for (const double h : {1.0, 0.25}) {
        double expected = 0.0;
        const int count = 500'000;
        for (int i = 0; i < count; ++i) {
            const double square = h * h + std::pow(3.0 - 5.0 * (i + 0.5) / count, 2);
            const double solid_angle = square > 0.25 ? 2.0 * pi * (1.0 - std::sqrt(1.0 - 0.25 / square)) : 4.0 * pi;
            expected += 5.0 / count * solid_angle;
        }
        expected *= 1e-6 / (4.0 * pi) / (pi * 0.25);
        expect_colour(pixel(scene, {h, 0, 3}, {h, 0, -2}, {1, 0.1, 2}), glm::dvec3(expected), 2e-5);
    }
}

// A beam of light across the eye's ray, which it meets 1 m from the lamp: only the smoke inside the cone glows.
TEST(Lamp, LightsTheConeOfASpot) {
    Scene scene = cube(1e-6F);
    scene.lights = {point_light({1.0F, 0.0F, 0.0F}, glm::vec3(1.0F))};
    scene.lights[0].direction = {-1.0F, 0.0F, 0.0F};
    scene.lights[0].cone = 2.0F * std::atan(0.5F); // a plane through cell centres: no step is half in the beam
    const double expected = 1e-6 / (4.0 * pi) * 2.0 * std::atan(0.5);
    expect_colour(pixel(scene, {0, 0, 3}, {0, 0, -3}), glm::dvec3(expected), 1e-5);
    scene.lights[0].direction = {1.0F, 0.0F, 0.0F};
    EXPECT_EQ(glm::dvec3(pixel(scene, {0, 0, 3}, {0, 0, -3})), glm::dvec3(0.0));
}

TEST(Lamp, IsHiddenFromTheSmokeBySolidsBeforeItOnly) {
    Scene scene = cube(0.5F);
    scene.lights = {point_light({2.0F, 0.0F, 0.0F}, glm::vec3(1.0F))};
    const auto wall = [](float x) { return parallelogram({x, -9, -9}, {0, 18, 0}, {0, 0, 18}, glm::vec3(0.5F)); };
    const glm::dvec4 open = pixel(scene, {0, 0, 3}, {0, 0, -3});
    EXPECT_GT(open.x, 0.0);
    scene.meshes = {wall(2.5F)};
    EXPECT_EQ(pixel(scene, {0, 0, 3}, {0, 0, -3}), open);
    scene.meshes = {wall(-1.0F)};
    EXPECT_EQ(pixel(scene, {0, 0, 3}, {0, 0, -3}), open);
    scene.meshes = {wall(1.5F)};
    EXPECT_EQ(glm::dvec3(pixel(scene, {0, 0, 3}, {0, 0, -3})), glm::dvec3(0.0));
}

// A wall hides the lower half of the panel, with its centre: the smoke that is level with it sees half of the panel
// by many samples, and none by one.
TEST(Panel, IsSeenFromTheSmokeByAsManySamplesAsAskedFor) {
    Scene scene = cube(1e-3F);
    scene.lights = {area_light(Light::Kind::RECTANGLE, {3, 0, 0}, {0, 0.5F, 0}, {0, 0, 0.5F}, glm::vec3(1.0F))};
    ASSERT_EQ(scene.lights[0].direction.x, -1.0F);
    const glm::vec3 from(-3.0F, 0.0F, 0.01F), to(-3.0F, 0.0F, -0.01F);
    const double open = pixel(scene, from, to, {1, 0.01, 8}).x;
    EXPECT_NEAR(open, pixel(scene, from, to, {1, 0.01, 1}).x, 0.01 * open); // far enough for one sample
    scene.meshes = {parallelogram({0, -9, -9}, {0, 18, 0}, {0, 0, 9.01F}, glm::vec3(0.5F))};
    EXPECT_EQ(pixel(scene, from, to, {1, 0.01, 1}).x, 0.0);
    EXPECT_NEAR(pixel(scene, from, to, {1, 0.01, 8}).x, 0.5 * open, 0.01 * open);
}

// ---- Several lights and several bodies of smoke ----

// Random smoke above a floor, 2 m wide, away from all lamps.
Scene smoke_over_floor() {
    Scene scene;
    scene.media = {random_medium({6, 5, 4}, glm::scale(glm::mat4(1.0F), glm::vec3(0.25F)), 3)};
    scene.media[0].scattering = {0.5F, 1.0F, 1.5F};
    scene.media[0].absorption = {0.5F, 0.25F, 0.0F};
    scene.media[0].anisotropy = 0.4F;
    scene.meshes = {parallelogram({-2, -2, -0.5F}, {4, 0, 0}, {0, 4, 0}, {0.8F, 0.4F, 0.2F})};
    scene.lights = {sun_light(glm::normalize(glm::vec3(1, 2, -4)), {1.0F, 2.0F, 3.0F}, 0.2F),
                    point_light({-2, -2, 2}, {9.0F, 6.0F, 3.0F}, 0.2F),
                    area_light(Light::Kind::ELLIPSE, {1, 0, 3}, {0.5F, 0, 0}, {0, 0.5F, 0}, glm::vec3(2.0F))};
    return scene;
}

std::vector<glm::dvec4> image(const Scene &scene) {
    return render(scene, camera_from_above(3.0F), 6, 6, {2, 0.05, 2});
}

void expect_same(const std::vector<glm::dvec4> &actual, const std::vector<glm::dvec4> &expected, double tolerance) {
    double brightest = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        for (int channel = 0; channel < 4; ++channel) {
            EXPECT_NEAR(actual[i][channel], expected[i][channel], tolerance) << "pixel " << i;
        }
        brightest = std::max(brightest, expected[i].x);
    }
    EXPECT_GT(brightest, 0.1);
}

TEST(Lights, AddUp) {
    const Scene all = smoke_over_floor();
    std::vector<glm::dvec4> sum(36, glm::dvec4(0.0));
    for (const Light &light : all.lights) {
        Scene one = all;
        one.lights = {light};
        const auto part = image(one);
        for (std::size_t i = 0; i < sum.size(); ++i) {
            sum[i] = glm::dvec4(glm::dvec3(sum[i]) + glm::dvec3(part[i]), part[i].w);
        }
    }
    expect_same(image(all), sum, 1e-12);
}

TEST(Media, ThatOverlapAddUp) {
    const Scene one = smoke_over_floor();
    Scene two = one; // the same smoke as red and as green and blue, and every other cell on its own
    two.media.resize(3, one.media[0]);
    two.media[0].scattering *= glm::vec3(1, 0, 0);
    two.media[0].absorption *= glm::vec3(1, 0, 0);
    for (const std::size_t part : {std::size_t{1}, std::size_t{2}}) {
        two.media[part].scattering *= glm::vec3(0, 1, 1);
        two.media[part].absorption *= glm::vec3(0, 1, 1);
        for (std::size_t cell = part % 2; cell < two.media[part].density.size(); cell += 2) {
            two.media[part].density[cell] = 0.0F;
        }
    }
    expect_same(image(two), image(one), 1e-12);
}

// Half a cell on each side of the seam is the other's too: together they are what one grid is.
TEST(Media, ThatTouchAreOne) {
    const Scene one = smoke_over_floor();
    Scene two = one;
    two.media.resize(2, one.media[0]);
    for (Medium &half : two.media) {
        half.resolution.z = 2;
    }
    two.media[1].density.erase(two.media[1].density.begin(), two.media[1].density.begin() + 60);
    two.media[1].grid_to_world = glm::translate(one.media[0].grid_to_world, glm::vec3(0.0F, 0.0F, 2.0F));
    expect_same(image(two), image(one), 1e-12);
}

// L = sum(sigma_s p(-1)) / sum(sigma_t) E (1 - exp(-2 tau)) / 2, straight back from two uniform slabs in one place.
TEST(Media, ScatterEachByItsOwnPhase) {
    Scene scene = cube(0.25F);
    scene.media.push_back(scene.media[0]);
    scene.media[0].anisotropy = 0.5F;
    scene.media[1].anisotropy = -0.25F;
    scene.media[1].scattering = {0.5F, 1.0F, 2.0F};
    scene.media[1].absorption = {0.5F, 0.0F, 1.0F};
    scene.lights = {sun_light({0, 0, -1}, {1.0F, 2.0F, 4.0F})};
    const glm::dvec3 extinction(2.0, 2.0, 4.0);
    const glm::dvec3 scattering =
        henyey_greenstein(-1.0, 0.5) * glm::dvec3(1.0) + henyey_greenstein(-1.0, -0.25) * glm::dvec3(0.5, 1.0, 2.0);
    const glm::dvec3 expected =
        scattering / extinction * glm::dvec3(1, 2, 4) * (1.0 - glm::exp(-2.0 * extinction * 0.25 * 8.0)) / 2.0;
    expect_colour(pixel(scene, {0.3F, 0.2F, 5}, {0.3F, 0.2F, -5}), expected, 1e-6);
}

// Steps end at the cells of both, so even coarse ones are good.
TEST(Media, EndStepsAtTheCellsOfEach) {
    Scene scene;
    scene.media = {random_medium({5, 6, 7}, oblique_grid(), 8), random_medium({6, 6, 6}, oblique_grid(), 9)};
    scene.media[1].grid_to_world = glm::scale(glm::rotate(oblique_grid(), 0.4F, {1.0F, 0.0F, 0.0F}), glm::vec3(0.9F));
    scene.media[0].scattering = scene.media[1].scattering = glm::vec3(2.0F);
    scene.lights = {sun_light(glm::normalize(glm::vec3(1.0F, 0.5F, -2.0F)), glm::vec3(1.0F))};
    const glm::vec3 from(1.2F, -0.6F, 3.0F), to(0.4F, -0.9F, -1.0F);
    const double finest = pixel(scene, from, to, {1, 0.002}).x;
    EXPECT_NEAR(pixel(scene, from, to, {1, 0.06}).x, finest, 1e-5 * finest);
    EXPECT_GT(finest, 0.01);
}

} // namespace
} // namespace sfumato::reference
