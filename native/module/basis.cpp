// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays as coefficients of a basis.
#include "module/parts.hpp"
#include "module/rays.hpp"
#include "rays/learned_basis.hpp"

#include <variant>

#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

using BasisArgument = std::variant<std::string, const Series *>;

Series series_of(const BasisArgument &basis, std::optional<std::size_t> count) {
    if (const auto *learned = std::get_if<const Series *>(&basis)) {
        if (*learned == nullptr) {
            throw py::value_error("basis is None, but must be a name or a LearnedBasis");
        }
        if (count && *count != (*learned)->count) {
            throw py::value_error("coefficients is " + std::to_string(*count) + ", but the learned basis has " +
                                  std::to_string((*learned)->count));
        }
        return **learned;
    }
    const auto name =
        static_cast<BasisName>(one_of<3>(std::get<std::string>(basis), {"fourier", "cosine", "piecewise"}, "basis"));
    Series series{name, count.value_or(7), {}};
    require_coefficients(series.basis(), series.count);
    return series;
}

py::object project_rays(const py::object &depth, const py::object &optical_depth, std::optional<int> coefficients,
                        float width, const BasisArgument &basis, const OptionalFloats &range) {
    const Rays rays(depth, optical_depth, width);
    if (coefficients) {
        require_range(*coefficients, 1, 1 << 20, "coefficients");
    }
    const Series series =
        series_of(basis, coefficients ? std::optional(static_cast<std::size_t>(*coefficients)) : std::nullopt);
    const std::vector<Range> ranges = ranges_of(range, rays.shape);
    std::vector<float> out(rays.count * series.count, 0.0F);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; ray < rays.count; ++ray) {
            project(series, rays.at(ray), ranges[ray], std::span(out).subspan(ray * series.count, series.count));
        }
    }
    return as_given(rays.given, to_numpy(std::move(out), rays.shape_with(series.count)));
}

py::object transmittance_of_rays(const py::object &coefficients, const py::object &depth, const BasisArgument &basis,
                                 const OptionalFloats &range, const std::string &evaluator) {
    const py::array given = any_array(coefficients, "coefficients");
    const Floats c(given), d(any_array(depth, "depth"));
    auto shape = batch_of(c, "coefficients");
    require_same_batch(shape, "coefficients, " + shape_of(c), d);
    const Series series = series_of(basis, last_axis(c));
    require_finite(c, "coefficients");
    require_range(d, 0.0F, 1.0F, "depth");
    const auto how = static_cast<Evaluator>(one_of<2>(evaluator, {"clamp", "monotone"}, "evaluator"));
    const std::vector<Range> ranges = ranges_of(range, shape);
    const std::size_t depths = last_axis(d);
    std::vector<float> out(static_cast<std::size_t>(d.size()));
    {
        const py::gil_scoped_release unlocked;
        const RayEvaluator evaluate(series, how);
        for (std::size_t ray = 0; ray < ranges.size(); ++ray) {
            evaluate({c.data() + ray * series.count, series.count}, ranges[ray], {d.data() + ray * depths, depths},
                     std::span(out).subspan(ray * depths, depths));
        }
    }
    shape.push_back(static_cast<py::ssize_t>(depths));
    return as_given(given, to_numpy(std::move(out), shape));
}

py::object transmittance_before_receivers(const py::object &coefficients, const py::object &depth,
                                          const py::object &optical_depth, const BasisArgument &basis,
                                          const OptionalFloats &range, float width) {
    const Floats c(any_array(coefficients, "coefficients"));
    const Rays receivers(depth, optical_depth, width);
    require_same_batch(batch_of(c, "coefficients"), "coefficients, " + shape_of(c), receivers.z);
    const Series series = series_of(basis, last_axis(c));
    require_finite(c, "coefficients");
    const std::vector<Range> ranges = ranges_of(range, receivers.shape);
    const std::size_t each = last_axis(receivers.z);
    std::vector<float> out(receivers.count * each);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; ray < receivers.count; ++ray) {
            transmittance_before(series, {c.data() + ray * series.count, series.count}, ranges[ray], receivers.at(ray),
                                 std::span(out).subspan(ray * each, each));
        }
    }
    return as_given(receivers.given, to_numpy(std::move(out), receivers.shape_with(each)));
}

py::array_t<float> range_of_rays(const py::object &depth, const py::object &optical_depth, const std::string &kind,
                                 float q, float width) {
    const Rays rays(depth, optical_depth, width);
    const RangeKind chosen = range_kind(kind);
    require_range(q, 0.01F, 100.0F, "q");
    std::vector<float> out;
    for (std::size_t ray = 0; ray < rays.count; ++ray) {
        const Range range = depth_range(rays.at(ray), chosen, q);
        out.insert(out.end(), {range.low, range.high});
    }
    return to_numpy(std::move(out), rays.shape_with(2));
}

Series learn(const py::object &depth, const py::object &optical_depth, int coefficients, const OptionalFloats &range,
             float width, int cells) {
    const Rays rays(depth, optical_depth, width);
    require_range(coefficients, 1, 64, "coefficients");
    require_range(cells, 2, 256, "cells");
    const std::vector<Range> ranges = ranges_of(range, rays.shape);
    const py::gil_scoped_release unlocked;
    return learn_basis(rays.all(), ranges, static_cast<std::size_t>(coefficients), static_cast<std::size_t>(cells));
}

py::array_t<std::uint8_t> pack_rays(const py::object &given, const BasisArgument &basis, const OptionalFloats &range) {
    const Floats coefficients(any_array(given, "coefficients"));
    auto shape = batch_of(coefficients, "coefficients");
    const Series series = series_of(basis, last_axis(coefficients));
    require_finite(coefficients, "coefficients");
    const std::vector<Range> ranges = ranges_of(range, shape);
    const std::size_t bytes = texel_bytes(series);
    std::vector<std::uint8_t> out(ranges.size() * bytes);
    for (std::size_t ray = 0; ray < ranges.size(); ++ray) {
        pack(series, {coefficients.data() + ray * series.count, series.count}, ranges[ray],
             std::span(out).subspan(ray * bytes, bytes));
    }
    shape.push_back(static_cast<py::ssize_t>(bytes));
    return to_numpy(std::move(out), shape);
}

py::tuple unpack_rays(const Bytes &texels, const BasisArgument &basis) {
    auto shape = batch_of(texels, "texels");
    const std::size_t bytes = last_axis(texels);
    if (bytes <= HEAD_BYTES) {
        throw py::value_error("texels has " + std::to_string(bytes) + " bytes a ray, but must have more than " +
                              std::to_string(HEAD_BYTES));
    }
    const auto *name = std::get_if<std::string>(&basis);
    const Series probe = series_of(basis, name != nullptr ? std::optional<std::size_t>(1) : std::nullopt);
    const Series series = series_of(basis, bytes - HEAD_BYTES + (probe.basis().leading ? 1 : 0));
    std::vector<float> out(product(shape) * series.count), ranges;
    for (std::size_t ray = 0; ray * series.count < out.size(); ++ray) {
        const Range range = unpack(series, {texels.data() + ray * bytes, bytes},
                                   std::span(out).subspan(ray * series.count, series.count));
        ranges.insert(ranges.end(), {range.low, range.high});
    }
    auto pairs = shape;
    shape.push_back(static_cast<py::ssize_t>(series.count));
    pairs.push_back(2);
    return py::make_tuple(to_numpy(std::move(out), shape), to_numpy(std::move(ranges), pairs));
}

std::vector<py::ssize_t> table_shape(const Series &series, std::size_t more) {
    return {static_cast<py::ssize_t>(series.count), static_cast<py::ssize_t>(series.tables.cells + more)};
}

} // namespace

void bind_basis(py::module_ &m) {
    py::class_<Series>(m, "LearnedBasis", R"(The functions that learn_basis made from a sample of rays.

>>> import numpy as np
>>> basis = learn_basis(np.array([[0.2, 0.4], [0.5, 0.9]]), np.ones((2, 2)), coefficients=2, cells=10)
>>> basis.density.shape, basis.integral.shape
((2, 10), (2, 11))
)")
        .def_property_readonly(
            "coefficients", [](const Series &s) { return s.count; }, "How many functions there are.")
        .def_property_readonly(
            "density", [](const Series &s) { return to_numpy(std::vector<float>(s.tables.f), table_shape(s, 0)); },
            "(coefficients, cells): F_k, constant over each cell.")
        .def_property_readonly(
            "integral", [](const Series &s) { return to_numpy(std::vector<float>(s.tables.g), table_shape(s, 1)); },
            "(coefficients, cells + 1): G_k at the edges of the cells, straight between them.");
    m.def("learn_basis", &learn, py::arg("depth"), py::arg("optical_depth"), py::arg("coefficients") = 15,
          py::arg("range") = py::none(), py::arg("width") = 0.0F, py::arg("cells") = 64,
          R"(The basis in which rays like these need the fewest coefficients: Karhunen and Loeve's, of their cumulative
optical depth on `cells` depths of each ray's range.

depth (..., n), optical_depth (..., n), width and range as in project. A quarter of a frame's rays teach enough; a
basis of an earlier frame does not fit. The first coefficient is the total, and both ends of the range are exact.

>>> import numpy as np
>>> basis = learn_basis(np.array([[0.2, 0.4], [0.5, 0.9]]), np.ones((2, 2)), coefficients=2)
>>> c = project(np.array([0.2, 0.4]), np.ones(2), basis=basis)
>>> transmittance(c, np.array([0.3, 1.0]), basis=basis).round(3).tolist()
[0.368, 0.135]
)");
    m.def("project", &project_rays, py::arg("depth"), py::arg("optical_depth"), py::arg("coefficients") = py::none(),
          py::arg("width") = 0.0F, py::arg("basis") = "fourier", py::arg("range") = py::none(),
          R"(Coefficients of absorbers along light rays: eqs 1-2 and 5-6 of Jansen and Bavoil (2010), or their like.

depth (..., n) in [0, 1] and optical_depth (..., n), not negative, of n absorbers in any order; width, the extent in
depth of each (0 for flat particles). Returns (..., coefficients), by default 7. Coefficients of several sets of
absorbers in one range add. basis:

- 'fourier': a0, a1, b1, a2, b2, ..., an odd number;
- 'cosine': half-range cosines, whose ends are not neighbours;
- 'piecewise': optical depth per slice, the opacity shadow maps of Kim and Neumann (2001);
- what learn_basis made: as many as it has.

range (..., 2), low and high for each ray (depth_range), is what the basis spans; without one it spans [0, 1].

>>> import numpy as np
>>> project(np.array([0.25, 0.75]), np.array([1.0, 1.0]), coefficients=1).tolist()
[4.0]
>>> project(np.array([0.2, 0.3]), np.array([1.0, 2.0]), 4, basis="piecewise").tolist()
[1.0, 2.0, 0.0, 0.0]
)");
    m.def("transmittance", &transmittance_of_rays, py::arg("coefficients"), py::arg("depth"),
          py::arg("basis") = "fourier", py::arg("range") = py::none(), py::arg("evaluator") = "clamp",
          R"(The share of light that reaches each depth: exp of minus eq 3 of Jansen and Bavoil (2010).

coefficients (..., m) with the basis and range of project, depth (..., d) in [0, 1]. Returns (..., d) in [0, 1], exact
at both ends of the range. evaluator 'clamp' keeps the optical depth between 0 and the total; 'monotone' takes the mean
of its running maximum from the front and its running minimum from behind, which never falls with depth.

>>> import numpy as np
>>> transmittance(project(np.array([0.5]), np.array([np.log(2.0)])), np.array([0.0, 1.0])).round(6).tolist()
[1.0, 0.5]
)");
    m.def("transmittance_before", &transmittance_before_receivers, py::arg("coefficients"), py::arg("depth"),
          py::arg("optical_depth"), py::arg("basis") = "fourier", py::arg("range") = py::none(),
          py::arg("width") = 0.0F,
          R"(The share of light that reaches the front of receivers which are among the absorbers, such as strands of
hair: what the series holds of a receiver's own optical depth is taken off (shaders/rays/opacity.glsl, self_harmonic).

coefficients (..., m) with the basis and range of project, of all absorbers; depth and optical_depth (..., n) of those
that receive, width as in project. Returns (..., n) in [0, 1].

>>> import numpy as np
>>> alone = np.array([0.3]), np.array([1.0])
>>> transmittance_before(project(*alone), *alone).tolist()
[1.0]
>>> transmittance(project(*alone), alone[0]).round(2).tolist()
[0.64]
)");
    m.def("depth_range", &range_of_rays, py::arg("depth"), py::arg("optical_depth"), py::arg("kind") = "minmax",
          py::arg("q") = 3.0F, py::arg("width") = 0.0F,
          R"(Low and high depth of the absorbers of each ray: (..., 2) float32, as a texel can store them.

kind 'whole': 0 and 1; 'minmax': all of them, with 5 % and .001 to spare; 'moments': mean -+ q standard deviations,
which can be had from sums; 'both': what the last two have in common; 'trimmed': as
'minmax', without the thin ends that hold .002 of the optical depth each. depth, optical_depth, width as in project.

>>> import numpy as np
>>> depth_range(np.array([0.25, 0.75]), np.array([1.0, 1.0])).astype(float).round(3).tolist()
[0.224, 0.776]
)");
    m.def("pack", &pack_rays, py::arg("coefficients"), py::arg("basis") = "fourier", py::arg("range") = py::none(),
          R"(Texels of 8 bits a coefficient: (..., bytes) uint8. Range in 2 x 16 bits, total as a half float, then the
coefficients relative to the largest that the total allows; 'fourier', 'cosine' and learned bases leave out the first,
which the total tells. So 15 of them take 20 bytes. Only for storage: texels do not add.

>>> import numpy as np
>>> pack(project(np.array([0.5]), np.array([1.0]), 15)).shape
(20,)
)");
    m.def("unpack", &unpack_rays, py::arg("texels"), py::arg("basis") = "fourier",
          R"(The coefficients (..., n) and range (..., 2) of texels that pack made with the same basis.

>>> import numpy as np
>>> coefficients, range = unpack(pack(np.array([2.0, 0.5, -0.25])))
>>> coefficients.round(2).tolist(), range.tolist()
([2.0, 0.5, -0.25], [0.0, 1.0])
)");
}

} // namespace sfumato
