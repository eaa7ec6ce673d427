// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

namespace sfumato::reference {
namespace {

glm::dvec3 transform(const glm::dmat4 &matrix, const glm::dvec3 &point) {
    return glm::dvec3(matrix * glm::dvec4(point, 1.0));
}

glm::dmat4 world_to_grid(const Medium &medium) {
    return glm::inverse(glm::dmat4(medium.grid_to_world));
}

// Trilinear interpolation at a point in grid space of what sample(index of a cell) gives; zero off the grid.
template <typename Value, typename Sample>
Value interpolate(const Medium &medium, const glm::dvec3 &point, const Sample &sample) {
    const glm::dvec3 position = point - 0.5; // in units in which the sample i is at i
    const glm::dvec3 size(medium.resolution);
    if (glm::any(glm::lessThanEqual(position, glm::dvec3(-1.0))) || glm::any(glm::greaterThanEqual(position, size))) {
        return Value(0.0);
    }
    const glm::dvec3 lower = glm::floor(position);
    const std::array<glm::dvec3, 2> weight{1.0 - (position - lower), position - lower};
    Value sum(0.0);
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 2; ++i) {
                const glm::ivec3 cell = glm::ivec3(lower) + glm::ivec3(i, j, k);
                if (glm::any(glm::lessThan(cell, glm::ivec3(0))) ||
                    glm::any(glm::greaterThanEqual(cell, glm::ivec3(medium.resolution)))) {
                    continue;
                }
                const glm::uvec3 index(cell);
                const std::size_t row = std::size_t{index.z} * medium.resolution.y + index.y;
                sum += weight[std::size_t(i)].x * weight[std::size_t(j)].y * weight[std::size_t(k)].z *
                       sample(row * medium.resolution.x + index.x);
            }
        }
    }
    return sum;
}

double density_at(const Medium &medium, const glm::dvec3 &point) {
    return interpolate<double>(medium, point, [&](std::size_t cell) { return double{medium.density[cell]}; });
}

} // namespace

double density(const Medium &medium, const glm::dvec3 &world) {
    return density_at(medium, transform(world_to_grid(medium), world));
}

glm::dvec3 scattering(const Medium &medium, const glm::dvec3 &world) {
    const glm::dvec3 white(medium.scattering);
    if (medium.colour.empty()) {
        return white * density(medium, world);
    }
    return white * interpolate<glm::dvec3>(medium, transform(world_to_grid(medium), world), [&](std::size_t cell) {
               return glm::dvec3(medium.colour[cell]) * double{medium.density[cell]};
           });
}

glm::dvec3 emission(const Medium &medium, const glm::dvec3 &world) {
    if (medium.glow.empty()) {
        return glm::dvec3(0.0);
    }
    const auto glow = interpolate<double>(medium, transform(world_to_grid(medium), world),
                                          [&](std::size_t cell) { return double{medium.glow[cell]}; });
    const double row = std::clamp(glow, 0.0, 1.0) * static_cast<double>(medium.emission.size() - 1);
    const auto low = static_cast<std::size_t>(row);
    const std::size_t high = std::min(low + 1, medium.emission.size() - 1);
    return glm::mix(glm::dvec3(medium.emission[low]), glm::dvec3(medium.emission[high]), row - std::floor(row));
}

std::vector<double> cell_crossings(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to) {
    const glm::dmat4 matrix = world_to_grid(medium);
    const glm::dvec3 a = transform(matrix, from);
    const glm::dvec3 b = transform(matrix, to);
    std::vector<double> crossings{0.0, 1.0};
    for (int axis = 0; axis < 3; ++axis) {
        // The samples i = -1 and i = size are zero: the density ends there.
        const auto size = static_cast<double>(medium.resolution[axis]);
        const double first = std::clamp(std::ceil(std::min(a[axis], b[axis]) - 0.5), -1.0, size + 1.0);
        const double last = std::clamp(std::floor(std::max(a[axis], b[axis]) - 0.5), -2.0, size);
        for (int i = static_cast<int>(first); i <= static_cast<int>(last); ++i) {
            if (a[axis] != b[axis]) { // else the segment lies in the plane and crosses nothing
                crossings.push_back(std::clamp((i + 0.5 - a[axis]) / (b[axis] - a[axis]), 0.0, 1.0));
            }
        }
    }
    std::sort(crossings.begin(), crossings.end());
    return crossings;
}

double column(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to) {
    const glm::dmat4 matrix = world_to_grid(medium);
    const glm::dvec3 a = transform(matrix, from);
    const glm::dvec3 b = transform(matrix, to);
    const std::vector<double> crossings = cell_crossings(medium, from, to);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        // Gauss and Legendre's rule with two points is exact for cubics.
        const double middle = 0.5 * (crossings[i] + crossings[i + 1]);
        const double half = 0.5 * (crossings[i + 1] - crossings[i]);
        const double offset = half / std::numbers::sqrt3;
        sum += half * density_at(medium, glm::mix(a, b, middle - offset));
        sum += half * density_at(medium, glm::mix(a, b, middle + offset));
    }
    return sum * glm::distance(from, to);
}

glm::dvec3 transmittance(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to) {
    const glm::dvec3 extinction = glm::dvec3(medium.scattering) + glm::dvec3(medium.absorption);
    return glm::exp(-extinction * column(medium, from, to));
}

glm::dvec3 transmittance(std::span<const Medium> media, const glm::dvec3 &from, const glm::dvec3 &to) {
    glm::dvec3 product(1.0);
    for (const Medium &medium : media) {
        product *= transmittance(medium, from, to);
    }
    return product;
}

glm::dvec3 transmittance_to_infinity(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &towards) {
    // No point of a box is further away than the furthest of its corners.
    const glm::dmat4 matrix(medium.grid_to_world);
    const glm::dvec3 size(medium.resolution);
    double reach = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 upper(corner & 1, (corner >> 1) & 1, corner >> 2);
        reach = std::max(reach, glm::distance(from, transform(matrix, upper * (size + 1.0) - 0.5)));
    }
    return transmittance(medium, from, from + reach * towards);
}

double henyey_greenstein(double cos_theta, double g) {
    return (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cos_theta, 1.5));
}

double transmittance(std::span<const Fragment> fragments, double d) {
    double product = 1.0;
    for (const Fragment &fragment : fragments) {
        if (fragment.depth <= d) {
            product *= 1.0 - fragment.alpha;
        }
    }
    return product;
}

} // namespace sfumato::reference
