// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes, materials and grids: what Python hands over, checked and taken once.
#include "module/scene_parts.hpp"

#include "media/medium.hpp"
#include "media/tint.hpp"
#include "module/parts.hpp"
#include "scene/volume_file.hpp"
#include "solids/surface_view.hpp"
#include "textures/pattern_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/matrix.hpp>
#include <pybind11/stl.h>
#define XXH_INLINE_ALL // a header, not one more library to find
#include <xxhash.h>

namespace sfumato {
namespace {

using namespace arguments;

constexpr py::ssize_t MOST_CELLS = py::ssize_t{1} << 29; // of one grid: the lanes' indices have 32 bits

// A layer: seven numbers in [0, 1] and an index of refraction; and where they go on, eight more.
Gloss gloss_of(const float *row, bool whole) {
    Gloss gloss{{row[0], row[1], row[2]}, row[3], row[7], {row[4], row[5]}, row[6] > 0.0F};
    if (whole) {
        gloss.lossless = row[8] > 0.0F;
        gloss.below = row[9] > 0.5F ? Below::NOTHING : row[9] > 0.0F ? Below::REST : Below::ALL;
        gloss.dip = {row[10], row[11], row[12]};
        gloss.beckmann = row[13] > 0.0F;
        gloss.share = row[14];
        gloss.turn = row[15];
    }
    return gloss;
}

std::vector<Gloss> glosses(const Floats &array, py::ssize_t count) {
    constexpr py::ssize_t PLAIN = 8, WHOLE = 16, INDEX = 7;
    const py::ssize_t lobes = array.ndim() == 3 ? array.shape(1) : 1;
    const py::ssize_t width = array.ndim() > 1 && array.shape(array.ndim() - 1) == WHOLE ? WHOLE : PLAIN;
    if (array.ndim() == 3) {
        require_shape(array, {count, -1, width}, "gloss");
    } else {
        require_shape(array, {count, width}, "gloss");
    }
    if (lobes > MAX_LOBES) {
        throw py::value_error("gloss has " + text(lobes) + " lobes; there may be " + text(MAX_LOBES));
    }
    std::vector<Gloss> out;
    for (py::ssize_t first = 0; first < array.size(); first += width) {
        const float *row = array.data() + first;
        for (py::ssize_t k = 0; k < width; ++k) {
            if (k == INDEX ? !is_index(row[k]) : !(row[k] >= 0.0F && row[k] <= 1.0F)) {
                throw py::value_error("gloss holds " + text(row[k]) + " at flat index " + text(first + k) + "; " +
                                      (k == INDEX ? "an index of refraction must be " + std::string(INDEX_RANGE)
                                                  : "every value but an index of refraction must lie between 0 and 1"));
            }
        }
        out.push_back(gloss_of(row, width == WHOLE));
        if (out.back().beckmann && (out.back().lossless || out.back().below == Below::REST)) {
            throw py::value_error("gloss has Beckmann's facets at flat index " + text(first + 13) +
                                  ", which lose what they send to each other and leave all or nothing below");
        }
    }
    return out;
}

// Rows of a kind, by its number, and a roughness.
std::vector<Diffuse> diffuse_of(const Floats &array, py::ssize_t count) {
    require_shape(array, {count, 2}, "diffuse");
    std::vector<Diffuse> out;
    constexpr auto LAST = static_cast<float>(Spreading::GROOVES_DEEPER);
    for (const float *row = array.data(); row != array.data() + array.size(); row += 2) {
        if (!(row[0] >= 0.0F && row[0] <= LAST && std::floor(row[0]) == row[0])) {
            throw py::value_error("diffuse has the kind " + text(row[0]) + ", but kinds go from 0 to " + text(LAST));
        }
        if (!(row[1] >= 0.0F && row[1] <= 1.0F)) {
            throw py::value_error("diffuse has the roughness " + text(row[1]) + ", which must lie between 0 and 1");
        }
        out.push_back({static_cast<Spreading>(static_cast<int>(row[0])), row[1]});
    }
    return out;
}

// Rows of a colour, a kind of spreading that sheens have, and a roughness.
std::vector<Sheen> sheens_of(const Floats &array, py::ssize_t count) {
    require_shape(array, {count, 5}, "sheen");
    require_range(array, 0.0F, 1e6F, "sheen");
    std::vector<Sheen> out;
    constexpr auto FIRST = static_cast<float>(Spreading::SHEEN), LAST = static_cast<float>(Spreading::FIBRES);
    for (const float *row = array.data(); row != array.data() + array.size(); row += 5) {
        if (!(row[3] >= FIRST && row[3] <= LAST && std::floor(row[3]) == row[3])) {
            throw py::value_error("sheen has the kind " + text(row[3]) + ", but kinds go from " + text(FIRST) + " to " +
                                  text(LAST));
        }
        if (row[4] > 1.0F) {
            throw py::value_error("sheen has the roughness " + text(row[4]) + ", which must lie between 0 and 1");
        }
        out.push_back({{row[0], row[1], row[2]}, {static_cast<Spreading>(static_cast<int>(row[3])), row[4]}});
    }
    return out;
}

void vectors(const Floats &array, std::vector<glm::vec3> &out) {
    const auto *first = reinterpret_cast<const glm::vec3 *>(array.data());
    // One more than there are: Embree loads sixteen bytes for the last of them, too.
    out.reserve(static_cast<std::size_t>(array.size() / 3) + 1);
    out.assign(first, first + array.size() / 3);
}

std::vector<std::array<glm::vec3, 3>> corners(const Floats &array) {
    const auto *first = reinterpret_cast<const std::array<glm::vec3, 3> *>(array.data());
    return {first, first + array.size() / 9};
}

// What meshes have millions of comes as 32-bit integers; anything else takes the slower way.
std::vector<std::uint32_t> any_indices(const py::array &array, py::ssize_t count, const std::string &name) {
    if (!array.dtype().is(py::dtype::of<std::int32_t>())) {
        return indices(Doubles(array), count, name);
    }
    const auto given = py::array_t<std::int32_t, py::array::c_style>::ensure(array);
    const std::int32_t *const first = given.data();
    const auto wrong =
        std::find_if(first, first + given.size(), [count](std::int32_t value) { return value < 0 || value >= count; });
    if (wrong != first + given.size()) {
        throw py::value_error(name + " holds " + text(*wrong) + " at flat index " + text(wrong - first) +
                              "; every value must be one of the " + text(count) + " indices from 0");
    }
    return {first, first + given.size()};
}

// Of what moves the middle is one of the times.
void require_odd(py::ssize_t times) {
    constexpr py::ssize_t MOST = 129; // that Embree takes
    if (times > 0 && (times < 3 || times % 2 == 0 || times > MOST)) {
        throw py::value_error("moving has " + text(times) + " times, but must have an odd number from 3 to " +
                              text(MOST));
    }
}

// 128 bits that differ wherever the arrays' types, shapes or bytes do.
py::bytes content_hash(const py::args &arrays) {
    XXH3_state_t *const state = XXH3_createState();
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> owner(state, &XXH3_freeState);
    XXH3_128bits_reset(state);
    for (const py::handle &each : arrays) {
        const py::array array = py::array::ensure(each, py::array::c_style);
        if (!array) {
            throw py::value_error("arrays hold " + std::string(py::repr(each)) + ", which is no array");
        }
        const std::string head = std::string(py::str(array.dtype())) + shape_of(array);
        XXH3_128bits_update(state, head.data(), head.size());
        // By Python's protocol: array.nbytes() is 0 where pybind11 before 2.12 meets NumPy 2, without an error.
        const py::buffer_info bytes = array.request();
        const py::gil_scoped_release unlocked;
        XXH3_128bits_update(state, bytes.ptr, static_cast<std::size_t>(bytes.size * bytes.itemsize));
    }
    XXH128_canonical_t digest;
    XXH128_canonicalFromHash(&digest, XXH3_128bits_digest(state));
    return {reinterpret_cast<const char *>(digest.digest), sizeof digest.digest};
}

} // namespace

CheckedMesh checked_mesh(const Floats &vertices, const py::object &triangles_given,
                         const std::optional<Floats> &normals, const std::optional<py::object> &material_given,
                         const std::optional<Floats> &tangents, const std::optional<Floats> &channels,
                         const std::optional<Floats> &moving) {
    const py::array triangles = any_array(triangles_given, "triangles");
    require_shape(vertices, {-1, 3}, "vertices");
    require_shape(triangles, {-1, 3}, "triangles");
    require_finite(vertices, "vertices");
    const py::ssize_t count = triangles.shape(0);
    auto shape = std::make_shared<Shape>();
    vectors(vertices, shape->vertices);
    if (moving) {
        require_shape(*moving, {-1, vertices.shape(0), 3}, "moving");
        require_finite(*moving, "moving");
        require_odd(moving->shape(0));
        shape->moving.resize(static_cast<std::size_t>(moving->shape(0)));
        const auto *first = reinterpret_cast<const glm::vec3 *>(moving->data());
        for (std::vector<glm::vec3> &time : shape->moving) {
            time.assign(first, first + vertices.shape(0));
            first += vertices.shape(0);
        }
    }
    const std::vector<std::uint32_t> all = any_indices(triangles, vertices.shape(0), "triangles");
    const auto *first = reinterpret_cast<const glm::uvec3 *>(all.data());
    shape->triangles.assign(first, first + count);
    if (normals) {
        require_finite(*normals, "normals");
        if (normals->ndim() == 3) {
            require_shape(*normals, {count, 3, 3}, "normals");
            shape->corner_normals = corners(*normals);
        } else {
            require_shape(*normals, {vertices.shape(0), 3}, "normals");
            vectors(*normals, shape->vertex_normals);
        }
    }
    if (tangents) {
        require_shape(*tangents, {count, 3, 3}, "tangents");
        require_finite(*tangents, "tangents");
        shape->corner_tangents = corners(*tangents);
    }
    if (channels) {
        require_shape(*channels, {count, 3, -1}, "channels");
        require_finite(*channels, "channels");
        if (channels->shape(2) > pattern_input::MOST_CHANNELS) {
            throw py::value_error("channels has shape " + shape_of(*channels) + "; of each corner there may be " +
                                  text(pattern_input::MOST_CHANNELS));
        }
        shape->channel_count = static_cast<std::uint32_t>(channels->shape(2));
        shape->channels.assign(channels->data(), channels->data() + channels->size());
    }
    CheckedMesh mesh;
    mesh.materials = count > 0 ? 1 : 0;
    if (material_given) {
        const py::array material = any_array(*material_given, "material");
        require_shape(material, {count}, "material");
        shape->material = any_indices(material, std::numeric_limits<std::int32_t>::max(), "material");
        for (const std::uint32_t row : shape->material) {
            mesh.materials = std::max(mesh.materials, row + 1);
        }
    }
    mesh.shape = std::move(shape);
    return mesh;
}

std::vector<std::vector<glm::mat4>> moving_places(const std::optional<Doubles> &moving, std::size_t count) {
    std::vector<std::vector<glm::mat4>> out;
    if (moving) {
        require_shape(*moving, {-1, static_cast<py::ssize_t>(count), 4, 4}, "moving");
        require_odd(moving->shape(0));
        Doubles all = *moving;
        const std::vector<glm::mat4> matrices = places(Doubles(all.reshape(std::vector<py::ssize_t>{-1, 4, 4})));
        for (auto first = matrices.begin(); first != matrices.end(); first += static_cast<std::ptrdiff_t>(count)) {
            out.emplace_back(first, first + static_cast<std::ptrdiff_t>(count));
        }
    }
    return out;
}

Materials checked_materials(const Floats &albedo, const std::optional<Floats> &gloss,
                            const std::optional<Floats> &emission, const std::optional<Floats> &diffuse,
                            const std::optional<Floats> &transmittance) {
    require_shape(albedo, {-1, 3}, "albedo");
    require_range(albedo, 0.0F, 1.0F, "albedo");
    Materials out;
    vectors(albedo, out.albedo);
    if (gloss) {
        out.gloss = glosses(*gloss, albedo.shape(0));
    }
    if (emission) {
        require_shape(*emission, {albedo.shape(0), 3}, "emission");
        require_range(*emission, 0.0F, 1e30F, "emission");
        vectors(*emission, out.emission);
    }
    if (diffuse) {
        out.diffuse = diffuse_of(*diffuse, albedo.shape(0));
    }
    if (transmittance) {
        require_shape(*transmittance, {albedo.shape(0), 3}, "transmittance");
        require_range(*transmittance, 0.0F, 1.0F, "transmittance");
        vectors(*transmittance, out.transmittance);
    }
    return out;
}

void add_more(const std::optional<Floats> &translucence, const std::optional<Floats> &sheen, Materials &out) {
    const auto count = static_cast<py::ssize_t>(out.albedo.size());
    if (translucence) {
        require_shape(*translucence, {count, 3}, "translucence");
        require_range(*translucence, 0.0F, 1.0F, "translucence");
        vectors(*translucence, out.translucence);
    }
    if (sheen) {
        out.sheen = sheens_of(*sheen, count);
    }
}

CheckedGrid checked_grid(const Floats &density, float empty_below, const std::optional<Floats> &colour,
                         const std::optional<Floats> &glow) {
    require_shape(density, {-1, -1, -1}, "density");
    if (density.size() == 0) {
        throw py::value_error("density has shape " + shape_of(density) + ", but must hold at least one cell");
    }
    if (density.size() > MOST_CELLS) {
        throw py::value_error("density has shape " + shape_of(density) + ", but can hold at most 2^29 cells");
    }
    require_range(density, 0.0F, 1e30F, "density");
    require_range(empty_below, 0.0F, std::numeric_limits<float>::infinity(), "empty_below");
    if (colour) {
        require_shape(*colour, {density.shape(0), density.shape(1), density.shape(2), 3}, "colour");
        require_range(*colour, 0.0F, 1e30F, "colour");
    }
    if (glow) {
        require_shape(*glow, {density.shape(0), density.shape(1), density.shape(2)}, "glow");
        require_range(*glow, 0.0F, 1.0F, "glow");
    }
    CheckedGrid out;
    out.resolution = {density.shape(2), density.shape(1), density.shape(0)};
    const auto count = static_cast<std::size_t>(density.size());
    const std::span<const float> cells(density.data(), count);
    const std::span<const float> glowing(glow ? glow->data() : nullptr, glow ? count : 0);
    const py::gil_scoped_release unlocked;
    const std::shared_ptr<Grid> grid = crop(cells, glm::ivec3(out.resolution), empty_below, Layout::BEST, glowing);
    if (grid && colour) {
        const std::span<const float> all(colour->data(), static_cast<std::size_t>(colour->size()));
        tint(*grid, {glm::ivec3(out.resolution), {all, all.subspan(1), all.subspan(2)}, 3}, glm::dmat4(1.0));
    }
    out.grid = grid;
    return out;
}

namespace {

py::tuple shape_and_place(const VolumeHeader &header) {
    const glm::ivec3 n = header.resolution;
    return py::make_tuple(py::make_tuple(n.z, n.y, n.x), to_numpy(header.grid_to_object));
}

CheckedGrid grid_from_file(const std::string &path, const std::string &grid, float empty_below,
                           const std::optional<std::string> &colour) {
    require_range(empty_below, 0.0F, std::numeric_limits<float>::infinity(), "empty_below");
    const CheckedGrid out = from_file([&] {
        const VolumeBlocks volume = read_volume_blocks(path, grid);
        const std::shared_ptr<Grid> cropped = crop(volume.blocks, empty_below);
        if (cropped && colour) {
            const std::vector<VolumeFile> files = read_volume_colours(path, *colour);
            const auto channel = [&](std::size_t c) { return std::span<const float>(files[c % files.size()].density); };
            tint(*cropped, {files[0].resolution, {channel(0), channel(1), channel(2)}, 1},
                 glm::inverse(files[0].grid_to_object) * volume.grid_to_object);
        }
        return CheckedGrid{cropped, glm::uvec3(volume.resolution)};
    });
    if (out.grid && out.grid->density.size() > static_cast<std::size_t>(MOST_CELLS)) {
        throw py::value_error("path '" + path + "' cannot be read: its grid '" + grid + "' takes " +
                              std::to_string(out.grid->density.size()) + " cells, but can hold at most 2^29");
    }
    return out;
}

} // namespace

namespace {

// The judge shows everything to the camera and every light to everything.
template <typename Thing, typename Plain>
void require_plain(const std::vector<Thing> &things, const std::string &name, const Plain &is_plain) {
    const auto other = std::find_if_not(things.begin(), things.end(), is_plain);
    if (other != things.end()) {
        throw py::value_error(name + " " + text(other - things.begin()) + ", which the reference does not know");
    }
}

} // namespace

Scene ConsoleScene::for_reference() const {
    const auto seen = [](const auto &thing) { return thing.visibility == Visibility{}; };
    require_plain(meshes, "there is a visibility of mesh", seen);
    require_plain(meshes, "there is a pattern of mesh",
                  [](const Instances &mesh) { return mesh.materials.patterns.empty(); });
    require_plain(meshes, "there is a transmittance of mesh",
                  [](const Instances &mesh) { return mesh.materials.transmittance.empty(); });
    require_plain(meshes, "there is a translucence or a sheen of mesh", [](const Instances &mesh) {
        return mesh.materials.translucence.empty() && mesh.materials.sheen.empty();
    });
    require_plain(media, "there is a visibility of medium", seen);
    require_plain(media, "there is a transfer of medium", [](const Medium &medium) { return !medium.transfer; });
    require_plain(particles, "there is a visibility of particles", seen);
    require_plain(lights, "there is a reach of light", [](const Light &l) { return l.reach == Reach{}; });
    require_plain(lights, "there is a stretched cone of light", [](const Light &l) { return !l.oval; });
    require_plain(air, "there is a visibility of air", seen);
    Scene scene = *this;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto &[density, colour, glow] = sources[i];
        if (!density) {
            throw py::value_error("medium " + text(i) + " came as a Grid; the reference wants its densities");
        }
        scene.media[i].density.assign(density->data(), density->data() + density->size());
        if (colour) {
            vectors(*colour, scene.media[i].colour);
        }
        if (glow) {
            scene.media[i].glow.assign(glow->data(), glow->data() + glow->size());
        }
    }
    return scene;
}

void bind_scene_parts(py::module_ &m) {
    m.def("content_hash", &content_hash, R"(16 bytes that differ wherever arrays do: in type, shape or values (XXH3).

>>> import numpy as np
>>> content_hash(np.zeros(3)) == content_hash(np.zeros(3)), content_hash(np.zeros(3)) == content_hash(np.zeros((3, 1)))
(True, False)
)");
    py::class_<CheckedMesh>(m, "Mesh", R"(Triangles that any number of objects may share, in a space of their own.

vertices (n, 3); triangles (m, 3), indices into vertices; normals, unit length: one for each vertex (n, 3) or one for
each corner (m, 3, 3), and without any, flat faces whose front is the side from which their corners run counterclockwise;
material (m,), a row of what the object's materials are, the first without it; tangents (m, 3, 3), the directions of
brushed gloss at the corners; channels (m, 3, k), numbers at the corners that patterns ask for; moving, vertices at even
times while the shutter of an Exposure is open, an odd number of them. A Frame keeps what it makes of a Mesh in its Prepared: add the same one again and nothing
is built twice. Raises ValueError for wrong shapes, indices out of range and values that are not finite.

>>> Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).triangles
1
)")
        .def(py::init(&checked_mesh), py::arg("vertices"), py::arg("triangles"), py::arg("normals") = py::none(),
             py::arg("material") = py::none(), py::arg("tangents") = py::none(), py::arg("channels") = py::none(),
             py::arg("moving") = py::none())
        .def_property_readonly(
            "triangles", [](const CheckedMesh &mesh) { return mesh.shape->triangles.size(); }, "How many there are.");
    m.def(
        "emptiness",
        [](const std::array<unsigned, 3> &shape, const Doubles &grid_to_world, const Floats &extinction) {
            return emptiness({shape[2], shape[1], shape[0]}, affine_matrix(grid_to_world, "grid_to_world"),
                             vector3(extinction, "extinction"));
        },
        py::arg("shape"), py::arg("grid_to_world"), py::arg("extinction"),
        R"(The density that could darken nothing by more than 1e-4 of optical depth along a grid's diagonal: what a frame
takes for empty. shape (nz, ny, nx); extinction (3,), per metre and unit density; infinite where that is 0.

>>> import numpy as np
>>> round(emptiness((12, 4, 3), np.eye(4), extinction=(1, 5, 1)) * 5 * 13 * 1e4, 6)
1.0
)");
    m.def(
        "volume_header",
        [](const std::string &path, const std::string &grid) {
            return shape_and_place(from_file([&] { return read_volume_header(path, grid); }));
        },
        py::arg("path"), py::arg("grid") = "density",
        R"(Of what read_volume gives, the density's shape (nz, ny, nx) and grid_to_object (4, 4), read from the file's
header alone where it has them. Raises ValueError as read_volume does.

>>> volume_header("missing.vdb")  # doctest: +ELLIPSIS
Traceback (most recent call last):
ValueError: path 'missing.vdb' cannot be read: ...
)");
    py::class_<CheckedGrid>(m, "Grid", R"(Densities of smoke, cropped to the cells above empty_below (see emptiness).

density (nz, ny, nx), not negative; colour (nz, ny, nx, 3), not negative, and glow (nz, ny, nx) in [0, 1], those of
Scene.add_medium. Cells that glow are kept, too. Scene.add_medium takes a Grid for its density: add the same one again,
with a lamp that has moved, and what is still right of its light maps is kept. The arrays are not kept.
Raises ValueError for an empty, negative or non-finite density, and for colours or a glow of another shape.

>>> import numpy as np
>>> smoke = np.zeros((8, 8, 8), np.float32)
>>> smoke[2:4, 2:5, 2:6] = 1.0
>>> Grid(smoke).cells
120
)")
        .def(py::init(&checked_grid), py::arg("density"), py::arg("empty_below") = 0.0F, py::arg("colour") = py::none(),
             py::arg("glow") = py::none())
        .def_static("from_file", &grid_from_file, py::arg("path"), py::arg("grid") = "density",
                    py::arg("empty_below") = 0.0F, py::arg("colour") = py::none(),
                    R"(The Grid of what read_volume gives, without that array in between; colour, another grid of the
file, of vectors or for grey of scalars, wherever it lies. Raises ValueError that names the file and the cause.

>>> Grid.from_file("missing.vdb")  # doctest: +ELLIPSIS
Traceback (most recent call last):
ValueError: path 'missing.vdb' cannot be read: ...
)")
        .def_property_readonly(
            "amount", [](const CheckedGrid &grid) { return grid.grid ? grid.grid->amount : 0.0; },
            "The sum of all densities that are kept.")
        .def_property_readonly(
            "brightest", [](const CheckedGrid &grid) { return to_numpy(brightest(grid.grid.get())); },
            "(3,): the highest value of each channel of its colour, 1 where it has none.")
        .def_property_readonly(
            "cells", [](const CheckedGrid &grid) { return grid.grid ? grid.grid->density.size() : 0; },
            "How many are kept, one empty cell around the smoke included; 0 where nothing can be seen of it. Where "
            "most of\n"
            "what lies between is empty, those of bricks of 9^3 cells, one of which is empty and stands for all that "
            "are.");
}

} // namespace sfumato
