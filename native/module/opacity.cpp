// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/opacity.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"

namespace sfumato {
namespace {

using namespace arguments;

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
    m.def("henyey_greenstein", &phase, py::arg("cos_theta"), py::arg("anisotropy") = 0.0F,
          R"(Phase function of Henyey and Greenstein (1941), per steradian; cos_theta (...) is the cosine between the
directions of travel before and after scattering, anisotropy g in (-1, 1).

>>> import numpy as np
>>> (henyey_greenstein(np.array([-1.0, 1.0]), 0.5) * 4 * np.pi).round(3).tolist()
[0.222, 6.0]
)");
}

} // namespace sfumato
