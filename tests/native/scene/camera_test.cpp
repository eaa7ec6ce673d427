// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/camera.glsl and native/scene/camera.cpp: rays, and where they are inside a box.
#include "scene/camera.hpp"
#include "scene/scene.hpp"
#include "text/camera_text.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using CameraText = text::CameraText<float>;

CameraText::Ray ray_of(const Camera &camera, float u, float v) {
    return CameraText().camera_ray(camera.near[0], camera.near[1], camera.near[2], camera.far[0], camera.far[1],
                                   camera.far[2], u, v);
}

const glm::dmat4 view = glm::lookAt(glm::dvec3(3.0, -7.0, 2.0), glm::dvec3(0.5, 0.0, 1.0), glm::dvec3(0.0, 0.0, 1.0));
const glm::dmat4 perspective = glm::perspective(0.7, 16.0 / 9.0, 0.1, 1000.0) * view;
const glm::dmat4 orthographic = glm::ortho(-4.0, 4.0, -2.25, 2.25, 0.1, 1000.0) * view;

// A point that the matrix takes to (x, y) on the image lies on the ray through (x, y), between near and far.
TEST(Camera, RaysPassThroughWhatIsProjectedOnThem) {
    std::mt19937 generator(21);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (const glm::dmat4 &matrix : {perspective, orthographic}) {
        const Camera camera = camera_from(matrix);
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 point(uniform(generator), uniform(generator), 1.0 + uniform(generator));
            const glm::dvec4 clip = matrix * glm::dvec4(point, 1.0);
            const CameraText::Ray ray =
                ray_of(camera, float(0.5 + 0.5 * clip.x / clip.w), float(0.5 + 0.5 * clip.y / clip.w));
            EXPECT_NEAR(glm::length(ray.direction), 1.0, 1e-6);
            const double along = glm::dot(point - glm::dvec3(ray.origin), glm::dvec3(ray.direction));
            EXPECT_GT(along, 0.0);
            EXPECT_LT(along, ray.reach);
            EXPECT_NEAR(glm::distance(glm::dvec3(ray.origin) + along * glm::dvec3(ray.direction), point), 0.0, 1e-5);
        }
    }
}

TEST(Camera, ReachesFromTheNearPlaneToTheFarPlane) {
    const glm::dvec3 eye(3.0, -7.0, 2.0), forward = glm::normalize(glm::dvec3(0.5, 0.0, 1.0) - eye);
    for (const glm::dmat4 &matrix : {perspective, orthographic}) {
        const CameraText::Ray ray = ray_of(camera_from(matrix), 0.9F, 0.2F);
        EXPECT_NEAR(glm::dot(glm::dvec3(ray.origin) - eye, forward), 0.1, 1e-5);
        EXPECT_NEAR(glm::dot(glm::dvec3(ray.origin) - eye + double{ray.reach} * glm::dvec3(ray.direction), forward),
                    1000.0, 1e-2);
    }
}

TEST(Camera, RefusesMatricesWithoutRays) {
    glm::dmat4 flat(1.0);
    flat[2][2] = 0.0;
    EXPECT_THROW((void)camera_from(flat), std::invalid_argument);
    flat[2][2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW((void)camera_from(flat), std::invalid_argument);
    glm::dmat4 reversed = glm::infinitePerspective(0.7, 1.0, 0.1); // near and far changed places
    for (int column = 0; column < 4; ++column) {
        reversed[column][2] = -reversed[column][2];
    }
    EXPECT_THROW((void)camera_from(reversed), std::invalid_argument);
}

// What a matrix in single precision makes of a far plane 1e8 times as far as the near one, or rounds to be beyond.
TEST(Camera, WithAFarPlaneAtInfinityHasTheSameRays) {
    for (const double beyond : {0.0, 1e-7}) {
        glm::dmat4 endless = glm::infinitePerspective(0.7, 16.0 / 9.0, 0.1);
        endless[2][2] += beyond;
        const Camera camera = camera_from(endless * view), usual = camera_from(perspective);
        for (const float u : {0.0F, 0.3F, 1.0F}) {
            const CameraText::Ray ray = ray_of(camera, u, 0.8F), expected = ray_of(usual, u, 0.8F);
            EXPECT_NEAR(glm::distance(ray.direction, expected.direction), 0.0F, 5e-6F);
            EXPECT_NEAR(glm::distance(ray.origin, expected.origin), 0.0F, 1e-5F);
            EXPECT_GT(ray.reach, 1e6F);
            EXPECT_TRUE(std::isfinite(ray.reach));
        }
    }
}

constexpr float FAR_AWAY = 1000.0F;
const glm::vec3 box(2.0F, 3.0F, 4.0F);

CameraText::Interval clip(const glm::vec3 &origin, const glm::vec3 &direction, float reach = FAR_AWAY) {
    return CameraText().clip_to_box({0.0F, reach}, origin, direction, box);
}

TEST(ClipToBox, IsWhereARayAlongAnAxisIsInside) {
    const CameraText::Interval through = clip({1.0F, -5.0F, 1.0F}, {0.0F, 1.0F, 0.0F});
    EXPECT_NEAR(through.near_t, 5.0F, 1e-5);
    EXPECT_NEAR(through.far_t, 8.0F, 1e-5);
    const CameraText::Interval backwards = clip({1.0F, 1.0F, 10.0F}, {0.0F, 0.0F, -1.0F});
    EXPECT_NEAR(backwards.near_t, 6.0F, 1e-5);
    EXPECT_NEAR(backwards.far_t, 10.0F, 1e-5);
    const CameraText::Interval cut = clip({1.0F, -5.0F, 1.0F}, {0.0F, 1.0F, 0.0F}, 6.0F);
    EXPECT_EQ(cut.far_t, 6.0F);
    const CameraText::Interval face = clip({0.0F, -5.0F, 0.0F}, {0.0F, 1.0F, 0.0F}); // along an edge: never a NaN
    EXPECT_FALSE(std::isnan(face.near_t) || std::isnan(face.far_t));
}

TEST(ClipToBox, StartsAtTheOriginWhenThatIsInside) {
    const CameraText::Interval inside = clip({1.0F, 1.0F, 1.0F}, {1.0F, 0.0F, 0.0F});
    EXPECT_EQ(inside.near_t, 0.0F);
    EXPECT_NEAR(inside.far_t, 1.0F, 1e-6);
}

TEST(ClipToBox, IsEmptyForMisses) {
    const auto empty = [](const CameraText::Interval &interval) { return interval.near_t >= interval.far_t; };
    EXPECT_TRUE(empty(clip({2.5F, -5.0F, 1.0F}, {0.0F, 1.0F, 0.0F})));       // beside
    EXPECT_TRUE(empty(clip({1.0F, 5.0F, 1.0F}, {0.0F, 1.0F, 0.0F})));        // behind
    EXPECT_TRUE(empty(clip({1.0F, -5.0F, 1.0F}, {0.0F, 1.0F, 0.0F}, 4.0F))); // out of reach
    EXPECT_TRUE(empty(clip({-2.0F, 1.0F, 1.0F}, glm::normalize(glm::vec3(1.0F, 2.0F, 0.0F)))));
}

// Whatever the ray, a point on it is inside the box where its distance is inside the interval.
TEST(ClipToBox, AgreesWithThePointsOfRandomRays) {
    std::mt19937 generator(22);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto random = [&] {
            const float x = uniform(generator), y = uniform(generator), z = uniform(generator);
            return glm::vec3(x, y, z);
        };
        const glm::vec3 origin = 0.5F * box + 5.0F * random(), direction = glm::normalize(random());
        const CameraText::Interval interval = clip(origin, direction);
        for (int k = 0; k < 50; ++k) {
            const float t = 0.3F * (float(k) + 0.5F);
            const glm::vec3 p = origin + t * direction;
            const glm::vec3 depth = glm::min(p, box - p); // below zero outside
            const float margin = std::min({depth.x, depth.y, depth.z});
            if (std::abs(margin) > 1e-4F) {
                EXPECT_EQ(t > interval.near_t && t<interval.far_t, margin> 0.0F);
                inside += margin > 0.0F ? 1 : 0;
            }
        }
    }
    EXPECT_GT(inside, 500);
}

} // namespace
} // namespace sfumato
