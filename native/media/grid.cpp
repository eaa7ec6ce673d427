// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/grid.hpp"

#include <algorithm>
#include <atomic>
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

// Calls visit(its cells, the first one's place) for each row along x that holds anything above the threshold.
template <typename Visit>
void for_each_row(const CellBlock &block, float threshold, const Visit &visit) {
    std::vector<float> line(block.strides.x == 1 ? 0 : static_cast<std::size_t>(block.size.x));
    for (int z = 0; z < block.size.z; ++z) {
        for (int y = 0; y < block.size.y; ++y) {
            const float *row = block.values + y * block.strides.y + z * block.strides.z;
            if (!line.empty()) {
                for (std::size_t x = 0; x < line.size(); ++x) {
                    line[x] = row[static_cast<std::ptrdiff_t>(x) * block.strides.x];
                }
                row = line.data();
            }
            // Most rows of a large domain are empty, and counting goes many cells at a time where a search goes one by
            // one.
            int count = 0;
            for (int x = 0; x < block.size.x; ++x) {
                count += row[x] > threshold ? 1 : 0;
            }
            if (count > 0) {
                visit(std::span(row, static_cast<std::size_t>(block.size.x)), block.first + glm::ivec3(0, y, z));
            }
        }
    }
}

struct Bounds {
    glm::ivec3 low{std::numeric_limits<int>::max()};
    glm::ivec3 high{std::numeric_limits<int>::min()}; // exclusive
    double amount = 0.0;                              // of all densities inside
};

Bounds together(const Bounds &a, const Bounds &b) {
    return {glm::min(a.low, b.low), glm::max(a.high, b.high), a.amount + b.amount};
}

Bounds occupied_bounds(std::span<const CellBlock> blocks, float threshold) {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    const auto of_blocks = [&](const Range &range, Bounds bounds) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for_each_row(blocks[i], threshold, [&](std::span<const float> row, const glm::ivec3 &at) {
                const auto filled = [threshold](float value) { return value > threshold; };
                const auto first = static_cast<int>(std::find_if(row.begin(), row.end(), filled) - row.begin());
                const auto after = static_cast<int>(row.rend() - std::find_if(row.rbegin(), row.rend(), filled));
                float sum = 0.0F; // of one row: the blocks' sums are added in double precision
                for (const float value : row) {
                    sum += value > threshold ? value : 0.0F;
                }
                bounds = together(bounds, {at + glm::ivec3(first, 0, 0), at + glm::ivec3(after, 1, 1), double{sum}});
            });
        }
        return bounds;
    };
    // Deterministic: media are sorted by their amounts.
    return oneapi::tbb::parallel_deterministic_reduce(Range(0, blocks.size()), Bounds{}, of_blocks, &together);
}

// Which bricks of `edge`^3 cells hold something above the threshold, counting `before` cells before each and one
// behind.
class Marks {
public:
    Marks(const glm::ivec3 &resolution, int edge, int before)
        : bricks(glm::max((resolution + edge - 1 - (1 - before)) / edge, 1)), flags(cells(bricks), 0), edge_(edge),
          before_(before) {}

    // From many threads at once.
    void mark(std::span<const float> row, const glm::ivec3 &at, float threshold) {
        const glm::ivec3 low = first_of(at), high = last_of(at + glm::ivec3(static_cast<int>(row.size()) - 1, 0, 0));
        for (int x = low.x; x <= high.x; ++x) {
            const int begin = std::max(x * edge_ - before_ - at.x, 0);
            const int end = std::min((x + 1) * edge_ - at.x + 1, static_cast<int>(row.size()));
            if (std::none_of(row.begin() + begin, row.begin() + end, [&](float value) { return value > threshold; })) {
                continue;
            }
            for (int z = low.z; z <= high.z; ++z) {
                for (int y = low.y; y <= high.y; ++y) {
                    const std::atomic_ref flag(flags[static_cast<std::size_t>(row_of(bricks, y, z) + x)]);
                    if (flag.load(std::memory_order_relaxed) == 0) {
                        flag.store(1, std::memory_order_relaxed);
                    }
                }
            }
        }
    }

    // Of the bricks that a cell counts for.
    [[nodiscard]] glm::ivec3 first_of(const glm::ivec3 &cell) const {
        return glm::max((cell + edge_ - 1) / edge_ - 1, 0);
    }
    [[nodiscard]] glm::ivec3 last_of(const glm::ivec3 &cell) const {
        return glm::min((cell + before_) / edge_, bricks - 1);
    }

    glm::ivec3 bricks;
    std::vector<std::uint8_t> flags;

private:
    int edge_, before_;
};

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

float above(float value, float threshold) {
    return value > threshold ? value : 0.0F;
}

void store_dense(const Grid &grid, std::vector<float> &values, std::span<const float> row, const glm::ivec3 &at,
                 float threshold) {
    const int begin = std::max(-at.x, 0), end = std::min(static_cast<int>(row.size()), grid.resolution.x - at.x);
    float *const to = values.data() + row_of(grid.resolution, at.y, at.z) + at.x;
    for (int x = begin; x < end; ++x) {
        to[x] = above(row[static_cast<std::size_t>(x)], threshold);
    }
}

// In each brick that holds a part of the row, which is more than one where they share a layer.
void store_in_bricks(const Grid &grid, std::vector<float> &values, const Marks &filled, std::span<const float> row,
                     const glm::ivec3 &at, float threshold) {
    const glm::ivec3 low = filled.first_of(glm::max(at, 0));
    const glm::ivec3 high = filled.last_of(at + glm::ivec3(static_cast<int>(row.size()) - 1, 0, 0));
    for (int z = low.z; z <= high.z; ++z) {
        for (int y = low.y; y <= high.y; ++y) {
            for (int x = low.x; x <= high.x; ++x) {
                const std::int32_t brick = grid.stored[static_cast<std::size_t>(row_of(grid.stored_bricks, y, z) + x)];
                const glm::ivec3 from(0, at.y - y * STORED, at.z - z * STORED);
                float *const to = values.data() + brick + row_of(glm::ivec3(STORED_ROW), from.y, from.z);
                const int begin = std::max(x * STORED - at.x, 0);
                const int end = std::min(x * STORED + STORED_ROW - at.x, static_cast<int>(row.size()));
                for (int cell = begin; brick != 0 && cell < end; ++cell) {
                    to[cell + at.x - x * STORED] = above(row[static_cast<std::size_t>(cell)], threshold);
                }
            }
        }
    }
}

// Room for the bricks that are filled, behind the empty one.
void number_bricks(Grid &grid, const Marks &filled) {
    grid.stored_bricks = filled.bricks;
    grid.stored.resize(filled.flags.size());
    std::size_t next = 0;
    for (int z = 0; z < filled.bricks.z; ++z) {
        for (int y = 0; y < filled.bricks.y; ++y) {
            for (int x = 0; x < filled.bricks.x; ++x, ++next) {
                if (filled.flags[next] != 0) {
                    grid.corners.push_back(glm::ivec3(x, y, z) * STORED);
                    grid.stored[next] = static_cast<std::int32_t>(grid.corners.size()) * STORED_CELLS;
                }
            }
        }
    }
    grid.density.assign((grid.corners.size() + 1) * STORED_CELLS, 0.0F);
}

} // namespace

GridView Grid::view() const {
    GridView out{
        density.data(), 1, resolution.x, resolution.y, resolution.z, resolution.x, resolution.x * resolution.y};
    if (!stored.empty()) {
        out.row = STORED_ROW;
        out.slice = STORED_ROW * STORED_ROW;
        out.bricks = stored.data();
        out.bricks_x = stored_bricks.x;
        out.bricks_y = stored_bricks.y;
    }
    return out;
}

int Grid::boxes() const {
    return stored.empty() ? resolution.z : static_cast<int>(corners.size());
}

Grid::Box Grid::box(int number) const {
    if (stored.empty()) {
        return {{0, 0, number}, {resolution.x, resolution.y, 1}, row_of(resolution, 0, number)};
    }
    return {corners[static_cast<std::size_t>(number)], glm::ivec3(STORED_ROW),
            (static_cast<std::ptrdiff_t>(number) + 1) * STORED_CELLS};
}

std::ptrdiff_t Grid::place_of(const glm::ivec3 &cell) const {
    if (stored.empty()) {
        return row_of(resolution, cell.y, cell.z) + cell.x;
    }
    const glm::ivec3 brick = glm::min(cell / STORED, stored_bricks - 1), within = cell - brick * STORED;
    return stored[static_cast<std::size_t>(row_of(stored_bricks, brick.y, brick.z) + brick.x)] +
           row_of(glm::ivec3(STORED_ROW), within.y, within.z) + within.x;
}

std::vector<float> clearances_of(std::span<const std::uint8_t> occupied, const glm::ivec3 &bricks) {
    const auto farthest = static_cast<float>(std::max({bricks.x, bricks.y, bricks.z}));
    std::vector<float> distance(occupied.size());
    std::transform(occupied.begin(), occupied.end(), distance.begin(),
                   [farthest](std::uint8_t flag) { return flag != 0 ? 0.0F : farthest; });
    spread(distance, bricks.x, 1, bricks.y, bricks.x, bricks.z, bricks.x * bricks.y);
    spread(distance, bricks.y, bricks.x, bricks.x, 1, bricks.z, bricks.x * bricks.y);
    spread(distance, bricks.z, bricks.x * bricks.y, bricks.x, 1, bricks.y, bricks.x);
    for (float &d : distance) {
        // d bricks away leaves d - 1 whole bricks between; an occupied brick is marked by a negative number.
        d = (d - 1.0F) * static_cast<float>(BRICK);
    }
    return distance;
}

std::vector<glm::vec2> brick_ranges(const Grid &grid) {
    std::vector<glm::vec2> ranges(cells(grid.bricks), glm::vec2(0.0F));
    oneapi::tbb::parallel_for(0, grid.bricks.z, [&](int z) {
        for (int y = 0; y < grid.bricks.y; ++y) {
            for (int x = 0; x < grid.bricks.x; ++x) {
                const auto number = static_cast<std::size_t>(row_of(grid.bricks, y, z) + x);
                if (grid.clearance[number] >= 0.0F) {
                    continue;
                }
                const glm::ivec3 first = glm::ivec3(x, y, z) * BRICK;
                const glm::ivec3 low = glm::max(first - 1, 0), high = glm::min(first + BRICK, grid.resolution - 1);
                glm::vec2 range(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
                for (int k = low.z; k <= high.z; ++k) {
                    for (int j = low.y; j <= high.y; ++j) {
                        for (int i = low.x; i <= high.x; ++i) {
                            const float value = grid.density[static_cast<std::size_t>(grid.place_of({i, j, k}))];
                            range = {std::min(range.x, value), std::max(range.y, value)};
                        }
                    }
                }
                ranges[number] = range;
            }
        }
    });
    return ranges;
}

void copy_cells(const Grid &grid, std::span<const float> stored, int channels, std::span<float> out) {
    if (grid.stored.empty()) {
        std::copy(stored.begin(), stored.end(), out.begin());
        return;
    }
    std::fill(out.begin(), out.end(), 0.0F);
    for (int number = 0; number < grid.boxes(); ++number) {
        const Grid::Box box = grid.box(number);
        const glm::ivec3 size = glm::min(box.size, grid.resolution - box.first);
        for (int z = 0; z < size.z; ++z) {
            for (int y = 0; y < size.y; ++y) {
                const float *from = stored.data() + (box.begin + row_of(box.size, y, z)) * channels;
                const std::ptrdiff_t to = row_of(grid.resolution, box.first.y + y, box.first.z + z) + box.first.x;
                std::copy(from, from + size.x * channels, out.begin() + to * channels);
            }
        }
    }
}

std::shared_ptr<Grid> crop(std::span<const CellBlock> blocks, float threshold, Layout layout,
                           std::span<const CellBlock> glow) {
    Bounds bounds = occupied_bounds(blocks, threshold);
    const double amount = bounds.amount;
    bounds = together(bounds, occupied_bounds(glow, 0.0F));
    if (bounds.low.x >= bounds.high.x) {
        return nullptr;
    }
    auto out = std::make_shared<Grid>();
    out->first = bounds.low - 1;
    out->resolution = bounds.high - bounds.low + 2;
    out->amount = amount;
    const auto each_row = [&out](std::span<const CellBlock> of, float above, const auto &visit) {
        oneapi::tbb::parallel_for(std::size_t{0}, of.size(), [&](std::size_t i) {
            for_each_row(of[i], above,
                         [&](std::span<const float> row, const glm::ivec3 &at) { visit(row, at - out->first); });
        });
    };
    Marks occupied(out->resolution, BRICK, 1), filled(out->resolution, STORED, 0);
    const auto mark = [&](std::span<const CellBlock> of, float above) {
        each_row(of, above, [&](std::span<const float> row, const glm::ivec3 &at) {
            occupied.mark(row, at, above);
            filled.mark(row, at, above);
        });
    };
    mark(blocks, threshold);
    mark(glow, 0.0F);
    out->bricks = occupied.bricks;
    out->clearance = clearances_of(occupied.flags, occupied.bricks);
    const auto count = static_cast<std::size_t>(std::count(filled.flags.begin(), filled.flags.end(), 1));
    const bool dense = layout == Layout::DENSE || (layout == Layout::BEST && 2 * count > filled.flags.size());
    if (dense) {
        out->density.assign(cells(out->resolution), 0.0F);
    } else {
        number_bricks(*out, filled);
    }
    const auto store = [&](std::vector<float> &values, std::span<const CellBlock> of, float above) {
        each_row(of, above, [&](std::span<const float> row, const glm::ivec3 &at) {
            dense ? store_dense(*out, values, row, at, above) : store_in_bricks(*out, values, filled, row, at, above);
        });
    };
    store(out->density, blocks, threshold);
    if (!glow.empty()) {
        out->glow.assign(out->density.size(), 0.0F);
        store(out->glow, glow, 0.0F);
    }
    return out;
}

std::shared_ptr<Grid> crop(std::span<const float> density, const glm::ivec3 &resolution, float threshold, Layout layout,
                           std::span<const float> glow) {
    const auto slices_of = [&resolution](std::span<const float> values) {
        std::vector<CellBlock> slices(values.empty() ? 0 : static_cast<std::size_t>(resolution.z));
        for (int z = 0; z < static_cast<int>(slices.size()); ++z) {
            slices[static_cast<std::size_t>(z)] = {values.data() + row_of(resolution, 0, z),
                                                   {0, 0, z},
                                                   {resolution.x, resolution.y, 1},
                                                   {1, resolution.x, 0}};
        }
        return slices;
    };
    return crop(slices_of(density), threshold, layout, slices_of(glow));
}

} // namespace sfumato
