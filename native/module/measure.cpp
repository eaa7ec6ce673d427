// SPDX-License-Identifier: GPL-3.0-or-later
// The measured error of a picture.
#include "frame/measure.hpp"

#include "frame/frame.hpp"
#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "module/rays.hpp"
#include "module/scene_parts.hpp"

#include <algorithm>
#include <string>

#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

Measured measure(const Frame &frame, const Camera &camera, const Floats &picture, int pixels, std::uint64_t seed,
                 const std::optional<Measured> &earlier, const std::string &filter, float filter_width) {
    if (picture.ndim() != 3 || picture.shape(2) != 4 || picture.size() == 0) {
        throw py::value_error("picture has shape " + shape_of(picture) + ", but must have (height, width, 4)");
    }
    require_finite(picture, "picture");
    require_range(pixels, 16, 1 << 20, "pixels");
    require_range(filter_width, 0.01F, 10.0F, "filter_width");
    const auto shape = one_of<3>(filter, {"blackman_harris", "gaussian", "box"}, "filter");
    const py::gil_scoped_release unlocked;
    const std::span<const float> values(picture.data(), static_cast<std::size_t>(picture.size()));
    Measured out = frame.measure(camera, static_cast<int>(picture.shape(1)), static_cast<int>(picture.shape(0)), values,
                                 {static_cast<Filter::Shape>(shape), filter_width}, pixels, seed);
    if (earlier) {
        out.add(*earlier);
    }
    return out;
}

} // namespace

void bind_measure(py::module_ &m) {
    py::class_<Measured>(m, "Measured", R"(What Frame.measure finds: the error of a picture against what it would be at
converged settings, as the root of the mean squared difference of all pixels and colours over the mean of its colours.

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> frame, camera = Frame(scene), Camera(np.eye(4))
>>> measured = frame.measure(camera, 1.5 * frame.render(camera, 16, 16))
>>> round(measured.reported, 2), measured.pixels, measured.frames, measured.unmeasured
(0.38, 256, 1, [])
)")
        .def_readonly("reported", &Measured::reported, "The estimate.")
        .def_readonly("low", &Measured::low, "With high, where the error is with a probability of 95 %.")
        .def_readonly("high", &Measured::high, "See low.")
        .def_readonly("pixels", &Measured::pixels, "How many were looked at, of all frames.")
        .def_readonly("frames", &Measured::frames, "How many frames these are of.")
        .def_readonly("seconds", &Measured::seconds, "That the last of them took.")
        .def_readonly("unmeasured", &Measured::unmeasured, "What of the picture is taken for right.")
        .def("__repr__", [](const Measured &measured) {
            return "<Measured " + std::to_string(measured.reported) + ", in [" + std::to_string(measured.low) + ", " +
                   std::to_string(measured.high) + "], of " + std::to_string(measured.pixels) + " pixels>";
        });

    // Of a class that frame.cpp has.
    const py::object frame = m.attr("Frame");
    frame.attr("measure") = py::cpp_function(
        &measure, py::name("measure"), py::is_method(frame), py::arg("camera"), py::arg("picture"),
        py::arg("pixels") = 256, py::arg("seed") = 0, py::arg("earlier") = py::none(),
        py::arg("filter") = "blackman_harris", py::arg("filter_width") = Filter{}.width,
        R"(The error of a picture (height, width, 4) that render() or passes() of this frame made of a camera
without lens and motion, a Measured. At
about so many `pixels` of it, chosen by `seed` and by where it changes most, many samples are followed at fine steps, and
from a part of these steps, and from surfaces, the way to a random point of each light is marched through the smoke
instead of being looked up in light maps. What `earlier` frames found, a Measured, is counted with it. filter and
filter_width are those of passes().

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> frame, camera = Frame(scene), Camera(np.eye(4))
>>> picture = frame.render(camera, 16, 16)
>>> first = frame.measure(camera, picture, pixels=64)
>>> first.reported < 1e-6, frame.measure(camera, picture, pixels=64, seed=1, earlier=first).pixels
(True, 128)
)");
}

} // namespace sfumato
