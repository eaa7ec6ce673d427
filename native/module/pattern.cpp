// SPDX-License-Identifier: GPL-3.0-or-later
// A pattern as Python hands it over, checked; and what it gives at points of a mesh.
#include "textures/pattern.hpp"

#include "module/parts.hpp"
#include "module/scene_parts.hpp"
#include "module/textures.hpp"
#include "solids/all_hits.hpp"
#include "solids/surfaces.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include <pybind11/stl.h>

namespace sfumato {

using namespace arguments;

namespace {

using LookUp = std::tuple<std::shared_ptr<SurfaceImage>, std::string, std::string>;

constexpr py::ssize_t STEP_COLUMNS = 3 + STEP_INPUTS;

std::shared_ptr<Pattern> pattern_of(const Doubles &steps, const Doubles &outputs, const Floats &constants,
                                    const py::list &tables, const std::optional<Doubles> &integers,
                                    const py::list &images) {
    require_shape(steps, {-1, STEP_COLUMNS}, "steps");
    require_shape(outputs, {-1, 2}, "outputs");
    require_shape(constants, {-1}, "constants");
    require_finite(constants, "constants");
    static_cast<void>(indices(steps, 1 << 16, "steps"));
    static_cast<void>(indices(outputs, 256, "outputs"));
    auto pattern = std::make_shared<Pattern>();
    for (py::ssize_t i = 0; i < steps.shape(0); ++i) {
        const double *const row = steps.data(i, 0);
        if (row[0] >= static_cast<double>(PATTERN_OPS.size())) {
            throw py::value_error("steps has operation " + text(row[0]) + " in row " + text(i) + "; there are " +
                                  text(PATTERN_OPS.size()));
        }
        const double *const wide = std::find_if(row + 1, row + STEP_COLUMNS, [&](const double &value) {
            return &value != row + 2 && value >= PATTERN_REGISTERS;
        });
        if (wide != row + STEP_COLUMNS) {
            throw py::value_error("steps names register " + text(*wide) + " in row " + text(i) + "; there are " +
                                  text(PATTERN_REGISTERS));
        }
        PatternStep step{
            static_cast<PatternOp>(row[0]), static_cast<std::uint8_t>(row[1]), static_cast<std::uint16_t>(row[2]), {}};
        std::transform(row + 3, row + STEP_COLUMNS, step.from.begin(),
                       [](double value) { return static_cast<std::uint8_t>(value); });
        pattern->steps.push_back(step);
    }
    for (py::ssize_t i = 0; i < outputs.shape(0); ++i) {
        pattern->outputs.push_back(
            {static_cast<std::uint8_t>(outputs.at(i, 0)), static_cast<std::uint8_t>(outputs.at(i, 1))});
    }
    pattern->constants.assign(constants.data(), constants.data() + constants.size());
    for (const py::handle &each : tables) {
        const Floats table(any_array(py::reinterpret_borrow<py::object>(each), "tables"));
        require_finite(table, "tables");
        if (table.ndim() != 1 || table.size() < 2) {
            throw py::value_error("tables holds one of shape " + shape_of(table) + ", but must have (n,), n from 2 on");
        }
        pattern->tables.emplace_back(table.data(), table.data() + table.size());
    }
    if (integers) {
        require_shape(*integers, {-1, STEP_INTEGERS}, "integers");
        require_range(*integers, -32768.0, 32767.0, "integers");
        for (py::ssize_t i = 0; i < integers->shape(0); ++i) {
            auto &row = pattern->integers.emplace_back();
            std::transform(integers->data(i, 0), integers->data(i, 0) + STEP_INTEGERS, row.begin(),
                           [](double value) { return static_cast<std::int16_t>(value); });
        }
    }
    for (const py::handle &each : images) {
        if (!py::isinstance<py::tuple>(each) || py::len(each) != 3 ||
            !py::isinstance<SurfaceImage>(each[py::int_(0)]) || !py::isinstance<py::str>(each[py::int_(1)]) ||
            !py::isinstance<py::str>(each[py::int_(2)])) {
            throw py::value_error("images holds " + told(each) +
                                  ", but must hold an Image each, with its interpolation and extension");
        }
        const auto [image, interpolation, extension] = each.cast<LookUp>();
        pattern->look_ups.push_back({image, interpolation_named(interpolation), extension_named(extension)});
    }
    const std::string wrong = settle(*pattern);
    if (!wrong.empty()) {
        throw py::value_error("steps cannot be run: " + wrong);
    }
    return pattern;
}

py::array outputs_at(const Pattern &pattern, const CheckedMesh &mesh, const Doubles &triangle, const Floats &u,
                     const Floats &v, const std::optional<Doubles> &to_world, const Floats &values) {
    const Shape &shape = *mesh.shape;
    require_shape(triangle, {-1}, "triangle");
    require_shape(u, {triangle.shape(0)}, "u");
    require_shape(v, {triangle.shape(0)}, "v");
    require_finite(u, "u");
    require_finite(v, "v");
    require_shape(values, {-1}, "values");
    const std::vector<std::uint32_t> rows =
        indices(triangle, static_cast<py::ssize_t>(shape.triangles.size()), "triangle");
    require_inputs(pattern, shape, static_cast<std::size_t>(values.size()));
    if (to_world) {
        require_shape(*to_world, {4, 4}, "to_world");
    }
    const glm::mat4 matrix = to_world ? places(*to_world).front() : glm::mat4(1.0F);
    PlaceView place = view_of(shape, matrix, 0);
    place.values = values.data();
    std::vector<Hit> hits;
    std::vector<glm::vec3> positions;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto at = static_cast<py::ssize_t>(i);
        const glm::uvec3 &corner = shape.triangles[rows[i]];
        const float second = u.at(at), third = v.at(at);
        const glm::vec3 own = shape.vertices[corner.x] * (1.0F - second - third) + shape.vertices[corner.y] * second +
                              shape.vertices[corner.z] * third;
        hits.push_back({0, 0.0F, 0, rows[i], second, third});
        positions.emplace_back(matrix * glm::vec4(own, 1.0F));
    }
    std::vector<float> out(hits.size() * pattern.outputs.size());
    varying_kernels().outputs(pattern, place, hits, positions, out);
    return to_numpy(out, {static_cast<py::ssize_t>(hits.size()), static_cast<py::ssize_t>(pattern.outputs.size())});
}

py::array outputs_of(const Pattern &pattern, const Floats &rows) {
    require_shape(rows, {-1, -1}, "rows");
    if (rows.shape(1) < pattern.channels || pattern.place_values > 0) {
        throw py::value_error("rows has shape " + shape_of(rows) + ", but the pattern asks for " +
                              text(pattern.channels) + " channels and " + text(pattern.place_values) +
                              " values of a place, of which rows have none");
    }
    const auto count = static_cast<std::size_t>(rows.shape(0));
    std::vector<float> out(count * pattern.outputs.size());
    if (count > 0) {
        const std::span<const float> all(rows.data(), static_cast<std::size_t>(rows.size()));
        const py::gil_scoped_release unlocked;
        varying_kernels().of_rows(pattern, all, count, out);
    }
    return to_numpy(out, {rows.shape(0), static_cast<py::ssize_t>(pattern.outputs.size())});
}

} // namespace

void require_inputs(const Pattern &pattern, const Shape &shape, std::size_t values) {
    if (static_cast<std::uint32_t>(pattern.channels) > shape.channel_count) {
        throw py::value_error("a pattern asks for " + text(pattern.channels) + " channels, but the mesh has " +
                              text(shape.channel_count));
    }
    if (static_cast<std::size_t>(pattern.place_values) > values) {
        throw py::value_error("a pattern asks for " + text(pattern.place_values) +
                              " values of a place, but there are " + text(values));
    }
}

void bind_pattern(py::module_ &m) {
    py::class_<Pattern, std::shared_ptr<Pattern>>(m, "Pattern",
                                                  R"(What of a material varies over a surface, as a program.

steps (n, 13), run one after the other: an operation, by its place in operations(); the register that it writes, one of 256; its
setting; and up to ten registers that it reads. 'constant' takes the constant of that number; 'input' the number of an
input: 0 to 2 the position in the world, metres, 3 to 5 in the mesh's own space, 6 to 8 the shading normal and 9 to 11 the
triangle's, towards the eye, 12 to 14 the direction to the eye, 15 whether it sees the back, 16 to 24 the matrix to the
world, column by column, 25 the width of what a sample is a mean of, pixels, from 26 on the values of a place and from 64 on the mesh's channels; and in place of the first
register 0, or 1 or 2 for the same a pixel further along either of its axes. 'table' and 'stepped table' take one of
tables, over [0, 1], linear between its entries or the one below; textures, from 'noise' on, which may write several
registers, a row of integers (j, 6), as shaders/textures has them; 'image' one of images, an Image with its interpolation
and extension. Of conditions 1 is true; what has no value is 0.
outputs (k, 2), pairs of a slot and a register: slots 0 to 2 are the albedo, 3 to 5 the emission, 6 to 8 the
transmittance, 9 the roughness of what is diffuse, 10 to 12 the normal in the world, and from 13 on for each layer of
gloss eleven: three each of reflectance and dip, two of alpha, index, share and turn.
Raises ValueError for steps that read what nothing has written, and for numbers that are not there.

>>> import numpy as np
>>> step = lambda *row: row + (0,) * (13 - len(row))
>>> x_twice = Pattern([step(1, 0, 3), step(2, 1, 0, 0, 0)], outputs=[(0, 1)])
>>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> x_twice.at(triangle, [0], u=[0.25], v=[0.5])
array([[0.5]], dtype=float32)
)")
        .def(py::init(&pattern_of), py::arg("steps"), py::arg("outputs"), py::arg("constants") = std::vector<float>{},
             py::arg("tables") = py::list(), py::arg("integers") = py::none(), py::arg("images") = py::list())
        .def_static(
            "operations", [] { return std::vector<std::string>(PATTERN_OPS.begin(), PATTERN_OPS.end()); },
            R"(The names of operations, in the order of their numbers.

>>> Pattern.operations()[2:4]
['add', 'subtract']
)")
        .def("of", &outputs_of, py::arg("rows"),
             R"((n, k): its outputs where rows (n, m) are the mesh's channels; all else that it asks for is 0. Raises
ValueError for too few channels.

>>> import numpy as np
>>> step = lambda *row: row + (0,) * (13 - len(row))
>>> root = Pattern([step(1, 0, 64), step(12, 1, 0, 0)], outputs=[(0, 1)])
>>> root.of([[4.0], [9.0]])
array([[2.],
       [3.]], dtype=float32)
)")
        .def("at", &outputs_at, py::arg("mesh"), py::arg("triangle"), py::arg("u"), py::arg("v"),
             py::arg("to_world") = py::none(), py::arg("values") = std::vector<float>{},
             R"((n, k): its outputs at places of a mesh, seen against their normals: triangle (n,), and on it u and v
(n,), the shares of its second and third corner. to_world (4, 4); values, what it asks for of the mesh's place.
Raises ValueError for what is not finite or not there.

>>> import numpy as np
>>> step = lambda *row: row + (0,) * (13 - len(row))
>>> height = Pattern([step(1, 0, 2)], outputs=[(0, 0)])
>>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 2]], [[0, 1, 2]])
>>> height.at(triangle, [0, 0], u=[0.5, 0.0], v=[0.5, 0.0])
array([[1.],
       [0.]], dtype=float32)
)");
}

} // namespace sfumato
