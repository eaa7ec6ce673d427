// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/grid.hpp"

#include <algorithm>
#include <limits>

#include <glm/common.hpp>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

namespace sfumato {
namespace {

std::size_t cells(const glm::ivec3 &n) {
    return static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z);
}

// Where the row of cells along x at (y, z) begins.
std::ptrdiff_t row_of(const glm::ivec3 &n, int y, int z) {
    return (static_cast<std::ptrdiff_t>(z) * n.y + y) * n.x;
}

struct Bounds {
    glm::ivec3 low{std::numeric_limits<int>::max()};
    glm::ivec3 high{std::numeric_limits<int>::min()}; // exclusive
};

Bounds together(const Bounds &a, const Bounds &b) {
    return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

Bounds occupied_slice(std::span<const float> cells, const glm::ivec3 &n, float threshold, int z) {
    Bounds bounds;
    const float *density = cells.data() + row_of(n, 0, z);
    for (int y = 0; y < n.y; ++y, density += n.x) {
        // Most rows of a large domain are empty, and counting goes many cells at a time where a search goes one by one.
        int count = 0;
        for (int x = 0; x < n.x; ++x) {
            count += density[x] > threshold ? 1 : 0;
        }
        if (count == 0) {
            continue;
        }
        int first = 0, last = n.x - 1;
        while (!(density[first] > threshold)) {
            ++first;
        }
        while (!(density[last] > threshold)) {
            --last;
        }
        bounds = together(bounds, {{first, y, z}, {last + 1, y + 1, z + 1}});
    }
    return bounds;
}

Bounds occupied_bounds(std::span<const float> density, const glm::ivec3 &n, float threshold) {
    using Slices = oneapi::tbb::blocked_range<int>;
    const auto of_slices = [&](const Slices &slices, Bounds bounds) {
        for (int z = slices.begin(); z != slices.end(); ++z) {
            bounds = together(bounds, occupied_slice(density, n, threshold, z));
        }
        return bounds;
    };
    return oneapi::tbb::parallel_reduce(Slices(0, n.z), Bounds{}, of_slices, &together);
}

// A brick may meet smoke if any sample that interpolation inside it can reach is above the threshold.
std::vector<float> occupied_bricks(const Grid &grid, float threshold) {
    const glm::ivec3 n = grid.resolution, bricks = grid.bricks;
    std::vector<float> occupied(cells(bricks), 0.0F);
    const auto mark = [&](int brick_z) {
        for (int z = std::max(0, brick_z * BRICK - 1); z <= std::min(n.z - 1, (brick_z + 1) * BRICK); ++z) {
            for (int y = 0; y < n.y; ++y) {
                const float *row = grid.density.data() + row_of(n, y, z);
                for (int x = 0; x < n.x; ++x) {
                    if (row[x] <= threshold) {
                        continue;
                    }
                    // A sample on a brick's rim is reached from the neighbour too.
                    for (int by = std::max(0, (y - 1) / BRICK); by <= std::min(bricks.y - 1, (y + 1) / BRICK); ++by) {
                        for (int bx = std::max(0, (x - 1) / BRICK); bx <= std::min(bricks.x - 1, (x + 1) / BRICK);
                             ++bx) {
                            occupied[static_cast<std::size_t>(row_of(bricks, by, brick_z) + bx)] = 1.0F;
                        }
                    }
                }
            }
        }
    };
    oneapi::tbb::parallel_for(0, bricks.z, mark);
    return occupied;
}

// Chebyshev distance to the nearest occupied brick, one axis at a time: the distance along a box of neighbours is the
// smallest of max(distance along the other axes, steps along this one).
void spread(std::vector<float> &distance, int count, int stride, int lines, int line_stride, int outer,
            int outer_stride) {
    std::vector<float> line(static_cast<std::size_t>(count));
    for (int o = 0; o < outer; ++o) {
        for (int l = 0; l < lines; ++l) {
            float *first = distance.data() + static_cast<std::ptrdiff_t>(o) * outer_stride +
                           static_cast<std::ptrdiff_t>(l) * line_stride;
            for (int i = 0; i < count; ++i) {
                float best = first[static_cast<std::ptrdiff_t>(i) * stride];
                for (int away = 1; static_cast<float>(away) < best && away < count; ++away) {
                    const auto reach = static_cast<float>(away);
                    if (i - away >= 0) {
                        best = std::min(best, std::max(reach, first[static_cast<std::ptrdiff_t>(i - away) * stride]));
                    }
                    if (i + away < count) {
                        best = std::min(best, std::max(reach, first[static_cast<std::ptrdiff_t>(i + away) * stride]));
                    }
                }
                line[static_cast<std::size_t>(i)] = best;
            }
            for (int i = 0; i < count; ++i) {
                first[static_cast<std::ptrdiff_t>(i) * stride] = line[static_cast<std::size_t>(i)];
            }
        }
    }
}

std::vector<float> clearances_of(std::vector<float> distance, glm::ivec3 bricks) {
    const auto farthest = static_cast<float>(std::max({bricks.x, bricks.y, bricks.z}));
    for (float &d : distance) {
        d = d > 0.0F ? 0.0F : farthest;
    }
    spread(distance, bricks.x, 1, bricks.y, bricks.x, bricks.z, bricks.x * bricks.y);
    spread(distance, bricks.y, bricks.x, bricks.x, 1, bricks.z, bricks.x * bricks.y);
    spread(distance, bricks.z, bricks.x * bricks.y, bricks.x, 1, bricks.y, bricks.x);
    for (float &d : distance) {
        // d bricks away leaves d - 1 whole bricks between; an occupied brick is marked by a negative number.
        d = (d - 1.0F) * static_cast<float>(BRICK);
    }
    return distance;
}

} // namespace

std::shared_ptr<const Grid> crop(std::span<const float> density, const glm::ivec3 &resolution, float threshold) {
    const Bounds bounds = occupied_bounds(density, resolution, threshold);
    if (bounds.low.x >= bounds.high.x) {
        return nullptr;
    }
    auto out = std::make_shared<Grid>();
    out->first = bounds.low - 1;
    out->resolution = bounds.high - bounds.low + 2;
    out->density.assign(cells(out->resolution), 0.0F);
    oneapi::tbb::parallel_for(bounds.low.z, bounds.high.z, [&](int z) {
        for (int y = bounds.low.y; y < bounds.high.y; ++y) {
            const float *source = density.data() + row_of(resolution, y, z);
            std::copy(source + bounds.low.x, source + bounds.high.x,
                      out->density.data() + row_of(out->resolution, y - bounds.low.y + 1, z - bounds.low.z + 1) + 1);
        }
    });
    out->bricks = (out->resolution + BRICK - 1) / BRICK;
    out->clearance = clearances_of(occupied_bricks(*out, threshold), out->bricks);
    return out;
}

} // namespace sfumato
