// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture is taken with.
#include "scene/exposure.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"

#include <cmath>
#include <optional>
#include <string>

#include <glm/geometric.hpp>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

Exposure make_exposure(const py::list &cameras, float radius, float focus, float near, int blades, float rotation,
                       float ratio, const std::optional<Floats> &shutter) {
    Exposure out;
    for (const py::handle &each : cameras) {
        if (!py::isinstance<Camera>(each)) {
            throw py::value_error("cameras holds " + told(each) + ", but must hold a Camera each");
        }
        out.cameras.push_back(each.cast<Camera>());
    }
    if (out.cameras.empty()) {
        throw py::value_error("cameras is empty, but a picture is taken from somewhere");
    }
    for (std::size_t i = 1; i < out.cameras.size(); ++i) {
        const Camera &a = out.cameras[i - 1], &b = out.cameras[i];
        if (!(glm::dot(a.near[1], b.near[1]) > 0.0F && glm::dot(a.near[2], b.near[2]) > 0.0F)) {
            throw py::value_error("cameras[" + std::to_string(i) +
                                  "] is turned by a right angle or more from the one " +
                                  "before it: between them there is none that sees anything");
        }
    }
    require_range(radius, 0.0F, 1e6F, "lens_radius");
    require_range(focus, 1e-6F, 1e30F, "focus");
    require_range(near, 0.0F, 1e30F, "near");
    require_range(blades, 0, 1024, "blades");
    require_range(rotation, -1e6F, 1e6F, "rotation");
    require_range(ratio, 1e-3F, 1e3F, "ratio");
    if (shutter) {
        require_shape(*shutter, {-1}, "shutter");
        require_finite(*shutter, "shutter");
        out.shutter.assign(shutter->data(), shutter->data() + shutter->size());
        for (std::size_t i = 0; i < out.shutter.size(); ++i) {
            require_range(out.shutter[i], i == 0 ? 0.0F : out.shutter[i - 1], 1.0F,
                          "shutter[" + std::to_string(i) + "]");
        }
        if (out.shutter.size() == 1) {
            throw py::value_error("shutter has 1 time, but needs 2 or more, or none");
        }
    }
    out.lens = {radius, focus, near, blades, rotation, ratio};
    out.moves = true;
    return out;
}

} // namespace

void bind_exposure(py::module_ &m) {
    py::class_<Exposure>(m, "Exposure", R"(What a picture is taken with, where a Camera alone would be sharp and still.

cameras, at even times from the opening of the shutter to its closing; one that does not move. shutter: at even shares of
the light that comes in, the times by which it has, not falling, 0 at the opening and 1 at the closing; by default it
comes in evenly. The lens is thin: lens_radius of its aperture in metres, 0 for none; all is sharp at `focus` metres along
the camera's axis, whose near plane is `near` metres away. The aperture has `blades` corners, turned by `rotation` radians,
or is round where these are less than three; `ratio` is its height over its width.
Raises ValueError where one of these cannot be.

>>> import numpy as np
>>> exposure = Exposure([Camera(np.eye(4))], lens_radius=0.1, focus=2.0, near=1.0)
>>> Frame(Scene()).render(exposure, width=2, height=1).shape
(1, 2, 4)
)")
        .def(py::init(&make_exposure), py::arg("cameras"), py::arg("lens_radius") = Lens{}.radius,
             py::arg("focus") = Lens{}.focus, py::arg("near") = Lens{}.near, py::arg("blades") = Lens{}.blades,
             py::arg("rotation") = Lens{}.rotation, py::arg("ratio") = Lens{}.ratio, py::arg("shutter") = py::none());
}

} // namespace sfumato
