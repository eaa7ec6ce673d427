// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame is made of: its light maps, in the console's terms, and its smoke.
#include "maps/light_map.hpp"
#include "media/medium.hpp"
#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "module/scene_parts.hpp"
#include "rays/curve.hpp"

#include <cstring>

namespace sfumato {
namespace {

using namespace arguments;

void require_series(const LightMap &map) {
    if (map.curved) {
        throw py::value_error("basis is 'curve', so there are no coefficients and ranges, but texels");
    }
}

py::object basis_of(const LightMap &map) {
    if (map.curved) {
        return py::str("curve");
    }
    return map.series.name == LEARNED ? py::cast(map.series) : py::str(map.series.basis().name);
}

py::array_t<float> coefficients_of(const LightMap &map) {
    require_series(map);
    return to_numpy(series_of(map).coefficients, {map.size.y, map.size.x, static_cast<py::ssize_t>(map.series.count)});
}

py::array_t<float> ranges_of(const LightMap &map) {
    require_series(map);
    std::vector<float> out;
    for (const Range &range : series_of(map).ranges) {
        out.insert(out.end(), {range.low, range.high});
    }
    return to_numpy(std::move(out), {map.size.y, map.size.x, 2});
}

py::array_t<std::uint8_t> texels_of(const LightMap &map) {
    if (!map.curved) {
        throw py::value_error("basis is '" + std::string(map.series.basis().name) +
                              "', so there are no texels, but coefficients and ranges");
    }
    std::vector<std::uint8_t> out(map.bytes());
    std::memcpy(out.data(), map.curves.data(), out.size());
    return to_numpy(std::move(out), {map.size.y, map.size.x, map.colours, static_cast<py::ssize_t>(CURVE_BYTES)});
}

py::array_t<float> density_of(const CroppedMedium &medium) {
    const glm::ivec3 n = medium.grid->resolution;
    py::array_t<float> out({n.z, n.y, n.x});
    copy_cells(*medium.grid, medium.grid->density, 1,
               std::span(out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
}

py::object tint_of(const CroppedMedium &medium) {
    const Grid &grid = *medium.grid;
    if (grid.tint.empty()) {
        return py::none();
    }
    py::array_t<float> out({grid.resolution.z, grid.resolution.y, grid.resolution.x, 3});
    copy_cells(grid, grid.tint, 3, std::span(out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
}

py::object glow_of(const CroppedMedium &medium) {
    const Grid &grid = *medium.grid;
    if (medium.emission.empty()) {
        return py::none();
    }
    py::array_t<float> out({grid.resolution.z, grid.resolution.y, grid.resolution.x});
    copy_cells(grid, grid.glow, 1, std::span(out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
}

py::array_t<float> emission_of(const CroppedMedium &medium) {
    py::array_t<float> out({static_cast<py::ssize_t>(medium.emission.size()), py::ssize_t{3}});
    for (std::size_t row = 0; row < medium.emission.size(); ++row) {
        for (int c = 0; c < 3; ++c) {
            out.mutable_at(static_cast<py::ssize_t>(row), c) = medium.emission[row][c];
        }
    }
    return out;
}

py::array_t<float> light_of(const CroppedMedium &medium) {
    const glm::ivec3 n = medium.grid->resolution;
    py::array_t<float> out({static_cast<py::ssize_t>(medium.light.size()), py::ssize_t{n.z}, py::ssize_t{n.y},
                            py::ssize_t{n.x}, py::ssize_t{medium.light_channels}});
    std::span<float> left(out.mutable_data(), static_cast<std::size_t>(out.size()));
    const std::size_t floats = medium.light.empty() ? 0 : left.size() / medium.light.size();
    for (const auto &volume : medium.light) {
        copy_cells(*medium.grid, *volume, medium.light_channels, left.first(floats));
        left = left.subspan(floats);
    }
    return out;
}

} // namespace

void bind_frame_parts(py::module_ &m) {
    py::class_<CroppedMedium>(m, "LitMedium", "A body of smoke of a frame, cropped, with the light that reaches it.")
        .def_property_readonly("density", &density_of, "(nz, ny, nx). A copy.")
        .def_property_readonly("tint", &tint_of,
                               "(nz, ny, nx, 3): density times the colour in which it scatters; None where that is "
                               "white. A copy.")
        .def_property_readonly("glow", &glow_of,
                               "(nz, ny, nx), that of Scene.add_medium; None where nothing glows. A copy.")
        .def_property_readonly(
            "ramp",
            [](const CroppedMedium &s) {
                return to_numpy(s.ramp ? s.ramp->rows : std::vector<float>(),
                                {s.ramp ? s.ramp->parts() : 0, PART_ROWS, 3});
            },
            "(parts, 7, 3): the transfer function between its stops, as shaders/media/ramp.glsl has a Part; no parts "
            "where density is the density. A copy.")
        .def_property_readonly("emission", &emission_of, "(n, 3), that of Scene.add_medium; no rows without a glow.")
        .def_property_readonly(
            "light", &light_of,
            "(lights, nz, ny, nx, c): r, of which r (r + 1) is the optical depth towards each light, in the one colour "
            "of grey smoke or in three, and the share of the light's falloff that passes solids and the edges of its "
            "cone. A copy.")
        .def_property_readonly(
            "grid_to_world", [](const CroppedMedium &s) { return to_numpy(s.grid_to_world); },
            "(4, 4): from cells to metres in world space.")
        .def_property_readonly(
            "clearance",
            [](const CroppedMedium &s) {
                const Grid &grid = *s.grid;
                return to_numpy(s.ramp ? s.ramp->clearance : grid.clearance,
                                {grid.bricks.z, grid.bricks.y, grid.bricks.x});
            },
            "(bz, by, bx), for each brick of 4^3 cells: negative where smoke may be met, else the number of cells "
            "that are surely empty in every direction.")
        .def_property_readonly(
            "extinction", [](const CroppedMedium &s) { return to_numpy(s.extinction); },
            "(3,), per metre and unit density.")
        .def_property_readonly(
            "scattering", [](const CroppedMedium &s) { return to_numpy(s.scattering); },
            "(3,), per metre and unit density.")
        .def_readonly("anisotropy", &CroppedMedium::anisotropy, "g of Henyey and Greenstein (1941).");

    py::class_<LightMap>(m, "LightMap", R"(What smoke there is along the rays of a light, of a frame.

>>> import numpy as np
>>> scene = Scene()
>>> scene.add_medium(np.ones((4, 4, 4)), np.eye(4), scattering=(0.5, 0.5, 0.5), absorption=(0, 0, 0))
>>> scene.add_sun((0, 0, -1), (4, 4, 4))
>>> map = Frame(scene, coefficients=5, basis="fourier").light_map()
>>> ray = 0.5 * map.coefficients[4, 4]  # of optical depth
>>> transmittance(ray, np.array([0.5, 1.0]), basis=map.basis, range=map.range[4, 4]).astype(float).round(3).tolist()
[0.368, 0.135]
)")
        .def_property_readonly("basis", &basis_of,
                               "As transmittance takes it: its name, a LearnedBasis, or 'curve', of RayStorage.")
        .def_property_readonly("coefficients", &coefficients_of,
                               "(height, width, n): of each ray's column density, metres times density, as project "
                               "makes them. A copy. Raises ValueError of curves.")
        .def_property_readonly("range", &ranges_of,
                               "(height, width, 2): low and high of each ray's series, as project takes them. A copy. "
                               "Raises ValueError of curves.")
        .def_property_readonly("texels", &texels_of,
                               "(height, width, colours, 20) uint8: curves of optical depth, in the one colour of grey "
                               "smoke or in three, as RayStorage stores them. A copy. Raises ValueError of series.")
        .def_property_readonly("bytes", &LightMap::bytes, "What the map takes, without its solids.")
        .def_property_readonly(
            "world_to_light", [](const LightMap &s) { return to_numpy(s.world_to_light); },
            "(4, 4): of a sun's map, to x and y across it and z along the light, all in [0, 1]; of others, to a frame "
            "with the light at the origin.");
}

} // namespace sfumato
