// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "module/scene_parts.hpp"

#include <algorithm>

namespace sfumato {
namespace {

using namespace arguments;

py::array_t<double> transmittance(const Doubles &depth, const Doubles &alpha, const Doubles &d) {
    require_shape(depth, {-1}, "depth");
    require_shape(alpha, {depth.shape(0)}, "alpha");
    require_shape(d, {-1}, "d");
    require_finite(depth, "depth");
    require_range(alpha, 0.0, 1.0, "alpha");
    require_finite(d, "d");
    std::vector<reference::Fragment> fragments;
    for (py::ssize_t i = 0; i < depth.size(); ++i) {
        fragments.push_back({depth.data()[i], alpha.data()[i]});
    }
    std::vector<double> out(d.data(), d.data() + d.size());
    {
        const py::gil_scoped_release unlocked;
        for (double &value : out) {
            value = reference::transmittance(fragments, value);
        }
    }
    return to_numpy(std::move(out), {d.shape(0)});
}

py::array_t<double> column(const ConsoleScene &given, const Doubles &start, const Doubles &end, int medium) {
    const Scene scene = given.for_reference();
    if (start.ndim() < 1 || start.shape(start.ndim() - 1) != 3) {
        throw py::value_error("start has shape " + shape_of(start) + ", but its last axis must be 3");
    }
    if (end.ndim() != start.ndim() || !std::equal(end.shape(), end.shape() + end.ndim(), start.shape())) {
        throw py::value_error("end has shape " + shape_of(end) + ", but must have that of start, " + shape_of(start));
    }
    require_finite(start, "start");
    require_finite(end, "end");
    if (medium < 0 || medium >= static_cast<int>(scene.media.size())) {
        throw py::value_error("medium is " + text(medium) + ", but the scene has " + text(scene.media.size()) +
                              ", counted from 0");
    }
    std::vector<double> out(static_cast<std::size_t>(start.size() / 3), 0.0);
    {
        const auto point = [](const double *p) { return glm::dvec3(p[0], p[1], p[2]); };
        const double *from = start.data(), *to = end.data();
        const py::gil_scoped_release unlocked;
        for (double &value : out) {
            value = reference::column(scene.media[static_cast<std::size_t>(medium)], point(from), point(to));
            from += 3;
            to += 3;
        }
    }
    return to_numpy(std::move(out), {start.shape(), start.shape() + start.ndim() - 1});
}

py::array_t<double> render(const ConsoleScene &given, const Camera &camera, int width, int height,
                           int sun_samples_per_axis, double step, int light_samples_per_axis) {
    require_range(width, 1, 65536, "width");
    require_range(height, 1, 65536, "height");
    require_range(sun_samples_per_axis, 1, 1024, "sun_samples_per_axis");
    require_range(light_samples_per_axis, 1, 1024, "light_samples_per_axis");
    require_range(step, 1e-6, 1e6, "step");
    const Scene scene = given.for_reference();
    std::vector<double> out;
    {
        const py::gil_scoped_release unlocked;
        const auto unsigned_of = [](int value) { return static_cast<unsigned>(value); };
        const auto image =
            reference::render(scene, camera, unsigned_of(width), unsigned_of(height),
                              {unsigned_of(sun_samples_per_axis), step, unsigned_of(light_samples_per_axis)});
        for (const glm::dvec4 &pixel : image) {
            out.insert(out.end(), {pixel.x, pixel.y, pixel.z, pixel.w});
        }
    }
    return to_numpy(std::move(out), {height, width, 4});
}

} // namespace

void bind_reference(py::module_ &parent) {
    py::module_ m = parent.def_submodule(
        "reference", "The answers that the methods approximate: float64, as plain as the textbook, and slow.");
    bind_reference_airlight(m);
    bind_reference_area_light(m);
    m.def("transmittance", &transmittance, py::arg("depth"), py::arg("alpha"), py::arg("d"),
          R"(The share of light left behind flat absorbers: the product of 1 - alpha over all whose depth is at most d.

depth (n,) and alpha (n,) in [0, 1], in any order; d (m,). Returns (m,) float64.

>>> reference.transmittance(depth=[0.25, 0.75], alpha=[0.5, 0.5], d=[0.0, 0.5, 1.0]).tolist()
[1.0, 0.5, 0.25]
)");
    m.def("column", &column, py::arg("scene"), py::arg("start"), py::arg("end"), py::arg("medium") = 0,
          R"(The integral of one medium's density along segments, in metres times density. Exact but for rounding.

start (..., 3) and end (..., 3), metres in world space; medium, its index in the order of Scene.add_medium. Returns
(...) float64. The density is trilinear between cell centres and zero off the grid.
Raises ValueError for wrong shapes, values that are not finite and a medium that the scene does not have.

>>> import numpy as np
>>> scene = Scene()
>>> scene.add_medium(np.full((4, 4, 4), 0.5), np.eye(4), scattering=(1, 1, 1), absorption=(0, 0, 0))
>>> reference.column(scene, [[2, 2, -9], [2, 2, 1]], [[2, 2, 9], [2, 2, 3]]).round(12).tolist()
[2.0, 1.0]
)");
    m.def("render", &render, py::arg("scene"), py::arg("camera"), py::arg("width"), py::arg("height"),
          py::arg("sun_samples_per_axis") = reference::Settings{}.sun_samples_per_axis,
          py::arg("step") = reference::Settings{}.step,
          py::arg("light_samples_per_axis") = reference::Settings{}.light_samples_per_axis,
          R"(The image of a scene with single scattering: (height, width, 4) float64, row 0 at the bottom.

One ray through the centre of each pixel, premultiplied scene-linear RGBA. Each light, sun or not, is sampled in
sun_samples_per_axis squared parts from surfaces and in light_samples_per_axis squared parts from the smoke; step is
the longest step along view rays in metres, well below the size of a cell. Lights themselves are not seen.

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> reference.render(scene, Camera(np.eye(4)), width=2, height=1)[0, 0].tolist()
[0.25, 0.5, 1.0, 0.0]

A lamp of pi W/sr, 2 m away from a white wall, gives it an irradiance of pi / 4:

>>> scene.add_point((0, 0, -2), intensity=(np.pi, np.pi, np.pi))
>>> wall = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
>>> scene.add_mesh(wall, [[0, 1, 2]], [[[0, 0, 1]] * 3], [0], [[1, 1, 1]])
>>> reference.render(scene, Camera(np.eye(4)), width=1, height=1)[0, 0].round(6).tolist()
[0.25, 0.25, 0.25, 1.0]
)");
    bind_reference_microfacet(m);
    bind_reference_transfer(m);
}

} // namespace sfumato
