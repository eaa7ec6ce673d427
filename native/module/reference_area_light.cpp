// SPDX-License-Identifier: GPL-3.0-or-later
#include "module/lights.hpp"
#include "module/parts.hpp"
#include "reference/area_light.hpp"

namespace sfumato {
namespace {

using namespace arguments;

struct Lobes {
    Lobes(const py::object &given_axis, const py::object &given_exponent, const py::object &given_normal,
          const Shape &batch)
        : axes(directions<double>(given_axis, "axis")), exponents(any_array(given_exponent, "exponent")),
          axis(per_light(axes, batch, 3, "axis")), exponent(per_light(exponents, batch, 1, "exponent")) {
        require_range(exponents, 0.0, 1e6, "exponent");
        if (!given_normal.is_none()) {
            normals = directions<double>(given_normal, "normal");
            normal = per_light(normals, batch, 3, "normal");
        }
    }
    [[nodiscard]] reference::Horizon horizon(std::size_t light) const {
        return normal.values != nullptr ? reference::Horizon(vector(normal.at(light))) : reference::Horizon();
    }
    [[nodiscard]] static glm::dvec3 vector(const double *v) { return {v[0], v[1], v[2]}; }

    Doubles axes, exponents, normals;
    PerLight<double> axis, exponent, normal;
};

template <typename Value>
py::array_t<double> each(const Shape &batch, const Value &value) {
    std::vector<double> out(product(batch));
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = value(i);
        }
    }
    return to_numpy(std::move(out), batch);
}

py::array_t<double> polygon_integral(const py::object &polygons, const py::object &axis, const py::object &exponent,
                                     const py::object &normal, const py::object &counts, const std::string &method) {
    const Polygons<double> corners(polygons, counts);
    const Lobes lobes(axis, exponent, normal, corners.batch);
    const std::size_t how = one_of<3>(method, {"boundary", "recurrence", "area"}, "method");
    return each(corners.batch, [&](std::size_t i) {
        const auto polygon = corners.corners(i);
        const glm::dvec3 r = Lobes::vector(lobes.axis.at(i));
        const double n = *lobes.exponent.at(i);
        const reference::Horizon horizon = lobes.horizon(i);
        return how == 0   ? reference::cosine_power(polygon, r, n, horizon)
               : how == 1 ? reference::cosine_power_exact(polygon, r, static_cast<int>(n), horizon)
                          : reference::cosine_power_by_area(polygon, r, n, horizon);
    });
}

py::array_t<double> sphere_integral(const py::object &centre, const py::object &radius, const py::object &axis,
                                    const py::object &exponent, const py::object &normal) {
    const Doubles centres = finite<double>(centre, "centre"), radii = finite<double>(radius, "radius");
    const Shape batch = leading_axes(centres, {3}, "centre");
    const Lobes lobes(axis, exponent, normal, batch);
    const PerLight<double> size = per_light(radii, batch, 1, "radius");
    require_range(radii, 1e-9, 1e9, "radius");
    return each(batch, [&](std::size_t i) {
        return reference::cosine_power_of_sphere(Lobes::vector(centres.data() + 3 * i), *size.at(i),
                                                 Lobes::vector(lobes.axis.at(i)), *lobes.exponent.at(i),
                                                 lobes.horizon(i));
    });
}

py::array_t<double> ellipse_integral(const py::object &centre, const py::object &u, const py::object &v,
                                     const py::object &axis, const py::object &exponent, const py::object &normal) {
    const Doubles centres = finite<double>(centre, "centre");
    const Shape batch = leading_axes(centres, {3}, "centre");
    const Doubles first = directions<double>(u, "u"), second = directions<double>(v, "v");
    const PerLight<double> us = per_light(first, batch, 3, "u"), vs = per_light(second, batch, 3, "v");
    const Lobes lobes(axis, exponent, normal, batch);
    return each(batch, [&](std::size_t i) {
        return reference::cosine_power_of_ellipse(Lobes::vector(centres.data() + 3 * i), Lobes::vector(us.at(i)),
                                                  Lobes::vector(vs.at(i)), Lobes::vector(lobes.axis.at(i)),
                                                  *lobes.exponent.at(i), lobes.horizon(i));
    });
}

} // namespace

void bind_reference_area_light(py::module_ &m) {
    m.def("polygon_integral", &polygon_integral, py::arg("polygons"), py::arg("axis"), py::arg("exponent"),
          py::arg("normal") = py::none(), py::arg("counts") = py::none(), py::arg("method") = "boundary",
          R"((n + 1)/(2 pi) int (u.axis)^n du over convex polygons, whichever side they show; float64. Arguments as in
sfumato.polygon_integral. method 'boundary': quadrature along the edges, any n; 'recurrence': exact, whole n;
'area': quadrature over the polygon, n up to a few hundred.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> ways = ("boundary", "recurrence", "area")
>>> [reference.polygon_integral(square, [0.2, 0, 1], 8, method=way).round(9).item() for way in ways]
[0.946448059, 0.946448059, 0.946448059]
)");
    m.def(
        "sphere_integral", &sphere_integral, py::arg("centre"), py::arg("radius"), py::arg("axis"), py::arg("exponent"),
        py::arg("normal") = py::none(),
        R"(The same over spheres, by adaptive quadrature along their outlines. Arguments as in sfumato.sphere_integral.

>>> reference.sphere_integral([0, 0, 2], 1, [0, 0, 1], 1).round(9).item()
0.25
)");
    m.def("ellipse_integral", &ellipse_integral, py::arg("centre"), py::arg("u"), py::arg("v"), py::arg("axis"),
          py::arg("exponent"), py::arg("normal") = py::none(),
          R"(The same over ellipses. Arguments as in sfumato.ellipse_integral.

>>> reference.ellipse_integral([0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], 1).round(9).item()
0.5
)");
}

} // namespace sfumato
