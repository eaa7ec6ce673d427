// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on surfaces as Python hands them over, checked.
#include "module/textures.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"
#include "textures/image_kernels.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

namespace sfumato {

using namespace arguments;

namespace {

std::shared_ptr<SurfaceImage> image_of(const py::object &given, bool curved, bool divided, bool closest) {
    const py::array pixels = any_array(given, "pixels");
    require_shape(pixels, {-1, -1, 4}, "pixels");
    if (pixels.size() == 0) {
        throw py::value_error("pixels has shape " + shape_of(pixels) + ", but an image has texels");
    }
    const bool bytes = pixels.dtype().is(py::dtype::of<std::uint8_t>());
    if (!bytes && pixels.dtype().kind() != 'f') {
        throw py::value_error("pixels is " + told(pixels) + ", but must be of uint8 or float32");
    }
    const std::int64_t texels = pixels.size() / 4, most = bytes ? SurfaceImage::MOST_BYTES : SurfaceImage::MOST_FLOATS;
    if (texels > most) {
        throw py::value_error("pixels has shape " + shape_of(pixels) + ", but an image has at most " + text(most) +
                              " texels");
    }
    const ImageMeaning meaning{curved, divided, closest};
    const auto height = static_cast<int>(pixels.shape(0)), width = static_cast<int>(pixels.shape(1));
    const auto size = static_cast<std::size_t>(pixels.size());
    if (bytes) {
        const py::array_t<std::uint8_t, py::array::c_style> values(pixels);
        const py::gil_scoped_release without;
        return std::make_shared<SurfaceImage>(width, height, std::span(values.data(), size), meaning);
    }
    const Floats values(pixels);
    require_finite(values, "pixels");
    const py::gil_scoped_release without;
    return std::make_shared<SurfaceImage>(width, height, std::span(values.data(), size), meaning);
}

template <typename Enum, std::size_t COUNT>
Enum one_of(const std::array<std::pair<const char *, Enum>, COUNT> &all, const std::string &given,
            const std::string &name) {
    std::string names;
    for (const auto &[known, value] : all) {
        if (given == known) {
            return value;
        }
        names += (names.empty() ? "'" : ", '") + std::string(known) + "'";
    }
    throw py::value_error(name + " is " + told(py::str(given)) + ", but must be one of " + names);
}

constexpr std::array INTERPOLATIONS{std::pair("closest", Interpolation::CLOSEST),
                                    std::pair("linear", Interpolation::LINEAR),
                                    std::pair("cubic", Interpolation::CUBIC)};
constexpr std::array EXTENSIONS{std::pair("repeat", Extension::REPEAT), std::pair("extend", Extension::EXTEND),
                                std::pair("clip", Extension::CLIP), std::pair("mirror", Extension::MIRROR)};

py::array_t<float> look_up_in(const SurfaceImage &image, const Floats &u, const Floats &v,
                              const std::optional<Floats> &du, const std::optional<Floats> &dv,
                              const std::string &interpolation, const std::string &extension) {
    require_shape(u, {-1}, "u");
    const py::ssize_t count = u.size();
    require_shape(v, {count}, "v");
    // Of a place its coordinate's two steps; the kernels take the two coordinates of a step.
    std::vector<float> across, up;
    if (du || dv) {
        across.assign(2 * static_cast<std::size_t>(count), 0.0F);
        up = across;
        for (const std::size_t coordinate : {std::size_t{0}, std::size_t{1}}) {
            const std::optional<Floats> &steps = coordinate == 0 ? du : dv;
            if (!steps) {
                continue;
            }
            require_shape(*steps, {count, 2}, coordinate == 0 ? "du" : "dv");
            for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
                across[2 * i + coordinate] = steps->data()[2 * i];
                up[2 * i + coordinate] = steps->data()[2 * i + 1];
            }
        }
    }
    const Interpolation between = interpolation_named(interpolation);
    const Extension beyond = extension_named(extension);
    std::vector<float> rgba(4 * static_cast<std::size_t>(count));
    {
        const py::gil_scoped_release without;
        image_kernels().look_up_all(image.view(), between, beyond,
                                    {static_cast<std::size_t>(count), u.data(), v.data(),
                                     across.empty() ? nullptr : across.data(), up.empty() ? nullptr : up.data(),
                                     rgba.data()});
    }
    return to_numpy(std::move(rgba), {count, 4});
}

} // namespace

Interpolation interpolation_named(const std::string &given) {
    return one_of(INTERPOLATIONS, given, "interpolation");
}

Extension extension_named(const std::string &given) {
    return one_of(EXTENSIONS, given, "extension");
}

void bind_textures(py::module_ &m) {
    py::class_<SurfaceImage, std::shared_ptr<SurfaceImage>>(m, "Image",
                                                            R"(A picture on surfaces, with a pyramid of means of itself.

pixels (height, width, 4) of red, green, blue and alpha, uint8 or floats, has rows from the bottom up. Where it is
`curved`, its colours have sRGB's curve: between texels they are mixed with it. Where it is `divided`, they are
multiplied by alpha, and what is looked up is divided by it. Of one that is only looked up `closest` nothing between
texels counts in means. Raises ValueError for other shapes, for values that are not finite, and beyond 2^30 texels of
bytes or 2^28 of floats.

>>> import numpy as np
>>> Image(np.full((2, 3, 4), 255, np.uint8)).shape
(2, 3)
)")
        .def(py::init(&image_of), py::arg("pixels"), py::arg("curved") = false, py::arg("divided") = false,
             py::arg("closest") = false)
        .def_property_readonly(
            "shape", [](const SurfaceImage &image) { return py::make_tuple(image.view().height, image.view().width); },
            "Its rows and columns.")
        .def("look_up", &look_up_in, py::arg("u"), py::arg("v"), py::arg("du") = std::nullopt,
             py::arg("dv") = std::nullopt, py::arg("interpolation") = "linear", py::arg("extension") = "repeat",
             R"(Linear colours and alpha (n, 4) at places u, v (n,), which are within [0, 1] on the picture. du and dv
(n, 2) are how far these move along both axes of a pixel, over which the mean is taken. interpolation is 'closest',
'linear' or 'cubic', extension 'repeat', 'extend', 'clip' or 'mirror'. Where a place is not finite, all is 0.

>>> import numpy as np
>>> Image(np.full((2, 2, 4), 51, np.uint8)).look_up([0.5], [0.5]).round(3)
array([[0.2, 0.2, 0.2, 0.2]], dtype=float32)
)");
}

} // namespace sfumato
