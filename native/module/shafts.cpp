// SPDX-License-Identifier: GPL-3.0-or-later
// Light shafts of suns in even air.
#include "frame/shafts.hpp"

#include "module/parts.hpp"
#include "module/rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;
using arguments::text;

constexpr std::array<double, 3> NONE{0.0, 0.0, 0.0};
constexpr float FURTHEST = 1e12F;
constexpr float DENSEST = 1e6F; // per metre
constexpr py::ssize_t LARGEST = 16384;

std::unique_ptr<SolidMap> solid_map(const py::object &depth, const Doubles &world_to_map) {
    const Floats given(any_array(depth, "depth"));
    require_shape(given, {-1, -1}, "depth");
    for (int axis = 0; axis < 2; ++axis) {
        if (given.shape(axis) < 2 || given.shape(axis) > LARGEST) {
            throw py::value_error("depth has shape " + shape_of(given) + ", but must have 2 to " + text(LARGEST) +
                                  " texels each way");
        }
    }
    std::vector<float> depths(given.data(), given.data() + given.size());
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (std::isnan(depths[i])) {
            throw py::value_error("depth holds nan at flat index " + text(i) +
                                  "; where there is no solid it must be infinite");
        }
        depths[i] = std::clamp(depths[i], -std::numeric_limits<float>::max(), std::numeric_limits<float>::max());
    }
    const glm::dmat4 onto = matrix4(world_to_map, "world_to_map");
    require_affine(glm::mat4(onto), 0, "world_to_map");
    return std::make_unique<SolidMap>(std::move(depths), static_cast<int>(given.shape(1)),
                                      static_cast<int>(given.shape(0)), onto);
}

std::vector<const SolidMap *> all_maps(const py::list &given) {
    std::vector<const SolidMap *> maps;
    for (const py::handle each : given) {
        if (!py::isinstance<SolidMap>(each)) {
            throw py::value_error("maps holds " + told(each) + ", but must be a list of SolidMap");
        }
        maps.push_back(each.cast<const SolidMap *>());
    }
    return maps;
}

glm::vec3 coefficients(const Floats &given, const std::string &name) {
    const glm::vec3 value = vector3(given, name);
    require_range(given, 0.0F, DENSEST, name);
    return value;
}

py::tuple shafts_of(const py::object &distance, const Camera &camera, const py::list &given_maps,
                    const py::object &direction, const py::object &irradiance, const Floats &rayleigh,
                    const Floats &mie, const Floats &absorption, float anisotropy, const std::string &method) {
    const Floats far(any_array(distance, "distance"));
    require_shape(far, {-1, -1}, "distance");
    require_range(far, 0.0F, std::numeric_limits<float>::infinity(), "distance");
    if (far.size() == 0) {
        throw py::value_error("distance has shape " + shape_of(far) + ", but must hold at least one pixel");
    }
    const std::vector<const SolidMap *> maps = all_maps(given_maps);
    const Floats towards(any_array(direction, "direction")), strength(any_array(irradiance, "irradiance"));
    const auto count = static_cast<py::ssize_t>(maps.size());
    require_shape(towards, {count, 3}, "direction");
    require_finite(towards, "direction");
    require_shape(strength, {count, 3}, "irradiance");
    require_range(strength, 0.0F, FURTHEST, "irradiance");
    const ShaftAir air{coefficients(rayleigh, "rayleigh"), coefficients(mie, "mie"),
                       coefficients(absorption, "absorption"), anisotropy};
    require_range(anisotropy, -0.999F, 0.999F, "anisotropy");
    const std::size_t how = one_of<4>(method, {"march", "minmax", "epipolar", "epipolar-fine"}, "method");
    std::vector<ShaftLight> lights;
    for (py::ssize_t i = 0; i < count; ++i) {
        const float *const d = towards.data() + 3 * i, *const e = strength.data() + 3 * i;
        const glm::vec3 along(d[0], d[1], d[2]);
        if (!(glm::length(along) > 0.0F)) {
            throw py::value_error("direction holds 0, 0, 0 for light " + text(i) + ", but must point somewhere");
        }
        lights.push_back({maps[static_cast<std::size_t>(i)], glm::normalize(along), {e[0], e[1], e[2]}});
    }
    const ShaftRays rays{camera,
                         static_cast<int>(far.shape(1)),
                         static_cast<int>(far.shape(0)),
                         {far.data(), static_cast<std::size_t>(far.size())}};
    Shafts made;
    {
        const py::gil_scoped_release unlocked;
        made = shafts(rays, lights, air, static_cast<ShaftMethod>(how));
    }
    return py::make_tuple(to_numpy(std::move(made.radiance), {far.shape(0), far.shape(1), 3}), made.texels, made.rays);
}

} // namespace

void bind_shafts(py::module_ &m) {
    py::class_<SolidMap>(m, "SolidMap",
                         R"(The first solids that the light of a sun meets: the shadow map of light shafts.

depth (rows, columns), infinite where there is none; world_to_map (4, 4) takes the world onto [0, 1]^3, the light along
the third axis, with depth on it. Texel (row, column) has its centre at ((column + 1/2) / columns, (row + 1/2) / rows).
Keeps bounds over squares of 2, 4, 8, ... texels.

>>> import numpy as np
>>> SolidMap(np.full((4, 8), np.inf), np.eye(4)).shape
(4, 8)
)")
        .def(py::init(&solid_map), py::arg("depth"), py::arg("world_to_map"))
        .def_property_readonly(
            "shape", [](const SolidMap &map) { return py::make_tuple(map.rows(), map.columns()); }, "(rows, columns).");
    m.def(
        "shafts", &shafts_of, py::arg("distance"), py::arg("camera"), py::arg("maps"), py::arg("direction"),
        py::arg("irradiance"), py::arg("rayleigh") = NONE, py::arg("mie") = NONE, py::arg("absorption") = NONE,
        py::arg("anisotropy") = 0.0F, py::arg("method") = "minmax",
        R"(What even air scatters of suns to the eye, once, where solids leave it lit: radiance (rows, columns, 3); how many
texels, or bounds of some, were looked at; and how many rays were followed.

distance (rows, columns) along the ray through the middle of each pixel, from the camera's near plane to the first
surface, rows from the bottom. maps: one SolidMap for each sun; direction (suns, 3) of their light, irradiance (suns, 3)
on what faces them. rayleigh, mie (of Henyey and Greenstein's phase function, with anisotropy) and absorption (3,) per
metre. Beside a map all is lit.
method 'march': each column of texels on each ray, Algorithm 1 of Yusov (2013); 'minmax': the same by bounds, his
Algorithm 2, and the same picture within 1e-6; 'epipolar': on rays of slices that share one line of the map, and
pixels between them; 'epipolar-fine': with no pixel further than one pixel from its samples.

>>> import numpy as np
>>> dark = SolidMap(np.zeros((4, 4)), np.eye(4))  # all of the box from (0, 0, 0) to (1, 1, 1) is in shadow
>>> light = shafts(np.full((2, 2), 2.0), Camera(np.eye(4)), [dark], [(0, 0, 1)], [(1, 1, 1)], mie=(0.1, 0.1, 0.1))
>>> light[0][:, :, 0].round(4).astype(float).round(4).tolist()
[[0.0144, 0.0144], [0.0144, 0.0076]]
)");
}

} // namespace sfumato
