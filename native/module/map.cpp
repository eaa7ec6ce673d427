// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of light rays: filtering, smaller maps, and ranges that their texels share.
#include "maps/map_filter.hpp"
#include "module/parts.hpp"
#include "module/rays.hpp"

#include <limits>

#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

MapSize map_size(const Floats &map, const std::string &name) {
    require_shape(map, {-1, -1, -1}, name);
    if (map.size() == 0) {
        throw py::value_error(name + " has shape " + shape_of(map) + ", but must hold at least one texel");
    }
    return {static_cast<std::size_t>(map.shape(0)), static_cast<std::size_t>(map.shape(1)), last_axis(map)};
}

std::vector<py::ssize_t> shape_of_map(const MapSize &size) {
    return {static_cast<py::ssize_t>(size.height), static_cast<py::ssize_t>(size.width),
            static_cast<py::ssize_t>(size.count)};
}

void require_one_range(const OptionalFloats &range, const MapSize &size) {
    const std::vector<Range> ranges =
        ranges_of(range, {static_cast<py::ssize_t>(size.height), static_cast<py::ssize_t>(size.width)});
    for (std::size_t i = 1; i < ranges.size(); ++i) {
        if (ranges[i].low != ranges[0].low || ranges[i].high != ranges[0].high) {
            throw py::value_error("range holds " + text(ranges[i].low) + ", " + text(ranges[i].high) + " at texel (" +
                                  std::to_string(i / size.width) + ", " + std::to_string(i % size.width) +
                                  ") and others elsewhere, but coefficients mix only where all share one range: see "
                                  "depth_ranges, or filter the transmittance");
        }
    }
}

py::object filter(const py::object &coefficients, double width, const std::string &kind, const OptionalFloats &range) {
    const py::array given = any_array(coefficients, "coefficients");
    const Floats map(given);
    const MapSize size = map_size(map, "coefficients");
    require_finite(map, "coefficients");
    const auto how = static_cast<FilterKind>(one_of<2>(kind, {"box", "gaussian"}, "kind"));
    require_range(width, how == FilterKind::BOX ? 1.0 : 0.0, 65535.0, "width");
    if (how == FilterKind::BOX && std::fmod(width, 2.0) != 1.0) {
        throw py::value_error("width is " + text(width) + ", but that of a box must be an odd number of texels");
    }
    require_one_range(range, size);
    std::vector<float> out(size.floats());
    {
        const py::gil_scoped_release unlocked;
        filter_map({map.data(), out.size()}, out, size, how, width);
    }
    return as_given(given, to_numpy(std::move(out), shape_of_map(size)));
}

py::list mip_chain(const py::object &coefficients, const OptionalFloats &range) {
    const py::array given = any_array(coefficients, "coefficients");
    const Floats map(given);
    MapSize size = map_size(map, "coefficients");
    require_finite(map, "coefficients");
    require_one_range(range, size);
    py::list levels;
    std::vector<float> fine(map.data(), map.data() + map.size());
    while (size.height > 1 || size.width > 1) {
        const MapSize half = half_size(size);
        std::vector<float> coarse(half.floats());
        {
            const py::gil_scoped_release unlocked;
            halve_map(fine, coarse, size);
        }
        levels.append(as_given(given, to_numpy(std::move(fine), shape_of_map(size))));
        fine = std::move(coarse);
        size = half;
    }
    levels.append(as_given(given, to_numpy(std::move(fine), shape_of_map(size))));
    return levels;
}

py::array_t<float> ranges_of_map(const py::object &depth, const py::object &optical_depth, int tile, int reach,
                                 const std::string &kind, float q, float width) {
    const Rays rays(depth, optical_depth, width);
    const MapSize size = map_size(rays.z, "depth");
    constexpr int MOST = std::numeric_limits<int>::max();
    require_range(tile, 0, MOST, "tile");
    require_range(reach, 0, MOST, "reach");
    require_range(q, 0.01F, 100.0F, "q");
    const RangeKind chosen = range_kind(kind);
    std::vector<Range> ranges;
    {
        const py::gil_scoped_release unlocked;
        ranges =
            shared_ranges(rays.all(), size, chosen, q, static_cast<std::size_t>(tile), static_cast<std::size_t>(reach));
    }
    std::vector<float> out;
    for (const Range &range : ranges) {
        out.insert(out.end(), {range.low, range.high});
    }
    return to_numpy(std::move(out), rays.shape_with(2));
}

} // namespace

void bind_map(py::module_ &m) {
    m.def("filter_map", &filter, py::arg("coefficients"), py::arg("width"), py::arg("kind") = "box",
          py::arg("range") = py::none(),
          R"(A map of coefficients, filtered along both axes: the coefficients of filtered density, whatever the basis
(Jansen and Bavoil 2010, section 3).

coefficients (height, width, n). kind 'box': the mean over `width` texels, an odd number; 'gaussian': a bell of standard
deviation `width` in texels, made of three boxes. Both take the same time whatever the width. Outside of the map there
is no smoke; what the filter carries across a rim is lost, so leave a margin as wide as it reaches.
range (height, width, 2), if given, is checked: ValueError unless all texels share one.

>>> import numpy as np
>>> spot = np.zeros((7, 7, 1))
>>> spot[3, 3] = 9.0
>>> filter_map(spot, 3)[:, :, 0].round(6).tolist()[2]
[0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]
>>> float(filter_map(spot, 0.4, "gaussian").sum().round(5))
9.0
)");
    m.def("mipmaps", &mip_chain, py::arg("coefficients"), py::arg("range") = py::none(),
          R"(A list of maps, each half as large as the one before, rounded down, from (height, width, n) itself to
(1, 1, n): means over the area that a texel covers. All have the same mean, odd sizes too. range as in filter_map.

>>> import numpy as np
>>> [level.shape for level in mipmaps(np.ones((5, 3, 7)))]
[(5, 3, 7), (2, 1, 7), (1, 1, 7)]
)");
    m.def("depth_ranges", &ranges_of_map, py::arg("depth"), py::arg("optical_depth"), py::arg("tile") = 0,
          py::arg("reach") = 1, py::arg("kind") = "minmax", py::arg("q") = 3.0F, py::arg("width") = 0.0F,
          R"(The range (height, width, 2) that every tile of tile x tile rays shares, so that their coefficients filter;
tile 0: the whole map.

depth and optical_depth (height, width, n); kind, q and width as in depth_range. A tile's range also holds the rays up
to `reach` texels beside it: 1 is enough for bilinear look-ups, (width - 1) / 2 for a box. At a border both tiles'
rays must be projected into the range of the tile that asks.

>>> import numpy as np
>>> z = np.array([0.1, 0.2, 0.3, 0.9]).reshape(1, 4, 1)
>>> depth_ranges(z, np.ones_like(z), tile=2)[0, :, 1].astype(float).round(2).tolist()
[0.3, 0.3, 0.9, 0.9]
)");
}

} // namespace sfumato
