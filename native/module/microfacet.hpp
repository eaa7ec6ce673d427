// SPDX-License-Identifier: GPL-3.0-or-later
// Rough surfaces as Python hands them over: to the methods and to the reference alike.
#pragma once

#include "lights/microfacet.hpp"
#include "module/lights.hpp"

namespace sfumato::arguments {

// Where the poles of two_poles end: exponent 8.
constexpr double BLINN_PHONG_ALPHA = 0.447;

// view (..., 3) and alpha, one number or two (x, y), for each light or one for all.
template <typename Number>
struct RoughSurfaces {
    RoughSurfaces(const py::object &given_view, const py::object &given_alpha, const std::string &name,
                  const Shape &batch)
        : brdf(static_cast<Brdf>(one_of<3>(name, {"ggx", "beckmann", "blinn-phong"}, "brdf"))),
          given_views(directions<Number>(given_view, "view")) {
        const Number *v = given_views.data();
        for (py::ssize_t i = 0; i < given_views.size(); i += 3, v += 3) {
            const Number length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            if (v[2] < 0) {
                throw py::value_error("view holds (" + text(v[0]) + ", " + text(v[1]) + ", " + text(v[2]) +
                                      ") at flat index " + text(i) + ", which is below the horizon");
            }
            views.insert(views.end(), {v[0] / length, v[1] / length, v[2] / length});
        }
        view = {views.data(), per_light(given_views, batch, 3, "view").stride};
        const Numbers<Number> given = finite<Number>(given_alpha, "alpha");
        const double highest = brdf == Brdf::BLINN_PHONG ? BLINN_PHONG_ALPHA : 1.0;
        require_range(given, Number{0}, static_cast<Number>(highest), "alpha");
        const bool pairs = given.ndim() > 0 && given.shape(given.ndim() - 1) == 2 &&
                           (given.ndim() == 1 || static_cast<std::size_t>(given.ndim()) == batch.size() + 1);
        if (!pairs) {
            per_light(given, batch, 1, "alpha");
        }
        const py::ssize_t step = pairs ? 2 : 1;
        for (py::ssize_t i = 0; i < given.size(); i += step) {
            const Number x = given.data()[i], y = given.data()[i + step - 1];
            if (brdf == Brdf::BLINN_PHONG && x != y) {
                throw py::value_error("alpha holds (" + text(x) + ", " + text(y) + ") at flat index " + text(i) +
                                      ", but must be one number for brdf 'blinn-phong'");
            }
            alphas.insert(alphas.end(), {x, y});
        }
        alpha = {alphas.data(), alphas.size() > 2 ? 2 : 0};
        if (pairs && alphas.size() > 2 && alphas.size() != 2 * product(batch)) {
            throw py::value_error("alpha has shape " + shape_of(given) +
                                  ", but must be one or two numbers for all lights or have their leading axes");
        }
    }

    Brdf brdf;
    Numbers<Number> given_views;
    std::vector<Number> views, alphas;
    PerLight<Number> view, alpha;
};

// The numbers of each light, one after another.
template <typename Number>
struct SphereLights {
    SphereLights(const py::object &centre, const py::object &radius)
        : centres(finite<Number>(centre, "centre")), batch(leading_axes(centres, {3}, "centre")) {
        const Numbers<Number> radii = finite<Number>(radius, "radius");
        const PerLight<Number> sizes = per_light(radii, batch, 1, "radius");
        for (std::size_t i = 0; i < product(batch); ++i) {
            const Number *c = centres.data() + 3 * i, r = *sizes.at(i);
            if (!(r > 0) || c[0] * c[0] + c[1] * c[1] + c[2] * c[2] <= r * r) {
                throw py::value_error("radius holds " + text(r) + " at flat index " + text(i) +
                                      ", but must be positive and less than the distance of the centre");
            }
            numbers.insert(numbers.end(), {c[0], c[1], c[2], r});
        }
    }

    Numbers<Number> centres;
    Shape batch;
    std::vector<Number> numbers;
};

template <typename Number>
struct EllipseLights {
    EllipseLights(const py::object &centre, const py::object &u, const py::object &v)
        : centres(finite<Number>(centre, "centre")), batch(leading_axes(centres, {3}, "centre")) {
        const Numbers<Number> first = directions<Number>(u, "u"), second = directions<Number>(v, "v");
        const PerLight<Number> us = per_light(first, batch, 3, "u"), vs = per_light(second, batch, 3, "v");
        for (std::size_t i = 0; i < product(batch); ++i) {
            const Number *c = centres.data() + 3 * i, *a = us.at(i), *b = vs.at(i);
            const auto along = [](const Number *x, const Number *y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
            if (std::abs(along(a, b)) > static_cast<Number>(1e-4) * std::sqrt(along(a, a) * along(b, b))) {
                throw py::value_error("u and v at flat index " + text(i) + " have the product " + text(along(a, b)) +
                                      ", but must be perpendicular");
            }
            numbers.insert(numbers.end(), {c[0], c[1], c[2], a[0], a[1], a[2], b[0], b[1], b[2]});
        }
    }

    Numbers<Number> centres;
    Shape batch;
    std::vector<Number> numbers;
};

// How reflectance depends on the angle: where it begins, and along which curve it rises.
struct Fresnel {
    Fresnel(double given_f0, double given_index) : f0(given_f0), index(given_index) {
        require_range(f0, 0.0, 1.0, "f0");
        if (!is_index(index)) {
            throw py::value_error("index is " + text(index) + ", but must be " + INDEX_RANGE);
        }
    }

    double f0, index;
};

} // namespace sfumato::arguments
