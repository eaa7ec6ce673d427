// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes are put together from, checked once: meshes, materials, grids.
#pragma once

#include "media/grid.hpp"
#include "module/arguments.hpp"
#include "scene/scene.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sfumato {

// A shape that is known to be sound.
struct CheckedMesh {
    std::shared_ptr<const Shape> shape;
    std::uint32_t materials = 0; // rows that it names
};

CheckedMesh checked_mesh(const arguments::Floats &vertices, const arguments::py::object &triangles,
                         const std::optional<arguments::Floats> &normals,
                         const std::optional<arguments::py::object> &material,
                         const std::optional<arguments::Floats> &tangents,
                         const std::optional<arguments::Floats> &channels = std::nullopt,
                         const arguments::py::sequence &moving = arguments::py::tuple());

// Raises ValueError where a pattern asks for more than there is.
void require_inputs(const Pattern &pattern, const Shape &shape, std::size_t values);

Materials checked_materials(const arguments::Floats &albedo, const std::optional<arguments::Floats> &gloss,
                            const std::optional<arguments::Floats> &emission,
                            const std::optional<arguments::Floats> &diffuse,
                            const std::optional<arguments::Floats> &transmittance);
void add_more(const std::optional<arguments::Floats> &translucence, const std::optional<arguments::Floats> &sheen,
              Materials &out);

// Densities, cropped; the grid is null where nothing can be seen of them.
struct CheckedGrid {
    std::shared_ptr<const Grid> grid;
    glm::uvec3 resolution{0};
};

CheckedGrid checked_grid(const arguments::Floats &density, float empty_below,
                         const std::optional<arguments::Floats> &colour, const std::optional<arguments::Floats> &glow);

// What `read` makes of a file, with the interpreter's lock released; its refusals are Python's.
template <typename Read>
auto from_file(const Read &read) {
    try {
        const pybind11::gil_scoped_release unlocked;
        return read();
    } catch (const std::runtime_error &error) {
        throw pybind11::value_error(std::string("path ") + error.what());
    }
}

// What a grid was made of.
struct GridSource {
    std::optional<arguments::Floats> density; // none where it came as a grid
    std::optional<arguments::Floats> colour, glow;
};

// A scene, and what its grids were made of: only the judge asks for that, so it stays the caller's.
struct ConsoleScene : Scene {
    std::vector<GridSource> sources; // of each medium

    // With all densities. Raises ValueError where a medium came as a grid, and for flags, which the reference has not.
    [[nodiscard]] Scene for_reference() const;
};

// How many strands have no two keys.
std::size_t add_strands(ConsoleScene &scene, const arguments::Floats &points, const arguments::Floats &radius,
                        const arguments::Doubles &first, const std::optional<arguments::Floats> &fibre,
                        const std::optional<arguments::Floats> &matt, const std::optional<arguments::Doubles> &material,
                        bool smooth, const std::optional<Visibility> &visibility);

// The world's, in the place of one that was there; none where nothing scatters, absorbs or emits.
void set_air(ConsoleScene &scene, const arguments::Floats &rayleigh, const arguments::Floats &mie,
             const arguments::Floats &absorption, const arguments::Floats &emission, float anisotropy,
             const std::string &phase, float scale_height, float ground, const arguments::Floats &tint);
void add_fog(ConsoleScene &scene, const CheckedMesh &mesh, const arguments::Doubles &to_world,
             const arguments::Floats &rayleigh, const arguments::Floats &mie, const arguments::Floats &absorption,
             const arguments::Floats &emission, float anisotropy, const std::string &phase,
             const arguments::Floats &tint, const std::optional<Visibility> &visibility);

// Matrices (4, 4) or (n, 4, 4).
std::vector<glm::mat4> places(const arguments::Doubles &to_world);
// Of `count` places, at an odd number of times; or none.
std::vector<std::vector<glm::mat4>> moving_places(const arguments::py::sequence &moving, std::size_t count);

} // namespace sfumato
