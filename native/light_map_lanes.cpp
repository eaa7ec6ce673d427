// SPDX-License-Identifier: GPL-3.0-or-later
// Building a Fourier opacity map from a density grid, and looking it up, many texels or cells at a time.
#include "lanes.hpp"
#include "sampling.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {

namespace {

// The light ray of a texel in grid space: the middle of the first slice, and from there one slice on.
struct Path {
    vec3 start, step;
};

Path path_of(const ProjectRow &row, const Real &column) {
    const LightMapView &map = row.map;
    const Real x = (column + 0.5F) * (1.0F / static_cast<float>(map.width));
    const Real y = (static_cast<float>(row.y) + 0.5F) * (1.0F / static_cast<float>(map.height));
    const Real slice = 1.0F / static_cast<float>(row.slices);
    if (!map.radial) {
        return {transform_point(row.light_to_grid, {x, y, 0.5F * slice}),
                transform_vector(row.light_to_grid, {Real(0.0F), Real(0.0F), slice})};
    }
    Octahedral place;
    place.x = map.low[0] + x * (1.0F / map.scale[0]);
    place.y = map.low[1] + y * (1.0F / map.scale[1]);
    const vec3 direction = octahedral_direction(place);
    const Real depth = slice * (1.0F / map.scale[2]);
    return {transform_point(row.light_to_grid, direction * (map.low[2] + 0.5F * depth)),
            transform_vector(row.light_to_grid, direction * depth)};
}

} // namespace

// Eqs 1-2, slice by slice. The weights are the same for all texels of a map; empty slices are leapt over.
void project_row(const ProjectRow &row) {
    constexpr int MAX_COUNT = 64;
    const int count = row.map.count, width = row.map.width;
    for (int x = 0; x < width; x += LANES) {
        Real sums[MAX_COUNT];
        for (int c = 0; c < count; ++c) {
            sums[c] = 0.0F;
        }
        const Path path = path_of(row, lane_numbers() + static_cast<float>(x));
        const float speed = highest(max(max(abs(path.step.x), abs(path.step.y)), abs(path.step.z)));
        const vec3 size{Real(static_cast<float>(row.density.nx)), Real(static_cast<float>(row.density.ny)),
                        Real(static_cast<float>(row.density.nz))};
        const auto slices = static_cast<float>(row.slices);
        const Interval inside = clip_to_box({Real(0.0F), Real(slices)}, path.start, path.step, size);
        const int first = static_cast<int>(std::min(slices, lowest(inside.near_t)));
        const int last = static_cast<int>(std::clamp(highest(inside.far_t) + 1.0F, 0.0F, slices));
        for (int s = first; s < last;) {
            const vec3 p = path.start + path.step * Real(static_cast<float>(s));
            const Real clear = clearance_at(row.clearance, p);
            if (!xsimd::any(clear < 0.0F)) {
                s += 1 + static_cast<int>(lowest(clear) / speed);
                continue;
            }
            const Real density = sample(row.density, locate(row.density, p), 0);
            const float *weights = row.weights + static_cast<std::ptrdiff_t>(s) * count;
            for (int c = 0; c < count; ++c) {
                sums[c] = xsimd::fma(density, Real(weights[c]), sums[c]);
            }
            ++s;
        }
        alignas(64) float lanes[LANES];
        for (int c = 0; c < count; ++c) {
            sums[c].store_aligned(lanes);
            for (int lane = 0; lane < LANES && x + lane < width; ++lane) {
                row.coefficients[(x + lane) * count + c] = lanes[lane];
            }
        }
    }
}

void look_up(const LightMapView &map, const float *points, float *columns, int count) {
    for (int i = 0; i < count; i += LANES) {
        alignas(64) float xyz[3][LANES] = {};
        for (int lane = 0; lane < LANES && i + lane < count; ++lane) {
            for (int axis = 0; axis < 3; ++axis) {
                xyz[axis][lane] = points[3 * (i + lane) + axis];
            }
        }
        const vec3 p{Real::load_aligned(xyz[0]), Real::load_aligned(xyz[1]), Real::load_aligned(xyz[2])};
        const vec3 m = place_on(map, p);
        alignas(64) float lanes[LANES];
        column_density(map, locate(map, m.x, m.y), m.z).store_aligned(lanes);
        for (int lane = 0; lane < LANES && i + lane < count; ++lane) {
            columns[i + lane] = lanes[lane];
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
