// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals of cosine powers, and of Lambert's cosine, over lights seen from the origin: batches for the console, for
// tests and for the charts, from the shared text. No tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato {

// DIFFUSE is Lambert's cosine about the normal. The others are N/(2 pi) int (u.axis)^n du with N = n + 1, in [0, 1]:
// POLES for any real n >= 1, ARVO exactly for whole n, the rest as published, for n >= 4.
enum class LobeMethod { DIFFUSE, POLES, ARVO, LORENTZIAN, LORENTZIAN_PEARSON, ELLIPSE_PEAK };
enum class LightShape { POLYGON, SPHERE, ELLIPSE };

// One value, or vector, for each light, or the same for all of them (stride 0).
template <typename Number>
struct PerLight {
    const Number *values = nullptr;
    std::ptrdiff_t stride = 0;

    [[nodiscard]] const Number *at(std::size_t light) const {
        return values + static_cast<std::ptrdiff_t>(light) * stride;
    }
};

template <typename Number>
struct LightBatch {
    LightShape shape = LightShape::POLYGON;
    LobeMethod method = LobeMethod::POLES;
    std::size_t count = 0;
    // `width` numbers a light: x, y, z of each vertex; the centre and the radius; the centre and both half axes.
    const Number *lights = nullptr;
    std::size_t width = 0;
    const std::int32_t *vertices = nullptr; // of each polygon, or null where all have width / 3
    PerLight<Number> axis, exponent;
    PerLight<Number> normal; // of the horizon; null where there is none. DIFFUSE needs it.
    bool two_sided = false;  // polygons wound clockwise, seen from the origin: as if they were not, or black
    Number *out = nullptr;
};

// As many lights at a time as this processor has lanes; and one at a time in double precision.
void integrate(const LightBatch<float> &batch);
void integrate(const LightBatch<double> &batch);

// int z^n (u.b) du, z = u.axis: Arvo's double moment, for whole n.
double double_moment(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, int exponent, const glm::dvec3 &b);

// One lobe for a product of lobes: scale * (u.axis)^exponent ~ prod_i (u.axes[i])^exponents[i].
struct CosineLobe {
    glm::dvec3 axis{0.0};
    double exponent = 0.0;
    double scale = 1.0;
};
CosineLobe product_of_lobes(std::span<const glm::dvec3> axes, std::span<const double> exponents);

// What keeps a polygon from being a light; SOUND for convex planar ones that do not vanish.
enum class PolygonFault { SOUND, NOT_FINITE, NO_AREA, NOT_PLANAR, NOT_CONVEX };
PolygonFault fault_of(std::span<const glm::dvec3> polygon);

} // namespace sfumato
