// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/medium.hpp"

#include "scene/scene.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
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

Bounds occupied_slice(const Medium &medium, float threshold, int z) {
    const glm::ivec3 n(medium.resolution);
    Bounds bounds;
    const float *density = medium.density.data() + row_of(n, 0, z);
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

Bounds occupied_bounds(const Medium &medium, float threshold) {
    using Slices = oneapi::tbb::blocked_range<int>;
    const auto of_slices = [&](const Slices &slices, Bounds bounds) {
        for (int z = slices.begin(); z != slices.end(); ++z) {
            bounds = together(bounds, occupied_slice(medium, threshold, z));
        }
        return bounds;
    };
    return oneapi::tbb::parallel_reduce(Slices(0, static_cast<int>(medium.resolution.z)), Bounds{}, of_slices,
                                        &together);
}

// A brick may meet smoke if any sample that interpolation inside it can reach is above the threshold.
std::vector<float> occupied_bricks(const CroppedMedium &medium, float threshold) {
    const glm::ivec3 n = medium.resolution, bricks = medium.bricks;
    std::vector<float> occupied(cells(bricks), 0.0F);
    const auto mark = [&](int brick_z) {
        for (int z = std::max(0, brick_z * BRICK - 1); z <= std::min(n.z - 1, (brick_z + 1) * BRICK); ++z) {
            for (int y = 0; y < n.y; ++y) {
                const float *row = medium.density.data() + row_of(n, y, z);
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

GridView CroppedMedium::density_grid() const {
    return {density.data(), 1, resolution.x, resolution.y, resolution.z};
}

ClearanceView CroppedMedium::clearances() const {
    return {clearance.data(), bricks.x, bricks.y, bricks.z};
}

CroppedMedium crop(const Medium &medium) {
    CroppedMedium out;
    out.extinction = medium.scattering + medium.absorption;
    out.scattering = medium.scattering;
    out.anisotropy = medium.anisotropy;
    const float strongest = std::max({out.extinction.x, out.extinction.y, out.extinction.z});
    if (!(strongest > 0.0F)) {
        return out;
    }
    const glm::dmat4 to_world(medium.grid_to_world);
    const glm::dvec3 n(medium.resolution);
    const double diagonal = glm::length(glm::dvec3(to_world * glm::dvec4(n, 0.0)));
    const auto threshold = static_cast<float>(1e-4 / (strongest * diagonal));
    const Bounds bounds = occupied_bounds(medium, threshold);
    if (bounds.low.x >= bounds.high.x) {
        return out;
    }

    out.resolution = bounds.high - bounds.low + 2;
    out.grid_to_world = glm::translate(to_world, glm::dvec3(bounds.low - 1));
    out.cell_size = std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis) {
        out.cell_size = std::min(out.cell_size, glm::length(glm::dvec3(to_world[axis])));
    }
    out.density.assign(cells(out.resolution), 0.0F);
    const glm::ivec3 size(medium.resolution);
    for (int z = bounds.low.z; z < bounds.high.z; ++z) {
        for (int y = bounds.low.y; y < bounds.high.y; ++y) {
            const float *source = medium.density.data() + row_of(size, y, z);
            std::copy(source + bounds.low.x, source + bounds.high.x,
                      out.density.data() + row_of(out.resolution, y - bounds.low.y + 1, z - bounds.low.z + 1) + 1);
        }
    }
    out.bricks = (out.resolution + BRICK - 1) / BRICK;
    out.clearance = clearances_of(occupied_bricks(out, threshold), out.bricks);
    return out;
}

} // namespace sfumato
