// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_arguments.hpp"
#include "module_parts.hpp"
#include "opacity.hpp"

namespace sfumato {
namespace {

using namespace arguments;

// The result keeps the caller's precision.
py::object as_given(const py::array &given, const py::array_t<float> &result) {
    return given.dtype().is(py::dtype::of<double>()) ? result.attr("astype")(py::dtype::of<double>())
                                                     : py::object(result);
}

std::vector<py::ssize_t> batch_of(const Floats &array, const std::string &name) {
    if (array.ndim() < 1) {
        throw py::value_error(name + " is a single number, but must have at least one axis");
    }
    return {array.shape(), array.shape() + array.ndim() - 1};
}

void require_coefficients(py::ssize_t count) {
    if (count < 1 || count % 2 == 0) {
        throw py::value_error("coefficients is " + std::to_string(count) +
                              ", but must be odd and at least 1: a constant and pairs of harmonics");
    }
}

py::object project(const py::object &depth, const py::object &optical_depth, int coefficients, float width) {
    const py::array given = any_array(depth, "depth");
    const Floats z(given), tau(any_array(optical_depth, "optical_depth"));
    auto shape = batch_of(z, "depth");
    if (z.ndim() != tau.ndim() || !std::equal(z.shape(), z.shape() + z.ndim(), tau.shape())) {
        throw py::value_error("optical_depth has shape " + shape_of(tau) + ", but must have that of depth, " +
                              shape_of(z));
    }
    require_range(z, 0.0F, 1.0F, "depth");
    require_range(tau, 0.0F, 1e30F, "optical_depth");
    require_range(width, 0.0F, 1.0F, "width");
    require_coefficients(coefficients);
    const auto fragments = static_cast<std::size_t>(z.shape(z.ndim() - 1));
    const std::size_t rays = fragments == 0 ? 0 : static_cast<std::size_t>(z.size()) / fragments;
    const auto count = static_cast<std::size_t>(coefficients);
    py::ssize_t batch = 1;
    for (const py::ssize_t size : shape) {
        batch *= size;
    }
    std::vector<float> out(static_cast<std::size_t>(batch) * count, 0.0F);
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; ray < rays; ++ray) {
            add_to_series({z.data() + ray * fragments, fragments}, {tau.data() + ray * fragments, fragments}, width,
                          std::span(out).subspan(ray * count, count));
        }
    }
    shape.push_back(coefficients);
    return as_given(given, to_numpy(std::move(out), shape));
}

py::object transmittance(const py::object &coefficients, const py::object &depth) {
    const py::array given = any_array(coefficients, "coefficients");
    const Floats series(given), d(any_array(depth, "depth"));
    auto shape = batch_of(series, "coefficients");
    const auto outer = batch_of(d, "depth");
    if (shape != outer) {
        throw py::value_error("depth has shape " + shape_of(d) +
                              ", but all axes other than the last must be those of " + "coefficients, " +
                              shape_of(series));
    }
    require_coefficients(series.shape(series.ndim() - 1));
    require_finite(series, "coefficients");
    require_range(d, 0.0F, 1.0F, "depth");
    const auto count = static_cast<std::size_t>(series.shape(series.ndim() - 1));
    const auto depths = static_cast<std::size_t>(d.shape(d.ndim() - 1));
    std::vector<float> out(static_cast<std::size_t>(d.size()));
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t ray = 0; depths > 0 && ray < out.size() / depths; ++ray) {
            series_transmittance({series.data() + ray * count, count}, {d.data() + ray * depths, depths},
                                 std::span(out).subspan(ray * depths, depths));
        }
    }
    shape.push_back(static_cast<py::ssize_t>(depths));
    return as_given(given, to_numpy(std::move(out), shape));
}

py::object phase(const py::object &cos_theta, float anisotropy) {
    const py::array given = any_array(cos_theta, "cos_theta");
    const Floats cosines(given);
    require_range(cosines, -1.0F, 1.0F, "cos_theta");
    require_range(anisotropy, -0.9999F, 0.9999F, "anisotropy");
    std::vector<float> out(static_cast<std::size_t>(cosines.size()));
    {
        const py::gil_scoped_release unlocked;
        henyey_greenstein({cosines.data(), out.size()}, anisotropy, out);
    }
    return as_given(given, to_numpy(std::move(out), {cosines.shape(), cosines.shape() + cosines.ndim()}));
}

} // namespace

void bind_opacity(py::module_ &m) {
    m.def("project", &project, py::arg("depth"), py::arg("optical_depth"), py::arg("coefficients") = 7,
          py::arg("width") = 0.0F,
          R"(Fourier coefficients of absorbers along light rays: eqs 1-2 and 5-6 of Jansen and Bavoil (2010).

depth (..., n) in [0, 1] and optical_depth (..., n), not negative, of n absorbers in any order; width, the extent in
depth of each (0 for flat particles). Returns (..., coefficients): a0, a1, b1, a2, b2, ... Coefficients of several
sets of absorbers add.

>>> import numpy as np
>>> project(np.array([0.25, 0.75]), np.array([1.0, 1.0]), coefficients=1).tolist()
[4.0]
)");
    m.def("transmittance", &transmittance, py::arg("coefficients"), py::arg("depth"),
          R"(The share of light that reaches each depth: exp of minus eq 3 of Jansen and Bavoil (2010).

coefficients (..., m) with m odd, depth (..., d) in [0, 1]. Returns (..., d) in [0, 1], exact at depths 0 and 1.

>>> import numpy as np
>>> transmittance(project(np.array([0.5]), np.array([np.log(2.0)])), np.array([0.0, 1.0])).round(6).tolist()
[1.0, 0.5]
)");
    m.def("henyey_greenstein", &phase, py::arg("cos_theta"), py::arg("anisotropy") = 0.0F,
          R"(Phase function of Henyey and Greenstein (1941), per steradian; cos_theta (...) is the cosine between the
directions of travel before and after scattering, anisotropy g in (-1, 1).

>>> import numpy as np
>>> (henyey_greenstein(np.array([-1.0, 1.0]), 0.5) * 4 * np.pi).round(3).tolist()
[0.222, 6.0]
)");
}

} // namespace sfumato
