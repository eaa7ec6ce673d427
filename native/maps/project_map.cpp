// SPDX-License-Identifier: GPL-3.0-or-later
// From the density on a map's rays to their series or curves.
#include "maps/light_map.hpp"
#include "maps/map_filter.hpp"
#include "maps/map_kernels.hpp"
#include "rays/curve.hpp"
#include "rays/learned_basis.hpp"
#include "rays/ray_kernels.hpp"
#include "scene/affine.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numbers>
#include <numeric>

#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// The smoke on one light ray, as column densities, and the range of depths that its series spans.
struct ColumnRay {
    std::vector<float> depth, column;
    float slice = 0.0F; // the extent in depth of each
    float total = 0.0F;
    Range range;

    [[nodiscard]] Absorbers absorbers() const { return {depth, column, slice}; }
};

// The rows of a map on their way through the smoke.
class Rows {
public:
    Rows(const LightMap &map, const CroppedMedium &medium, const InstructionSet &with)
        : map_(map), kernels_(map_kernels(with)), lanes_(static_cast<std::size_t>(with.lanes)) {
        row_.density = medium.grid->view();
        row_.clearance = medium.grid->clearances();
        row_.map = map.view();
        row_.light_to_grid = affine(glm::inverse(medium.grid_to_world) * glm::inverse(map.world_to_light));
        row_.slice_length = static_cast<float>(map.length / map.slices);
        row_.extinction = medium.strongest();
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

// The basis of a quarter of a map's rays.
Series learned(const LightMap &map, const Rows &rows) {
    constexpr int EVERY = 4;
    std::vector<std::vector<ColumnRay>> teachers(static_cast<std::size_t>((map.size.y + EVERY - 1) / EVERY));
    oneapi::tbb::parallel_for(std::size_t{0}, teachers.size(), [&](std::size_t i) {
        rows.for_rays(static_cast<int>(i) * EVERY, [&](int, const ColumnRay &ray) {
            if (ray.total > 0.0F) {
                teachers[i].push_back(ray);
            }
        });
    });
    std::vector<Absorbers> rays;
    std::vector<Range> ranges;
    for (const std::vector<ColumnRay> &row : teachers) {
        for (const ColumnRay &ray : row) {
            rays.push_back(ray.absorbers());
            ranges.push_back(ray.range);
        }
    }
    return learn_basis(rays, ranges, map.series.count);
}

// A ray's series as a texel has it: LightMapView.
void write_texel(const Series &series, bool shared, const ColumnRay &ray, std::span<float> c, float *texel) {
    std::fill(c.begin(), c.end(), 0.0F);
    project(series, ray.absorbers(), ray.range, c);
    *texel++ = ray.total;
    if (!shared) {
        *texel++ = ray.range.low;
        *texel++ = 1.0F / (ray.range.high - ray.range.low);
    }
    float before = 0.0F;
    for (std::size_t k = 1; k < c.size(); ++k) {
        before += c[k - 1];
        *texel++ = series.name == PIECEWISE ? before : c[k];
    }
}

// The inverse: a total and numbers (integral_of() in rays/series_lanes.hpp) as coefficients.
void read_texel(const Series &series, float total, std::span<const float> numbers, std::span<float> c) {
    constexpr float PI = std::numbers::pi_v<float>;
    c[0] = series.name == FOURIER ? 2.0F * total : total;
    for (std::size_t k = 1; k < c.size(); ++k) {
        const auto pair = static_cast<float>(k + k % 2); // twice the number of Fourier's pair
        c[k] = numbers[k - 1] * (series.name == FOURIER  ? PI * pair
                                 : series.name == COSINE ? PI * static_cast<float>(k)
                                                         : 1.0F);
    }
    if (series.name == PIECEWISE) { // sums so far
        std::rotate(c.begin(), c.begin() + 1, c.end());
        std::adjacent_difference(c.begin(), c.end(), c.begin());
    }
}

void write_curves(const LightMap &map, ColumnRay &ray, std::span<std::uint8_t> texel) {
    const std::vector<float> columns = ray.column;
    for (int colour = 0; colour < map.colours; ++colour) {
        // Grey smoke has one, whichever; of coloured smoke each.
        const float extinction = map.extinction[colour];
        std::transform(columns.begin(), columns.end(), ray.column.begin(), [=](float c) { return c * extinction; });
        fit_curve(exact_curve(ray.absorbers()),
                  texel.subspan(static_cast<std::size_t>(colour) * CURVE_BYTES, CURVE_BYTES));
    }
}

void blur(LightMap &map) {
    const MapSize size{static_cast<std::size_t>(map.size.y), static_cast<std::size_t>(map.size.x),
                       static_cast<std::size_t>(map.view().stride())};
    std::vector<float> filtered(map.coefficients.size());
    filter_map(map.coefficients, filtered, size, FilterKind::GAUSSIAN, map.blur);
    map.coefficients = std::move(filtered);
}

} // namespace

MapSeries series_of(const LightMap &map) {
    MapSeries out;
    if (map.curved) {
        return out;
    }
    const auto head = static_cast<std::size_t>(map.view().head()),
               stride = static_cast<std::size_t>(map.view().stride());
    out.coefficients.resize(map.texels() * map.series.count);
    out.ranges.resize(map.texels());
    for (std::size_t i = 0; i < map.texels(); ++i) {
        const std::span<const float> texel = std::span(map.coefficients).subspan(i * stride, stride);
        if (!map.shared) {
            out.ranges[i] = {texel[1], texel[1] + 1.0F / texel[2]};
        }
        read_texel(map.series, texel[0], texel.subspan(head),
                   std::span(out.coefficients).subspan(i * map.series.count, map.series.count));
    }
    return out;
}

LightMap projected(LightMap map, const CroppedMedium &medium, const InstructionSet &with) {
    const Rows rows(map, medium, with);
    const auto width = static_cast<std::size_t>(map.size.x);
    if (map.curved) {
        const std::size_t texel = CURVE_BYTES * static_cast<std::size_t>(map.colours);
        map.curves.resize(map.texels() * texel / sizeof(std::int32_t));
        oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
            std::vector<std::uint8_t> bytes(width * texel);
            rows.for_rays(y, [&](int x, ColumnRay &ray) {
                write_curves(map, ray, std::span(bytes).subspan(static_cast<std::size_t>(x) * texel, texel));
            });
            std::memcpy(map.curves.data() + static_cast<std::size_t>(y) * bytes.size() / sizeof(std::int32_t),
                        bytes.data(), bytes.size());
        });
        return map;
    }
    if (map.series.name == LEARNED) {
        map.series = learned(map, rows);
    }
    const bool harmonics = map.series.name == COSINE || map.series.name == FOURIER;
    const auto stride = static_cast<std::size_t>(map.view().stride());
    map.coefficients.resize(map.texels() * stride);
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        float *const row = map.coefficients.data() + static_cast<std::size_t>(y) * width * stride;
        if (harmonics) {
            rows.project(y, row);
            return;
        }
        std::vector<float> c(map.series.count);
        rows.for_rays(y, [&](int x, const ColumnRay &ray) {
            write_texel(map.series, map.shared, ray, c, row + static_cast<std::size_t>(x) * stride);
        });
    });
    if (map.blur > 0.0) {
        blur(map);
    }
    return map;
}

} // namespace sfumato
