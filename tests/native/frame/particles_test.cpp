// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of particles, against the reference and against what must not matter.
#include "support/particle_clouds.hpp"
#include "support/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using namespace reference::testing;

const FrameSettings usual{};

// Under a sun, over a floor or alone.
Scene scene_of(std::vector<Particles> particles, bool floor = true) {
    Scene scene;
    if (floor) {
        scene.meshes = {parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, {0.8F, 0.6F, 0.4F})};
        scene.background = {0.1F, 0.2F, 0.4F};
    }
    scene.particles = std::move(particles);
    scene.lights = {sun_light(glm::normalize(glm::vec3(0.5F, 0.4F, -1.0F)), {4.0F, 3.5F, 3.0F})};
    return scene;
}

Particles at(Particles particles, const glm::vec3 &place) {
    for (glm::vec3 &point : particles.points) {
        point += place;
    }
    return particles;
}

// A few of them overlap.
Particles overlapping() {
    Particles out;
    out.points = {{0.0F, 0.0F, 0.9F}, {0.3F, 0.1F, 1.1F}, {-0.2F, 0.4F, 0.7F}, {0.1F, -0.3F, 0.5F}};
    out.radius = {0.5F, 0.3F, 0.4F, 0.25F};
    out.opacity = {0.6F, 0.8F, 0.3F, 0.95F};
    out.albedo = {{0.9F, 0.5F, 0.2F}, {0.3F, 0.9F, 0.9F}, glm::vec3(1.0F), glm::vec3(0.6F)};
    return out;
}

double error_of(const Scene &scene, const FrameSettings &settings = usual) {
    return error(render(scene, settings), exact(scene));
}

// Measured: two thirds of these.
TEST(ParticlePicture, OfALonePuffIsThatOfTheReference) {
    for (const float opacity : {0.1F, 0.5F, 0.95F}) {
        const Particles puff = puff_at({0.0F, 0.0F, 0.9F}, 0.6F, opacity);
        EXPECT_LT(error_of(scene_of({puff})), 0.01) << opacity;
        EXPECT_LT(error_of(scene_of({puff}, false)), 0.016) << opacity;
    }
}

TEST(ParticlePicture, OfOverlappingColouredOnesIsThatOfTheReference) {
    Particles particles = overlapping();
    EXPECT_LT(error_of(scene_of({particles})), 0.01);
    EXPECT_LT(error_of(scene_of({particles}, false)), 0.016);
    particles.extinction = {1.0F, 0.6F, 0.3F};
    particles.anisotropy = 0.5F;
    EXPECT_LT(error_of(scene_of({particles})), 0.01);
    // Two bodies, which scatter differently.
    EXPECT_LT(error_of(scene_of({particles, at(overlapping(), {0.3F, 0.2F, 0.1F})}, false)), 0.01);
}

TEST(ParticlePicture, OfAPlumeIsThatOfTheReference) {
    Scene scene = scene_of({at(plume(500, 3), {0.0F, 0.0F, 0.3F})});
    EXPECT_LT(error_of(scene), 0.01);
    scene = scene_of({at(plume(500, 3), {0.0F, 0.0F, 0.3F})}, false);
    EXPECT_LT(error_of(scene), 0.01);
    scene.lights = {point_light({0.9F, -0.8F, 1.6F}, glm::vec3(5.0F))};
    EXPECT_LT(error_of(scene), 0.01);
    scene.lights = {point_light({0.05F, 0.1F, 0.8F}, glm::vec3(5.0F))}; // inside
    EXPECT_LT(error_of(scene), 0.02);
}

TEST(ParticlePicture, WithAGridIsThatOfTheReference) {
    Scene scene = smoke_over_floor();
    scene.particles = {overlapping()};
    scene.particles[0].anisotropy = -0.3F;
    EXPECT_LT(error_of(scene), 0.01);
    scene.meshes.clear();
    scene.background = glm::vec3(0.0F);
    EXPECT_LT(error_of(scene), 0.01);
    Scene without = scene;
    without.particles.clear();
    EXPECT_GT(error(render(without), exact(scene)), 0.1); // there is something to get wrong
}

TEST(ParticlePicture, WithLightMapsOfEveryKindIsThatOfTheReference) {
    const Scene scene = scene_of({at(plume(300, 5), {0.0F, 0.0F, 0.3F})}, false);
    const auto expected = exact(scene);
    FrameSettings settings;
    for (const BasisName basis : {FOURIER, COSINE, PIECEWISE, LEARNED}) {
        settings.basis = basis;
        settings.coefficients = 15;
        EXPECT_LT(error(render(scene, settings), expected), 0.05) << BASES[basis].name;
    }
    settings.curved = true;
    EXPECT_LT(error(render(scene, settings), expected), 0.05);
    settings = {};
    settings.shared_ranges = true;
    settings.basis = FOURIER;
    settings.coefficients = 7;
    EXPECT_LT(error(render(scene, settings), expected), 0.3);
}

TEST(ParticlePicture, FromInsideAndOfAnOrthographicCameraIsThatOfTheReference) {
    const Scene scene = scene_of({overlapping()});
    const Camera inside = camera_at({0.1F, -0.1F, 0.9F}, {1.0F, 0.6F, 0.5F}, 16.0F / 9.0F);
    EXPECT_LT(error(render(scene, usual, 1, inside), exact(scene, inside)), 0.01);
    EXPECT_LT(error(render(scene, usual, 1, camera_from_above(3.0F)), exact(scene, camera_from_above(3.0F))), 0.01);
}

TEST(ParticlePicture, DoesNotDependOnTheOrderOfParticles) {
    Particles cloud = at(plume(400, 4), {0.0F, 0.0F, 0.3F});
    cloud.albedo.assign(cloud.points.size(), glm::vec3(0.9F));
    const std::vector<float> image = render(scene_of({cloud}), usual);
    std::vector<std::size_t> order(cloud.points.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    Particles shuffled = cloud;
    for (std::size_t i = 0; i < order.size(); ++i) {
        shuffled.points[i] = cloud.points[order[i]];
        shuffled.radius[i] = cloud.radius[order[i]];
        shuffled.opacity[i] = cloud.opacity[order[i]];
    }
    EXPECT_LT(largest_difference(render(scene_of({shuffled}), usual), image), 1e-5);
}

TEST(ParticlePicture, IsTheSameOnEveryInstructionSet) {
    const Scene scene = scene_of({at(plume(200, 4), {0.0F, 0.0F, 0.3F}), overlapping()});
    const std::vector<float> image = render(scene, usual);
    for (const InstructionSet &with : instruction_sets()) {
        EXPECT_LT(largest_difference(render(scene, usual, 1, camera, with), image), 2e-4) << with.name;
    }
}

TEST(ParticlePicture, MovesWithTheScene) {
    const glm::vec3 by(3.0F, -2.0F, 1.5F);
    Scene scene = scene_of({at(plume(300, 6), {0.0F, 0.0F, 0.3F})}, false);
    const std::vector<float> image = render(scene, usual);
    scene.particles[0] = at(scene.particles[0], by);
    const Camera moved = camera_at(glm::vec3(2.5F, -4.5F, 2.2F) + by, glm::vec3(0.0F, 0.0F, 0.75F) + by, 16.0F / 9.0F);
    EXPECT_LT(largest_difference(render(scene, usual, 1, moved), image), 2e-3);
}

TEST(ParticlePicture, OfNoneOrOfWhatShowsNothingIsThatWithoutThem) {
    const std::vector<float> image = render(scene_of({}), usual);
    Particles unseen = overlapping(), clear = overlapping(), behind = at(overlapping(), {20.0F, -40.0F, 0.0F});
    unseen.visibility = {Seen::UNSEEN, ~LightSets{0}, 0};
    std::fill(clear.opacity.begin(), clear.opacity.end(), 0.0F);
    for (const Particles &particles : {Particles{}, unseen, clear, behind}) {
        EXPECT_EQ(largest_difference(render(scene_of({particles}), usual), image), 0.0);
    }
    // Dots: what they take is less than a rounding.
    Particles dots = overlapping();
    std::fill(dots.radius.begin(), dots.radius.end(), 1e-6F);
    EXPECT_LT(largest_difference(render(scene_of({dots}), usual), image), 1e-4);
}

// All of them together let through what one of their opacities together would.
TEST(ParticlePicture, OfAMillionInOnePlaceIsThatOfOne) {
    Particles many, one = puff_at({0.0F, 0.0F, 0.9F}, 0.05F, 0.9F);
    many.points.assign(1000000, one.points[0]);
    many.radius.assign(many.points.size(), one.radius[0]);
    many.opacity.assign(many.points.size(), float(-std::expm1(std::log1p(-0.9) / 1e6)));
    many.albedo = one.albedo;
    const std::vector<float> image = render(scene_of({many}), usual);
    EXPECT_LT(largest_difference(image, render(scene_of({one}), usual)), 5e-3);
}

} // namespace
} // namespace sfumato
