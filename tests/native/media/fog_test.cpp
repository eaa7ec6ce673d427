// SPDX-License-Identifier: GPL-3.0-or-later
// Where rays are in fog, against the judge, who counts how often a mesh winds around a point.
#include "media/fog.hpp"
#include "reference/reference.hpp"
#include "support/shapes.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using reference::testing::add_box;
using reference::testing::box_shape;
using reference::testing::torus_shape;

Air air_in(std::shared_ptr<const Shape> shape, std::vector<glm::mat4> places = {glm::mat4(1.0F)}) {
    Air air;
    air.shape = std::move(shape);
    air.to_world = std::move(places);
    air.mie = glm::vec3(1.0F);
    return air;
}

std::vector<FogStretch> stretches(const Fog &fog, const FogRay &ray) {
    std::vector<Hit> hits;
    std::vector<FogStretch> out;
    follow(fog.view(), std::span(&ray, 1), hits, out);
    return out;
}

// The way in a fog, up to `far`.
double way(const Fog &fog, const FogRay &ray, double far) {
    double sum = 0.0;
    for (const FogStretch &stretch : stretches(fog, ray)) {
        sum += std::max(std::min(double{stretch.far}, far) - double{stretch.near}, 0.0);
    }
    return sum;
}

glm::mat4 turned(float angle, const glm::vec3 &place, const glm::vec3 &scale) {
    return glm::scale(glm::rotate(glm::translate(glm::mat4(1.0F), place), angle, {0.3F, 0.5F, 0.8F}), scale);
}

// Rays from anywhere in and around a box of 5 m.
void expect_as_the_judge(const Air &air, std::size_t count) {
    Solids solids;
    const auto fogs = fogs_of(std::span(&air, 1), solids);
    ASSERT_EQ(fogs.size(), 1U);
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> unit(-2.5F, 2.5F);
    constexpr double FAR = 4.0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 origin(unit(generator), unit(generator), unit(generator));
        const glm::vec3 towards(unit(generator), unit(generator), unit(generator));
        const FogRay ray{origin, glm::normalize(towards)};
        const glm::dvec3 from(origin), to = from + FAR * glm::dvec3(ray.direction);
        EXPECT_NEAR(way(*fogs[0], ray, FAR), reference::way_inside(air, from, to), 1e-4)
            << "from " << origin.x << ", " << origin.y << ", " << origin.z;
    }
}

TEST(Fog, OfABoxIsThatOfTheJudge) {
    expect_as_the_judge(air_in(box_shape({-1, -1, -1}, {1, 1, 1})), 300);
}

TEST(Fog, OfARingIsThatOfTheJudge) {
    expect_as_the_judge(air_in(torus_shape(1.5F, 0.5F, 16, 8)), 300);
}

TEST(Fog, OfAMeshWhoseNormalsPointInwardsIsInsideAllTheSame) {
    const auto box = box_shape({-1, -1, -1}, {1, 1, 1});
    for (glm::uvec3 &triangle : box->triangles) {
        std::swap(triangle.x, triangle.y);
    }
    expect_as_the_judge(air_in(box), 200);
}

TEST(Fog, OfShellsThatOverlapInOneMeshIsOnce) {
    const auto boxes = box_shape({-1, -1, -1}, {1, 1, 1});
    add_box(*boxes, {0, 0, 0}, {2, 2, 2});
    add_box(*boxes, {0.2F, 0.2F, 0.2F}, {0.4F, 0.4F, 0.4F});
    expect_as_the_judge(air_in(boxes), 300);
}

TEST(Fog, OfPlacesThatAreTurnedStretchedAndMirroredAdds) {
    expect_as_the_judge(air_in(torus_shape(1.5F, 0.5F, 12, 6),
                               {turned(0.7F, {0.2F, 0, 0}, {1, 0.7F, 1.3F}), turned(2.1F, {0, 0.4F, 0}, {-1, 1, 1}),
                                turned(4.0F, {1, 0, 0.2F}, {0.5F, -0.5F, -0.5F})}),
                        200);
}

// Through the diagonals of its faces, its edges and corners: none is lost, none counts twice.
TEST(Fog, IsWholeOnRaysAlongSeams) {
    const Air air = air_in(box_shape({-1, -1, -1}, {1, 1, 1}));
    Solids solids;
    const auto fogs = fogs_of(std::span(&air, 1), solids);
    for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
            const float x = 0.25F * static_cast<float>(i), y = 0.25F * static_cast<float>(j);
            const double down = way(*fogs[0], {{x, y, 3.0F}, {0, 0, -1}}, 10.0);
            if (std::max(std::abs(i), std::abs(j)) < 4) {
                EXPECT_FLOAT_EQ(static_cast<float>(down), 2.0F) << x << ", " << y;
                EXPECT_FLOAT_EQ(static_cast<float>(way(*fogs[0], {{x, y, 0.5F}, {0, 0, -1}}, 10.0)), 1.5F);
            } else {
                EXPECT_TRUE(down == 0.0 || static_cast<float>(down) == 2.0F) << x << ", " << y << ": " << down;
            }
        }
    }
    const glm::vec3 corner = glm::normalize(glm::vec3(1.0F));
    EXPECT_NEAR(way(*fogs[0], {-3.0F * corner, corner}, 10.0), 2.0 * std::sqrt(3.0), 1e-5);
}

TEST(Fog, OfAnOpenMeshLiesBetweenAFrontAndABackAlone) {
    const auto box = box_shape({-1, -1, -1}, {1, 1, 1});
    box->triangles.erase(box->triangles.begin() + 2, box->triangles.begin() + 4); // its lid
    const Air air = air_in(box);
    Solids solids;
    const auto fogs = fogs_of(std::span(&air, 1), solids);
    EXPECT_FLOAT_EQ(static_cast<float>(way(*fogs[0], {{-3, 0, 0}, {1, 0, 0}}, 10.0)), 2.0F);
    EXPECT_EQ(stretches(*fogs[0], {{0.1F, 0.2F, 3}, {0, 0, -1}}).size(), 0U); // comes in by the hole
    EXPECT_EQ(stretches(*fogs[0], {{0.1F, 0.2F, -3}, {0, 0, 1}}).size(), 0U); // leaves by it
}

TEST(Fog, IsLeftOutWhereThereIsNone) {
    Solids solids;
    const auto none = [&solids](const Air &air) { return fogs_of(std::span(&air, 1), solids).empty(); };
    const auto box = box_shape({-1, -1, -1}, {1, 1, 1});
    EXPECT_FALSE(none(air_in(box)));
    EXPECT_TRUE(none(air_in(nullptr)));
    EXPECT_TRUE(none(air_in(std::make_shared<Shape>())));
    EXPECT_TRUE(none(air_in(box, {})));
    EXPECT_TRUE(none(air_in(box, {glm::scale(glm::mat4(1.0F), {1, 1, 0})})));
    Air clear = air_in(box);
    clear.mie = glm::vec3(0.0F);
    EXPECT_TRUE(none(clear));
    // A box without thickness holds none.
    const Air flat = air_in(box_shape({-1, -1, 0}, {1, 1, 0}));
    const auto fogs = fogs_of(std::span(&flat, 1), solids);
    EXPECT_EQ(way(*fogs[0], {{0.1F, 0.2F, 3}, {0, 0, -1}}, 10.0), 0.0);
}

} // namespace
} // namespace sfumato
