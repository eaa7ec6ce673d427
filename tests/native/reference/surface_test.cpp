// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/exponential.hpp>
#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using namespace testing;

const glm::vec3 grey(0.5F);

// A floor of 20 m by 20 m at z = 0 under a sun straight overhead.
Scene floor_in_the_sun() {
    Scene scene;
    scene.meshes = {parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, {0.8F, 0.4F, 0.2F})};
    scene.lights = {sun_light({0.0F, 0.0F, -1.0F}, {3.0F, 2.0F, 1.0F})};
    return scene;
}

glm::dvec3 radiance_of_floor(const Scene &scene, double x, double y, unsigned samples) {
    const auto hit = first_hit(scene, {x, y, 0.5}, {0, 0, -1}, 1.0);
    return hit ? reflected(scene, *hit, samples) : glm::dvec3(-1.0);
}

// The part of a unit disk on one side of a line at a signed distance from its centre.
double disk_beyond(double distance) {
    const double d = std::clamp(distance, -1.0, 1.0);
    return (std::acos(d) - d * std::sqrt(1.0 - d * d)) / std::numbers::pi;
}

TEST(FirstHit, IsTheNearestTriangleWithinReach) {
    Scene scene;
    scene.meshes = {parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, {0.1F, 0.2F, 0.3F}),
                    parallelogram({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, {0.4F, 0.5F, 0.6F})};
    const auto hit = first_hit(scene, {0.25, 0.5, 4.0}, {0, 0, -1}, 100.0);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 3.0, 1e-14);
    EXPECT_NEAR(glm::distance(hit->position, glm::dvec3(0.25, 0.5, 1.0)), 0.0, 1e-14);
    EXPECT_NEAR(hit->albedo.y, 0.5, 1e-7);
    std::swap(scene.meshes[0], scene.meshes[1]);
    EXPECT_NEAR(first_hit(scene, {0.25, 0.5, 4.0}, {0, 0, -1}, 100.0)->distance, 3.0, 1e-14);
    EXPECT_TRUE(first_hit(scene, {0.25, 0.5, 4.0}, {0, 0, -1}, 3.001));
    EXPECT_FALSE(first_hit(scene, {0.25, 0.5, 4.0}, {0, 0, -1}, 2.999)); // out of reach
    EXPECT_FALSE(first_hit(scene, {0.25, 0.5, 4.0}, {0, 0, 1}, 100.0));  // behind
    EXPECT_FALSE(first_hit(scene, {1.01, 0.5, 4.0}, {0, 0, -1}, 100.0)); // beside
}

TEST(FirstHit, InterpolatesCornerNormalsForTheSideThatIsSeen) {
    Scene scene;
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.corner_normals = {{glm::vec3(0.0F, 0.0F, 1.0F), glm::vec3(0.6F, 0.0F, 0.8F), glm::vec3(0.0F, 0.8F, 0.6F)}};
    mesh.material = {1};
    mesh.albedo = {grey, {0.9F, 0.9F, 0.9F}};
    scene.meshes = {mesh};
    const glm::dvec3 expected = glm::normalize(glm::dvec3(0.2 * 0.6, 0.3 * 0.8, 0.5 + 0.2 * 0.8 + 0.3 * 0.6));
    const auto front = first_hit(scene, {0.2, 0.3, 1.0}, {0, 0, -1}, 10.0);
    const auto back = first_hit(scene, {0.2, 0.3, -1.0}, {0, 0, 1}, 10.0);
    ASSERT_TRUE(front && back);
    EXPECT_NEAR(glm::distance(front->normal, expected), 0.0, 1e-7);
    EXPECT_NEAR(glm::distance(back->normal, -expected), 0.0, 1e-7);
    EXPECT_NEAR(front->albedo.x, 0.9, 1e-7);
    // The order of the corners carries no meaning.
    std::swap(mesh.triangles[0].y, mesh.triangles[0].z);
    std::swap(mesh.corner_normals[0][1], mesh.corner_normals[0][2]);
    scene.meshes = {mesh};
    const auto reversed = first_hit(scene, {0.2, 0.3, 1.0}, {0, 0, -1}, 10.0);
    ASSERT_TRUE(reversed);
    EXPECT_NEAR(glm::distance(reversed->normal, expected), 0.0, 1e-7);
    // Grazing: the interpolated normal leans away from the eye, but the side that we see is still the front.
    const glm::dvec3 grazing = glm::normalize(glm::dvec3(1.0, 0.0, -0.05));
    const auto silhouette = first_hit(scene, glm::dvec3(0.8, 0.1, 0.0) - grazing, grazing, 10.0);
    ASSERT_TRUE(silhouette);
    EXPECT_GT(glm::dot(silhouette->normal, grazing), 0.0);
    EXPECT_GT(silhouette->normal.z, 0.0);
}

TEST(Reflected, IsLambertUnderASunOfAnySize) {
    Scene scene = floor_in_the_sun();
    for (const float tilt : {0.0F, 0.7F}) {
        scene.lights[0].direction = {std::sin(tilt), 0.0F, -std::cos(tilt)};
        for (const float angle : {0.0F, 0.009F, 0.6F}) {
            scene.lights[0].angle = angle;
            const glm::dvec3 radiance = radiance_of_floor(scene, 0.3, 0.2, 6);
            const double factor = std::cos(double{tilt}) / std::numbers::pi;
            EXPECT_NEAR(radiance.x, 0.8 * 3.0 * factor, 1e-6) << tilt << ' ' << angle;
            EXPECT_NEAR(radiance.y, 0.4 * 2.0 * factor, 1e-6) << tilt << ' ' << angle;
            EXPECT_NEAR(radiance.z, 0.2 * 1.0 * factor, 1e-6) << tilt << ' ' << angle;
        }
    }
}

TEST(Reflected, AddsUpLocalLights) {
    Scene scene = floor_in_the_sun();
    const Light sun = scene.lights[0];
    const Light bulb = point_light({0.0F, 0.0F, 3.0F}, {18.0F, 9.0F, 4.5F}); // E cos: I h / d^3
    const Light panel =
        area_light(Light::Kind::RECTANGLE, {1, 0, 2}, {0.25F, 0, 0}, {0, 0.25F, 0}, {4.0F, 8.0F, 16.0F});
    const glm::dvec3 albedo(0.8, 0.4, 0.2);
    scene.lights = {bulb};
    const glm::dvec3 by_bulb = radiance_of_floor(scene, 4.0, 0.0, 8);
    for (int colour = 0; colour < 3; ++colour) {
        const double expected = albedo[colour] / std::numbers::pi * double{bulb.strength[colour]} * 3.0 / 125.0;
        EXPECT_NEAR(by_bulb[colour], expected, 1e-6 * expected);
    }
    scene.lights = {panel};
    const glm::dvec3 by_panel = radiance_of_floor(scene, 4.0, 0.0, 8);
    EXPECT_NEAR(by_panel.x, 0.8 / std::numbers::pi * 4.0 * 0.25 * 4.0 / 169.0, 0.02 * by_panel.x); // L A h^2 / d^4
    scene.lights = {sun};
    const glm::dvec3 by_sun = radiance_of_floor(scene, 4.0, 0.0, 8);
    scene.lights = {bulb, sun, panel};
    EXPECT_NEAR(glm::distance(radiance_of_floor(scene, 4.0, 0.0, 8), by_bulb + by_sun + by_panel), 0.0, 1e-15);
}

TEST(Reflected, IsBlackOnTheFarSideFromTheSunAndWithoutIt) {
    Scene scene = floor_in_the_sun();
    const auto hit = first_hit(scene, {0.3, 0.2, -1.0}, {0, 0, 1}, 2.0); // the floor, seen from below
    ASSERT_TRUE(hit);
    EXPECT_EQ(reflected(scene, *hit, 4), glm::dvec3(0.0));
    // Nor does light come through a triangle whose smooth normal leans over to the sun's side.
    scene.lights[0].direction = glm::normalize(glm::vec3(-1.0F, 0.0F, 0.1F));
    Hit leaning = *hit;
    leaning.normal = glm::dvec3(0.6, 0.0, 0.8);
    leaning.face = glm::dvec3(0.0, 0.0, 1.0);
    EXPECT_EQ(reflected(scene, leaning, 4), glm::dvec3(0.0));
    // Nor does a triangle that faces the sun, under a smooth normal that does not, give negative light.
    std::swap(leaning.normal, leaning.face);
    EXPECT_EQ(reflected(scene, leaning, 4), glm::dvec3(0.0));
    scene.lights.clear();
    EXPECT_EQ(radiance_of_floor(scene, 0.3, 0.2, 4), glm::dvec3(0.0));
}

// The roof is a half plane x < 0 at height 2, so the sun's disk, seen from the floor, is cut by a straight line.
TEST(Shadow, OfAHalfPlaneHasTheUmbraThePenumbraAndTheLight) {
    Scene scene = floor_in_the_sun();
    scene.lights[0].angle = 0.4F;
    scene.meshes.push_back(parallelogram({-50, -50, 2}, {50, 0, 0}, {0, 100, 0}, grey));
    const double lit = 0.8 * 3.0 / std::numbers::pi;
    const double edge = 2.0 * std::tan(0.2); // of the penumbra
    EXPECT_EQ(radiance_of_floor(scene, -edge - 0.01, 0.0, 16).x, 0.0);
    EXPECT_NEAR(radiance_of_floor(scene, edge + 0.01, 0.0, 16).x, lit, 1e-6);
    for (const double x : {-0.3, -0.1, 0.05, 0.2, 0.35}) {
        // The line of sight to the edge of the roof is at an angle of atan(x / 2), and the disk lies in sines.
        const double visible = disk_beyond(-std::sin(std::atan(x / 2.0)) / std::sin(0.2));
        // The cosine to the floor and the weight of each direction cancel under a sun overhead: only area counts.
        EXPECT_NEAR(radiance_of_floor(scene, x, 0.0, 64).x / lit, visible, 0.01) << "x = " << x;
    }
}

TEST(Shadow, OfABoxIsBlackBelowItAndAbsentBesideIt) {
    Scene scene = floor_in_the_sun();
    scene.lights[0].direction = glm::normalize(glm::vec3(1.0F, 0.0F, -1.0F)); // the shadow falls towards +x
    scene.meshes.push_back(parallelogram({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, grey));
    scene.meshes.push_back(parallelogram({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, grey));
    scene.meshes.push_back(parallelogram({-1, -1, 1}, {0, 2, 0}, {0, 0, 1}, grey));
    scene.meshes.push_back(parallelogram({1, -1, 1}, {0, 2, 0}, {0, 0, 1}, grey));
    const double lit = 0.8 * 3.0 * std::numbers::sqrt2 / 2.0 / std::numbers::pi;
    // Between z = 1 and z = 2 the box covers x from -1 + 1 to 1 + 2 on the floor.
    EXPECT_NEAR(radiance_of_floor(scene, -0.01, 0.0, 1).x, lit, 1e-6);
    EXPECT_EQ(radiance_of_floor(scene, 0.01, 0.0, 1).x, 0.0);
    EXPECT_EQ(radiance_of_floor(scene, 2.99, 0.0, 1).x, 0.0);
    EXPECT_NEAR(radiance_of_floor(scene, 3.01, 0.0, 1).x, lit, 1e-6);
    EXPECT_NEAR(radiance_of_floor(scene, 1.5, 1.01, 1).x, lit, 1e-6);
}

TEST(Shadow, IsThereUnderAPlateThatAlmostTouches) {
    Scene scene = floor_in_the_sun();
    scene.meshes.push_back(parallelogram({-1, -1, 1e-6F}, {2, 0, 0}, {0, 2, 0}, grey));
    EXPECT_TRUE(occluded(scene, {0.5, 0.5, 0.0}, {0, 0, 1}));
    EXPECT_FALSE(occluded(scene, {1.5, 0.5, 0.0}, {0, 0, 1}));
}

// No triangle shades its own points, however far from the origin of the world and however flat the light.
TEST(Shadow, DoesNotFallOnTheSurfaceThatCastsIt) {
    Scene scene;
    scene.lights = {sun_light(glm::normalize(glm::vec3(1.0F, 0.3F, -0.01F)), glm::vec3(1.0F))};
    scene.meshes = {parallelogram({1000, 1000, 100}, {3, 0, 0.01F}, {0, 3, -0.02F}, grey)};
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 eye(1000.01 + 0.029 * i, 1000.01 + 0.0137 * i, 103.0);
        const auto hit = first_hit(scene, eye, {0, 0, -1}, 10.0);
        ASSERT_TRUE(hit);
        EXPECT_FALSE(occluded(scene, hit->position, -glm::dvec3(scene.lights[0].direction)));
    }
}

TEST(Shadow, OfALocalLightIsThatOfWhatStandsBeforeIt) {
    Scene scene = floor_in_the_sun();
    const auto plate = [](float height) { return parallelogram({-5, -5, height}, {10, 0, 0}, {0, 10, 0}, grey); };
    const Light bulb = point_light({0, 0, 2}, glm::vec3(1.0F)), ball = point_light({0, 0, 2}, glm::vec3(1.0F), 0.5F);
    const Light panel = area_light(Light::Kind::ELLIPSE, {0, 0, 2}, {0.5F, 0, 0}, {0, 0.5F, 0}, glm::vec3(1.0F));
    const Instances floor = scene.meshes[0];
    for (const Light &light : {bulb, ball, panel}) {
        scene.lights = {light};
        scene.meshes = {floor};
        const glm::dvec3 lit = radiance_of_floor(scene, 0.3, 0.2, 4);
        EXPECT_GT(lit.x, 0.0);
        for (const float behind : {2.0F, 2.001F, 7.0F}) {
            scene.meshes = {floor, plate(behind)};
            EXPECT_EQ(radiance_of_floor(scene, 0.3, 0.2, 4), lit) << behind;
        }
        for (const float before : {1.0F, 1.49F, light.radius > 0.0F ? 1.49F : 1.999F}) {
            scene.meshes = {floor, plate(before)};
            EXPECT_EQ(radiance_of_floor(scene, 0.3, 0.2, 4), glm::dvec3(0.0)) << before;
        }
    }
}

// A strip of light above the edge of a roof, at twice its height: the floor at x sees the strip beyond -x. What comes
// from du at a distance u along it goes with 1 / (u^2 + h^2)^2.
TEST(Shadow, OfAHalfPlaneUnderAStripHasItsPenumbra) {
    Scene scene = floor_in_the_sun();
    scene.lights = {area_light(Light::Kind::RECTANGLE, {0, 0, 4}, {1, 0, 0}, {0, 0.01F, 0}, glm::vec3(1.0F))};
    scene.meshes.push_back(parallelogram({-50, -50, 2}, {50, 0, 0}, {0, 100, 0}, grey));
    const auto integral = [](double u) { return u / (32.0 * (u * u + 16.0)) + std::atan(u / 4.0) / 128.0; };
    for (const double x : {-1.01, -0.6, 0.0, 0.35, 1.01}) {
        const double first = std::clamp(-x, -1.0, 1.0);
        const double expected = 0.8 / std::numbers::pi * 0.02 * 16.0 * (integral(1.0 - x) - integral(first - x));
        EXPECT_NEAR(radiance_of_floor(scene, x, 0.0, 200).x, expected, 2e-6) << "x = " << x;
        EXPECT_EQ(radiance_of_floor(scene, x, 0.0, 200).x > 0.0, x > -1.0);
    }
}

TEST(Shadow, OfSmokeIsItsTransmittance) {
    Scene scene = floor_in_the_sun();
    const glm::vec3 corner(-2.0F, -2.0F, 1.0F);
    scene.media = {uniform_medium({4, 4, 3}, 0.5F, glm::translate(glm::mat4(1.0F), corner))};
    scene.media[0].scattering = {0.2F, 0.4F, 0.6F};
    scene.media[0].absorption = {0.1F, 0.0F, 0.3F};
    const glm::dvec3 lit = glm::dvec3(0.8 * 3.0, 0.4 * 2.0, 0.2 * 1.0) / std::numbers::pi;
    const glm::dvec3 expected = lit * glm::exp(-1.5 * glm::dvec3(0.3, 0.4, 0.9));
    const glm::dvec3 shadow = radiance_of_floor(scene, 0.3, -0.2, 1);
    for (int colour = 0; colour < 3; ++colour) {
        EXPECT_NEAR(shadow[colour], expected[colour], 1e-6);
    }
    EXPECT_NEAR(radiance_of_floor(scene, 2.6, 0.0, 1).x, lit.x, 1e-6);
}

// The smoke from z = 1 to 4 is 3 m thick under a light above it, 1 m thick under one inside it, and none under one
// below it.
TEST(Shadow, OfSmokeEndsAtALocalLight) {
    Scene scene;
    scene.meshes = {parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, glm::vec3(1.0F))};
    scene.media = {uniform_medium({4, 4, 3}, 0.5F, glm::translate(glm::mat4(1.0F), {-2.0F, -2.0F, 1.0F}))};
    scene.media[0].scattering = {0.2F, 0.4F, 0.6F};
    scene.media.push_back(scene.media[0]); // as much again, and grey
    scene.media[1].scattering = glm::vec3(0.0F);
    scene.media[1].absorption = glm::vec3(1.0F);
    for (const auto &[height, thickness] : {std::pair(6.0F, 3.0), std::pair(2.0F, 1.0), std::pair(0.4F, 0.0)}) {
        scene.lights = {point_light({0, 0, height}, glm::vec3(1.0F))};
        const glm::dvec3 seen = radiance_of_floor(scene, 0.0, 0.0, 1);
        const glm::dvec3 extinction(1.2, 1.4, 1.6);
        for (int colour = 0; colour < 3; ++colour) {
            const double reaches = std::exp(-0.5 * extinction[colour] * thickness) / double{height} / double{height};
            EXPECT_NEAR(seen[colour], reaches / std::numbers::pi, 1e-6 * reaches);
        }
    }
}

} // namespace
} // namespace sfumato::reference
