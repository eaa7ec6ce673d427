// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals over area lights.
#include "module/lights.hpp"
#include "module/parts.hpp"

namespace sfumato {
namespace {

using namespace arguments;

constexpr double GREATEST_EXPONENT = 1e5;

LobeMethod method_named(const std::string &name) {
    const auto index =
        one_of<5>(name, {"poles-2", "arvo", "lorentzian", "lorentzian-pearson", "ellipse-peak"}, "method");
    return static_cast<LobeMethod>(index + static_cast<std::size_t>(LobeMethod::POLES));
}

// Each method's own range; whole numbers where it counts with them.
template <typename Number>
Numbers<Number> exponents(const py::object &given, LobeMethod method) {
    Numbers<Number> out(any_array(given, "exponent"));
    const bool arvo = method == LobeMethod::ARVO;
    const Number least = arvo ? Number{0} : method == LobeMethod::POLES ? Number{1} : Number{4};
    require_range(out, least, arvo ? Number{1e4} : static_cast<Number>(GREATEST_EXPONENT), "exponent");
    for (py::ssize_t i = 0; arvo && i < out.size(); ++i) {
        if (out.data()[i] != std::floor(out.data()[i])) {
            throw py::value_error("exponent holds " + text(out.data()[i]) + " at flat index " + text(i) +
                                  ", but must be whole for method 'arvo'");
        }
    }
    return out;
}

template <typename Number>
py::object run(LightBatch<Number> &batch, const Shape &shape) {
    std::vector<Number> out(product(shape));
    batch.count = out.size();
    batch.out = out.data();
    if (batch.count > 0) {
        const py::gil_scoped_release unlocked;
        integrate(batch);
    }
    return to_numpy(std::move(out), shape);
}

// float32 is worked on in float32, everything else in float64.
template <typename Work>
py::object in_precision_of(const py::object &given, const std::string &name, const Work &work) {
    return any_array(given, name).dtype().is(py::dtype::of<float>()) ? work(float{}) : work(double{});
}

py::object over_polygons(const py::object &polygons, const py::object &axis, const py::object &exponent,
                         LobeMethod method, const py::object &normal, const py::object &counts, bool two_sided) {
    return in_precision_of(polygons, "polygons", [&](auto zero) {
        using Number = decltype(zero);
        const Polygons<Number> corners(polygons, counts);
        LightBatch<Number> batch;
        batch.method = method;
        batch.lights = corners.vertices.data();
        batch.width = 3 * corners.width;
        batch.vertices = corners.counts.data();
        batch.two_sided = two_sided;
        Numbers<Number> axes, powers, normals;
        if (method != LobeMethod::DIFFUSE) {
            axes = directions<Number>(axis, "axis");
            powers = exponents<Number>(exponent, method);
            batch.axis = per_light(axes, corners.batch, 3, "axis");
            batch.exponent = per_light(powers, corners.batch, 1, "exponent");
        }
        if (!normal.is_none() || method == LobeMethod::DIFFUSE) { // of which a surface's normal is the axis
            normals = directions<Number>(normal, "normal");
            batch.normal = per_light(normals, corners.batch, 3, "normal");
        }
        return run(batch, corners.batch);
    });
}

// Round lights: the numbers of each, one after another.
template <typename Number>
struct RoundLights {
    RoundLights(const py::object &centre, const py::object &radius)
        : shape(LightShape::SPHERE), centres(finite<Number>(centre, "centre")),
          batch(leading_axes(centres, {3}, "centre")), width(4) {
        const Numbers<Number> radii = finite<Number>(radius, "radius");
        const PerLight<Number> sizes = per_light(radii, batch, 1, "radius");
        for (std::size_t i = 0; i < product(batch); ++i) {
            const Number *c = centres.data() + 3 * i, r = *sizes.at(i);
            if (!(r > 0)) {
                throw py::value_error("radius holds " + text(r) + " at flat index " + text(i) +
                                      ", but must be positive");
            }
            numbers.insert(numbers.end(), {c[0], c[1], c[2], r});
        }
    }
    RoundLights(const py::object &centre, const py::object &u, const py::object &v)
        : shape(LightShape::ELLIPSE), centres(finite<Number>(centre, "centre")),
          batch(leading_axes(centres, {3}, "centre")), width(9) {
        const Numbers<Number> first = directions<Number>(u, "u"), second = directions<Number>(v, "v");
        const PerLight<Number> us = per_light(first, batch, 3, "u"), vs = per_light(second, batch, 3, "v");
        for (std::size_t i = 0; i < product(batch); ++i) {
            const Number *c = centres.data() + 3 * i, *a = us.at(i), *b = vs.at(i);
            const auto product_of = [](const Number *x, const Number *y) {
                return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
            };
            if (std::abs(product_of(a, b)) >
                static_cast<Number>(1e-4) * std::sqrt(product_of(a, a) * product_of(b, b))) {
                throw py::value_error("u and v at flat index " + text(i) + " have the product " +
                                      text(product_of(a, b)) + ", but must be perpendicular");
            }
            numbers.insert(numbers.end(), {c[0], c[1], c[2], a[0], a[1], a[2], b[0], b[1], b[2]});
        }
    }
    LightBatch<Number> lights() const {
        LightBatch<Number> out;
        out.shape = shape;
        out.lights = numbers.data();
        out.width = width;
        return out;
    }
    void require_outside() const {
        for (std::size_t i = 0; i < numbers.size(); i += 4) {
            const Number *c = numbers.data() + i;
            if (c[0] * c[0] + c[1] * c[1] + c[2] * c[2] <= c[3] * c[3]) {
                throw py::value_error("radius holds " + text(c[3]) + " at flat index " + text(i / 4) +
                                      ", which reaches the origin");
            }
        }
    }

    LightShape shape;
    Numbers<Number> centres;
    Shape batch;
    std::size_t width;
    std::vector<Number> numbers;
};

template <typename Number>
py::object diffuse(const RoundLights<Number> &lights, const py::object &normal) {
    LightBatch<Number> batch = lights.lights();
    const Numbers<Number> normals = directions<Number>(normal, "normal");
    batch.method = LobeMethod::DIFFUSE;
    batch.normal = per_light(normals, lights.batch, 3, "normal");
    return run(batch, lights.batch);
}

template <typename Number>
py::object lobe(const RoundLights<Number> &lights, const py::object &axis, const py::object &exponent,
                const py::object &normal) {
    LightBatch<Number> batch = lights.lights();
    const Numbers<Number> axes = directions<Number>(axis, "axis");
    const Numbers<Number> powers = exponents<Number>(exponent, LobeMethod::POLES);
    Numbers<Number> normals;
    batch.axis = per_light(axes, lights.batch, 3, "axis");
    batch.exponent = per_light(powers, lights.batch, 1, "exponent");
    if (!normal.is_none()) {
        normals = directions<Number>(normal, "normal");
        batch.normal = per_light(normals, lights.batch, 3, "normal");
    }
    return run(batch, lights.batch);
}

double moment(const py::object &polygon, const Doubles &axis, int exponent, const Doubles &b) {
    require_shape(Doubles(any_array(polygon, "polygon")), {-1, 3}, "polygon");
    const Polygons<double> corners(polygon, py::none());
    const auto vector = [](const Doubles &array, const std::string &name) {
        require_shape(array, {3}, name);
        require_finite(array, name);
        return glm::dvec3(array.data()[0], array.data()[1], array.data()[2]);
    };
    require_range(exponent, 0, 10'000, "exponent");
    directions<double>(axis, "axis");
    return double_moment(corners.corners(0), vector(axis, "axis"), exponent, vector(b, "b"));
}

py::tuple product_lobe(const Doubles &axes, const Doubles &powers) {
    require_shape(axes, {-1, 3}, "axes");
    require_shape(powers, {axes.shape(0)}, "exponents");
    require_range(powers, 0.0, GREATEST_EXPONENT, "exponents");
    if (axes.shape(0) < 1) {
        throw py::value_error("axes has shape " + shape_of(axes) + ", but must hold at least one axis");
    }
    directions<double>(axes, "axes");
    std::vector<glm::dvec3> vectors;
    for (py::ssize_t i = 0; i < axes.shape(0); ++i) {
        vectors.emplace_back(axes.at(i, 0), axes.at(i, 1), axes.at(i, 2));
    }
    const CosineLobe lobe = product_of_lobes(vectors, {powers.data(), vectors.size()});
    return py::make_tuple(to_numpy(std::vector<double>{lobe.axis.x, lobe.axis.y, lobe.axis.z}, {3}), lobe.exponent,
                          lobe.scale);
}

} // namespace

void bind_area_light(py::module_ &m) {
    m.def(
        "polygon_integral",
        [](const py::object &polygons, const py::object &axis, const py::object &exponent, const std::string &method,
           const py::object &normal, const py::object &counts, bool two_sided) {
            return over_polygons(polygons, axis, exponent, method_named(method), normal, counts, two_sided);
        },
        py::arg("polygons"), py::arg("axis"), py::arg("exponent"), py::arg("method") = "poles-2",
        py::arg("normal") = py::none(), py::arg("counts") = py::none(), py::arg("two_sided") = false,
        R"((n + 1)/(2 pi) times the integral of (u.axis)^n over the directions u from the origin to convex polygons: the
share, in [0, 1], of a Phong lobe that they fill. (...), float32 worked in float32, all else in float64.

polygons (..., vertices, 3), their first `counts` (...) vertices each, or all; axis (3,) or (..., 3), of any length;
exponent, one or (...). What lies behind the axis's plane is cut off, and so is what lies below the horizon of `normal`
(as axis), if there is one. A polygon lights its front, from where its vertices go counter-clockwise; its back is
black, or like the front if two_sided. method:

- 'poles-2': ours, n from 1 to 1e5. Two complex poles stand for the lobe's profile to within 1.3e-4;
- 'arvo': exact, whole n up to 1e4, in time proportional to n (Arvo 1995);
- 'lorentzian', 'lorentzian-pearson', 'ellipse-peak': Lecocq et al. (2017), section 6, n from 4.

ValueError for polygons that are not convex, not planar or without area, and for all that is not finite or in range.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> [round(float(polygon_integral(square, [1, 0, 1], 30, method)), 4) for method in ("poles-2", "arvo")]
[0.4999, 0.4999]
)");
    m.def(
        "sphere_integral",
        [](const py::object &centre, const py::object &radius, const py::object &axis, const py::object &exponent,
           const py::object &normal) {
            return in_precision_of(centre, "centre", [&](auto zero) {
                const RoundLights<decltype(zero)> lights(centre, radius);
                lights.require_outside();
                return lobe(lights, axis, exponent, normal);
            });
        },
        py::arg("centre"), py::arg("radius"), py::arg("axis"), py::arg("exponent"), py::arg("normal") = py::none(),
        R"(As polygon_integral, over spheres that do not hold the origin: centre (..., 3), radius one or (...).

The outline of a sphere is a circle, so this is ellipse_integral: two poles, exactly integrated.

>>> import numpy as np
>>> round(float(sphere_integral([0, 0, 2], 1, [0, 0, 1], 1)), 4) # sin^2 of the half angle
0.25
)");
    m.def(
        "ellipse_integral",
        [](const py::object &centre, const py::object &u, const py::object &v, const py::object &axis,
           const py::object &exponent, const py::object &normal) {
            return in_precision_of(centre, "centre", [&](auto zero) {
                return lobe(RoundLights<decltype(zero)>(centre, u, v), axis, exponent, normal);
            });
        },
        py::arg("centre"), py::arg("u"), py::arg("v"), py::arg("axis"), py::arg("exponent"),
        py::arg("normal") = py::none(),
        R"(As polygon_integral, over ellipses, both of whose sides shine: centre (..., 3) and the half axes u and v,
(3,) or (..., 3), perpendicular. Two poles from n = 9, integrated along the outline exactly, horizons included; below,
64 corners, which leave up to 2e-4 beside large lights.

>>> import numpy as np
>>> round(float(ellipse_integral([0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], 99)), 4)
1.0
)");
    m.def(
        "diffuse_polygon",
        [](const py::object &polygons, const py::object &normal, const py::object &counts, bool two_sided) {
            return over_polygons(polygons, normal, py::none(), LobeMethod::DIFFUSE, normal, counts, two_sided);
        },
        py::arg("polygons"), py::arg("normal"), py::arg("counts") = py::none(), py::arg("two_sided") = false,
        R"(Irradiance / pi at the origin, on a surface with `normal`, from polygons of radiance 1: exact (Lambert 1760).
In [0, 1]. Arguments as in polygon_integral; what is below the horizon gives nothing.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> round(float(diffuse_polygon(square, [0, 0, 1])), 4)
0.5541
)");
    m.def(
        "diffuse_sphere",
        [](const py::object &centre, const py::object &radius, const py::object &normal) {
            return in_precision_of(centre, "centre", [&](auto zero) {
                return diffuse(RoundLights<decltype(zero)>(centre, radius), normal);
            });
        },
        py::arg("centre"), py::arg("radius"), py::arg("normal"),
        R"(Irradiance / pi at the origin from spheres of radiance 1: exact, horizon-cut ones included (Snyder 1996).
centre (..., 3), radius one or (...), normal (3,) or (..., 3). 1 inside the sphere.

>>> round(float(diffuse_sphere([0, 0, 2], 1, [0, 0, 1])), 4)
0.25
)");
    m.def(
        "diffuse_ellipse",
        [](const py::object &centre, const py::object &u, const py::object &v, const py::object &normal) {
            return in_precision_of(centre, "centre", [&](auto zero) {
                return diffuse(RoundLights<decltype(zero)>(centre, u, v), normal);
            });
        },
        py::arg("centre"), py::arg("u"), py::arg("v"), py::arg("normal"),
        R"(Irradiance / pi at the origin from ellipses of radiance 1, both of whose sides shine: exact, horizon-cut ones
included. centre, u, v as in ellipse_integral.

>>> round(float(diffuse_ellipse([0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1])), 4)
0.5
)");
    m.def("double_moment", &moment, py::arg("polygon"), py::arg("axis"), py::arg("exponent"), py::arg("b"),
          R"(The integral of (u.axis)^n (u.b) over the directions to one polygon (vertices, 3) in front of the axis's
plane, whole n: Arvo's double moment (1995), exact. Negative for polygons seen from behind.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> round(double_moment(square, [0, 0, 1], 0, [0, 0, 1]) / np.pi, 4) # Lambert
0.5541
)");
    m.def("product_of_lobes", &product_lobe, py::arg("axes"), py::arg("exponents"),
          R"((axis, exponent, scale) of one lobe for a product of lobes: scale (u.axis)^exponent for the product of
(u.axes[i])^exponents[i], as Lecocq et al. (2017), section 7, want it. Ours: both have their peak in one place, at one
height and with one mean curvature. Good for lobes less than 75 degrees apart; at 85 degrees a fifth of it is wrong.

>>> axis, exponent, scale = product_of_lobes([[1, 0, 1], [-1, 0, 1]], [8, 8])
>>> axis.round(6).tolist(), round(exponent, 6), round(scale, 6)
([0.0, 0.0, 1.0], 24.0, 0.003906)
)");
}

} // namespace sfumato
