// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

namespace sfumato::reference {
namespace {

using Corners = std::array<glm::dvec3, 3>;

Corners corners_of(const Air &air, std::size_t place, const glm::uvec3 &triangle) {
    Corners out;
    for (int i = 0; i < 3; ++i) {
        out[static_cast<std::size_t>(i)] =
            glm::dvec3(glm::dmat4(air.to_world[place]) * glm::dvec4(air.shape->vertices[triangle[i]], 1.0));
    }
    return out;
}

} // namespace

// Solid angles of triangles: van Oosterom and Strackee, 1983.
double winding(const Air &air, std::size_t place, const glm::dvec3 &world) {
    double sum = 0.0;
    for (const glm::uvec3 &triangle : air.shape->triangles) {
        Corners to = corners_of(air, place, triangle);
        for (glm::dvec3 &corner : to) {
            corner -= world;
        }
        const double a = glm::length(to[0]), b = glm::length(to[1]), c = glm::length(to[2]);
        const double over = glm::dot(to[0], glm::cross(to[1], to[2]));
        const double under =
            a * b * c + glm::dot(to[0], to[1]) * c + glm::dot(to[1], to[2]) * a + glm::dot(to[2], to[0]) * b;
        sum += 2.0 * std::atan2(over, under);
    }
    return std::abs(sum) / (4.0 * std::numbers::pi);
}

double places_around(const Air &air, const glm::dvec3 &world) {
    double held = 0.0;
    for (std::size_t place = 0; place < air.to_world.size(); ++place) {
        held += winding(air, place, world) > 0.5 ? 1.0 : 0.0;
    }
    return held;
}

std::vector<double> crossings(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to) {
    std::vector<double> out;
    for (std::size_t place = 0; place < air.to_world.size(); ++place) {
        for (const glm::uvec3 &triangle : air.shape->triangles) {
            const Corners at = corners_of(air, place, triangle);
            const glm::dvec3 p = at[1] - at[0], q = at[2] - at[0];
            // from + t (to - from) = at[0] + u p + v q
            const glm::dmat3 system(from - to, p, q);
            if (glm::determinant(system) == 0.0) {
                continue;
            }
            const glm::dvec3 tuv = glm::inverse(system) * (from - at[0]);
            // One too many does no harm.
            constexpr double ROOM = 1e-9;
            if (tuv.x > 0.0 && tuv.x < 1.0 && tuv.y > -ROOM && tuv.z > -ROOM && tuv.y + tuv.z < 1.0 + ROOM) {
                out.push_back(tuv.x);
            }
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

double way_inside(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to) {
    std::vector<double> ends = crossings(air, from, to);
    ends.insert(ends.begin(), 0.0);
    ends.push_back(1.0);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const double length = ends[i + 1] - ends[i];
        if (length > 1e-12) {
            sum += length * places_around(air, from + 0.5 * (ends[i] + ends[i + 1]) * (to - from));
        }
    }
    return sum * glm::distance(from, to);
}

} // namespace sfumato::reference
