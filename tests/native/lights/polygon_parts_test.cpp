// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a polygon are convex, and together what it is: its area, and each point of it once.
#include "lights/polygon_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using Polygon = std::vector<glm::dvec3>;

// On a plane that leans.
glm::dvec3 on_plane(double x, double y) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(2.0, 1.0, -0.5)),
                     v = glm::normalize(glm::cross({0.3, -1.0, 2.0}, u));
    return glm::dvec3(5.0, -3.0, 2.0) + x * u + y * v;
}

Polygon star(int points, double inner) {
    Polygon out;
    for (int i = 0; i < 2 * points; ++i) {
        const double angle = std::numbers::pi * i / points, radius = i % 2 == 0 ? 1.0 : inner;
        out.push_back(on_plane(radius * std::cos(angle), radius * std::sin(angle)));
    }
    return out;
}

// The solid angle's numerator is not needed: in its plane a point is inside where the polygon winds around it.
double winding(const Polygon &polygon, const glm::dvec3 &normal, const glm::dvec3 &p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 a = polygon[i] - p, b = polygon[(i + 1) % polygon.size()] - p;
        sum += std::atan2(glm::dot(normal, glm::cross(a, b)), glm::dot(a, b));
    }
    return sum / (2.0 * std::numbers::pi);
}

glm::dvec3 area_of(const Polygon &polygon) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        sum += 0.5 * glm::cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
    }
    return sum;
}

void expect_whole(const Polygon &polygon, std::size_t most) {
    const auto parts = convex_parts(polygon);
    ASSERT_TRUE(parts.has_value());
    EXPECT_LE(parts->size(), most);
    const glm::dvec3 area = area_of(polygon), normal = glm::normalize(area);
    glm::dvec3 sum(0.0);
    for (const Polygon &part : *parts) {
        ASSERT_TRUE(part.size() == 3 || part.size() == 4);
        for (std::size_t i = 0; i < part.size(); ++i) {
            const auto corner = [&](std::size_t k) { return part[(i + k) % part.size()]; };
            EXPECT_GT(glm::dot(normal, glm::cross(corner(1) - corner(0), corner(2) - corner(1))), 0.0);
        }
        sum += area_of(part);
    }
    EXPECT_NEAR(glm::distance(sum, area), 0.0, 1e-9);
    std::mt19937 random(3); // NOLINT(cert-msc51-cpp): the same at each run
    std::uniform_real_distribution<double> place(-1.1, 1.1);
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 p = on_plane(place(random), place(random));
        double covered = 0.0;
        for (const Polygon &part : *parts) {
            covered += winding(part, normal, p);
        }
        EXPECT_NEAR(covered, winding(polygon, normal, p), 1e-6);
    }
}

TEST(ConvexParts, AreTheWholePolygon) {
    expect_whole({on_plane(0, 0), on_plane(1, 0), on_plane(0, 1)}, 1);
    expect_whole({on_plane(0, 0), on_plane(1, 0), on_plane(1, 1), on_plane(0, 1)}, 1);
    expect_whole({on_plane(0, 0), on_plane(1, 0), on_plane(0.2, 0.2), on_plane(0, 1)}, 2);
    for (const int points : {3, 5, 12}) {
        expect_whole(star(points, 0.4), static_cast<std::size_t>(2 * points - 2));
        Polygon round = star(points, 1.0); // as good as a disk
        expect_whole(round, static_cast<std::size_t>(points));
        std::reverse(round.begin(), round.end());
        expect_whole(round, static_cast<std::size_t>(points));
    }
}

TEST(ConvexParts, KnowCornersOnOneLine) {
    expect_whole({on_plane(0, 0), on_plane(0.5, 0), on_plane(1, 0), on_plane(1, 1), on_plane(0.5, 1), on_plane(0, 1)},
                 4);
}

TEST(ConvexParts, OfWhatCrossesItselfAreNone) {
    EXPECT_FALSE(convex_parts(Polygon{on_plane(0, 0), on_plane(1, 1), on_plane(1, 0), on_plane(0, 0.9)}).has_value());
    Polygon twice = star(5, 1.0);
    const Polygon again = twice;
    twice.insert(twice.end(), again.begin(), again.end());
    EXPECT_FALSE(convex_parts(twice).has_value());
}

} // namespace
} // namespace sfumato
