// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/glance.hpp"

#include "frame/glance_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// How far a value may be from the middle between its neighbours, as a share of the brightness, before the pixels
// between them are traced: an eighth of that is what interpolation then misses.
constexpr float CONTRAST = 0.08F;
// The same of an edge that F12 would sample closely.
constexpr float EDGE = 0.03F;
// The same of distances, which say where one surface ends.
constexpr float STEP = 0.02F;
constexpr std::array<std::array<int, 2>, 2> WAYS = {{{1, 0}, {0, 1}}};

struct Point {
    int x, y;
};

// Calls body(i, j) for all i < across, j < up, block by block: rays of one packet should be close together, since all
// of them march where one of them must.
template <typename Body>
void in_blocks(int across, int up, const Body &body) {
    constexpr int BLOCK = 4;
    for (int j0 = 0; j0 < up; j0 += BLOCK) {
        for (int i0 = 0; i0 < across; i0 += BLOCK) {
            for (int j = j0; j < std::min(j0 + BLOCK, up); ++j) {
                for (int i = i0; i < std::min(i0 + BLOCK, across); ++i) {
                    body(i, j);
                }
            }
        }
    }
}

class Glance {
public:
    Glance(const Tracer &tracer, int width, int height) : tracer_(tracer), pixels_(tracer.wanted, width, height) {}

    std::vector<float> run(int spacing) {
        const std::vector<int> columns = every(pixels_.width, spacing), rows = every(pixels_.height, spacing);
        std::vector<Point> points;
        in_blocks(static_cast<int>(columns.size()), static_cast<int>(rows.size()), [&](int i, int j) {
            add(points, columns[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
        });
        trace(points);
        bright_ = mean_brightness();
        std::vector<Cell> split = first_cells(columns, rows);
        while (!split.empty()) {
            split = divided(split);
        }
        soften();
        return std::move(pixels_.values);
    }

private:
    // 0, spacing, 2 spacing, ... and the last.
    static std::vector<int> every(int size, int spacing) {
        std::vector<int> out;
        for (int i = 0; i < size - 1; i += spacing) {
            out.push_back(i);
        }
        out.push_back(size - 1);
        return out;
    }

    void add(std::vector<Point> &points, int x, int y) {
        std::uint8_t &seen = pixels_.traced[pixels_.at(x, y)];
        if (seen == 0) {
            seen = 1;
            points.push_back({x, y});
            all_.push_back({x, y});
        }
    }

    // Of what is traced, in the colour that is the brightest.
    float mean_brightness() {
        double sum = 0.0;
        for (const auto &[x, y] : all_) {
            const float *const rgb = pixels_.value(0, pixels_.at(x, y));
            sum += static_cast<double>(std::max({rgb[0], rgb[1], rgb[2]}));
        }
        return std::max(static_cast<float>(sum / static_cast<double>(all_.size())), 1e-12F);
    }

    void trace(const std::vector<Point> &points) {
        const std::size_t grain = 16 * static_cast<std::size_t>(tracer_.with.lanes);
        oneapi::tbb::parallel_for(
            oneapi::tbb::blocked_range<std::size_t>(0, points.size(), grain), [&](const auto &range) {
                const Point *const first = points.data() + range.begin();
                const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                    packet.u[lane] = (static_cast<float>(first[number].x) + 0.5F) / static_cast<float>(pixels_.width);
                    packet.v[lane] = (static_cast<float>(first[number].y) + 0.5F) / static_cast<float>(pixels_.height);
                    packet.light_u[lane] = packet.light_v[lane] = packet.look_u[lane] = packet.look_v[lane] = 0.5F;
                };
                tracer_.trace(range.size(), fill, [&](const Layers &layers, std::size_t lane, std::size_t number) {
                    pixels_.store(pixels_.at(first[number].x, first[number].y), layers, lane);
                });
            });
    }

    [[nodiscard]] bool distance_bends(std::size_t before, std::size_t centre, std::size_t after) const {
        const float d = pixels_.distance[centre];
        return std::abs(pixels_.distance[before] + pixels_.distance[after] - 2.0F * d) > STEP * d;
    }

    // Whether a pixel is so far from the middle between two others that these are not enough.
    bool bends(std::size_t before, std::size_t centre, std::size_t after) {
        for (std::size_t plane = 0; plane < pixels_.planes; ++plane) {
            const float *const a = pixels_.value(plane, before), *const b = pixels_.value(plane, after),
                               *const c = pixels_.value(plane, centre);
            const float allowed = CONTRAST * std::max({bright_, c[0], c[1], c[2]});
            for (int i = 0; i < pixels_.channels; ++i) {
                if (std::abs(a[i] + b[i] - 2.0F * c[i]) > allowed) {
                    return true;
                }
            }
        }
        return false;
    }

    // The cells between the first pixels that are not smooth; the others are filled.
    std::vector<Cell> first_cells(const std::vector<int> &columns, const std::vector<int> &rows) {
        const int across = static_cast<int>(columns.size()), up = static_cast<int>(rows.size());
        std::vector<std::uint8_t> bent(columns.size() * rows.size());
        const auto number = [&](int i, int j) { return static_cast<std::size_t>(j * across + i); };
        const auto pixel = [&](int i, int j) {
            return pixels_.at(columns[static_cast<std::size_t>(std::clamp(i, 0, across - 1))],
                              rows[static_cast<std::size_t>(std::clamp(j, 0, up - 1))]);
        };
        oneapi::tbb::parallel_for(0, up, [&](int j) {
            for (int i = 0; i < across; ++i) {
                const bool found = std::any_of(WAYS.begin(), WAYS.end(), [&](const std::array<int, 2> &way) {
                    const std::size_t before = pixel(i - way[0], j - way[1]), after = pixel(i + way[0], j + way[1]);
                    return distance_bends(before, pixel(i, j), after) || bends(before, pixel(i, j), after);
                });
                bent[number(i, j)] = found ? 1 : 0;
            }
        });
        std::vector<Cell> split, smooth;
        in_blocks(std::max(across - 1, 1), std::max(up - 1, 1), [&](int i, int j) {
            const int i1 = std::min(i + 1, across - 1), j1 = std::min(j + 1, up - 1);
            const bool any =
                (bent[number(i, j)] | bent[number(i1, j)] | bent[number(i, j1)] | bent[number(i1, j1)]) != 0;
            const auto index = [](int k) { return static_cast<std::size_t>(k); };
            (any ? split : smooth).push_back({columns[index(i)], rows[index(j)], columns[index(i1)], rows[index(j1)]});
        });
        pixels_.fill(smooth);
        std::erase_if(split, [](const Cell &cell) { return cell.done(); });
        return split;
    }

    // Traces the middles of cells and of their sides, and gives back those of their quarters that are not smooth.
    std::vector<Cell> divided(const std::vector<Cell> &cells) {
        std::vector<Point> points;
        for (const Cell &cell : cells) {
            for (const int j : {cell.y0, (cell.y0 + cell.y1) / 2, cell.y1}) {
                for (const int i : {cell.x0, (cell.x0 + cell.x1) / 2, cell.x1}) {
                    add(points, i, j);
                }
            }
        }
        trace(points);
        std::vector<Cell> split, smooth;
        for (const Cell &cell : cells) {
            const int x = (cell.x0 + cell.x1) / 2, y = (cell.y0 + cell.y1) / 2;
            const bool bent = bends(cell, x, y);
            // The lower half of two neighbouring pixels is nothing.
            const std::array<int, 3> xs = {cell.x0, x, cell.x1}, ys = {cell.y0, y, cell.y1};
            for (std::size_t j = y == cell.y0 ? 1 : 0; j < 2; ++j) {
                for (std::size_t i = x == cell.x0 ? 1 : 0; i < 2; ++i) {
                    const Cell quarter{xs[i], ys[j], xs[i + 1], ys[j + 1]};
                    if (!quarter.done()) {
                        (bent && differ(quarter) ? split : smooth).push_back(quarter);
                    }
                }
            }
        }
        pixels_.fill(smooth);
        return split;
    }

    // Whether the corners of a cell differ by more than what may be interpolated.
    bool differ(const Cell &cell) {
        const std::array<std::size_t, 4> corners = {pixels_.at(cell.x0, cell.y0), pixels_.at(cell.x1, cell.y0),
                                                    pixels_.at(cell.x0, cell.y1), pixels_.at(cell.x1, cell.y1)};
        const auto [near, far] = std::minmax({pixels_.distance[corners[0]], pixels_.distance[corners[1]],
                                              pixels_.distance[corners[2]], pixels_.distance[corners[3]]});
        if (far - near > 4.0F * STEP * near) {
            return true;
        }
        for (std::size_t plane = 0; plane < pixels_.planes; ++plane) {
            float brightest = bright_, widest = 0.0F;
            for (int c = 0; c < pixels_.channels; ++c) {
                const auto [low, high] =
                    std::minmax({pixels_.value(plane, corners[0])[c], pixels_.value(plane, corners[1])[c],
                                 pixels_.value(plane, corners[2])[c], pixels_.value(plane, corners[3])[c]});
                brightest = std::max(brightest, high);
                widest = std::max(widest, high - low);
            }
            if (widest > CONTRAST * brightest) {
                return true;
            }
        }
        return false;
    }

    // Whether any of the lines of three through a cell's corners, middles and middle does that.
    bool bends(const Cell &cell, int x, int y) {
        const auto line = [this](int xa, int ya, int xb, int yb, int xc, int yc) {
            const std::size_t a = pixels_.at(xa, ya), b = pixels_.at(xb, yb), c = pixels_.at(xc, yc);
            return distance_bends(a, b, c) || bends(a, b, c);
        };
        for (const int j : {cell.y0, y, cell.y1}) {
            if (line(cell.x0, j, x, j, cell.x1, j)) {
                return true;
            }
        }
        for (const int i : {cell.x0, x, cell.x1}) {
            if (line(i, cell.y0, i, y, i, cell.y1)) {
                return true;
            }
        }
        return false;
    }

    // Whether a surface ends at a pixel or changes. Smoke is as it is, without the film's filter.
    [[nodiscard]] bool edge(int x, int y) const {
        const std::size_t centre = pixels_.at(x, y);
        return std::any_of(WAYS.begin(), WAYS.end(), [&](const std::array<int, 2> &way) {
            // What is interpolated is smooth: as good as the pixel itself.
            const auto beside = [&](int i, int j) {
                const std::size_t pixel = pixels_.clamped(i, j);
                return pixels_.traced[pixel] != 0 ? pixel : centre;
            };
            const std::size_t before = beside(x - way[0], y - way[1]), after = beside(x + way[0], y + way[1]);
            const float own = pixels_.surface[centre];
            return std::abs(pixels_.surface[before] + pixels_.surface[after] - 2.0F * own) > EDGE * own ||
                   distance_bends(before, centre, after);
        });
    }

    // One sample a pixel leaves stairs at edges. Half of a pixel's own colour and an eighth of each neighbour's beside
    // it come closest to what many samples and the film's filter make of an edge: measured by least squares.
    void soften() {
        std::vector<std::pair<std::size_t, std::array<float, 3>>> found;
        const std::size_t plane = pixels_.planes - 1;
        for (const auto &[x, y] : all_) {
            if (!edge(x, y)) {
                continue;
            }
            const float *const own = pixels_.value(plane, pixels_.at(x, y));
            const std::array<const float *, 4> sides = {
                pixels_.value(plane, pixels_.clamped(x - 1, y)), pixels_.value(plane, pixels_.clamped(x + 1, y)),
                pixels_.value(plane, pixels_.clamped(x, y - 1)), pixels_.value(plane, pixels_.clamped(x, y + 1))};
            std::array<float, 3> mean;
            for (std::size_t c = 0; c < 3; ++c) {
                mean[c] = 0.5F * own[c] + 0.125F * (sides[0][c] + sides[1][c] + sides[2][c] + sides[3][c]);
            }
            found.emplace_back(pixels_.at(x, y), mean);
        }
        for (const auto &[pixel, mean] : found) {
            std::copy(mean.begin(), mean.end(), pixels_.value(plane, pixel));
        }
    }

    const Tracer &tracer_;
    GlancePixels pixels_;
    float bright_ = 0.0F;    // the mean of the first pixels: of what is darker the error may be as large
    std::vector<Point> all_; // that are traced
};

} // namespace

std::vector<float> glance(const Tracer &tracer, int width, int height, int spacing) {
    return Glance(tracer, width, height).run(spacing);
}

} // namespace sfumato
