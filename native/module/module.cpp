// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module. No arithmetic: arguments are checked, work is handed on, results are wrapped.
#include "frame/libraries.hpp"
#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "module/scene_parts.hpp"
#include "scene/volume_file.hpp"
#include "text/dispatch.hpp"

namespace sfumato {
namespace {

using namespace arguments;

py::tuple read_volume_file(const std::string &path, const std::string &grid) {
    std::vector<VolumeFile> channels = from_file([&] { return read_volume_colours(path, grid); });
    const glm::ivec3 n = channels[0].resolution;
    const py::object to_object = to_numpy(channels[0].grid_to_object);
    if (channels.size() == 1) {
        return py::make_tuple(to_numpy(std::move(channels[0].density), {n.z, n.y, n.x}), to_object);
    }
    std::vector<float> vectors(channels.size() * channels[0].density.size());
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        vectors[i] = channels[i % channels.size()].density[i / channels.size()];
    }
    return py::make_tuple(to_numpy(std::move(vectors), {n.z, n.y, n.x, static_cast<int>(channels.size())}), to_object);
}

} // namespace
} // namespace sfumato

PYBIND11_MODULE(sfumato, m) {
    using namespace sfumato;
    namespace py = pybind11;
    m.doc() =
        "Smoke, its light and its shadow: NumPy arrays in, NumPy arrays out.\n\n"
        "Metres, Z up, scene-linear RGB. Arrays may be float32 or float64; work is done in float32, but for\n"
        "integrals over area lights, which keep the precision that they are given. Values that cannot be used\n"
        "raise ValueError, which says which argument it was, and calls without it, or with one too many, TypeError.";
    m.attr("instruction_set") = instruction_set().name;
    m.attr("interface") = SFUMATO_INTERFACE; // the hash of sfumato.pyi: what calls this was written for the same one
    bind_airlight(m);
    bind_area_light(m);
    bind_basis(m);
    bind_map(m);
    bind_microfacet(m);
    bind_opacity(m);
    bind_pictures(m);
    bind_ray_storage(m);
    bind_transfer(m); // whose types the reference takes
    bind_transparency(m);

    m.def("read_volume", &read_volume_file, py::arg("path"), py::arg("grid") = "density",
          R"(The active part of a grid of an OpenVDB file, of scalars (nz, ny, nx) or of vectors (nz, ny, nx, 3), and
grid_to_object (4, 4), which takes cells to the file's own space. Raises ValueError that names the file and the cause.

>>> read_volume("missing.vdb")  # doctest: +ELLIPSIS
Traceback (most recent call last):
ValueError: path 'missing.vdb' cannot be read: ...
)");

    m.def(
        "library_problem", &library_problem,
        R"(What is wrong with Embree or oneTBB as this process has them, or nothing: their versions are asked for, and one
ray is traced.

>>> library_problem()
''
)");
    m.def("end_threads", &end_threads, py::call_guard<py::gil_scoped_release>(),
          R"(Ends the threads that work for this module, until there is work again. False where a Prepared or a Frame is
still there that has some. Done when Python exits, too.

>>> end_threads()
True
)");
    // Else they may still run while what they need goes with the process.
    py::module_::import("atexit").attr("register")(m.attr("end_threads"));

    bind_scene_parts(m);
    bind_textures(m);
    bind_pattern(m);
    bind_visibility(m);
    bind_sky(m);
    bind_scene(m);
    bind_exposure(m);
    bind_shafts(m);
    bind_reference(m);
    bind_frame_parts(m);
    bind_frame(m);
    bind_measure(m);
    refuse_plainly(m);
}
