// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/light_map.hpp"

#include "lights/light.hpp"
#include "maps/map_filter.hpp"
#include "maps/map_kernels.hpp"
#include "maps/sheet_depths.hpp"
#include "rays/ray_kernels.hpp"
#include "scene/affine.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

constexpr int MOST_SLICES = 32768;

// The eight corners of the body's box, taken through `to`.
std::array<glm::dvec3, 8> corners_of(const Body &body, const glm::dmat4 &to) {
    std::array<glm::dvec3, 8> corners = body.corners();
    for (glm::dvec3 &corner : corners) {
        corner = glm::dvec3(to * glm::dvec4(corner, 1.0));
    }
    return corners;
}

// Slices of half a cell, `cells` of which the ray crosses: with one a cell, the total of a small dense puff can be off
// by more than 1 %.
int slices_for(double cells) {
    return static_cast<int>(std::clamp(std::ceil(2.0 * cells), 1.0, double{MOST_SLICES}));
}

// The edge of a texel in metres: the shortest edge of a cell; but where cells are thin and seen from their flat side,
// no less than a quarter of the width that they show to the light.
double texel_edge(const Body &body, const glm::dvec3 &towards) {
    const glm::dmat3 m(body.cells_to_world);
    const double shown = std::abs(glm::dot(glm::cross(m[0], m[1]), towards)) +
                         std::abs(glm::dot(glm::cross(m[1], m[2]), towards)) +
                         std::abs(glm::dot(glm::cross(m[2], m[0]), towards));
    return std::max(body.cell_size, 0.25 * std::sqrt(shown));
}

// Texels of at least the asked-for size, so many that they fill an extent within memory; the rim around them stays
// empty.
glm::ivec2 texels_for(const glm::dvec2 &extent, double texel, int floats, double most_floats) {
    const double least = std::sqrt(extent.x * extent.y * floats / most_floats);
    return glm::ivec2(glm::ceil(extent / std::max(texel, least))) + 2;
}

// Empty texels on every side, more than the usual one, so that a filter keeps the smoke's mass.
int rim_for(double blur) {
    return blur > 0.0 ? static_cast<int>(std::ceil(3.0 * blur)) + BOXES : 0;
}

// A narrower bell is no wider than the look-up's own filter.
double worth(double blur) {
    return blur < 0.25 ? 0.0 : blur;
}

// Numbers of four bytes a texel.
int words(const LightMap &map) {
    return map.curved ? RAY_WORDS * map.colours : map.view().stride();
}

// A map of what the settings ask for, without its rays.
LightMap planned(const Body &body, const LightMapSettings &settings) {
    LightMap map;
    map.series = {settings.basis, static_cast<std::size_t>(settings.coefficients), {}};
    map.shared = settings.shared && !settings.curved;
    map.curved = settings.curved;
    map.colours = settings.curved && !body.grey() ? 3 : 1;
    map.extinction = body.extinction;
    return map;
}

} // namespace

LightMapView LightMap::view(const SolidDepths *solids, const SheetDepths *sheets) const {
    LightMapView view;
    if (sheets != nullptr && !sheets->depth.empty()) {
        view.sheets = {sheets->first.data(), sheets->depth.data(), &sheets->left.front().x};
    }
    view.coefficients = coefficients.empty() ? nullptr : coefficients.data();
    view.solid_depth = solids == nullptr ? nullptr : solids->data();
    view.count = static_cast<int>(series.count);
    view.width = size.x;
    view.height = size.y;
    view.radial = radial;
    view.world_to_light = affine(world_to_light);
    for (int axis = 0; axis < 3; ++axis) {
        view.low[axis] = static_cast<float>(low[axis]);
        view.scale[axis] = static_cast<float>(1.0 / (high[axis] - low[axis]));
        view.per_depth[axis] = extinction[axis] > 0.0F ? 1.0F / extinction[axis] : 0.0F;
    }
    view.basis = series.name;
    view.shared = shared;
    view.sharp = sharp;
    view.tables = {static_cast<int>(series.tables.cells), series.tables.g.data()};
    view.curves = curves.empty() ? nullptr : curves.data();
    view.colours = colours;
    return view;
}

void LightMap::look_up(std::span<const float> points, std::span<float> columns, int colour) const {
    constexpr int CHUNK = 4096;
    const auto total = static_cast<int>(columns.size());
    oneapi::tbb::parallel_for(0, (total + CHUNK - 1) / CHUNK, [&](int chunk) {
        const int first = chunk * CHUNK;
        map_kernels().look_up(view(), points.data() + static_cast<std::ptrdiff_t>(first) * 3, columns.data() + first,
                              std::min(CHUNK, total - first), colour);
    });
}

LightMap plan_parallel_map(const Body &body, const glm::dvec3 &direction, const LightMapSettings &settings) {
    const glm::dmat3 to_light = glm::transpose(axes_of(direction));
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const glm::dvec3 &p : corners_of(body, glm::dmat4(to_light))) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    LightMap map = planned(body, settings);
    const double texel = texel_edge(body, glm::normalize(direction)) / settings.texels_per_cell;
    map.size = texels_for(glm::dvec2(high - low), texel, words(map), settings.most_floats);
    const double fitted = std::max({texel, (high.x - low.x) / (map.size.x - 2), (high.y - low.y) / (map.size.y - 2)});
    map.blur = worth(settings.blur / fitted);
    map.size += 2 * rim_for(map.blur);
    const glm::dvec3 extent(glm::dvec2(map.size) * fitted, high.z - low.z);
    const glm::dvec3 origin = 0.5 * (low + high) - 0.5 * extent;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            map.world_to_light[column][row] = to_light[column][row] / extent[row];
        }
        map.world_to_light[3][row] = -origin[row] / extent[row];
    }
    const glm::dmat4 light_to_grid = glm::inverse(body.cells_to_world) * glm::inverse(map.world_to_light);
    map.length = extent.z;
    map.slices = slices_for(glm::length(glm::dvec3(light_to_grid[2])));
    return map;
}

LightMap plan_radial_map(const Body &body, const glm::dvec3 &position, const LightMapSettings &settings) {
    // The frame of the light looks at the middle of the smoke, so that the seams of the octahedron lie behind it.
    const glm::dvec3 middle(body.cells_to_world * glm::dvec4(0.5 * body.cells, 1.0));
    const glm::dvec3 towards = middle - position;
    const double distance = glm::length(towards);
    const glm::dvec3 look = distance > 1e-9 ? towards / distance : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dmat3 to_light = glm::transpose(axes_of(look));
    LightMap map = planned(body, settings);
    map.radial = true;
    map.world_to_light = glm::dmat4(to_light);
    map.world_to_light[3] = glm::dvec4(-(to_light * position), 1.0);

    const std::array<glm::dvec3, 8> corners = corners_of(body, map.world_to_light);
    map.low = glm::dvec3(-1.0, -1.0, 0.0);
    map.high = glm::dvec3(1.0, 1.0, 0.0);
    for (const glm::dvec3 &p : corners) {
        map.high.z = std::max(map.high.z, glm::length(p));
    }
    // So a light inside the smoke is not: some corner lies behind it.
    const bool before = std::all_of(corners.begin(), corners.end(), [](const glm::dvec3 &p) { return p.z > 0.0; });
    if (before) {
        // Straight edges bend where they cross from one face of the octahedron to the next, so a few points on each are
        // looked at, and the margin is generous.
        glm::dvec2 low(1.0), high(-1.0);
        constexpr int POINTS = 16;
        for (std::size_t a = 0; a < 8; ++a) {
            for (std::size_t bit = 1; bit < 8; bit *= 2) {
                for (int i = 0; (a & bit) == 0 && i <= POINTS; ++i) {
                    const glm::dvec3 p = glm::mix(corners[a], corners[a | bit], double(i) / POINTS);
                    const LightsText::Octahedral place = LightsText().octahedral(glm::vec3(p));
                    low = glm::min(low, glm::dvec2(place.x, place.y));
                    high = glm::max(high, glm::dvec2(place.x, place.y));
                }
            }
        }
        const glm::dvec2 margin = 0.02 * (high - low);
        low = glm::max(low - margin, -1.0);
        high = glm::min(high + margin, 1.0);
        // No point of the box is nearer than its corners are deep. Harmonics are spent on what lies between the
        // bounds, so from afar they must not begin at the light.
        double depth = map.high.z;
        for (const glm::dvec3 &p : corners) {
            depth = std::min(depth, p.z);
        }
        map.low = glm::dvec3(low, depth);
        map.high = glm::dvec3(high, map.high.z);
    }
    // A texel spans a cell, or the share asked for, at the middle of the smoke; near the light it spans less.
    const double reach = std::max(distance, 0.25 * map.high.z);
    const double texel = texel_edge(body, look) / (settings.texels_per_cell * reach);
    const glm::dvec2 extent(map.high - map.low);
    map.size = texels_for(extent, texel, words(map), settings.most_floats);
    // The rim of two texels must lie outside the smoke, unless the map is all that there is.
    glm::dvec2 rim = extent / glm::dvec2(map.size - 2);
    map.blur = worth(settings.blur / (reach * std::max(rim.x, rim.y)));
    const int wider = rim_for(map.blur);
    map.size += 2 * wider;
    rim *= 1 + wider;
    map.low = glm::dvec3(glm::max(glm::dvec2(map.low) - rim, -1.0), map.low.z);
    map.high = glm::dvec3(glm::min(glm::dvec2(map.high) + rim, 1.0), map.high.z);
    map.length = map.high.z - map.low.z;
    map.slices = slices_for(map.length / body.cell_size);
    return map;
}

} // namespace sfumato
