// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays in a few bytes each, and the choice of how.
#include "module/parts.hpp"
#include "module/rays.hpp"
#include "rays/choose_basis.hpp"
#include "rays/curve.hpp"

namespace sfumato {
namespace {

using namespace arguments;

py::array_t<std::uint8_t> store_rays(const Choice &choice, const py::object &depth, const py::object &optical_depth,
                                     float width) {
    const Rays rays(depth, optical_depth, width);
    const std::size_t bytes = choice.bytes();
    std::vector<std::uint8_t> out(rays.count * bytes);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; ray < rays.count; ++ray) {
            store(choice, rays.at(ray), std::span(out).subspan(ray * bytes, bytes));
        }
    }
    return to_numpy(std::move(out), rays.shape_with(bytes));
}

py::array_t<float> look_up_rays(const Choice &choice, const Bytes &texels, const py::object &depths_given) {
    auto shape = batch_of(texels, "texels");
    const Floats depth(any_array(depths_given, "depth"));
    require_same_batch(shape, "texels, " + shape_of(texels), depth);
    const std::size_t bytes = last_axis(texels), depths = last_axis(depth);
    if (bytes != choice.bytes()) {
        throw py::value_error("texels has " + std::to_string(bytes) + " bytes a ray, but " + choice.name() + " has " +
                              std::to_string(choice.bytes()));
    }
    require_range(depth, 0.0F, 1.0F, "depth");
    std::vector<float> out(static_cast<std::size_t>(depth.size()));
    {
        const py::gil_scoped_release unlocked;
        look_up(choice, {texels.data(), static_cast<std::size_t>(texels.size())}, {depth.data(), out.size()}, out);
    }
    shape.push_back(static_cast<py::ssize_t>(depths));
    return to_numpy(std::move(out), shape);
}

Choice curve_choice() {
    Choice choice;
    choice.curve = true;
    return choice;
}

Choice choose(const py::object &depth, const py::object &optical_depth, int bytes, bool additive, float width) {
    const Rays rays(depth, optical_depth, width);
    if (rays.count == 0) {
        throw py::value_error("depth has shape " + shape_of(rays.z) + ", but must hold at least one ray");
    }
    require_range(bytes, 8, 64, "bytes");
    const py::gil_scoped_release unlocked;
    return choose_basis(rays.all(), static_cast<std::size_t>(bytes), additive);
}

} // namespace

void bind_ray_storage(py::module_ &m) {
    py::class_<Choice>(m, "RayStorage", R"(A way to store light rays in a few bytes each, chosen by choose_basis.

RayStorage() is the resolved curve: 20 bytes, straight lines of transmittance between nine knots that are fitted to each
ray. Transmittance falls with depth and is exact in front of and behind all absorbers. Texels can neither be added nor
filtered: filter what comes back.

>>> import numpy as np
>>> curve = RayStorage()
>>> texels = curve.store(np.array([0.2, 0.7]), np.array([1.0, 1.0]))
>>> curve.transmittance(texels, np.array([0.1, 0.5, 0.9])).astype(float).round(2).tolist()
[1.0, 0.37, 0.14]
)")
        .def(py::init(&curve_choice))
        .def_property_readonly("name", &Choice::name,
                               "'curve', or a basis and its range: 'cosine-range', 'learned-both', ...")
        .def_property_readonly(
            "additive", [](const Choice &c) { return !c.curve; },
            "Whether coefficients, before they are stored, add and filter.")
        .def_property_readonly("bytes", &Choice::bytes, "A texel.")
        .def_property_readonly(
            "coefficients", [](const Choice &c) { return c.curve ? 2 * CURVE_KNOTS : c.series.count; },
            "Numbers a texel, besides its range and total.")
        .def_readonly("error", &Choice::error, "Root mean square error of transmittance over the judging rays.")
        .def_readonly("reason", &Choice::reason, "What was measured, against what; empty where nothing was.")
        .def("store", &store_rays, py::arg("depth"), py::arg("optical_depth"), py::arg("width") = 0.0F,
             R"((..., bytes) uint8 of absorbers as in project.

>>> import numpy as np
>>> RayStorage().store(np.full((4, 3), 0.5), np.ones((4, 3))).shape
(4, 20)
)")
        .def("transmittance", &look_up_rays, py::arg("texels"), py::arg("depth"),
             R"((..., d) float32 at depth (..., d) in [0, 1].

>>> import numpy as np
>>> storage = RayStorage()
>>> storage.transmittance(storage.store(np.array([0.5]), np.array([1e9])), np.array([0.4, 0.6])).round(6).tolist()
[1.0, 0.0]
)");
    m.def("choose_basis", &choose, py::arg("depth"), py::arg("optical_depth"), py::arg("bytes") = 20,
          py::arg("additive") = false, py::arg("width") = 0.0F,
          R"(The RayStorage that serves a sample of a scene's rays best in at most `bytes` a texel, and why.

depth (..., n), optical_depth (..., n) and width as in project. Every basis with every range, and the curve unless only
additive storage will do, stores half of the rays and is judged by the exact transmittance; learned bases learn from
the other half. Equal samples, equal choices.

>>> import numpy as np
>>> z = np.random.default_rng(1).uniform(0.2, 0.8, (8, 3))
>>> choose_basis(z, np.full(z.shape, 0.5), additive=True).name
'cosine-range'
>>> choose_basis(z, np.full(z.shape, 0.5)).reason  # doctest: +ELLIPSIS
"curve: RMS error of T ...e-3 on 4 of the scene's rays at 20 bytes, against ...e-3 of cosine-range"
)");
}

} // namespace sfumato
