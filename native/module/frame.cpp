// SPDX-License-Identifier: GPL-3.0-or-later
// Frames: images, and what a GPU needs to make them.
#include "frame/frame.hpp"

#include "frame/passes.hpp"
#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "module/rays.hpp"
#include "module/scene_parts.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <variant>

#include <pybind11/functional.h>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

FrameSettings settings_of(std::optional<int> coefficients, const std::string &basis, const std::string &ranges) {
    FrameSettings settings;
    const auto form = one_of<5>(basis, {"fourier", "cosine", "piecewise", "learned", "curve"}, "basis");
    settings.shared_ranges = one_of<2>(ranges, {"own", "shared"}, "ranges") == 1;
    settings.curved = form > LEARNED;
    if (settings.curved) {
        if (coefficients) {
            throw py::value_error("coefficients is " + std::to_string(*coefficients) +
                                  ", but the basis is 'curve', which has none");
        }
        if (settings.shared_ranges) {
            throw py::value_error("ranges is 'shared', but the basis is 'curve': each curve has its own range");
        }
        return settings;
    }
    settings.basis = static_cast<BasisName>(form);
    settings.coefficients = coefficients.value_or(settings.coefficients);
    require_range(settings.coefficients, 1, 63, "coefficients");
    require_coefficients(BASES[settings.basis], static_cast<std::size_t>(settings.coefficients));
    return settings;
}

Frame make_frame(const ConsoleScene &scene, std::optional<int> coefficients, double texels_per_cell,
                 double steps_per_cell, int light_samples, const std::shared_ptr<Prepared> &prepared,
                 const std::string &basis, const std::string &ranges, int air_texels) {
    FrameSettings settings = settings_of(coefficients, basis, ranges);
    require_range(air_texels, 16, 8192, "air_texels");
    settings.air_texels = air_texels;
    require_range(texels_per_cell, 0.05, 8.0, "texels_per_cell");
    require_range(steps_per_cell, 0.05, 64.0, "steps_per_cell");
    require_range(light_samples, 1, 1024, "light_samples");
    settings.texels_per_cell = texels_per_cell;
    settings.steps_per_cell = steps_per_cell;
    settings.light_samples = light_samples;
    const py::gil_scoped_release unlocked;
    return {scene, settings, prepared ? prepared : std::make_shared<Prepared>()};
}

void require_size(int width, int height) {
    require_range(width, 1, 65536, "width");
    require_range(height, 1, 65536, "height");
}

using PythonProgress = std::optional<std::function<py::object(double)>>;

Progress reporting(const PythonProgress &progress) {
    if (!progress) {
        return {};
    }
    return [&progress](double done) {
        const py::gil_scoped_acquire locked;
        const py::object answer = (*progress)(done);
        return answer.is_none() || py::bool_(answer); // a function without a return statement stops nothing
    };
}

// The image that `work` makes with the interpreter's lock released, or None.
template <typename Work>
py::object image_of(int width, int height, const Work &work) {
    std::optional<std::vector<float>> image;
    {
        const py::gil_scoped_release unlocked;
        image = work();
    }
    return image ? py::object(to_numpy(std::move(*image), {height, width, 4})) : py::none();
}

using CameraOrExposure = std::variant<Camera, Exposure>;

Exposure exposure_of(const CameraOrExposure &taken) {
    return std::visit([](const auto &each) { return Exposure(each); }, taken);
}

py::object render(const Frame &frame, const CameraOrExposure &camera, int width, int height, int edge_samples,
                  const PythonProgress &progress) {
    require_size(width, height);
    require_range(edge_samples, 1, 1024, "edge_samples");
    return image_of(width, height, [&] {
        return frame.render(exposure_of(camera), width, height, edge_samples, reporting(progress));
    });
}

// Mist by name as Frame.passes has it: (start, depth, power).
Mist mist_of(const std::optional<Floats> &given, const Floats &eye, const Floats &axis) {
    Mist mist{vector3(eye, "eye"), vector3(axis, "axis"), 0.0F, 1.0F, 1.0F};
    if (given) {
        const glm::vec3 values = vector3(*given, "mist");
        mist.start = values.x, mist.depth = values.y, mist.power = values.z;
        require_range(mist.start, 0.0F, 1e30F, "mist's start");
        require_range(mist.depth, 1e-6F, 1e30F, "mist's depth");
        require_range(mist.power, 0.01F, 100.0F, "mist's power");
    }
    return mist;
}

py::object passes(const Frame &frame, const CameraOrExposure &camera, int width, int height,
                  const std::vector<std::string> &names, int edge_samples, const PythonProgress &progress,
                  const std::optional<Floats> &mist, const Floats &eye, const Floats &axis, const std::string &filter,
                  float filter_width, float least_alpha) {
    require_size(width, height);
    require_range(edge_samples, 1, 1024, "edge_samples");
    require_range(filter_width, 0.01F, 10.0F, "filter_width");
    require_range(least_alpha, 0.0F, 1.0F, "least_alpha");
    const auto shape = one_of<3>(filter, {"blackman_harris", "gaussian", "box"}, "filter");
    const Film film{edge_samples, {static_cast<Filter::Shape>(shape), filter_width}};
    LayerSet wanted = PICTURE;
    for (const std::string &name : names) {
        const auto kinds = pass_kinds();
        const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const PassKind &k) { return k.name == name; });
        if (kind == kinds.end()) {
            std::string all;
            for (const PassKind &known : kinds) {
                all += (all.empty() ? "'" : ", '") + std::string(known.name) + "'";
            }
            throw py::value_error("names holds '" + name + "', but must be of " + all);
        }
        wanted = wanted.with(kind->layer);
    }
    const Mist fading = mist_of(mist, eye, axis);
    std::optional<Image> image;
    {
        const py::gil_scoped_release unlocked;
        image =
            frame.passes(exposure_of(camera), width, height, wanted, fading, least_alpha, film, reporting(progress));
    }
    if (!image) {
        return py::none();
    }
    py::dict out;
    out["picture"] = to_numpy(std::move(image->rgba), {height, width, 4});
    for (PassImage &pass : image->passes) {
        const auto channels = static_cast<py::ssize_t>(pass.kind->channels);
        out[pass.kind->name] = to_numpy(std::move(pass.values), {height, width, channels});
    }
    return out;
}

LayerSet layers_of(const std::string &name, const std::string &others) {
    if (name == "smoke_shadow" || name == "all_shadows") {
        return name == "smoke_shadow" ? Layer::SMOKE_SHADOW : Layer::ALL_SHADOWS;
    }
    if (name == "opaque") {
        return LayerSet(Layer::RADIANCE).with(Layer::SHEETLESS);
    }
    if (name != "radiance") {
        throw py::value_error("output is '" + name + "', but must be " + others +
                              "'radiance', 'opaque', 'smoke_shadow' or 'all_shadows'");
    }
    return Layer::RADIANCE;
}

py::object surfaces(const Frame &frame, const Camera &camera, int width, int height, const std::string &output,
                    int edge_samples, const PythonProgress &progress) {
    require_size(width, height);
    require_range(edge_samples, 1, 1024, "edge_samples");
    const LayerSet wanted = layers_of(output, "");
    return image_of(width, height,
                    [&] { return frame.surfaces(camera, width, height, wanted, edge_samples, reporting(progress)); });
}

py::object glance(const Frame &frame, const Camera &camera, int width, int height, const std::string &output,
                  int spacing, std::optional<float> shadow_strength) {
    require_size(width, height);
    require_range(spacing, 1, 64, "spacing");
    LayerSet wanted = output == "picture" ? PICTURE : layers_of(output, "'picture', ");
    if (shadow_strength) {
        require_range(*shadow_strength, 0.0F, 1.0F, "shadow_strength");
        if (!wanted.shadow()) {
            throw py::value_error("shadow_strength is given, but output is '" + output + "', which is no shadow");
        }
        wanted = wanted.with(Layer::SMOKE);
    }
    std::vector<float> values;
    {
        const py::gil_scoped_release unlocked;
        values = frame.glance(camera, width, height, wanted, spacing, shadow_strength.value_or(1.0F));
    }
    if (shadow_strength) {
        return to_numpy(std::move(values), {2, height, width, 4});
    }
    return to_numpy(std::move(values), {height, width, 4});
}

py::object from_rows(const std::vector<glm::vec3> &rows, const std::vector<py::ssize_t> &shape) {
    std::vector<float> values;
    values.reserve(3 * rows.size());
    for (const glm::vec3 &row : rows) {
        values.insert(values.end(), {row.x, row.y, row.z});
    }
    return to_numpy(std::move(values), shape);
}

py::tuple sprites(const Frame &frame, const Camera &camera, bool past_smoke) {
    Sprites made;
    {
        const py::gil_scoped_release unlocked;
        made = frame.sprites(camera, past_smoke);
    }
    const auto count = static_cast<py::ssize_t>(made.radius.size());
    return py::make_tuple(from_rows(made.points, {count, 3}), to_numpy(std::move(made.radius), {count}),
                          to_numpy(std::move(made.opacity), {count}), from_rows(made.colour, {count, 3}));
}

py::tuple triangles(const Frame &frame, const Camera &camera, int width, int height) {
    require_size(width, height);
    Triangles made;
    {
        const py::gil_scoped_release unlocked;
        made = frame.triangles(camera, width, height);
    }
    const auto count = static_cast<py::ssize_t>(made.opacity.size());
    std::vector<float> strip;
    for (const glm::vec2 &corner : made.strip) {
        strip.insert(strip.end(), {corner.x, corner.y});
    }
    return py::make_tuple(from_rows(made.corners, {count, 3, 3}), to_numpy(std::move(made.opacity), {count}),
                          from_rows(made.colour, {count, 3, 3}), to_numpy(std::move(strip), {count, 3, 2}));
}

void require_light(const Frame &frame, int light) {
    const auto count = static_cast<int>(frame.lighting().views().size());
    if (light < 0 || light >= count) {
        throw py::value_error("light is " + std::to_string(light) + ", but the frame has " + std::to_string(count));
    }
}

const LightMap *light_map(const Frame &frame, int light, int sample, int medium) {
    require_light(frame, light);
    const auto samples = static_cast<int>(frame.lighting().views()[static_cast<std::size_t>(light)].samples.size());
    require_range(sample, 0, samples - 1, "sample");
    require_range(medium, 0, static_cast<int>(frame.lighting().bodies().size()) - 1, "medium");
    const auto index = [](int value) { return static_cast<std::size_t>(value); };
    return frame.lighting().map(index(light), index(sample), index(medium));
}

py::array_t<float> lights_of(const Frame &frame) {
    std::vector<float> values;
    const auto row = [&values](const glm::vec3 &v, float last) { values.insert(values.end(), {v.x, v.y, v.z, last}); };
    const auto lights = frame.lighting().views().first(frame.lighting().of_smoke());
    for (const LightView &light : lights) {
        row(light.direction, light.parallel() ? 2.0F - light.concentration : 0.0F);
        row(light.position, light.parallel() ? light.radius * light.radius : light.size2);
        row(light.strength, static_cast<float>(light.samples.size()));
    }
    return to_numpy(std::move(values), {static_cast<py::ssize_t>(lights.size()), 3, 4});
}

py::array_t<float> transmittance_at(const Frame &frame, const Floats &points, int light) {
    if (points.ndim() < 1 || points.shape(points.ndim() - 1) != 3) {
        throw py::value_error("points has shape " + shape_of(points) + ", but its last axis must be 3");
    }
    require_finite(points, "points");
    require_light(frame, light);
    std::vector<float> out(static_cast<std::size_t>(points.size()), 1.0F);
    {
        const py::gil_scoped_release unlocked;
        frame.transmittance(static_cast<std::size_t>(light),
                            std::span(points.data(), static_cast<std::size_t>(points.size())), out);
    }
    return to_numpy(std::move(out), {points.shape(), points.shape() + points.ndim()});
}

} // namespace

void bind_frame(py::module_ &m) {
    py::class_<Prepared, std::shared_ptr<Prepared>>(m, "Prepared",
                                                    R"(What outlives a frame: the meshes, light maps and lit
smoke of the last one, and the threads that make them, as many as `threads` says, or all for 0. Of the next frame only
what has changed is made.

>>> import numpy as np
>>> scene, prepared = Scene(), Prepared(threads=2)
>>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> scene.add_instances(triangle, np.eye(4), albedo=[[0.8, 0.8, 0.8]])
>>> first, second = Frame(scene, prepared=prepared), Frame(scene, prepared=prepared)
>>> prepared.made["places"]
1
)")
        .def(py::init([](int threads) {
                 require_range(threads, 0, 1024, "threads");
                 return std::make_shared<Prepared>(threads);
             }),
             py::arg("threads") = 0)
        .def_property_readonly(
            "made",
            [](const Prepared &prepared) {
                py::dict out;
                out["meshes"] = prepared.solids.made();
                out["places"] = prepared.solids.places_made();
                out["maps"] = prepared.lights.maps.made();
                out["solids on maps"] = prepared.lights.solids.made();
                out["volumes"] = prepared.lights.volumes.made();
                return out;
            },
            "How many parts of each kind were ever made: what did not change is not made again.");

    py::class_<Frame>(m, "Frame", R"(Everything about a scene that does not depend on the camera, computed once.

The light maps keep what `basis` says of each ray: coefficients (1 to 63; by default 15) of 'cosine', 'fourier' (an odd
number), 'piecewise' or 'learned', as project makes them, or a 'curve' (RayStorage), which has none. ranges 'own': each
ray's series spans the ray's own smoke; 'shared': the map's whole depth, so that coefficients filter: a large light has
one map, and a filter stands for its size.
texels_per_cell and steps_per_cell relate the maps' resolution and the march along view rays to the cells of the smoke;
light_samples, the most points at which a light is sampled that is large enough to blur the smoke's shadow; air_texels,
the resolution along its longer side of what throws shadows in the world's air, of the maps for that. What
`prepared`, a Prepared, knows from an earlier frame is not made again.

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> Frame(scene).render(Camera(np.eye(4)), width=2, height=1)[0, 0].tolist()
[0.25, 0.5, 1.0, 0.0]
)")
        .def(py::init(&make_frame), py::arg("scene"), py::arg("coefficients") = py::none(),
             py::arg("texels_per_cell") = FrameSettings{}.texels_per_cell,
             py::arg("steps_per_cell") = FrameSettings{}.steps_per_cell,
             py::arg("light_samples") = FrameSettings{}.light_samples, py::arg("prepared") = py::none(),
             py::arg("basis") = BASES[FrameSettings{}.basis].name, py::arg("ranges") = "own",
             py::arg("air_texels") = FrameSettings{}.air_texels)
        .def("render", &render, py::arg("camera"), py::arg("width"), py::arg("height"), py::arg("edge_samples") = 16,
             py::arg("progress") = py::none(),
             R"(The finished image: (height, width, 4) float32, premultiplied scene-linear RGBA, row 0 at the bottom.

edge_samples are taken where surfaces or their shadows change, one elsewhere; of what an Exposure blurs as
many or a quarter, 16 at least; with one everything is sharp. progress(done) is called with the
share of the work that is done, by the thread that called; when it returns False the result is None.

>>> import numpy as np
>>> frame, shares = Frame(Scene()), []
>>> frame.render(Camera(np.eye(4)), width=4, height=3, progress=shares.append).shape
(3, 4, 4)
>>> frame.render(Camera(np.eye(4)), width=4, height=3, progress=lambda done: done < 0.25) is None
True
)")
        .def("passes", &passes, py::arg("camera"), py::arg("width"), py::arg("height"), py::arg("names"),
             py::arg("edge_samples") = 16, py::arg("progress") = py::none(), py::arg("mist") = py::none(),
             py::arg("eye") = std::array<float, 3>{}, py::arg("axis") = std::array<float, 3>{},
             py::arg("filter") = "blackman_harris", py::arg("filter_width") = Filter{}.width,
             py::arg("least_alpha") = FrameView{}.least_alpha,
             R"(A dictionary of images (height, width, n) float32: "picture", which is what render() makes, and those of
names. Of the first surface on each ray, through the middle of each pixel: "position" (4), in the scene's space, and 1
where there is a surface, 0 where there is none; "object_index" and "material_index" (1) as add_instances has them, else
0. Filtered as the picture is: "normal" (3), in the world and towards the eye; "mist" (1); "smoke" (4), premultiplied:
what the smoke before the surface sends, and how much it hides; "smoke_shadow" (3), the share of a surface's radiance that
smoke leaves it; "shadow" (3), the share of the light that it reflects that smoke and solids leave it, both also where
something is held out or catches shadows. Where there is no light, as where there is no surface, the first is 1, for a
product, and the second 0, as in Cycles.

What is said of one surface, its place, normal and numbers, is said of the first whose alpha is at least least_alpha,
where some let light through.
mist: start and depth in metres and a power, of the way from `eye`, or of what is parallel along `axis` from there.
filter, "blackman_harris", "gaussian" or "box", and filter_width in pixels are Cycles'; a box has 1.

>>> import numpy as np
>>> images = Frame(Scene()).passes(Camera(np.eye(4)), 2, 1, ["mist", "smoke_shadow"])
>>> {name: image.shape for name, image in images.items()}
{'picture': (1, 2, 4), 'mist': (1, 2, 1), 'smoke_shadow': (1, 2, 3)}
>>> images["mist"].tolist()
[[[1.0], [1.0]]]
)")
        .def("surfaces", &surfaces, py::arg("camera"), py::arg("width"), py::arg("height"),
             py::arg("output") = "radiance", py::arg("edge_samples") = 1, py::arg("progress") = py::none(),
             R"((height, width, 4) float32: of the first surface what `output` says, and the distance to it through the
pixel's centre in metres, the far plane's where there is none. "radiance": in the shadow of smoke and solids, but without
the smoke between it and the eye; "opaque": the same without transparent meshes before it; "smoke_shadow": the share of the light on it that smoke takes, in [0, 1], of all that
it would have if it faced every light; "all_shadows": the share that smoke and solids take.

edge_samples and progress are those of render(). With edge_samples of 1 all lights are seen at their middles, and solids
throw hard shadows; with more, lights with a size throw soft ones.

>>> import numpy as np
>>> Frame(Scene()).surfaces(Camera(np.diag([1, 1, -0.1, 1])), width=1, height=1)[0, 0].tolist()
[0.0, 0.0, 0.0, 20.0]
)")
        .def("glance", &glance, py::arg("camera"), py::arg("width"), py::arg("height"), py::arg("output") = "picture",
             py::arg("spacing") = 4, py::arg("shadow_strength") = py::none(),
             R"((height, width, 4) float32, for a camera that moves: one pixel of every spacing in either direction is
traced, those between them where these bend or surfaces end, and the rest is interpolated. All lights are seen at their
middles. "picture" is what render() makes, the other outputs what surfaces() makes.

With shadow_strength, the share of a surface's light that shadows take at most, and an output that is a shadow:
(2, height, width, 4), the smoke's radiance and 0, and the share left of what lies behind the smoke, and whether that is
a surface (1) or the background (0).

>>> import numpy as np
>>> scene = Scene()
>>> scene.set_background((0.25, 0.5, 1.0))
>>> Frame(scene).glance(Camera(np.eye(4)), width=9, height=5)[2, 3].tolist()
[0.25, 0.5, 1.0, 0.0]
>>> Frame(scene).glance(Camera(np.eye(4)), 9, 5, "all_shadows", shadow_strength=0.8)[:, 2, 3].tolist()
[[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 0.0]]
)")
        .def("sprites", &sprites, py::arg("camera"), py::arg("past_smoke") = true,
             R"(Of a drawable frame the particles that a camera sees, as Transparency of the add-on draws them: points
(n, 3); radius (n,); opacity (n,) through the middle; colour (n, 3), the radiance that each sends to the eye at an
opacity of 1, past solids and, unless past_smoke says otherwise, past all smoke and particles.

>>> import numpy as np
>>> scene = Scene()
>>> scene.add_particles([[0, 0, 0]], radius=0.5, opacity=0.75, albedo=(1, 1, 1))
>>> scene.add_sun((0, 0, -1), (4 * np.pi, 0, 0))
>>> points, radius, opacity, colour = Frame(scene).sprites(Camera(np.eye(4)), past_smoke=False)
>>> radius.tolist(), opacity.tolist(), colour.round(3).tolist()
([0.5], [0.75], [[1.0, 0.0, 0.0]])
)")
        .def(
            "triangles", &triangles, py::arg("camera"), py::arg("width"), py::arg("height"),
            R"(Of a drawable frame the hair and the transparent meshes that a camera sees, as triangles for a picture of
width x height pixels: corners (n, 3, 3); opacity (n,); colour (n, 3, 3), the radiance that each corner sends to the eye
at an opacity of 1; strip (n, 3, 2), of hair how far each corner is from its middle, and half of its width, in pixels,
else 0. Hair is strips that face the camera, wider than it by what a pixel sees around itself; meshes are cut to pieces
that are small in the picture, since their light is straight between corners.

>>> import numpy as np
>>> scene, glass = Scene(), Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
>>> scene.add_instances(glass, np.eye(4), albedo=[[0, 0, 0]], transmittance=[[0.25, 0.25, 0.25]])
>>> corners, opacity, colour, strip = Frame(scene).triangles(Camera(np.eye(4)), 64, 64)
>>> corners.shape, set(opacity.tolist())
((576, 3, 3), {0.75})
)")
        .def("transmittance", &transmittance_at, py::arg("points"), py::arg("light") = 0,
             R"(The share of a light that the smoke lets through to each of points (..., 3): (..., 3), RGB; light is
its number. Solids are left out. Raises ValueError where there is no such light.

>>> import numpy as np
>>> scene = Scene()
>>> scene.add_medium(np.full((8, 8, 8), 0.25), np.eye(4), scattering=(1, 0, 0), absorption=(0, 1, 2))
>>> scene.add_sun((0, 0, -1), (4, 4, 4))
>>> Frame(scene).transmittance([[4, 4, 20], [4, 4, -1]]).astype(float).round(3).tolist()
[[1.0, 1.0, 1.0], [0.135, 0.135, 0.018]]
)")
        .def_property_readonly(
            "media",
            [](const py::object &self) {
                py::list out;
                const auto &frame = py::cast<const Frame &>(self);
                for (const CroppedMedium &medium : frame.media().first(frame.seen_media())) {
                    out.append(py::cast(&medium, py::return_value_policy::reference_internal, self));
                }
                return out;
            },
            "A list of LitMedium, those that hold any smoke and that the camera sees.")
        .def(
            "light_map", &light_map, py::arg("light") = 0, py::arg("sample") = 0, py::arg("medium") = 0,
            py::return_value_policy::reference_internal,
            R"(The LightMap of a medium, or of particles, which follow the media, from one of the points that a light is
sampled at; None where that light cannot meet it. Raises ValueError where there is no such light, sample or medium.

>>> import numpy as np
>>> scene = Scene()
>>> scene.add_medium(np.ones((4, 4, 4)), np.eye(4), scattering=(1, 1, 1), absorption=(0, 0, 0))
>>> scene.add_sun((0, 0, -1), (4, 4, 4))
>>> Frame(scene, coefficients=7).light_map().coefficients.shape
(8, 8, 7)
)")
        .def_property_readonly("lights", &lights_of,
                               R"((n, 3, 4) float32: direction and 1 for a sun, else 0; position and
the square of the light's size, as in falloff() of shaders/lights/light.glsl, or of the sine of a sun's radius; strength, and the number of its samples.)")
        .def_property_readonly("grey", &Frame::grey, "Whether all smoke takes all colours alike: one march does.")
        .def_property_readonly(
            "opaque", &Frame::opaque,
            "Whether the first surface on each ray has an alpha of 1: none is transparent, held out, or "
            "catches shadows.")
        .def_property_readonly(
            "drawable", &Frame::drawable,
            "Whether what is sorted can be drawn by a GPU, as sprites() and triangles(): none of it "
            "takes one colour more than another, there are no grids and no air to sort it with, and no "
            "surface behind it is held out or catches shadows.")
        .def_property_readonly("particles", &Frame::particles, "Whether the camera sees any particles.")
        .def_property_readonly("air", &Frame::air, "Whether air fills the world, or a mesh.")
        .def_property_readonly("sorted", &Frame::sorted,
                               "Whether anything else than grids may lie before an opaque surface, such as transparent "
                               "meshes, or air: no march through grids shows that.")
        .def_property_readonly(
            "origin", [](const Frame &frame) { return py::array_t<double>(3, &frame.origin().x); },
            "The scene's, (3,): the place in the world to which cameras and points are relative.")
        .def_property_readonly("step_length", &Frame::step_length, "Of the march along view rays, in cells.")
        .def_property_readonly(
            "stages",
            [](const Frame &frame) {
                py::dict out;
                for (const StageClock::Row &row : frame.stages()) {
                    out[row.name] = row.seconds;
                }
                return out;
            },
            R"(The stages that ran so far, in order, and the seconds that each took: of "solids", "smoke", "particles",
"world", "lights", "light maps" and "light volumes", when the frame was made; of "surfaces", "sheets", "slices" of particles,
"march", "air", "merge" and "composite", in all pictures since, summed over the threads. What a scene does not need is not there.

>>> import numpy as np
>>> frame = Frame(Scene())
>>> image = frame.render(Camera(np.eye(4)), width=2, height=2)
>>> list(frame.stages)
['solids', 'surfaces', 'composite']
)");
}

} // namespace sfumato
