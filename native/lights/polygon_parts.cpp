// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/polygon_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace sfumato {
namespace {

// Twice the area to the left of the way from a over b to c.
double turn(const glm::dvec2 &a, const glm::dvec2 &b, const glm::dvec2 &c) {
    const glm::dvec2 u = b - a, v = c - a;
    return u.x * v.y - u.y * v.x;
}

// The polygon on its own plane, on which it runs counterclockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> polygon) {
    glm::dvec3 normal(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        normal += glm::cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
    }
    normal = glm::normalize(normal);
    const glm::dvec3 side = std::abs(normal.x) < 0.7 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(side, normal)), y = glm::cross(normal, x);
    std::vector<glm::dvec2> out;
    for (const glm::dvec3 &corner : polygon) {
        out.emplace_back(glm::dot(corner - polygon[0], x), glm::dot(corner - polygon[0], y));
    }
    return out;
}

// Whether two edges have a point in common.
bool touch(const glm::dvec2 &a, const glm::dvec2 &b, const glm::dvec2 &c, const glm::dvec2 &d) {
    const auto within = [](const glm::dvec2 &p, const glm::dvec2 &q, const glm::dvec2 &r) { // of three on a line
        return std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y &&
               r.y <= std::max(p.y, q.y);
    };
    const double c_side = turn(a, b, c), d_side = turn(a, b, d), a_side = turn(c, d, a), b_side = turn(c, d, b);
    return (c_side * d_side < 0.0 && a_side * b_side < 0.0) || (c_side == 0.0 && within(a, b, c)) ||
           (d_side == 0.0 && within(a, b, d)) || (a_side == 0.0 && within(c, d, a)) ||
           (b_side == 0.0 && within(c, d, b));
}

bool crosses_itself(std::span<const glm::dvec2> p) {
    const std::size_t n = p.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            if (!(i == 0 && j == n - 1) && touch(p[i], p[i + 1], p[j], p[(j + 1) % n])) {
                return true;
            }
        }
    }
    return false;
}

using Corners = std::vector<std::size_t>; // numbers

// Whether the triangle around corner `at` of what is left holds none of the others.
bool is_ear(std::span<const glm::dvec2> p, const Corners &left, std::size_t at) {
    const std::size_t n = left.size(), before = left[(at + n - 1) % n], after = left[(at + 1) % n];
    const glm::dvec2 &a = p[before], &b = p[left[at]], &c = p[after];
    if (!(turn(a, b, c) > 0.0)) {
        return false;
    }
    return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
        const bool own = other == before || other == left[at] || other == after;
        return !own && turn(a, b, p[other]) >= 0.0 && turn(b, c, p[other]) >= 0.0 && turn(c, a, p[other]) >= 0.0;
    });
}

bool is_convex(std::span<const glm::dvec2> p, const Corners &part) {
    for (std::size_t i = 0; i < part.size(); ++i) {
        const auto corner = [&](std::size_t k) { return p[part[(i + k) % part.size()]]; };
        const double edges = glm::distance(corner(0), corner(1)) * glm::distance(corner(1), corner(2));
        if (!(turn(corner(0), corner(1), corner(2)) > 1e-6 * edges)) {
            return false;
        }
    }
    return true;
}

// The quadrilateral of two triangles with a common edge; empty where they have none.
Corners together(const Corners &a, const Corners &b) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (a[i] == b[(j + 1) % 3] && a[(i + 1) % 3] == b[j]) {
                return {a[i], b[(j + 2) % 3], a[(i + 1) % 3], a[(i + 2) % 3]};
            }
        }
    }
    return {};
}

} // namespace

std::optional<std::vector<std::vector<glm::dvec3>>> convex_parts(std::span<const glm::dvec3> polygon) {
    const std::vector<glm::dvec2> p = flattened(polygon);
    if (crosses_itself(p)) {
        return std::nullopt;
    }
    Corners left(p.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] = i;
    }
    std::vector<Corners> parts;
    bool mergeable = false; // whether the last part is a triangle
    while (left.size() >= 3) {
        const std::size_t n = left.size();
        std::size_t at = 0;
        while (at < n && !is_ear(p, left, at)) {
            ++at;
        }
        // Rounding may leave no ear, of corners on one line: what such a corner cuts off has no area.
        at %= n;
        const Corners ear{left[(at + n - 1) % n], left[at], left[(at + 1) % n]};
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
        if (!is_convex(p, ear)) {
            continue;
        }
        const Corners both = mergeable ? together(parts.back(), ear) : Corners{};
        mergeable = both.empty() || !is_convex(p, both);
        if (mergeable) {
            parts.push_back(ear);
        } else {
            parts.back() = both;
        }
    }
    std::vector<std::vector<glm::dvec3>> out;
    for (const Corners &part : parts) {
        std::vector<glm::dvec3> &corners = out.emplace_back();
        for (const std::size_t corner : part) {
            corners.push_back(polygon[corner]);
        }
    }
    return out;
}

} // namespace sfumato
