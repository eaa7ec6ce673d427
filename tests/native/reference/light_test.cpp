// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

using namespace testing;
using std::numbers::pi;

constexpr Light::Kind RECTANGLE = Light::Kind::RECTANGLE, ELLIPSE = Light::Kind::ELLIPSE;

// On a surface without obstacles.
glm::dvec3 irradiance(const Light &light, const glm::dvec3 &position, const glm::dvec3 &normal, unsigned per_axis) {
    glm::dvec3 sum(0.0);
    for (const LightSample &sample : light_samples(light, position, per_axis)) {
        sum += std::max(0.0, glm::dot(normal, sample.towards)) * sample.irradiance;
    }
    return sum;
}

// Over all directions.
glm::dvec3 fluence(const Light &light, const glm::dvec3 &position, unsigned per_axis) {
    glm::dvec3 sum(0.0);
    for (const LightSample &sample : light_samples(light, position, per_axis)) {
        sum += sample.irradiance;
    }
    return sum;
}

void expect_near(const glm::dvec3 &actual, const glm::dvec3 &expected, double relative) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(actual[axis], expected[axis], relative * std::max(std::abs(expected[axis]), 1e-6));
    }
}

TEST(SunSamples, FillTheConeAndAreEqualPartsOfTheIrradiance) {
    const Light sun = sun_light(glm::normalize(glm::vec3(1.0F, -2.0F, -3.0F)), glm::vec3(1.0F), 0.5F);
    const glm::dvec3 axis = -glm::normalize(glm::dvec3(sun.direction));
    double widest = 0.0;
    glm::dvec3 mean(0.0);
    double second_moment = 0.0;
    const auto samples = light_samples(sun, {5, 6, 7}, 40);
    ASSERT_EQ(samples.size(), 1600U);
    for (const LightSample &sample : samples) {
        EXPECT_NEAR(glm::length(sample.towards), 1.0, 1e-12);
        EXPECT_EQ(sample.distance, ENDLESS);
        EXPECT_NEAR(sample.irradiance.x * glm::dot(sample.towards, axis), 1.0 / 1600.0, 1e-12);
        const double angle = std::acos(glm::dot(sample.towards, axis));
        widest = std::max(widest, angle);
        mean += sample.towards / 1600.0;
        second_moment += std::pow(std::sin(angle), 2) / 1600.0;
    }
    EXPECT_LT(widest, 0.25);
    EXPECT_GT(widest, 0.24);
    EXPECT_NEAR(glm::length(glm::cross(mean, axis)), 0.0, 1e-12);
    // Over a uniform disk the mean square radius is half the square of the radius.
    EXPECT_NEAR(second_moment, 0.5 * std::pow(std::sin(0.25), 2), 1e-4);
    // Radiance E / (pi sin^2) from a solid angle of 2 pi (1 - cos).
    EXPECT_NEAR(fluence(sun, {5, 6, 7}, 100).x, 2.0 / (1.0 + std::cos(0.25)), 1e-5);
}

TEST(SunSamples, AreItsCentreWhenItHasNoExtent) {
    const auto samples = light_samples(sun_light({0.0F, 0.6F, -0.8F}, {1.0F, 2.0F, 3.0F}), {5, 6, 7}, 4);
    ASSERT_EQ(samples.size(), 1U);
    expect_near(samples[0].towards, {0.0, -0.6, 0.8}, 1e-7);
    EXPECT_EQ(samples[0].irradiance, glm::dvec3(1, 2, 3));
    EXPECT_EQ(samples[0].distance, ENDLESS);
}

TEST(PointSamples, FollowTheInverseSquare) {
    const Light light = point_light({1.0F, 2.0F, 3.0F}, {8.0F, 4.0F, 2.0F});
    for (const glm::dvec3 &offset : {glm::dvec3(0, 0, -2), glm::dvec3(3, 0, 4), glm::dvec3(-0.1, 0.2, 0.2)}) {
        const auto samples = light_samples(light, glm::dvec3(1, 2, 3) + offset, 4);
        ASSERT_EQ(samples.size(), 1U);
        const double distance = glm::length(offset);
        EXPECT_NEAR(samples[0].distance, distance, 1e-12);
        expect_near(samples[0].towards, -offset / distance, 1e-12);
        expect_near(samples[0].irradiance, glm::dvec3(8, 4, 2) / (distance * distance), 1e-12);
    }
    EXPECT_TRUE(light_samples(light, {1, 2, 3}, 4).empty());
}

// E = pi L sin^2 = I / d^2, at any distance, and a tilted surface that sees all of the sphere gets its cosine.
TEST(SphereSamples, LightASurfaceLikeAPoint) {
    const Light light = point_light({0.0F, 0.0F, 3.0F}, {8.0F, 4.0F, 2.0F}, 0.5F);
    for (const double distance : {0.5, 0.51, 0.8, 2.0, 2e4}) {
        const glm::dvec3 expected = glm::dvec3(8, 4, 2) / (distance * distance);
        const glm::dvec3 position(0.0, 0.0, 3.0 - distance);
        expect_near(irradiance(light, position, {0, 0, 1}, 200), expected, 3e-4);
        if (distance >= 0.8) { // where the sphere spans at most 38.7 degrees from its centre
            expect_near(irradiance(light, position, {0.6, 0.0, 0.8}, 200), 0.8 * expected, 3e-4);
        }
    }
}

TEST(SphereSamples, FillTheSolidAngleOnTheNearSide) {
    const glm::dvec3 centre(1, -2, 3);
    const Light light = point_light(centre, glm::vec3(1.0F), 0.5F);
    const double radiance = 1.0 / (pi * 0.25);
    for (const double distance : {0.501, 0.7, 3.0, 3e4}) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(2, -1, 2));
        const double sine = 0.5 / distance, height = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine));
        const auto samples = light_samples(light, centre - distance * axis, 16);
        ASSERT_EQ(samples.size(), 256U);
        double mean_height = 0.0;
        for (const LightSample &sample : samples) {
            EXPECT_NEAR(glm::length(sample.towards), 1.0, 1e-12);
            EXPECT_NEAR(sample.irradiance.x, radiance * 2.0 * pi * height / 256.0, 1e-12);
            const glm::dvec3 from_centre = sample.distance * sample.towards - distance * axis;
            EXPECT_NEAR(glm::length(from_centre), 0.5, 1e-10 * distance);
            EXPECT_LT(glm::dot(from_centre, sample.towards), 0.0);
            mean_height += 0.5 * glm::dot(sample.towards - axis, sample.towards - axis) / 256.0; // 1 - cos
        }
        EXPECT_NEAR(mean_height / height, 0.5, 0.01); // equal areas of a cap are equal heights
    }
}

TEST(SphereSamples, SurroundWhatIsInside) {
    const Light light = point_light({1.0F, 2.0F, 3.0F}, glm::vec3(1.0F), 0.5F);
    for (const glm::dvec3 &offset : {glm::dvec3(0.0), glm::dvec3(0.1, 0.2, -0.3)}) {
        const auto samples = light_samples(light, glm::dvec3(1, 2, 3) + offset, 16);
        ASSERT_EQ(samples.size(), 256U);
        glm::dvec3 mean(0.0);
        for (const LightSample &sample : samples) {
            EXPECT_NEAR(glm::length(offset + sample.distance * sample.towards), 0.5, 1e-12);
            EXPECT_GT(sample.distance, 0.0);
            mean += sample.towards / 256.0;
        }
        EXPECT_NEAR(glm::length(mean), 0.0, 0.01);
        EXPECT_NEAR(fluence(light, glm::dvec3(1, 2, 3) + offset, 16).x, 4.0 * pi / (pi * 0.25), 1e-12);
    }
}

// A spot of 90 degrees that fades over 0.4 of 1 - cos, at the cosine that is the share t of the way into the fade.
TEST(SpotSamples, FadeFromTheConeInwards) {
    Light light = point_light({0.0F, 0.0F, 3.0F}, glm::vec3(4.0F));
    light.cone = float(0.5 * pi);
    light.blend = 0.4F;
    const auto factor = [&](double cosine) {
        return fluence(light, {2.0 * std::sqrt(1.0 - cosine * cosine), 0.0, 3.0 - 2.0 * cosine}, 1).x;
    };
    const double edge = std::cos(pi / 4.0);
    const auto into = [&](double t) { return edge + t * (1.0 - edge) * 0.4; };
    EXPECT_EQ(factor(into(-0.01)), 0.0);
    EXPECT_EQ(factor(-1.0), 0.0);
    EXPECT_NEAR(factor(into(0.25)), 0.15625, 1e-6); // 3/16 - 2/64
    EXPECT_NEAR(factor(into(0.5)), 0.5, 1e-6);
    EXPECT_NEAR(factor(into(0.75)), 0.84375, 1e-6);
    EXPECT_EQ(factor(into(1.01)), 1.0);
    EXPECT_EQ(factor(1.0), 1.0);
    light.blend = 0.0F;
    EXPECT_EQ(factor(into(-1e-6)), 0.0);
    EXPECT_EQ(factor(into(1e-6)), 1.0);
    light.cone = 0.0F; // the axis and nothing else
    EXPECT_EQ(factor(1.0), 1.0);
    EXPECT_EQ(factor(1.0 - 1e-6), 0.0);
    light.cone = Light{}.cone;
    EXPECT_EQ(factor(-1.0), 1.0);
}

// The cone cuts the rays of a sphere by their own directions, so its edge is blurred as the sphere is wide.
TEST(SpotSamples, OfASphereFadeByTheirOwnDirections) {
    Light light = point_light({0.0F, 0.0F, 3.0F}, glm::vec3(1.0F), 0.5F);
    const glm::dvec3 on_edge(std::sqrt(0.5), 0.0, 3.0 - std::sqrt(0.5));
    const auto whole = light_samples(light, on_edge, 32);
    light.cone = float(0.5 * pi);
    const auto cut = light_samples(light, on_edge, 32);
    ASSERT_EQ(whole.size(), cut.size());
    double visible = 0.0;
    for (std::size_t i = 0; i < cut.size(); ++i) {
        EXPECT_EQ(cut[i].irradiance.x, cut[i].towards.z >= std::sqrt(0.5) + 1e-7 ? whole[i].irradiance.x : 0.0);
        visible += cut[i].irradiance.x / whole[i].irradiance.x / 1024.0;
    }
    EXPECT_GT(visible, 0.3);
    EXPECT_LT(visible, 0.7);
}

// E = pi L r^2 / (r^2 + d^2), on the axis of a disk.
TEST(EllipseSamples, OfADiskLightAFacingSurface) {
    const Light light = area_light(ELLIPSE, {1, 2, 3}, {0.5F, 0, 0}, {0, 0.5F, 0}, {4.0F, 2.0F, 1.0F});
    for (const double distance : {0.3, 1.0, 5.0}) {
        const glm::dvec3 expected = glm::dvec3(4, 2, 1) * (pi * 0.25 / (0.25 + distance * distance));
        const glm::dvec3 position(1.0, 2.0, 3.0 - distance);
        expect_near(irradiance(light, position, {0, 0, 1}, 64), expected, 1e-3);
        // Its solid angle is 2 pi (1 - cos).
        const double solid_angle = 2.0 * pi * (1.0 - distance / std::hypot(distance, 0.5));
        expect_near(fluence(light, position, 64), solid_angle * glm::dvec3(4, 2, 1), 1e-3);
    }
}

TEST(EllipseSamples, CoverTheEllipseEvenly) {
    const Light light = area_light(ELLIPSE, {0, 0, 1}, {0.8F, 0, 0}, {0, 0.2F, 0}, glm::vec3(1.0F));
    glm::dvec3 square(0.0);
    for (const LightSample &sample : light_samples(light, {0, 0, 0}, 32)) {
        const glm::dvec3 point = sample.distance * sample.towards;
        EXPECT_NEAR(point.z, 1.0, 1e-12);
        EXPECT_LE(std::pow(point.x / 0.8, 2) + std::pow(point.y / 0.2, 2), 1.0);
        square += point * point / 1024.0;
    }
    EXPECT_NEAR(square.x, 0.64 / 4.0, 1e-3);
    EXPECT_NEAR(square.y, 0.04 / 4.0, 1e-4);
    EXPECT_NEAR(irradiance(light, {0, 0, -999}, {0, 0, 1}, 4).x, pi * 0.16 * 1e-6, 1e-12);
}

// E = L / 2 (X / sqrt(1 + X^2) atan(Y / sqrt(1 + X^2)) + the same with X and Y changed), for the rectangle that goes
// from straight ahead X times the distance to one side and Y times to the other: the form factor of the textbooks.
double corner_irradiance(double x, double y) {
    const double a = std::sqrt(1.0 + x * x), b = std::sqrt(1.0 + y * y);
    return 0.5 * (x / a * std::atan(y / a) + y / b * std::atan(x / b));
}

TEST(RectangleSamples, LightAFacingSurface) {
    const Light light = area_light(RECTANGLE, {1, 2, 3}, {0.75F, 0, 0}, {0, 0.25F, 0}, {4.0F, 2.0F, 1.0F});
    for (const double distance : {0.3, 1.0, 5.0}) {
        const glm::dvec3 below(1.0, 2.0, 3.0 - distance);
        const glm::dvec3 centre = irradiance(light, below, {0, 0, 1}, 64);
        expect_near(centre, 4.0 * corner_irradiance(0.75 / distance, 0.25 / distance) * glm::dvec3(4, 2, 1), 1e-3);
        const glm::dvec3 corner = irradiance(light, below + glm::dvec3(0.75, 0.25, 0.0), {0, 0, 1}, 64);
        expect_near(corner, corner_irradiance(1.5 / distance, 0.5 / distance) * glm::dvec3(4, 2, 1), 1e-3);
        const double solid_angle =
            4.0 * std::asin(0.75 * 0.25 / (std::hypot(0.75, distance) * std::hypot(0.25, distance)));
        expect_near(fluence(light, below, 64), solid_angle * glm::dvec3(4, 2, 1), 1e-3);
    }
}

TEST(AreaSamples, LieOnTheLightAndShineOnOneSide) {
    const glm::vec3 across(0.3F, 0.4F, 0.0F), up(0.4F, -0.3F, 0.0F); // cross: towards -z, so it shines towards +z
    for (const Light::Kind kind : {RECTANGLE, ELLIPSE}) {
        const Light light = area_light(kind, {1, 2, 3}, across, up, glm::vec3(1.0F));
        EXPECT_EQ(light_samples(light, {1, 2, 5}, 4).size(), 16U);
        glm::dvec3 mean(0.0);
        for (const LightSample &sample : light_samples(light, {1.5, 2.5, 5}, 4)) {
            mean += (glm::dvec3(1.5, 2.5, 5) + sample.distance * sample.towards) / 16.0;
            EXPECT_NEAR(sample.distance * sample.towards.z, -2.0, 1e-12);
            EXPECT_GT(sample.irradiance.x, 0.0);
        }
        expect_near(mean, {1, 2, 3}, 1e-6);
        EXPECT_EQ(fluence(light, {1, 2, 1}, 4), glm::dvec3(0.0));
        EXPECT_EQ(fluence(light, {5, 2, 3}, 4), glm::dvec3(0.0)); // from the side
        EXPECT_TRUE(light_samples(light, {1, 2, 3}, 1).empty());
    }
}

TEST(AreaSamples, FadeWithTheTangentOfTheAngleUpToTheSpread) {
    Light light = area_light(RECTANGLE, {0, 0, 0}, {0.5F, 0, 0}, {0, 0.5F, 0}, glm::vec3(1.0F));
    const auto factor = [&](double angle) { // all that the cosine does not explain, 2 m away
        return 4.0 * fluence(light, {2.0 * std::sin(angle), 0.0, -2.0 * std::cos(angle)}, 1).x / std::cos(angle);
    };
    for (const double angle : {0.0, 0.3, 1.5}) {
        EXPECT_NEAR(factor(angle), 1.0, 1e-12);
    }
    light.spread = 2.0F;
    EXPECT_NEAR(factor(0.0), 1.0, 1e-12);
    EXPECT_NEAR(factor(std::atan(0.5 * std::tan(1.0))), 0.5, 1e-12);
    EXPECT_GT(factor(0.999), 0.0);
    EXPECT_EQ(factor(1.001), 0.0);
}

// The flux of a light of unit area and radiance is pi (1 - h / tan(h)), for a spread of 2 h: the integral of
// 2 pi (1 - tan(a) / tan(h)) cos(a) sin(a) up to h.
TEST(AreaSamples, KeepOfTheFluxWhatTheSpreadLetsThrough) {
    Light light = area_light(ELLIPSE, {0, 0, 0}, {0.5F, 0, 0}, {0, 0.5F, 0}, glm::vec3(1.0F));
    for (const float spread : {0.2F, 1.0F, 2.0F, 3.0F, Light{}.spread}) {
        light.spread = spread;
        const int count = 100'000;
        double flux = 0.0;
        for (int i = 0; i < count; ++i) {
            const double cosine = (i + 0.5) / count;
            const glm::dvec3 position(2.0 * std::sqrt(1.0 - cosine * cosine), 0.0, -2.0 * cosine);
            flux += 4.0 * 2.0 * pi / count * fluence(light, position, 1).x;
        }
        const double half = 0.5 * double{spread};
        EXPECT_NEAR(flux / (pi * 0.25), pi * (1.0 - half / std::tan(half)), 1e-6) << spread;
    }
}

} // namespace
} // namespace sfumato::reference
