// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights as Python hands them over: any leading axes, then one light; other quantities one a light, or one for
// all.
#pragma once

#include "lights/area_light.hpp"
#include "module/arguments.hpp"
#include "module/rays.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace sfumato::arguments {

template <typename Number>
using Numbers = py::array_t<Number, py::array::c_style | py::array::forcecast>;

using Shape = std::vector<py::ssize_t>;

template <typename Number>
Numbers<Number> finite(const py::object &given, const std::string &name) {
    Numbers<Number> out(any_array(given, name));
    require_finite(out, name);
    return out;
}

// The shape of `array` without its last axes, which must be `last` (-1 for any).
template <typename Array>
Shape leading_axes(const Array &array, const Shape &last, const std::string &name) {
    const auto axes = static_cast<py::ssize_t>(last.size());
    bool fits = array.ndim() >= axes;
    std::string wanted;
    for (py::ssize_t axis = 0; axis < axes; ++axis) {
        const py::ssize_t size = last[static_cast<std::size_t>(axis)];
        fits = fits && (size < 0 || array.shape(array.ndim() - axes + axis) == size);
        wanted += ", " + (size < 0 ? "any" : text(size));
    }
    if (!fits) {
        throw py::value_error(name + " has shape " + shape_of(array) + ", but must have (..." + wanted + ")");
    }
    return {array.shape(), array.shape() + array.ndim() - axes};
}

// One item of `width` numbers for each light of the batch, or one for all.
template <typename Number>
PerLight<Number> per_light(const Numbers<Number> &array, const Shape &batch, py::ssize_t width,
                           const std::string &name) {
    const Shape shape = leading_axes(array, width > 1 ? Shape{width} : Shape{}, name);
    if (!shape.empty() && shape != batch) {
        throw py::value_error(name + " has shape " + shape_of(array) +
                              ", but must be one for all lights or have their leading axes");
    }
    return {array.data(), shape.empty() ? 0 : width};
}

template <typename Number>
Numbers<Number> directions(const py::object &given, const std::string &name) {
    Numbers<Number> out = finite<Number>(given, name);
    leading_axes(out, {3}, name);
    for (py::ssize_t i = 0; i < out.size(); i += 3) {
        const Number *d = out.data() + i;
        if (!(std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) > static_cast<Number>(1e-12))) {
            throw py::value_error(name + " holds (" + text(d[0]) + ", " + text(d[1]) + ", " + text(d[2]) +
                                  ") at flat index " + text(i) + ", which is no direction");
        }
    }
    return out;
}

// Refuses a polygon that no closed form can take, which `name` holds at the place `where`.
inline void require_sound(std::span<const glm::dvec3> polygon, const std::string &name, const std::string &where) {
    const char *why = nullptr;
    switch (fault_of(polygon)) {
    case PolygonFault::SOUND:
        return;
    case PolygonFault::NO_AREA:
        why = "has no area";
        break;
    case PolygonFault::NOT_PLANAR:
        why = "is not planar";
        break;
    default:
        why = "is not convex, or crosses itself";
        break;
    }
    std::string all;
    for (const glm::dvec3 &v : polygon) {
        all += (all.empty() ? "(" : ", (") + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + ")";
    }
    throw py::value_error(name + " holds [" + all + "]" + where + ", which " + why);
}

// Polygons (..., vertices, 3) and how many of each one's vertices count.
template <typename Number>
struct Polygons {
    Polygons(const py::object &given, const py::object &given_counts)
        : vertices(finite<Number>(given, "polygons")), batch(leading_axes(vertices, {-1, 3}, "polygons")),
          width(static_cast<std::size_t>(vertices.shape(vertices.ndim() - 2))) {
        if (width < 3 || width > 64) {
            throw py::value_error("polygons has shape " + shape_of(vertices) +
                                  ", but must have 3 to 64 vertices a polygon");
        }
        counts.assign(product(batch), static_cast<std::int32_t>(width));
        if (!given_counts.is_none()) {
            const Doubles sizes(any_array(given_counts, "counts"));
            if (leading_axes(sizes, {}, "counts") != batch) {
                throw py::value_error("counts has shape " + shape_of(sizes) + ", but must have one for each polygon");
            }
            for (std::size_t i = 0; i < counts.size(); ++i) {
                const double size = sizes.data()[i];
                if (!(size >= 3.0 && size <= static_cast<double>(width) && size == std::floor(size))) {
                    throw py::value_error("counts holds " + text(size) + " at flat index " + text(i) +
                                          ", but must be whole and lie between 3 and " + text(width));
                }
                counts[i] = static_cast<std::int32_t>(size);
            }
        }
        for (std::size_t i = 0; i < counts.size(); ++i) {
            require_sound(corners(i), "polygons", " at flat index " + text(i));
        }
    }
    [[nodiscard]] std::vector<glm::dvec3> corners(std::size_t polygon) const {
        std::vector<glm::dvec3> out;
        const Number *v = vertices.data() + 3 * width * polygon;
        for (std::int32_t i = 0; i < counts[polygon]; ++i, v += 3) {
            out.emplace_back(v[0], v[1], v[2]);
        }
        return out;
    }

    Numbers<Number> vertices;
    Shape batch;
    std::size_t width;
    std::vector<std::int32_t> counts;
};

} // namespace sfumato::arguments
