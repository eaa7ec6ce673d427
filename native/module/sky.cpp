// SPDX-License-Identifier: GPL-3.0-or-later
// A sky as Python hands it over, checked.
#include "lights/sky.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace sfumato {

using namespace arguments;

namespace {

std::shared_ptr<SkyImage> sky_image(const Floats &radiance) {
    require_shape(radiance, {-1, -1, 3}, "radiance");
    if (radiance.size() == 0) {
        throw py::value_error("radiance has shape " + shape_of(radiance) + ", but a sky has texels");
    }
    require_range(radiance, 0.0F, 1e30F, "radiance");
    auto image = std::make_shared<SkyImage>();
    image->height = static_cast<int>(radiance.shape(0));
    image->width = static_cast<int>(radiance.shape(1));
    image->radiance.resize(static_cast<std::size_t>(radiance.size()) / 3);
    std::copy_n(radiance.data(), radiance.size(), &image->radiance.front().x);
    return image;
}

py::list suns_of(const SkyImage &image) {
    py::list out;
    const Sky sky(image);
    const auto row = [](const glm::vec3 &v) { return to_numpy(std::vector<float>{v.x, v.y, v.z}, {3}); };
    for (const Sky::Sun &sun : sky.suns()) {
        out.append(py::make_tuple(row(-sun.towards), row(sun.irradiance), sun.angle));
    }
    return out;
}

} // namespace

void bind_sky(py::module_ &m) {
    py::class_<SkyImage, std::shared_ptr<SkyImage>>(m, "Sky",
                                                    R"(A sky that differs from side to side.

radiance (height, width, 3), W/(m^2 sr), is equirectangular: rows from the zenith down, columns from -x by way of +y, +x
and -y back to -x. Raises ValueError for other shapes and for values that are not finite or negative.

>>> import numpy as np
>>> Sky(np.ones((4, 8, 3))).shape
(4, 8)
)")
        .def(py::init(&sky_image), py::arg("radiance"))
        .def_property_readonly(
            "shape", [](const SkyImage &image) { return py::make_tuple(image.height, image.width); },
            "Its rows and columns.")
        .def("suns", &suns_of,
             R"(What of it is so bright and narrow that it throws a shadow of its own, as add_sun's arguments: the
direction of its light (3,), irradiance (3,), and angular diameter.

>>> import numpy as np
>>> radiance = np.ones((64, 128, 3))
>>> radiance[20, 30] = 1e4
>>> len(Sky(radiance).suns())
1
)");
}

} // namespace sfumato
