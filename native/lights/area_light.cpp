// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/area_light.hpp"

#include "lights/area_light_loops.hpp"
#include "lights/light_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

namespace sfumato {
namespace {

using Loops = AreaLightLoops<double, text::OneLane, double>;

} // namespace

void integrate(const LightBatch<float> &batch) {
    light_kernels().integrate_lights(batch);
}

void integrate(const LightBatch<double> &batch) {
    Loops().integrate_batch(batch);
}

double double_moment(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, int exponent, const glm::dvec3 &b) {
    Loops loops;
    const glm::dvec3 r = loops.unit_or_zero(axis);
    Loops::Polygon corners;
    corners.count = polygon.size();
    std::copy(polygon.begin(), polygon.end(), std::begin(corners.vertices));
    const double n = exponent;
    const double moment =
        exponent == 0 ? 0.0
                      : loops.along_boundary(corners, r, nullptr, [&](const Loops::Edge &edge, double from, double to) {
                            return loops.arvo_along(loops.unit_arc_of(edge, r, from, to), exponent - 1);
                        });
    double sum = loops.dot(r, b) * moment;
    Loops::Gap behind = loops.no_gap();
    for (std::size_t i = 0; i < corners.count; ++i) {
        const Loops::Edge edge =
            loops.edge_between(corners.vertices[i], corners.vertices[i + 1 < corners.count ? i + 1 : 0]);
        const double from = loops.dot(edge.from, r), to = loops.dot(edge.to, r);
        sum += loops.dot(edge.normal, b) * loops.moment_along(loops.unit_arc_of(edge, r, from, to), exponent);
        behind = loops.gap_after(behind, edge, from, to);
    }
    if (exponent == 0) {
        sum += loops.dot(r, b) * loops.gap_angle(behind, r);
    }
    return -sum / (n + 2.0);
}

CosineLobe product_of_lobes(std::span<const glm::dvec3> given, std::span<const double> exponents) {
    std::vector<glm::dvec3> axes;
    for (const glm::dvec3 &axis : given) {
        axes.push_back(glm::normalize(axis));
    }
    // The product's peak: where sum_i n_i r_i / (u.r_i) is parallel to u. Four steps from the mean axis.
    glm::dvec3 u(0.0);
    for (std::size_t i = 0; i < axes.size(); ++i) {
        u += exponents[i] * axes[i];
    }
    u = glm::normalize(u);
    for (int step = 0; step < 4; ++step) {
        glm::dvec3 next(0.0);
        for (std::size_t i = 0; i < axes.size(); ++i) {
            next += exponents[i] / std::max(glm::dot(u, axes[i]), 1e-6) * axes[i];
        }
        u = glm::normalize(next);
    }
    CosineLobe lobe{u, 0.0, 1.0};
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const double cosine = std::max(glm::dot(u, axes[i]), 1e-6);
        lobe.scale *= std::pow(cosine, exponents[i]);
        lobe.exponent += exponents[i] * (1.0 + 0.5 * (1.0 / (cosine * cosine) - 1.0));
    }
    return lobe;
}

PolygonFault fault_of(std::span<const glm::dvec3> polygon) {
    constexpr double FLATNESS = 1e-3, CONVEXITY = 1e-4; // of the size, of the product of two edges
    const std::size_t n = polygon.size();
    glm::dvec3 area(0.0);
    double size = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec3 &v = polygon[i];
        if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) {
            return PolygonFault::NOT_FINITE;
        }
        area += glm::cross(v - polygon[0], polygon[(i + 1) % n] - polygon[0]);
        size = std::max(size, glm::length(v - polygon[0]));
    }
    const double twice = glm::length(area);
    if (!(twice > 1e-12 * size * size)) {
        return PolygonFault::NO_AREA;
    }
    const glm::dvec3 normal = area / twice;
    for (const glm::dvec3 &v : polygon) {
        if (std::abs(glm::dot(v - polygon[0], normal)) > FLATNESS * size) {
            return PolygonFault::NOT_PLANAR;
        }
    }
    // Turning left everywhere is not enough: a star does. Its edges turn away from the first, and back, more than once.
    const glm::dvec3 first = polygon[1] - polygon[0];
    int changes = 0;
    bool forward = true;
    for (std::size_t i = 0; i < n; ++i) {
        const glm::dvec3 edge = polygon[(i + 1) % n] - polygon[i];
        const glm::dvec3 next = polygon[(i + 2) % n] - polygon[(i + 1) % n];
        const double turn = glm::dot(glm::cross(edge, next), normal);
        if (turn < -CONVEXITY * glm::length(edge) * glm::length(next)) {
            return PolygonFault::NOT_CONVEX;
        }
        const double along = glm::dot(next, first);
        if (along != 0.0 && (along > 0.0) != forward) {
            forward = !forward;
            ++changes;
        }
    }
    return changes <= 2 ? PolygonFault::SOUND : PolygonFault::NOT_CONVEX;
}

} // namespace sfumato
