// SPDX-License-Identifier: GPL-3.0-or-later
#include "module/microfacet.hpp"
#include "module/parts.hpp"
#include "reference/microfacet.hpp"

namespace sfumato {
namespace {

using namespace arguments;

// value(surface, light) for each light of the batch.
template <typename Value>
py::array_t<double> each(const RoughSurfaces<double> &surfaces, const Shape &batch, const Fresnel &how,
                         const Value &value) {
    std::vector<double> out(product(batch));
    {
        const py::gil_scoped_release unlocked;
        for (std::size_t i = 0; i < out.size(); ++i) {
            const double *v = surfaces.view.at(i), *a = surfaces.alpha.at(i);
            const auto facets = static_cast<reference::Facets>(surfaces.brdf);
            const auto [plain, fresnel] =
                value(reference::RoughSurface{facets, a[0], a[1], {v[0], v[1], v[2]}, how.index}, i);
            out[i] = reference::with_f0(plain, fresnel, how.f0);
        }
    }
    return to_numpy(std::move(out), batch);
}

bool by_area(const std::string &method) {
    return one_of<2>(method, {"outline", "area"}, "method") == 1;
}

py::array_t<double> polygon(const py::object &polygons, const py::object &view, const py::object &alpha,
                            const std::string &brdf, double f0, const py::object &counts, const std::string &method,
                            double index) {
    const Polygons<double> corners(polygons, counts);
    const RoughSurfaces<double> surfaces(view, alpha, brdf, corners.batch);
    const bool area = by_area(method);
    return each(surfaces, corners.batch, {f0, index}, [&](const reference::RoughSurface &surface, std::size_t i) {
        const auto points = corners.corners(i);
        return area ? reference::reflected_by_area(surface, points) : reference::reflected_by_outline(surface, points);
    });
}

template <typename Disk>
py::array_t<double> disks(const Shape &batch, const py::object &view, const py::object &alpha, const std::string &brdf,
                          const Fresnel &how, const std::string &method, const Disk &disk) {
    const RoughSurfaces<double> surfaces(view, alpha, brdf, batch);
    const bool area = by_area(method);
    return each(surfaces, batch, how, [&](const reference::RoughSurface &surface, std::size_t i) {
        const reference::DiskLight light = disk(i);
        return area ? reference::reflected_by_area(surface, light) : reference::reflected_by_outline(surface, light);
    });
}

glm::dvec3 vector_at(const double *v) {
    return {v[0], v[1], v[2]};
}

py::array_t<double> sphere(const py::object &centre, const py::object &radius, const py::object &view,
                           const py::object &alpha, const std::string &brdf, double f0, const std::string &method,
                           double index) {
    const SphereLights<double> lights(centre, radius);
    return disks(lights.batch, view, alpha, brdf, {f0, index}, method, [&](std::size_t i) {
        const double *light = lights.numbers.data() + 4 * i;
        return reference::disk_of_sphere(vector_at(light), light[3]);
    });
}

py::array_t<double> ellipse(const py::object &centre, const py::object &u, const py::object &v, const py::object &view,
                            const py::object &alpha, const std::string &brdf, double f0, const std::string &method,
                            double index) {
    const EllipseLights<double> lights(centre, u, v);
    return disks(lights.batch, view, alpha, brdf, {f0, index}, method, [&](std::size_t i) {
        const double *light = lights.numbers.data() + 9 * i;
        return reference::DiskLight{vector_at(light), vector_at(light + 3), vector_at(light + 6)};
    });
}

} // namespace

void bind_reference_microfacet(py::module_ &m) {
    m.def("microfacet_polygon", &polygon, py::arg("polygons"), py::arg("view"), py::arg("alpha"),
          py::arg("brdf") = "ggx", py::arg("f0") = 1.0, py::arg("counts") = py::none(), py::arg("method") = "outline",
          py::arg("index") = 0.0,
          R"(What sfumato.microfacet_polygon approximates, with the same arguments: (...) float64. method:

- 'outline': one quadrature along the outline, one from the normal to it on the plane of slopes, about 1e-8;
- 'area': quadrature over the polygon itself, about 1e-6 and slower. It shares the BRDF with the other and no more.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> [round(float(reference.microfacet_polygon(square, [0, 0, 1], 0.5, method=m)), 4) for m in ("outline", "area")]
[0.4323, 0.4323]
)");
    m.def("microfacet_sphere", &sphere, py::arg("centre"), py::arg("radius"), py::arg("view"), py::arg("alpha"),
          py::arg("brdf") = "ggx", py::arg("f0") = 1.0, py::arg("method") = "outline", py::arg("index") = 0.0,
          R"(What sfumato.microfacet_sphere approximates; method as in microfacet_polygon.

>>> round(float(reference.microfacet_sphere([0, 0, 2], 1, view=[0, 0, 1], alpha=0.1)), 3)
0.878
)");
    m.def("microfacet_ellipse", &ellipse, py::arg("centre"), py::arg("u"), py::arg("v"), py::arg("view"),
          py::arg("alpha"), py::arg("brdf") = "ggx", py::arg("f0") = 1.0, py::arg("method") = "outline",
          py::arg("index") = 0.0,
          R"(What sfumato.microfacet_ellipse approximates; method as in microfacet_polygon.

>>> round(float(reference.microfacet_ellipse([0, 0, 1], [1, 0, 0], [0, 1, 0], view=[0, 0, 1], alpha=0.1)), 3)
0.945
)");
}

} // namespace sfumato
