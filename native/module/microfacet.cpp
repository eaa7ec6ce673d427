// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by microfacets.
#include "module/microfacet.hpp"

#include "module/parts.hpp"

namespace sfumato {
namespace {

using namespace arguments;

template <typename Number>
py::object run(MicrofacetBatch<Number> batch, const RoughSurfaces<Number> &surfaces, const Shape &shape,
               const Fresnel &fresnel) {
    std::vector<Number> out(2 * product(shape));
    batch.brdf = surfaces.brdf;
    batch.view = surfaces.view;
    batch.alpha = surfaces.alpha;
    batch.index = static_cast<Number>(fresnel.index);
    batch.count = out.size() / 2;
    batch.out = out.data();
    if (batch.count > 0) {
        const py::gil_scoped_release unlocked;
        reflect(batch);
        mix_fresnel(out, static_cast<Number>(fresnel.f0));
    }
    return to_numpy(std::move(out), shape);
}

// float32 is worked on in float32, everything else in float64.
template <typename Work>
py::object in_precision_of(const py::object &given, const std::string &name, const Work &work) {
    return any_array(given, name).dtype().is(py::dtype::of<float>()) ? work(float{}) : work(double{});
}

py::object polygon(const py::object &polygons, const py::object &view, const py::object &alpha, const std::string &brdf,
                   double f0, const py::object &counts, double index) {
    const Fresnel fresnel(f0, index);
    return in_precision_of(polygons, "polygons", [&](auto zero) {
        using Number = decltype(zero);
        const Polygons<Number> corners(polygons, counts);
        const RoughSurfaces<Number> surfaces(view, alpha, brdf, corners.batch);
        MicrofacetBatch<Number> batch;
        batch.lights = corners.vertices.data();
        batch.width = 3 * corners.width;
        batch.vertices = counts.is_none() ? nullptr : corners.counts.data();
        return run(batch, surfaces, corners.batch, fresnel);
    });
}

py::object sphere(const py::object &centre, const py::object &radius, const py::object &view, const py::object &alpha,
                  const std::string &brdf, double f0, double index) {
    const Fresnel fresnel(f0, index);
    return in_precision_of(centre, "centre", [&](auto zero) {
        using Number = decltype(zero);
        const SphereLights<Number> lights(centre, radius);
        const RoughSurfaces<Number> surfaces(view, alpha, brdf, lights.batch);
        MicrofacetBatch<Number> batch;
        batch.shape = LightShape::SPHERE;
        batch.lights = lights.numbers.data();
        batch.width = 4;
        return run(batch, surfaces, lights.batch, fresnel);
    });
}

py::object ellipse(const py::object &centre, const py::object &u, const py::object &v, const py::object &view,
                   const py::object &alpha, const std::string &brdf, double f0, double index) {
    const Fresnel fresnel(f0, index);
    return in_precision_of(centre, "centre", [&](auto zero) {
        using Number = decltype(zero);
        const EllipseLights<Number> lights(centre, u, v);
        const RoughSurfaces<Number> surfaces(view, alpha, brdf, lights.batch);
        MicrofacetBatch<Number> batch;
        batch.shape = LightShape::ELLIPSE;
        batch.lights = lights.numbers.data();
        batch.width = 9;
        return run(batch, surfaces, lights.batch, fresnel);
    });
}

} // namespace

void bind_microfacet(py::module_ &m) {
    m.def(
        "microfacet_polygon", &polygon, py::arg("polygons"), py::arg("view"), py::arg("alpha"), py::arg("brdf") = "ggx",
        py::arg("f0") = 1.0, py::arg("counts") = py::none(), py::arg("index") = 0.0,
        R"(The radiance that a rough surface at the origin reflects to the eye, of convex polygons of radiance 1 that shine
to both sides: (...), float32 worked in float32, all else in float64.

polygons (..., vertices, 3), their first `counts` (...) vertices each, or all, in the surface's frame: z is the normal,
x the tangent. view, towards the eye, (3,) or (..., 3), of any length, not below the horizon. alpha, the roughness (the
square of the one on artists' sliders), one or (...), or one along x and one along y, (2,) or (..., 2); below 0.01 it is taken for 0.01.
f0: the reflectance of light from straight on. index, of refraction, from 1 on: it rises to 1 at grazing angles as that of
a dielectric does, scaled to begin at f0 (Fresnel 1823: Born and Wolf, Principles of Optics, 1.5.3; Walter et al. 2007, eq
22); 0: as Schlick's fifth power does (1994). What lies below the horizon gives nothing. brdf:

- 'ggx': the lobe over the polygon is exact; masking (Smith, height-correlated) and Fresnel are averaged over it;
- 'beckmann', 'blinn-phong' (exponent 2/alpha^2 - 2, alpha up to 0.447): the lobe as two complex poles.

No tables. ValueError for polygons that are not convex, not planar or without area, and for all that is not finite or
in range.

>>> import numpy as np
>>> square = np.array([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
>>> [round(float(microfacet_polygon(square, [0, 0, 1], alpha)), 3) for alpha in (0.01, 0.1, 0.5)]
[0.999, 0.951, 0.432]
>>> wall = np.array([[-1, 3, 0.2], [1, 3, 0.2], [1, 3, 1.2], [-1, 3, 1.2]])
>>> [round(float(microfacet_polygon(wall, [0, -3, 0.7], 0.1, f0=0.04, index=index)), 3) for index in (0, 1, 1.5)]
[0.169, 0.022, 0.164]
)");
    m.def("microfacet_sphere", &sphere, py::arg("centre"), py::arg("radius"), py::arg("view"), py::arg("alpha"),
          py::arg("brdf") = "ggx", py::arg("f0") = 1.0, py::arg("index") = 0.0,
          R"(As microfacet_polygon, of spheres that do not hold the origin: centre (..., 3), radius one or (...).

Their rim is a circle of directions, over which the lobe of 'ggx' is exact too.

>>> round(float(microfacet_sphere([0, 0, 2], 1, view=[0, 0, 1], alpha=0.1)), 3)
0.878
)");
    m.def("microfacet_ellipse", &ellipse, py::arg("centre"), py::arg("u"), py::arg("v"), py::arg("view"),
          py::arg("alpha"), py::arg("brdf") = "ggx", py::arg("f0") = 1.0, py::arg("index") = 0.0,
          R"(As microfacet_polygon, of ellipses: centre (..., 3) and the half axes u and v, (3,) or (..., 3).

Their rim is taken for eight circles of directions that enclose what it does: 1e-3 of the radiance, on average.

>>> round(float(microfacet_ellipse([0, 0, 1], [1, 0, 0], [0, 1, 0], view=[0, 0, 1], alpha=0.1)), 3)
0.945
)");
}

} // namespace sfumato
