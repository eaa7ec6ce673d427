// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/column_rays.hpp"

#include "maps/map_filter.hpp"
#include "rays/curve.hpp"
#include "rays/learned_basis.hpp"

#include <algorithm>
#include <cstring>
#include <numbers>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// The basis of some of a map's rays.
Series learned(const LightMap &map, const ColumnRays &rays) {
    std::vector<std::vector<ColumnRay>> teachers(
        static_cast<std::size_t>((rays.strips + rays.teachers - 1) / rays.teachers));
    oneapi::tbb::parallel_for(std::size_t{0}, teachers.size(), [&](std::size_t i) {
        rays.for_rays(static_cast<int>(i) * rays.teachers, [&](std::size_t, const ColumnRay &ray) {
            if (ray.total > 0.0F) {
                teachers[i].push_back(ray);
            }
        });
    });
    std::vector<Absorbers> absorbers;
    std::vector<Range> ranges;
    for (const std::vector<ColumnRay> &strip : teachers) {
        for (const ColumnRay &ray : strip) {
            absorbers.push_back(ray.absorbers());
            ranges.push_back(ray.range);
        }
    }
    return learn_basis(absorbers, ranges, map.series.count);
}

// Of a series of harmonics, how often a texel's number k is the coefficient.
float per_number(const Series &series, std::size_t k) {
    constexpr float PI = std::numbers::pi_v<float>;
    switch (series.name) {
    case FOURIER:
        return PI * static_cast<float>(k + k % 2); // twice the number of the pair
    case COSINE:
        return PI * static_cast<float>(k);
    default:
        return 1.0F;
    }
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
        *texel++ = series.name == PIECEWISE ? before : c[k] / per_number(series, k);
    }
}

// The inverse: a total and numbers (integral_of() in rays/series_lanes.hpp) as coefficients.
void read_texel(const Series &series, float total, std::span<const float> numbers, std::span<float> c) {
    c[0] = series.name == FOURIER ? 2.0F * total : total;
    for (std::size_t k = 1; k < c.size(); ++k) {
        c[k] = numbers[k - 1] * per_number(series, k);
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

void blur(LightMap &map) {
    if (!(map.blur > 0.0)) {
        return;
    }
    const MapSize size{static_cast<std::size_t>(map.size.y), static_cast<std::size_t>(map.size.x),
                       static_cast<std::size_t>(map.view().stride())};
    std::vector<float> filtered(map.coefficients.size());
    filter_map(map.coefficients, filtered, size, FilterKind::GAUSSIAN, map.blur);
    map.coefficients = std::move(filtered);
}

void fill(LightMap &map, const ColumnRays &rays) {
    if (map.curved) {
        const std::size_t texel = CURVE_BYTES * static_cast<std::size_t>(map.colours);
        std::vector<std::uint8_t> bytes(map.texels() * texel);
        oneapi::tbb::parallel_for(0, rays.strips, [&](int strip) {
            rays.for_rays(strip, [&](std::size_t at, ColumnRay &ray) {
                write_curves(map, ray, std::span(bytes).subspan(at * texel, texel));
            });
        });
        map.curves.resize(bytes.size() / sizeof(std::int32_t));
        std::memcpy(map.curves.data(), bytes.data(), bytes.size());
        return;
    }
    if (map.series.name == LEARNED) {
        map.series = learned(map, rays);
    }
    const auto stride = static_cast<std::size_t>(map.view().stride());
    map.coefficients.resize(map.texels() * stride);
    oneapi::tbb::parallel_for(0, rays.strips, [&](int strip) {
        std::vector<float> c(map.series.count);
        rays.for_rays(strip, [&](std::size_t at, const ColumnRay &ray) {
            write_texel(map.series, map.shared, ray, c, map.coefficients.data() + at * stride);
        });
    });
    blur(map);
}

} // namespace sfumato
