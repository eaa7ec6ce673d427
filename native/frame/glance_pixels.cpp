// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/glance_pixels.hpp"

#include <array>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {

void GlancePixels::store(std::size_t pixel, const Layers &layers, std::size_t lane) {
    float *const to = value(0, pixel);
    for (std::size_t c = 0; c < 3; ++c) {
        to[c] = layers.picture[c][lane];
    }
    distance[pixel] = layers.distance[lane];
    surface[pixel] = layers.open[lane];
    if (planes == 2) {
        float *const behind = value(1, pixel);
        for (std::size_t c = 0; c < 3; ++c) {
            behind[c] = layers.behind[c][lane];
        }
        behind[3] = layers.picture[3][lane];
    } else {
        to[3] = channels == 4 ? layers.picture[3][lane] : layers.distance[lane];
    }
}

void GlancePixels::fill(const std::vector<Cell> &cells) {
    constexpr std::size_t GRAIN = 256;
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, cells.size(), GRAIN), [&](const auto &range) {
        for (std::size_t number = range.begin(); number != range.end(); ++number) {
            for (std::size_t plane = 0; plane < planes; ++plane) {
                fill(cells[number], plane);
            }
        }
    });
}

void GlancePixels::fill(const Cell &cell, std::size_t plane) {
    const int across = cell.x1 - cell.x0, up = cell.y1 - cell.y0;
    const float *const a = value(plane, at(cell.x0, cell.y0)), *const b = value(plane, at(cell.x1, cell.y0));
    const float *const c = value(plane, at(cell.x0, cell.y1)), *const d = value(plane, at(cell.x1, cell.y1));
    // The upper and right sides are the next cells', but for the last.
    const int last_x = cell.x1 == width - 1 ? across : across - 1;
    const int last_y = cell.y1 == height - 1 ? up : up - 1;
    for (int j = 0; j <= last_y; ++j) {
        const float v = up > 0 ? static_cast<float>(j) / static_cast<float>(up) : 0.0F;
        std::array<float, 4> left, slope;
        for (std::size_t i = 0; i < 4; ++i) {
            left[i] = a[i] + (c[i] - a[i]) * v;
            slope[i] = across > 0 ? (b[i] + (d[i] - b[i]) * v - left[i]) / static_cast<float>(across) : 0.0F;
        }
        const std::size_t row = at(cell.x0, cell.y0 + j);
        for (int x = 0; x <= last_x; ++x) {
            const std::size_t pixel = row + static_cast<std::size_t>(x);
            if (traced[pixel] != 0) {
                continue;
            }
            float *const to = value(plane, pixel);
            for (std::size_t i = 0; i < 4; ++i) {
                to[i] = left[i] + slope[i] * static_cast<float>(x);
            }
        }
    }
}

} // namespace sfumato
