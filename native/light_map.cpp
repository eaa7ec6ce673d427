// SPDX-License-Identifier: GPL-3.0-or-later
#include "light_map.hpp"

#include "glsl.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr double MOST_COEFFICIENTS = 1 << 26; // a quarter of a gibibyte

// What each slice of the light's path adds to each coefficient, per unit of density: eqs 1-2 for slabs.
std::vector<float> slice_weights(int slices, int count, double path) {
    std::vector<float> weights(static_cast<std::size_t>(slices) * static_cast<std::size_t>(count));
    const float width = 1.0F / static_cast<float>(slices);
    const float length = static_cast<float>(path) * width;
    for (int s = 0; s < slices; ++s) {
        float *w = weights.data() + static_cast<std::ptrdiff_t>(s) * count;
        const glsl::Harmonic first = glsl::harmonic(1.0F, (static_cast<float>(s) + 0.5F) * width);
        glsl::Harmonic h = first;
        w[0] = 2.0F * length;
        for (int k = 1; 2 * k < count; ++k) {
            const float thickness = glsl::slab_factor(static_cast<float>(k), width);
            w[2 * k - 1] = glsl::project_cosine(length, h, thickness);
            w[2 * k] = glsl::project_sine(length, h, thickness);
            h = glsl::next_harmonic(h, first);
        }
    }
    return weights;
}

// Where along each texel's light ray, in the map's depth, the first solid stands.
void find_solids(LightMap &map, const SurfaceView &surfaces) {
    map.solid_depth.assign(map.texels(), std::numeric_limits<float>::max());
    if (surfaces.scene == nullptr) {
        return;
    }
    RTCBounds bounds;
    rtcGetSceneBounds(surfaces.scene, &bounds);
    const glm::dvec3 low(bounds.lower_x, bounds.lower_y, bounds.lower_z);
    const glm::dvec3 high(bounds.upper_x, bounds.upper_y, bounds.upper_z);
    double nearest = 0.0; // map depth of the solids' corner that is nearest to the light
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                           (corner & 4) != 0 ? high.z : low.z);
        nearest = std::min(nearest, (map.world_to_map * glm::dvec4(p, 1.0)).z - 1e-3);
    }
    const glm::dmat4 to_world = glm::inverse(map.world_to_map);
    const glm::dvec3 along(to_world[2]); // one map depth
    const double path = glm::length(along);
    const glm::vec3 direction(along / path);
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        for (int x = 0; x < map.size.x; ++x) {
            const glm::vec3 from(to_world * glm::dvec4((x + 0.5) / map.size.x, (y + 0.5) / map.size.y, nearest, 1.0));
            const float hit = first_hit(surfaces.scene, from, direction);
            if (std::isfinite(hit)) {
                map.solid_depth[static_cast<std::size_t>(y * map.size.x + x)] =
                    static_cast<float>(nearest + static_cast<double>(hit) / path);
            }
        }
    });
}

} // namespace

Affine affine(const glm::dmat4 &m) {
    Affine out;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            out.rows[row][column] = static_cast<float>(m[column][row]);
        }
    }
    return out;
}

glm::dmat3 light_axes(const Sun &sun) {
    const glm::dvec3 along = glm::normalize(glm::dvec3(sun.direction));
    const glm::dvec3 helper = std::abs(along.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 across = glm::normalize(glm::cross(helper, along));
    return {across, glm::cross(along, across), along};
}

LightMapView LightMap::view() const {
    return {coefficients.data(), solid_depth.data(), count, size.x, size.y, affine(world_to_map)};
}

void LightMap::look_up(std::span<const float> points, std::span<float> columns) const {
    constexpr int CHUNK = 4096;
    const auto total = static_cast<int>(columns.size());
    oneapi::tbb::parallel_for(0, (total + CHUNK - 1) / CHUNK, [&](int chunk) {
        const int first = chunk * CHUNK;
        kernels().look_up(view(), points.data() + static_cast<std::ptrdiff_t>(first) * 3, columns.data() + first,
                          std::min(CHUNK, total - first));
    });
}

LightMap build_light_map(const CroppedMedium &medium, const Sun &sun, const SurfaceView &surfaces, int count,
                         double texels_per_cell, const Kernels &with) {
    const glm::dmat3 axes = light_axes(sun);
    const glm::dmat3 to_light = glm::transpose(axes);
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 cell((corner & 1) != 0 ? medium.resolution.x : 0, (corner & 2) != 0 ? medium.resolution.y : 0,
                              (corner & 4) != 0 ? medium.resolution.z : 0);
        const glm::dvec3 p = to_light * glm::dvec3(medium.grid_to_world * glm::dvec4(cell, 1.0));
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    LightMap map;
    map.count = count;
    // Thin cells would ask for more texels than memory holds.
    const double area = (high.x - low.x) * (high.y - low.y);
    const double texel = std::max(medium.cell_size / texels_per_cell, std::sqrt(area * count / MOST_COEFFICIENTS));
    map.size = glm::ivec2(glm::ceil(glm::dvec2(high - low) / texel)) + 2; // the rim stays empty
    const glm::dvec3 extent(glm::dvec2(map.size) * texel, high.z - low.z);
    const glm::dvec3 middle = 0.5 * (low + high);
    const glm::dvec3 origin = middle - 0.5 * extent;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            map.world_to_map[column][row] = to_light[column][row] / extent[row];
        }
        map.world_to_map[3][row] = -origin[row] / extent[row];
    }

    // Two slices a cell: with one, the total of a small dense puff can be off by more than 1 %.
    const int slices = std::max(1, static_cast<int>(std::ceil(2.0 * extent.z / medium.cell_size)));
    const std::vector<float> weights = slice_weights(slices, count, extent.z);
    glm::dmat4 texel_to_map(1.0);
    const glm::dvec3 steps(1.0 / map.size.x, 1.0 / map.size.y, 1.0 / slices);
    for (int axis = 0; axis < 3; ++axis) {
        texel_to_map[axis][axis] = steps[axis];
        texel_to_map[3][axis] = 0.5 * steps[axis];
    }
    const glm::dmat4 texel_to_grid = glm::inverse(medium.grid_to_world) * glm::inverse(map.world_to_map) * texel_to_map;
    map.coefficients.resize(map.texels() * static_cast<std::size_t>(count));
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        ProjectRow row;
        row.density = medium.grid();
        row.clearance = medium.clearances();
        row.texel_to_grid = affine(texel_to_grid);
        row.weights = weights.data();
        row.slices = slices;
        row.count = count;
        row.width = map.size.x;
        row.y = y;
        row.coefficients = map.coefficients.data() + static_cast<std::ptrdiff_t>(y) * map.size.x * count;
        with.project_row(row);
    });
    find_solids(map, surfaces);
    return map;
}

void light_medium(CroppedMedium &medium, const LightMap &map, const Kernels &with) {
    std::vector<float> occlusion(medium.lit.size() / 2, 0.0F);
    LightSlice slice;
    slice.map = map.view();
    slice.clearance = medium.clearances();
    slice.grid_to_map = affine(map.world_to_map * medium.grid_to_world);
    slice.lit = medium.lit.data();
    slice.occlusion = occlusion.data();
    slice.nx = medium.resolution.x;
    slice.ny = medium.resolution.y;
    slice.nz = medium.resolution.z;
    oneapi::tbb::parallel_for(0, medium.resolution.z, [&, slice](int z) {
        LightSlice own = slice;
        own.z = z;
        with.light_slice(own);
    });
    // Most smoke stands in the open: then the march need not fetch what is zero everywhere.
    if (std::none_of(occlusion.begin(), occlusion.end(), [](float share) { return share > 0.0F; })) {
        return;
    }
    std::vector<float> shaded(3 * occlusion.size());
    for (std::size_t i = 0; i < occlusion.size(); ++i) {
        shaded[3 * i] = medium.lit[2 * i];
        shaded[3 * i + 1] = medium.lit[2 * i + 1];
        shaded[3 * i + 2] = occlusion[i];
    }
    medium.lit = std::move(shaded);
    medium.channels = 3;
}

} // namespace sfumato
