// SPDX-License-Identifier: GPL-3.0-or-later
// From the density of a grid to the rays of a map.
#include "maps/column_rays.hpp"
#include "maps/light_map.hpp"
#include "maps/map_kernels.hpp"
#include "scene/affine.hpp"

#include <algorithm>
#include <cstddef>

#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// The rows of a map on their way through the smoke.
class Rows {
public:
    Rows(const LightMap &map, const Grid &grid, const MediumRamp *ramp, const glm::dmat4 &grid_to_world,
         float extinction, const InstructionSet &with)
        : map_(map), kernels_(map_kernels(with)), lanes_(static_cast<std::size_t>(with.lanes)) {
        row_.density = grid.view();
        row_.clearance = grid.clearances();
        if (ramp != nullptr) {
            row_.clearance.cells = ramp->clearance.data();
            row_.ramp = {ramp->rows.data(), ramp->parts()};
        }
        row_.map = map.view();
        row_.light_to_grid = affine(glm::inverse(grid_to_world) * glm::inverse(map.world_to_light));
        row_.slice_length = static_cast<float>(map.length / map.slices);
        row_.extinction = extinction;
        row_.slices = map.slices;
    }

    // Row y onto harmonics, all in lanes.
    void project(int y, float *coefficients) const {
        std::vector<float> scratch;
        ProjectRow row = at(y, scratch);
        row.coefficients = coefficients;
        kernels_.project_row(row);
    }

    // use(x, ray) for each ray of row y.
    template <typename Use>
    void for_rays(int y, const Use &use) const {
        std::vector<float> scratch;
        const ProjectRow row = at(y, scratch);
        const float slice = 1.0F / static_cast<float>(map_.slices);
        RowAbsorbers found;
        ColumnRay ray;
        ray.slice = slice;
        for (int x0 = 0; x0 < map_.size.x; x0 += static_cast<int>(lanes_)) {
            kernels_.march_row(row, x0, found);
            const float *const densities = scratch.data() + map_.slices;
            for (std::size_t lane = 0; lane < lanes_ && x0 + static_cast<int>(lane) < map_.size.x; ++lane) {
                ray.depth.clear();
                ray.column.clear();
                for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
                    const float density = densities[i * lanes_ + lane];
                    if (density > 0.0F) {
                        ray.depth.push_back(slice * (scratch[i] + 0.5F));
                        ray.column.push_back(density * row.slice_length);
                    }
                }
                ray.total = found.total[lane];
                ray.range = {found.low[lane], found.high[lane]};
                use(x0 + static_cast<int>(lane), ray);
            }
        }
    }

private:
    [[nodiscard]] ProjectRow at(int y, std::vector<float> &scratch) const {
        ProjectRow row = row_;
        row.y = y;
        scratch.resize(static_cast<std::size_t>(map_.slices) * (MAX_LANES + 1));
        row.scratch = scratch.data();
        return row;
    }

    const LightMap &map_;
    const MapKernels &kernels_;
    std::size_t lanes_;
    ProjectRow row_;
};

} // namespace

LightMap projected(LightMap map, const Grid &grid, const MediumRamp *ramp, const glm::dmat4 &grid_to_world,
                   float extinction, const InstructionSet &with) {
    const Rows rows(map, grid, ramp, grid_to_world, extinction, with);
    if (!map.harmonic()) {
        constexpr int EVERY = 4;
        ColumnRays all{map.size.y, EVERY, {}};
        all.for_rays = [&rows, width = map.size.x](int y, const UseRay &use) {
            rows.for_rays(y, [&](int x, ColumnRay &ray) { use(static_cast<std::size_t>(y * width + x), ray); });
        };
        fill(map, all);
        return map;
    }
    const std::size_t row = static_cast<std::size_t>(map.size.x) * static_cast<std::size_t>(map.view().stride());
    map.coefficients.resize(row * static_cast<std::size_t>(map.size.y));
    oneapi::tbb::parallel_for(
        0, map.size.y, [&](int y) { rows.project(y, map.coefficients.data() + static_cast<std::size_t>(y) * row); });
    blur(map);
    return map;
}

} // namespace sfumato
