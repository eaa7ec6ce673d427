// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module. No arithmetic: arguments are checked, work is handed on, results are wrapped.
#include "camera.hpp"
#include "frame.hpp"
#include "module_arguments.hpp"
#include "module_parts.hpp"
#include "volume_file.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

void add_mesh(Scene &scene, const Floats &vertices, const Doubles &triangles, const Floats &corner_normals,
              const Doubles &material, const Floats &albedo) {
    require_shape(vertices, {-1, 3}, "vertices");
    require_shape(triangles, {-1, 3}, "triangles");
    const py::ssize_t count = triangles.shape(0);
    require_shape(corner_normals, {count, 3, 3}, "corner_normals");
    require_shape(material, {count}, "material");
    require_shape(albedo, {-1, 3}, "albedo");
    require_finite(vertices, "vertices");
    require_finite(corner_normals, "corner_normals");
    require_range(albedo, 0.0F, 1.0F, "albedo");
    const std::vector<std::uint32_t> corners = indices(triangles, vertices.shape(0), "triangles");
    Mesh mesh;
    mesh.material = indices(material, albedo.shape(0), "material");
    const auto vectors = [](const Floats &array, std::vector<glm::vec3> &out) {
        const auto *first = reinterpret_cast<const glm::vec3 *>(array.data());
        out.assign(first, first + array.size() / 3);
    };
    vectors(vertices, mesh.vertices);
    vectors(albedo, mesh.albedo);
    const auto *normals = reinterpret_cast<const glm::vec3 *>(corner_normals.data());
    for (std::size_t first = 0; first < corners.size(); first += 3) {
        mesh.triangles.emplace_back(corners[first], corners[first + 1], corners[first + 2]);
        mesh.corner_normals.push_back({normals[first], normals[first + 1], normals[first + 2]});
    }
    scene.meshes.push_back(std::move(mesh));
}

void set_medium(Scene &scene, const Floats &density, const Doubles &grid_to_world, const Floats &scattering,
                const Floats &absorption, float anisotropy) {
    require_shape(density, {-1, -1, -1}, "density");
    if (density.size() == 0) {
        throw py::value_error("density has shape " + shape_of(density) + ", but must hold at least one cell");
    }
    constexpr py::ssize_t MOST_CELLS = py::ssize_t{1} << 29; // the lanes' indices have 32 bits
    if (density.size() > MOST_CELLS) {
        throw py::value_error("density has shape " + shape_of(density) + ", but can hold at most 2^29 cells");
    }
    require_range(density, 0.0F, 1e30F, "density");
    Medium medium;
    require_range(grid_to_world, -1e30, 1e30, "grid_to_world");
    medium.grid_to_world = glm::mat4(matrix4(grid_to_world, "grid_to_world"));
    for (int column = 0; column < 4; ++column) {
        if (medium.grid_to_world[column][3] != (column == 3 ? 1.0F : 0.0F)) {
            throw py::value_error("grid_to_world holds " + text(medium.grid_to_world[column][3]) + " at flat index " +
                                  text(12 + column) + "; its last row must be 0, 0, 0, 1");
        }
    }
    const double determinant = glm::determinant(glm::dmat4(medium.grid_to_world));
    if (!(std::abs(determinant) > 0.0)) {
        throw py::value_error("grid_to_world flattens the grid: its determinant is 0");
    }
    medium.resolution = {density.shape(2), density.shape(1), density.shape(0)};
    medium.density.assign(density.data(), density.data() + density.size());
    medium.scattering = vector3(scattering, "scattering");
    medium.absorption = vector3(absorption, "absorption");
    require_range(scattering, 0.0F, 1e30F, "scattering");
    require_range(absorption, 0.0F, 1e30F, "absorption");
    require_range(anisotropy, -0.9999F, 0.9999F, "anisotropy");
    medium.anisotropy = anisotropy;
    scene.medium = std::move(medium);
}

void set_sun(Scene &scene, const Floats &direction, const Floats &irradiance, float angle) {
    Sun sun;
    sun.direction = vector3(direction, "direction");
    const double length = glm::length(glm::dvec3(sun.direction));
    if (!(length > 0.0)) {
        throw py::value_error("direction is (0, 0, 0), but must point somewhere");
    }
    sun.direction = glm::vec3(glm::dvec3(sun.direction) / length);
    sun.irradiance = vector3(irradiance, "irradiance");
    require_range(irradiance, 0.0F, 1e30F, "irradiance");
    require_range(angle, 0.0F, 3.1415F, "angle");
    sun.angle = angle;
    scene.sun = sun;
}

Frame make_frame(const Scene &scene, int coefficients, double texels_per_cell, double steps_per_cell) {
    require_range(coefficients, 1, 63, "coefficients");
    if (coefficients % 2 == 0) {
        throw py::value_error("coefficients is " + std::to_string(coefficients) +
                              ", but must be odd: a constant and pairs of harmonics");
    }
    require_range(texels_per_cell, 0.05, 8.0, "texels_per_cell");
    require_range(steps_per_cell, 0.05, 64.0, "steps_per_cell");
    const py::gil_scoped_release unlocked;
    return {scene, {coefficients, texels_per_cell, steps_per_cell}};
}

void require_size(int width, int height) {
    require_range(width, 1, 65536, "width");
    require_range(height, 1, 65536, "height");
}

py::object render(const Frame &frame, const Camera &camera, int width, int height, int edge_samples,
                  const std::optional<std::function<py::object(double)>> &progress) {
    require_size(width, height);
    require_range(edge_samples, 1, 1024, "edge_samples");
    Progress report;
    if (progress) {
        report = [&progress](double done) {
            const py::gil_scoped_acquire locked;
            const py::object answer = (*progress)(done);
            return answer.is_none() || py::bool_(answer); // a function without a return statement stops nothing
        };
    }
    std::optional<std::vector<float>> image;
    {
        const py::gil_scoped_release unlocked;
        image = frame.render(camera, width, height, edge_samples, report);
    }
    return image ? py::object(to_numpy(std::move(*image), {height, width, 4})) : py::none();
}

py::array_t<float> surfaces(const Frame &frame, const Camera &camera, int width, int height, bool lit) {
    require_size(width, height);
    std::vector<float> buffer;
    {
        const py::gil_scoped_release unlocked;
        buffer = frame.surfaces(camera, width, height, lit);
    }
    return to_numpy(std::move(buffer), {height, width, 4});
}

py::array_t<float> lit_volume(const CroppedMedium &medium) {
    const glm::ivec3 n = medium.resolution;
    return to_numpy(medium.lit, {n.z, n.y, n.x, medium.channels});
}

py::array_t<float> transmittance_at(const Frame &frame, const Floats &points) {
    if (points.ndim() < 1 || points.shape(points.ndim() - 1) != 3) {
        throw py::value_error("points has shape " + shape_of(points) + ", but its last axis must be 3");
    }
    require_finite(points, "points");
    std::vector<float> out(static_cast<std::size_t>(points.size()), 1.0F);
    {
        const py::gil_scoped_release unlocked;
        frame.transmittance(std::span(points.data(), static_cast<std::size_t>(points.size())), out);
    }
    return to_numpy(std::move(out), {points.shape(), points.shape() + points.ndim()});
}

py::array_t<float> corners(const Camera &camera) {
    std::vector<float> values;
    for (const auto &plane : {camera.near, camera.far}) {
        for (const glm::vec3 &v : plane) {
            values.insert(values.end(), {v.x, v.y, v.z});
        }
    }
    return to_numpy(std::move(values), {6, 3});
}

py::tuple read_volume_file(const std::string &path, const std::string &grid) {
    VolumeFile volume;
    try {
        const py::gil_scoped_release unlocked;
        volume = read_volume(path, grid);
    } catch (const std::runtime_error &error) {
        throw py::value_error(std::string("path ") + error.what());
    }
    const glm::ivec3 n = volume.resolution;
    return py::make_tuple(to_numpy(std::move(volume.density), {n.z, n.y, n.x}), to_numpy(volume.grid_to_object));
}

} // namespace
} // namespace sfumato

PYBIND11_MODULE(sfumato, m) {
    using namespace sfumato;
    namespace py = pybind11;
    m.doc() = "Smoke, its light and its shadow: NumPy arrays in, NumPy arrays out.\n\n"
              "Metres, Z up, scene-linear RGB. Arrays may be float32 or float64; work is done in float32.\n"
              "Anything unusable raises ValueError and says which argument it was.";
    m.attr("instruction_set") = kernels().name;
    bind_area_light(m);
    bind_basis(m);
    bind_microfacet(m);
    bind_opacity(m);
    bind_ray_storage(m);

    m.def(
        "read_volume", &read_volume_file, py::arg("path"), py::arg("grid") = "density",
        R"(The active part of a grid of floats in an OpenVDB file: density (nz, ny, nx) and grid_to_object (4, 4), which
takes cells to the file's own space. Raises ValueError that names the file and the cause.

>>> read_volume("missing.vdb")  # doctest: +ELLIPSIS
Traceback (most recent call last):
ValueError: path 'missing.vdb' cannot be read: ...
)");

    py::class_<Scene>(m, "Scene", R"(Meshes, one medium and one sun.

>>> scene = Scene()
>>> scene.set_sun((0, 0, -1), irradiance=(1, 1, 1), angle=0.0)
>>> scene.set_background((0.5, 0.5, 0.5))
)")
        .def(py::init<>())
        .def("add_mesh", &add_mesh, py::arg("vertices"), py::arg("triangles"), py::arg("corner_normals"),
             py::arg("material"), py::arg("albedo"),
             R"(Add triangles that reflect diffusely.

vertices (n, 3), metres in world space; triangles (m, 3), indices into vertices; corner_normals (m, 3, 3), unit
length; material (m,), indices into albedo; albedo (k, 3) in [0, 1].
Raises ValueError for wrong shapes, indices out of range and values that are not finite.

>>> Scene().add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[[0, 0, 1]] * 3], [0], [[0.8, 0.8, 0.8]])
)")
        .def("set_medium", &set_medium, py::arg("density"), py::arg("grid_to_world"), py::arg("scattering"),
             py::arg("absorption"), py::arg("anisotropy") = 0.0F,
             R"(Set the smoke.

density (nz, ny, nx), not negative, sampled at cell centres, zero outside the grid; grid_to_world (4, 4) takes
cells to metres: cell (i, j, k) fills [i, i + 1] and so on; scattering and absorption (3,), per metre and unit
density; anisotropy g of Henyey and Greenstein (1941) in (-1, 1).
Raises ValueError for an empty, negative or non-finite density and for a matrix that flattens the grid.

>>> import numpy as np
>>> Scene().set_medium(np.ones((4, 4, 4)), np.eye(4), scattering=(1, 1, 1), absorption=(0, 0, 0))
)")
        .def("set_sun", &set_sun, py::arg("direction"), py::arg("irradiance"), py::arg("angle") = 0.0F,
             R"(Set the sun: direction (3,) in which its light travels; irradiance (3,) in W/m^2 on a surface that
faces it; angle, its angular diameter in radians.

>>> Scene().set_sun((0, 0, -1), (4, 4, 4), angle=0.009)
)")
        .def(
            "set_background",
            [](Scene &scene, const Floats &radiance) {
                require_range(radiance, 0.0F, 1e30F, "radiance");
                scene.background = vector3(radiance, "radiance");
            },
            py::arg("radiance"),
            "Set the radiance (3,) where no surface is. It lights nothing.\n\n"
            ">>> Scene().set_background((0, 0, 0))\n");

    py::class_<Camera>(m, "Camera", R"(The rays of a projection.

view_projection (4, 4) takes world space to OpenGL's clip space, perspective or orthographic.
Raises ValueError if it cannot be inverted.

>>> import numpy as np
>>> Camera(np.eye(4)).corners.shape
(6, 3)
)")
        .def(py::init([](const Doubles &matrix) { return camera_from(matrix4(matrix, "view_projection")); }),
             py::arg("view_projection"))
        .def_property_readonly("corners", &corners,
                               "(6, 3): near0, near_u, near_v, far0, far_u, far_v of shaders/camera.glsl.");

    bind_reference(m);

    py::class_<CroppedMedium>(m, "LitMedium", "The smoke of a frame, cropped, with the light that reaches it.")
        .def_property_readonly("lit_volume", &lit_volume,
                               "(nz, ny, nx, c): density, column density towards the sun (metres times density), and "
                               "where solids shade the "
                               "smoke (c = 3) the share of the sun that they keep back. A copy.")
        .def_property_readonly(
            "grid_to_world", [](const CroppedMedium &s) { return to_numpy(s.grid_to_world); },
            "(4, 4): from cells of lit_volume to metres in world space.")
        .def_property_readonly(
            "clearance",
            [](const CroppedMedium &s) {
                return to_numpy(s.clearance, {s.bricks.z, s.bricks.y, s.bricks.x});
            },
            "(bz, by, bx), for each brick of 4^3 cells: negative where smoke may be met, else the number of cells "
            "that are surely empty in every direction.")
        .def_property_readonly(
            "extinction", [](const CroppedMedium &s) { return to_numpy(s.extinction); },
            "(3,), per metre and unit density.")
        .def_property_readonly(
            "albedo", [](const CroppedMedium &s) { return to_numpy(s.albedo); },
            "(3,): scattering over extinction, 0 where there is neither.")
        .def_readonly("anisotropy", &CroppedMedium::anisotropy, "g of Henyey and Greenstein (1941).");

    py::class_<LightMap>(m, "LightMap", "A Fourier opacity map of column density, seen from the sun.")
        .def_property_readonly(
            "coefficients",
            [](const LightMap &s) {
                return to_numpy(s.coefficients, {s.size.y, s.size.x, s.count});
            },
            "(height, width, n): a0, a1, b1, a2, b2, ... of eqs 1-2 of Jansen and Bavoil (2010). A copy.")
        .def_property_readonly(
            "world_to_map", [](const LightMap &s) { return to_numpy(s.world_to_map); },
            "(4, 4): to x and y across the map and z along the light, all in [0, 1].");

    py::class_<Frame>(m, "Frame", R"(Everything about a scene that does not depend on the camera, computed once.

coefficients (odd, 1 to 63) of each texel of the light map; texels_per_cell and steps_per_cell relate the map's
resolution and the march along view rays to the cells of the medium.

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> Frame(scene).render(Camera(np.eye(4)), width=2, height=1)[0, 0].tolist()
[0.25, 0.5, 1.0, 0.0]
)")
        .def(py::init(&make_frame), py::arg("scene"), py::arg("coefficients") = FrameSettings{}.coefficients,
             py::arg("texels_per_cell") = FrameSettings{}.texels_per_cell,
             py::arg("steps_per_cell") = FrameSettings{}.steps_per_cell)
        .def("render", &render, py::arg("camera"), py::arg("width"), py::arg("height"), py::arg("edge_samples") = 16,
             py::arg("progress") = py::none(),
             R"(The finished image: (height, width, 4) float32, premultiplied scene-linear RGBA, row 0 at the bottom.

edge_samples are taken where surfaces or their shadows change, one elsewhere. progress(done) is called with the
share of the work that is done, by the thread that called; when it returns False the result is None.

>>> import numpy as np
>>> frame, shares = Frame(Scene()), []
>>> frame.render(Camera(np.eye(4)), width=4, height=3, progress=shares.append).shape
(3, 4, 4)
>>> frame.render(Camera(np.eye(4)), width=4, height=3, progress=lambda done: done < 0.25) is None
True
)")
        .def("surfaces", &surfaces, py::arg("camera"), py::arg("width"), py::arg("height"), py::arg("lit") = true,
             R"((height, width, 4) float32 without the smoke: the radiance of the first surface (unlit: the
cosine of the sun's angle, in red times the visibility of the sun) and the distance to it in metres, the far plane's
where there is none.

>>> import numpy as np
>>> Frame(Scene()).surfaces(Camera(np.diag([1, 1, -0.1, 1])), width=1, height=1)[0, 0].tolist()
[0.0, 0.0, 0.0, 20.0]
)")
        .def("transmittance", &transmittance_at, py::arg("points"),
             R"(The share of the sun's light that the smoke lets through to each of points (..., 3): (..., 3), RGB.
Solids are left out. All ones where the scene has no smoke or no sun.

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_medium(np.full((8, 8, 8), 0.25), np.eye(4), scattering=(1, 0, 0), absorption=(0, 1, 2))
>>> scene.set_sun((0, 0, -1), (4, 4, 4))
>>> Frame(scene).transmittance([[4, 4, 20], [4, 4, -1]]).astype(float).round(3).tolist()
[[1.0, 1.0, 1.0], [0.135, 0.135, 0.018]]
)")
        .def_property_readonly(
            "medium", [](const Frame &frame) { return frame.medium().empty() ? nullptr : &frame.medium(); },
            py::return_value_policy::reference_internal, "LitMedium, or None where there is no smoke.")
        .def_property_readonly(
            "light_map", [](const Frame &frame) { return frame.light_map() ? &*frame.light_map() : nullptr; },
            py::return_value_policy::reference_internal, "LightMap, or None where there is no smoke or no sun.")
        .def_property_readonly("step_length", &Frame::step_length, "Of the march along view rays, in cells.")
        .def_property_readonly(
            "sun",
            [](const Frame &frame) -> py::object {
                const auto &sun = frame.sun();
                return sun ? py::make_tuple(to_numpy(sun->direction), to_numpy(sun->irradiance), sun->angle)
                           : py::object(py::none());
            },
            "(direction, irradiance, angle) or None.");
}
