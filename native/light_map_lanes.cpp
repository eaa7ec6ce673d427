// SPDX-License-Identifier: GPL-3.0-or-later
// Building a Fourier opacity map from a density grid, and looking it up, many texels or cells at a time.
#include "lanes.hpp"
#include "sampling.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {

// Eqs 1-2, slice by slice. The weights are the same for all texels of a map; empty slices are leapt over.
void project_row(const ProjectRow &row) {
    constexpr int MAX_COUNT = 64;
    const float speed = std::max({std::abs(row.texel_to_grid.rows[0][2]), std::abs(row.texel_to_grid.rows[1][2]),
                                  std::abs(row.texel_to_grid.rows[2][2])});
    for (int x = 0; x < row.width; x += LANES) {
        Real sums[MAX_COUNT];
        for (int c = 0; c < row.count; ++c) {
            sums[c] = 0.0F;
        }
        const Real column = lane_numbers() + static_cast<float>(x);
        const vec3 start = transform_point(row.texel_to_grid, {column, Real(static_cast<float>(row.y)), Real(0.0F)});
        const vec3 step = transform_vector(row.texel_to_grid, {Real(0.0F), Real(0.0F), Real(1.0F)});
        const vec3 size{Real(static_cast<float>(row.density.nx)), Real(static_cast<float>(row.density.ny)),
                        Real(static_cast<float>(row.density.nz))};
        const Interval inside = clip_to_box({Real(0.0F), Real(static_cast<float>(row.slices))}, start, step, size);
        const auto slices = static_cast<float>(row.slices);
        const int first = static_cast<int>(std::min(slices, lowest(inside.near_t)));
        const int last = static_cast<int>(std::clamp(highest(inside.far_t) + 1.0F, 0.0F, slices));
        for (int s = first; s < last;) {
            const vec3 p = start + step * Real(static_cast<float>(s));
            const Real clear = clearance_at(row.clearance, p);
            if (!xsimd::any(clear < 0.0F)) {
                s += 1 + static_cast<int>(lowest(clear) / speed);
                continue;
            }
            const Real density = sample(row.density, locate(row.density, p), 0);
            const float *weights = row.weights + static_cast<std::ptrdiff_t>(s) * row.count;
            for (int c = 0; c < row.count; ++c) {
                sums[c] = xsimd::fma(density, Real(weights[c]), sums[c]);
            }
            ++s;
        }
        alignas(64) float lanes[LANES];
        for (int c = 0; c < row.count; ++c) {
            sums[c].store_aligned(lanes);
            for (int lane = 0; lane < LANES && x + lane < row.width; ++lane) {
                row.coefficients[(x + lane) * row.count + c] = lanes[lane];
            }
        }
    }
}

namespace {

// The share of light that solids keep back: 0 before the first solid of each texel, 1 behind, filtered bilinearly
// (Reeves, Salesin and Cook 1987). The softening over one texel stands for the sun's disk.
inline Real solid_occlusion(const LightMapView &map, const Texels &texels, Real z) {
    Real occluded[4];
    for (int t = 0; t < 4; ++t) {
        occluded[t] = pick(z < gather(map.solid_depth, texels.at[t]), 0.0F, 1.0F);
    }
    return bilinear(texels, occluded);
}

// Whether interpolation in a brick that holds smoke can reach any of these cells: an empty cell beside smoke counts.
inline bool within_reach(const ClearanceView &bricks, const vec3 &p) {
    Mask reached(false);
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [corner](int axis) { return (corner >> axis & 1) != 0 ? 1.0F : -1.0F; };
        reached = reached | (clearance_at(bricks, {p.x + side(0), p.y + side(1), p.z + side(2)}) < 0.0F);
    }
    return xsimd::any(reached);
}

} // namespace

void light_slice(const LightSlice &slice) {
    const Real z = static_cast<float>(slice.z) + 0.5F;
    for (int y = 0; y < slice.ny; ++y) {
        for (int x = 0; x < slice.nx; x += LANES) {
            const vec3 p{lane_numbers() + (static_cast<float>(x) + 0.5F), Real(static_cast<float>(y) + 0.5F), z};
            if (!within_reach(slice.clearance, p)) {
                continue;
            }
            const vec3 m = transform_point(slice.grid_to_map, p);
            const Texels texels = locate(slice.map, m.x, m.y);
            const Real column = column_density(slice.map, texels, m.z);
            const Real occlusion = solid_occlusion(slice.map, texels, m.z);
            alignas(64) float columns[LANES], occlusions[LANES];
            column.store_aligned(columns);
            occlusion.store_aligned(occlusions);
            const std::ptrdiff_t row = (static_cast<std::ptrdiff_t>(slice.z) * slice.ny + y) * slice.nx;
            for (int lane = 0; lane < LANES && x + lane < slice.nx; ++lane) {
                slice.lit[2 * (row + x + lane) + 1] = columns[lane];
                slice.occlusion[row + x + lane] = occlusions[lane];
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
        const vec3 m = transform_point(map.world_to_map, p);
        alignas(64) float lanes[LANES];
        column_density(map, locate(map, m.x, m.y), m.z).store_aligned(lanes);
        for (int lane = 0; lane < LANES && i + lane < count; ++lane) {
            columns[i + lane] = lanes[lane];
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
