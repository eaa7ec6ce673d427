// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <glm/exponential.hpp>
#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using namespace testing;

const Settings fine{4, 0.01};

// Smoke in layers, 8 m wide and 1 m thick, around z = 0. The layers differ and the sums below do not care: for light
// that comes and goes through the same layers, only the optical depth counts.
Scene layered_slab() {
    const glm::mat4 grid_to_world =
        glm::scale(glm::translate(glm::mat4(1.0F), glm::vec3(-4.0F, -4.0F, -0.5F)), glm::vec3(0.25F, 0.25F, 0.125F));
    Scene scene;
    scene.media = {uniform_medium({32, 32, 8}, 0.0F, grid_to_world)};
    for (std::size_t i = 0; i < scene.media[0].density.size(); ++i) {
        scene.media[0].density[i] = 0.5F + float((i / 1024) % 3); // 0.5, 1.5, 2.5, 0.5, ...: 11 over the 8 layers
    }
    scene.media[0].scattering = {0.5F, 1.0F, 1.5F};
    scene.media[0].absorption = {0.5F, 0.25F, 0.0F};
    scene.media[0].anisotropy = 0.4F;
    scene.lights = {sun_light({0.0F, 0.0F, -1.0F}, {1.0F, 2.0F, 4.0F})};
    return scene;
}

const glm::dvec3 optical_depth = (0.125 * 11.0) * glm::dvec3(1.0, 1.25, 1.5); // of the slab, straight through

// A camera with a single pixel, whose ray runs from `from` to `to`.
Camera single_ray(const glm::vec3 &from, const glm::vec3 &to) {
    return {{from, glm::vec3(0.0F), glm::vec3(0.0F)}, {to, glm::vec3(0.0F), glm::vec3(0.0F)}};
}

glm::dvec4 pixel(const Scene &scene, const glm::vec3 &from, const glm::vec3 &to, const Settings &settings = fine) {
    return render(scene, single_ray(from, to), 1, 1, settings).at(0);
}

void expect_colour(const glm::dvec4 &actual, const glm::dvec3 &expected, double tolerance) {
    for (int colour = 0; colour < 3; ++colour) {
        EXPECT_NEAR(actual[colour], expected[colour], tolerance) << "colour " << colour;
    }
}

TEST(Render, ShowsTheBackgroundOfAnEmptyScene) {
    Scene scene;
    scene.background = {0.25F, 0.5F, 2.0F};
    for (const glm::dvec4 &colour : render(scene, camera_from_above(2.0F), 3, 2, fine)) {
        EXPECT_EQ(colour, glm::dvec4(0.25, 0.5, 2.0, 0.0));
    }
    EXPECT_EQ(render(scene, camera_from_above(2.0F), 3, 2, fine).size(), 6U);
}

TEST(Render, StartsAtTheLowerLeftAndLooksThroughPixelCentres) {
    Scene scene;
    scene.lights = {Light{}};
    // The image is 4 m wide; its pixels are 1 m by 2 m. Only the centres at x = -1.5, -0.5 and y = -1 lie on the plate.
    scene.meshes = {parallelogram({-1.75F, -1.1F, 0}, {1.5F, 0, 0}, {0, 0.2F, 0}, glm::vec3(1.0F))};
    const auto image = render(scene, camera_from_above(4.0F), 4, 2, fine);
    ASSERT_EQ(image.size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
        const bool covered = i == 0 || i == 1;
        EXPECT_EQ(image[i].w, covered ? 1.0 : 0.0) << "pixel " << i;
        EXPECT_NEAR(image[i].x, covered ? 1.0 / std::numbers::pi : 0.0, 1e-12) << "pixel " << i;
    }
}

TEST(Render, SeesNothingBeyondTheFarPlane) {
    Scene scene;
    scene.meshes = {parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, glm::vec3(1.0F))};
    EXPECT_EQ(pixel(scene, {0.3F, 0.1F, 4}, {0.3F, 0.1F, 0.01F}).w, 0.0);
    EXPECT_EQ(pixel(scene, {0.3F, 0.1F, 4}, {0.3F, 0.1F, -0.01F}).w, 1.0);
    scene = layered_slab();
    EXPECT_EQ(pixel(scene, {0, 0, 4}, {0, 0, 1}), glm::dvec4(0.0));
}

// L = albedo p(-1) E (1 - exp(-2 tau)) / 2.
TEST(Slab, ScattersLightStraightBack) {
    const Scene scene = layered_slab();
    const glm::dvec3 albedo(0.5, 0.8, 1.0);
    const double phase = henyey_greenstein(-1.0, double{0.4F});
    const glm::dvec3 expected =
        albedo * phase * glm::dvec3(1.0, 2.0, 4.0) * (1.0 - glm::exp(-2.0 * optical_depth)) / 2.0;
    expect_colour(pixel(scene, {0.1F, 0.2F, 4}, {0.1F, 0.2F, -4}), expected, 1e-7);
}

// L = albedo p(1) E tau exp(-tau): wherever the light turns, it crosses the whole slab once.
TEST(Slab, ScattersLightStraightOn) {
    const Scene scene = layered_slab();
    const glm::dvec3 albedo(0.5, 0.8, 1.0);
    const double phase = henyey_greenstein(1.0, double{0.4F});
    const glm::dvec3 expected = albedo * phase * glm::dvec3(1.0, 2.0, 4.0) * optical_depth * glm::exp(-optical_depth);
    expect_colour(pixel(scene, {0.1F, 0.2F, -4}, {0.1F, 0.2F, 4}), expected, 1e-7);
}

// Chandrasekhar, Radiative Transfer, 1950, section 47: L = albedo p E m / (m + n) (1 - exp(-tau (1/m + 1/n))), for
// light at a cosine m to the slab's normal and an eye at a cosine n.
TEST(Slab, ScattersLightBackAtAnyAngle) {
    Scene scene = layered_slab();
    scene.lights[0].direction = glm::normalize(glm::vec3(0.5F, -1.0F, -2.0F));
    const glm::dvec3 view = glm::normalize(glm::dvec3(-2, 0, -4));
    const double m = -double{scene.lights[0].direction.z};
    const double n = -view.z;
    const double phase = henyey_greenstein(glm::dot(glm::dvec3(scene.lights[0].direction), -view), double{0.4F});
    const glm::dvec3 depth = optical_depth * (1.0 / m + 1.0 / n);
    const glm::dvec3 albedo(0.5, 0.8, 1.0);
    const glm::dvec3 expected = albedo * phase * glm::dvec3(1.0, 2.0, 4.0) * (m / (m + n)) * (1.0 - glm::exp(-depth));
    expect_colour(pixel(scene, {1, 0, 2}, {-1, 0, -2}), expected, 1e-6);
}

TEST(Slab, DimsWhatIsBehindItAndSetsAlpha) {
    Scene scene = layered_slab();
    scene.lights.clear();
    scene.background = {0.25F, 0.5F, 2.0F};
    const glm::dvec3 through = glm::exp(-optical_depth);
    const glm::dvec4 colour = pixel(scene, {0.1F, 0.2F, 4}, {0.1F, 0.2F, -4});
    expect_colour(colour, through * glm::dvec3(0.25, 0.5, 2.0), 1e-12);
    EXPECT_NEAR(colour.w, 1.0 - (through.x + through.y + through.z) / 3.0, 1e-12);
}

// A floor under the slab is seen through it and lit through it, and has the slab's own light in front.
TEST(Slab, LiesInFrontOfASurface) {
    Scene scene = layered_slab();
    const glm::dvec4 smoke = pixel(scene, {0.1F, 0.2F, 4}, {0.1F, 0.2F, -4});
    scene.meshes = {parallelogram({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, glm::vec3(0.5F))};
    const glm::dvec3 floor = 0.5 / std::numbers::pi * glm::dvec3(1.0, 2.0, 4.0) * glm::exp(-2.0 * optical_depth);
    const glm::dvec4 colour = pixel(scene, {0.1F, 0.2F, 4}, {0.1F, 0.2F, -4});
    expect_colour(colour, glm::dvec3(smoke) + floor, 1e-12);
    EXPECT_EQ(colour.w, 1.0);
}

// A floor in the middle of the slab hides the smoke below it.
TEST(Slab, EndsAtASurfaceInsideIt) {
    Scene scene = layered_slab();
    scene.meshes = {parallelogram({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, glm::vec3(0.0F))};
    const glm::dvec3 above = glm::dvec3(1.0, 1.25, 1.5) * column(scene.media[0], {0.1, 0.2, 4}, {0.1, 0.2, 0});
    const glm::dvec3 albedo(0.5, 0.8, 1.0);
    const double phase = henyey_greenstein(-1.0, double{0.4F});
    const glm::dvec3 expected = albedo * phase * glm::dvec3(1.0, 2.0, 4.0) * (1.0 - glm::exp(-2.0 * above)) / 2.0;
    expect_colour(pixel(scene, {0.1F, 0.2F, 4}, {0.1F, 0.2F, -4}), expected, 1e-7);
    EXPECT_LT(above.x, 0.6 * optical_depth.x);
}

// Lit from the left, with a wall up to z = 1/16: the eye above sees the smoke over that height shine, and none below
// it. This is a plane through cell centres, so no step is half in the shadow.
TEST(Slab, IsShadedBySolids) {
    Scene scene = layered_slab();
    scene.lights[0].direction = {1.0F, 0.0F, 0.0F};
    const glm::dvec4 whole = pixel(scene, {-3.5F, 0.2F, 4}, {-3.5F, 0.2F, -4});
    const glm::dvec4 upper = pixel(scene, {-3.5F, 0.2F, 4}, {-3.5F, 0.2F, 0.0625F});
    scene.meshes = {parallelogram({-6, -9, -9}, {0, 18, 0}, {0, 0, 9.0625F}, glm::vec3(0.5F))};
    const glm::dvec4 shaded = pixel(scene, {-3.5F, 0.2F, 4}, {-3.5F, 0.2F, -4});
    expect_colour(shaded, glm::dvec3(upper), 1e-7);
    EXPECT_LT(shaded.x, 0.9 * whole.x);
    EXPECT_NEAR(shaded.w, whole.w, 1e-12);
    scene.meshes = {parallelogram({-6, -9, -9}, {0, 18, 0}, {0, 0, 18}, glm::vec3(0.5F))};
    EXPECT_EQ(glm::dvec3(pixel(scene, {-3.5F, 0.2F, 4}, {-3.5F, 0.2F, -4})), glm::dvec3(0.0));
}

// Smoke cannot send on more than it takes out of the ray: L <= albedo p_max E alpha, for each colour.
TEST(RoughSmoke, StaysWithinTheLightThereIs) {
    Scene scene;
    scene.media = {random_medium({5, 6, 7}, oblique_grid(), 7)};
    scene.media[0].scattering = glm::vec3(4.0F);
    scene.media[0].absorption = glm::vec3(1.0F);
    scene.media[0].anisotropy = -0.3F;
    scene.lights = {sun_light(glm::normalize(glm::vec3(1.0F, 0.5F, -2.0F)), glm::vec3(2.0F))};
    const double bound = 0.8 * henyey_greenstein(-1.0, double{-0.3F}) * 2.0;
    double brightest = 0.0;
    for (const glm::dvec4 &colour : render(scene, camera_from_above(6.0F), 16, 16, {1, 0.05})) {
        EXPECT_GE(colour.x, 0.0);
        EXPECT_LE(colour.x, bound * colour.w);
        EXPECT_LE(colour.w, 1.0);
        brightest = std::max(brightest, colour.x);
    }
    EXPECT_GT(brightest, 0.05 * bound);
}

// The steps only serve the exponentials, so even coarse ones are good, and finer ones change nothing.
TEST(RoughSmoke, HasConvergedAtHalfACell) {
    Scene scene;
    scene.media = {random_medium({5, 6, 7}, oblique_grid(), 8)};
    scene.media[0].scattering = glm::vec3(3.0F);
    scene.lights = {sun_light(glm::normalize(glm::vec3(1.0F, 0.5F, -2.0F)), glm::vec3(1.0F))};
    const glm::vec3 from(1.2F, -0.6F, 3.0F);
    const glm::vec3 to(0.4F, -0.9F, -1.0F);
    const double coarse = pixel(scene, from, to, {1, 0.06}).x;
    const double finest = pixel(scene, from, to, {1, 0.002}).x;
    EXPECT_NEAR(coarse, finest, 1e-5 * finest);
    EXPECT_GT(finest, 0.01);
}

TEST(Render, RefusesSettingsThatMeanNothing) {
    const Scene scene;
    const Camera camera = camera_from_above(2.0F);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(render(scene, camera, 1, 1, {0, 0.1}), std::invalid_argument);
    EXPECT_THROW(render(scene, camera, 1, 1, {4, 0.1, 0}), std::invalid_argument);
    EXPECT_THROW(render(scene, camera, 1, 1, {4, 0.0}), std::invalid_argument);
    EXPECT_THROW(render(scene, camera, 1, 1, {4, -1.0}), std::invalid_argument);
    EXPECT_THROW(render(scene, camera, 1, 1, {4, nan}), std::invalid_argument);
}

} // namespace
} // namespace sfumato::reference
