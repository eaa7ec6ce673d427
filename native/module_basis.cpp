// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays as coefficients of a basis, as resolved curves, and the choice between them.
#include "choose_basis.hpp"
#include "curve.hpp"
#include "learned_basis.hpp"
#include "module_arguments.hpp"
#include "module_parts.hpp"

#include <optional>
#include <variant>

#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

using Bytes = py::array_t<std::uint8_t, py::array::c_style>;
using BasisArgument = std::variant<std::string, const Series *>;
using OptionalFloats = std::optional<Floats>;

template <typename Array>
std::vector<py::ssize_t> batch_of(const Array &array, const std::string &name) {
    if (array.ndim() < 1) {
        throw py::value_error(name + " is a single number, but must have at least one axis");
    }
    return {array.shape(), array.shape() + array.ndim() - 1};
}

std::size_t product(const std::vector<py::ssize_t> &shape) {
    std::size_t out = 1;
    for (const py::ssize_t size : shape) {
        out *= static_cast<std::size_t>(size);
    }
    return out;
}

template <typename Array>
std::size_t last_axis(const Array &array) {
    return static_cast<std::size_t>(array.shape(array.ndim() - 1));
}

// `text` as an index into names, or a refusal that lists them.
template <std::size_t N>
std::size_t one_of(const std::string &given, const std::array<const char *, N> &names, const std::string &name) {
    std::string all;
    for (std::size_t i = 0; i < N; ++i) {
        if (given == names[i]) {
            return i;
        }
        all += (i > 0 ? ", " : "") + std::string("'") + names[i] + "'";
    }
    throw py::value_error(name + " is '" + given + "', but must be one of " + all);
}

RangeKind range_kind(const std::string &kind) {
    return static_cast<RangeKind>(one_of<4>(kind, {"whole", "minmax", "moments", "both"}, "kind"));
}

void require_coefficients(const Basis &basis, std::size_t count) {
    if (count < 1 || (basis.odd && count % 2 == 0)) {
        throw py::value_error("coefficients is " + std::to_string(count) + ", but must be " +
                              (basis.odd ? "odd and at least 1: a constant and pairs of harmonics" : "at least 1"));
    }
}

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

// Checked absorbers of many rays.
struct Rays {
    Rays(const py::array &depth, const py::array &optical_depth, float slab_width)
        : z(depth), tau(optical_depth), width(slab_width), shape(batch_of(z, "depth")) {
        if (z.ndim() != tau.ndim() || !std::equal(z.shape(), z.shape() + z.ndim(), tau.shape())) {
            throw py::value_error("depth has shape " + shape_of(z) + " and optical_depth " + shape_of(tau) +
                                  ", but they must be equal");
        }
        require_range(z, 0.0F, 1.0F, "depth");
        require_range(tau, 0.0F, 1e30F, "optical_depth");
        require_range(width, 0.0F, 1.0F, "width");
        count = product(shape);
    }
    [[nodiscard]] Absorbers at(std::size_t ray) const {
        const std::size_t n = last_axis(z);
        return {{z.data() + ray * n, n}, {tau.data() + ray * n, n}, width};
    }
    [[nodiscard]] std::vector<Absorbers> all() const {
        std::vector<Absorbers> out;
        for (std::size_t ray = 0; ray < count; ++ray) {
            out.push_back(at(ray));
        }
        return out;
    }
    [[nodiscard]] std::vector<py::ssize_t> shape_with(std::size_t size) const {
        auto out = shape;
        out.push_back(static_cast<py::ssize_t>(size));
        return out;
    }

    Floats z, tau;
    float width;
    std::vector<py::ssize_t> shape;
    std::size_t count = 0;
};

// The range of every ray: given, or the whole depth.
std::vector<Range> ranges_of(const OptionalFloats &range, const std::vector<py::ssize_t> &batch) {
    std::vector<Range> out(product(batch));
    if (!range) {
        return out;
    }
    auto wanted = batch;
    wanted.push_back(2);
    if (range->ndim() != static_cast<py::ssize_t>(wanted.size()) ||
        !std::equal(wanted.begin(), wanted.end(), range->shape())) {
        throw py::value_error("range has shape " + shape_of(*range) +
                              ", but must have the axes of the rays, then 2: low and high");
    }
    require_finite(*range, "range");
    for (std::size_t ray = 0; ray < out.size(); ++ray) {
        const float *pair = range->data() + 2 * ray;
        if (pair[0] > pair[1]) {
            throw py::value_error("range holds " + text(pair[0]) + " before " + text(pair[1]) + " for ray " +
                                  std::to_string(ray) + ", but low must not exceed high");
        }
        out[ray] = {pair[0], pair[1]};
    }
    return out;
}

void require_same_batch(const std::vector<py::ssize_t> &a, const std::vector<py::ssize_t> &b,
                        const std::string &names) {
    if (a != b) {
        throw py::value_error(names + ", but all axes other than the last must be equal");
    }
}

py::object project_rays(const py::array &depth, const py::array &optical_depth, std::optional<int> coefficients,
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
    return as_given(depth, to_numpy(std::move(out), rays.shape_with(series.count)));
}

py::object transmittance_of_rays(const py::array &coefficients, const py::array &depth, const BasisArgument &basis,
                                 const OptionalFloats &range, const std::string &evaluator) {
    const Floats c(coefficients), d(depth);
    auto shape = batch_of(c, "coefficients");
    require_same_batch(shape, batch_of(d, "depth"),
                       "coefficients has shape " + shape_of(c) + " and depth " + shape_of(d));
    const Series series = series_of(basis, last_axis(c));
    require_finite(c, "coefficients");
    require_range(d, 0.0F, 1.0F, "depth");
    const auto how = static_cast<Evaluator>(one_of<2>(evaluator, {"clamp", "monotone"}, "evaluator"));
    const std::vector<Range> ranges = ranges_of(range, shape);
    const std::size_t depths = last_axis(d);
    std::vector<float> out(static_cast<std::size_t>(d.size()));
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; ray < ranges.size(); ++ray) {
            transmittance(series, {c.data() + ray * series.count, series.count}, ranges[ray], how,
                          {d.data() + ray * depths, depths}, std::span(out).subspan(ray * depths, depths));
        }
    }
    shape.push_back(static_cast<py::ssize_t>(depths));
    return as_given(coefficients, to_numpy(std::move(out), shape));
}

py::array_t<float> range_of_rays(const py::array &depth, const py::array &optical_depth, const std::string &kind,
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

Series learn(const py::array &depth, const py::array &optical_depth, int coefficients, const OptionalFloats &range,
             float width, int cells) {
    const Rays rays(depth, optical_depth, width);
    require_range(coefficients, 1, 64, "coefficients");
    require_range(cells, 2, 256, "cells");
    const std::vector<Range> ranges = ranges_of(range, rays.shape);
    const py::gil_scoped_release unlocked;
    return learn_basis(rays.all(), ranges, static_cast<std::size_t>(coefficients), static_cast<std::size_t>(cells));
}

py::array_t<std::uint8_t> pack_rays(const Floats &coefficients, const BasisArgument &basis,
                                    const OptionalFloats &range) {
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

py::array_t<std::uint8_t> store_rays(const Choice &choice, const py::array &depth, const py::array &optical_depth,
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

py::array_t<float> look_up_rays(const Choice &choice, const Bytes &texels, const Floats &depth) {
    auto shape = batch_of(texels, "texels");
    require_same_batch(shape, batch_of(depth, "depth"),
                       "texels has shape " + shape_of(texels) + " and depth " + shape_of(depth));
    const std::size_t bytes = last_axis(texels), depths = last_axis(depth);
    if (bytes != choice.bytes()) {
        throw py::value_error("texels has " + std::to_string(bytes) + " bytes a ray, but " + choice.name() + " has " +
                              std::to_string(choice.bytes()));
    }
    require_range(depth, 0.0F, 1.0F, "depth");
    std::vector<float> out(static_cast<std::size_t>(depth.size()));
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; depths > 0 && ray < out.size() / depths; ++ray) {
            look_up(choice, {texels.data() + ray * bytes, bytes}, {depth.data() + ray * depths, depths},
                    std::span(out).subspan(ray * depths, depths));
        }
    }
    shape.push_back(static_cast<py::ssize_t>(depths));
    return to_numpy(std::move(out), shape);
}

Choice curve_choice() {
    Choice choice;
    choice.curve = true;
    return choice;
}

Choice choose(const py::array &depth, const py::array &optical_depth, int bytes, bool additive, float width) {
    const Rays rays(depth, optical_depth, width);
    if (rays.count == 0) {
        throw py::value_error("depth has shape " + shape_of(rays.z) + ", but must hold at least one ray");
    }
    require_range(bytes, 8, 64, "bytes");
    const py::gil_scoped_release unlocked;
    return choose_basis(rays.all(), static_cast<std::size_t>(bytes), additive);
}

std::vector<py::ssize_t> table_shape(const Series &series, std::size_t more) {
    return {static_cast<py::ssize_t>(series.count), static_cast<py::ssize_t>(series.tables.cells + more)};
}

void bind_series(py::module_ &m) {
    py::class_<Series>(m, "LearnedBasis", R"(Functions learned from a sample of rays; see learn_basis.)")
        .def_property_readonly("coefficients", [](const Series &s) { return s.count; })
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
    m.def("depth_range", &range_of_rays, py::arg("depth"), py::arg("optical_depth"), py::arg("kind") = "minmax",
          py::arg("q") = 3.0F, py::arg("width") = 0.0F,
          R"(Low and high depth of the absorbers of each ray: (..., 2) float32, as a texel can store them.

kind 'whole': 0 and 1; 'minmax': all of them, with 5 % and .001 to spare; 'moments': mean -+ q standard deviations,
which can be had from sums; 'both': what the last two have in common. depth, optical_depth, width as in project.

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

} // namespace

void bind_basis(py::module_ &m) {
    bind_series(m);
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
        .def_property_readonly("name", &Choice::name)
        .def_property_readonly("additive", [](const Choice &c) { return !c.curve; })
        .def_property_readonly("bytes", &Choice::bytes, "A texel.")
        .def_property_readonly("coefficients",
                               [](const Choice &c) { return c.curve ? 2 * CURVE_KNOTS : c.series.count; })
        .def_readonly("error", &Choice::error, "Root mean square error of transmittance over the judging rays.")
        .def_readonly("reason", &Choice::reason)
        .def("store", &store_rays, py::arg("depth"), py::arg("optical_depth"), py::arg("width") = 0.0F,
             "(..., bytes) uint8 of absorbers as in project.")
        .def("transmittance", &look_up_rays, py::arg("texels"), py::arg("depth"),
             "(..., d) float32 at depth (..., d) in [0, 1].");
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
