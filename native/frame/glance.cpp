// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/glance.hpp"

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

// Pixels x0 <= x <= x1, y0 <= y <= y1, of which the corners are traced.
struct Cell {
    int x0, y0, x1, y1;
    [[nodiscard]] bool done() const { return x1 - x0 <= 1 && y1 - y0 <= 1; }
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
    Glance(const InstructionSet &with, const FrameView &view, Output output, int width, int height)
        : with_(with), view_(view), output_(output), width_(width), height_(height),
          planes_(view.shadow_strength ? 2 : 1), channels_(output == Output::PICTURE ? 4 : 3),
          values_(planes_ * 4 * at(0, height)), distance_(at(0, height)), surface_(at(0, height)),
          traced_(at(0, height)) {}

    std::vector<float> run(int spacing) {
        const std::vector<int> columns = every(width_, spacing), rows = every(height_, spacing);
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
        return std::move(values_);
    }

private:
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    [[nodiscard]] std::size_t clamped(int x, int y) const {
        return at(std::clamp(x, 0, width_ - 1), std::clamp(y, 0, height_ - 1));
    }

    [[nodiscard]] float *value(std::size_t plane, std::size_t pixel) {
        return values_.data() + 4 * (plane * distance_.size() + pixel);
    }

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
        std::uint8_t &seen = traced_[at(x, y)];
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
            const float *const rgb = value(0, at(x, y));
            sum += static_cast<double>(std::max({rgb[0], rgb[1], rgb[2]}));
        }
        return std::max(static_cast<float>(sum / static_cast<double>(all_.size())), 1e-12F);
    }

    void trace(const std::vector<Point> &points) {
        const auto lanes = static_cast<std::size_t>(with_.lanes);
        const std::size_t packets = (points.size() + lanes - 1) / lanes;
        constexpr std::size_t GRAIN = 16;
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, packets, GRAIN), [&](const auto &range) {
            Packet packet;
            std::fill_n(packet.light_u, lanes, 0.5F);
            std::fill_n(packet.light_v, lanes, 0.5F);
            Traced light;
            for (std::size_t number = range.begin(); number != range.end(); ++number) {
                const std::size_t first = number * lanes;
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const Point &point = points[std::min(first + lane, points.size() - 1)];
                    packet.u[lane] = (static_cast<float>(point.x) + 0.5F) / static_cast<float>(width_);
                    packet.v[lane] = (static_cast<float>(point.y) + 0.5F) / static_cast<float>(height_);
                    packet.active[lane] = first + lane < points.size() ? 1.0F : 0.0F;
                }
                frame_kernels(with_).trace(view_, output_, packet, light);
                for (std::size_t lane = 0; lane < lanes && first + lane < points.size(); ++lane) {
                    store(at(points[first + lane].x, points[first + lane].y), light, lane);
                }
            }
        });
    }

    void store(std::size_t pixel, const Traced &light, std::size_t lane) {
        float *const to = value(0, pixel);
        for (std::size_t c = 0; c < 3; ++c) {
            to[c] = light.radiance[c][lane];
        }
        distance_[pixel] = light.distance[lane];
        surface_[pixel] = light.surface[lane];
        if (planes_ == 2) {
            float *const behind = value(1, pixel);
            for (std::size_t c = 0; c < 3; ++c) {
                behind[c] = light.behind[c][lane];
            }
            behind[3] = light.alpha[lane];
        } else {
            to[3] = output_ == Output::PICTURE ? light.alpha[lane] : light.distance[lane];
        }
    }

    [[nodiscard]] bool distance_bends(std::size_t before, std::size_t centre, std::size_t after) const {
        const float d = distance_[centre];
        return std::abs(distance_[before] + distance_[after] - 2.0F * d) > STEP * d;
    }

    // Whether a pixel is so far from the middle between two others that these are not enough.
    bool bends(std::size_t before, std::size_t centre, std::size_t after) {
        for (std::size_t plane = 0; plane < planes_; ++plane) {
            const float *const a = value(plane, before), *const b = value(plane, after),
                               *const c = value(plane, centre);
            const float allowed = CONTRAST * std::max({bright_, c[0], c[1], c[2]});
            for (int i = 0; i < channels_; ++i) {
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
            return at(columns[static_cast<std::size_t>(std::clamp(i, 0, across - 1))],
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
        fill(smooth);
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
        fill(smooth);
        return split;
    }

    // Whether the corners of a cell differ by more than what may be interpolated.
    bool differ(const Cell &cell) {
        const std::array<std::size_t, 4> corners = {at(cell.x0, cell.y0), at(cell.x1, cell.y0), at(cell.x0, cell.y1),
                                                    at(cell.x1, cell.y1)};
        const auto [near, far] =
            std::minmax({distance_[corners[0]], distance_[corners[1]], distance_[corners[2]], distance_[corners[3]]});
        if (far - near > 4.0F * STEP * near) {
            return true;
        }
        for (std::size_t plane = 0; plane < planes_; ++plane) {
            float brightest = bright_, widest = 0.0F;
            for (int c = 0; c < channels_; ++c) {
                const auto [low, high] = std::minmax({value(plane, corners[0])[c], value(plane, corners[1])[c],
                                                      value(plane, corners[2])[c], value(plane, corners[3])[c]});
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
            const std::size_t a = at(xa, ya), b = at(xb, yb), c = at(xc, yc);
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

    // Interpolates between the corners of cells, which share no pixel but on their sides. Of a side that is traced on
    // the other cell's behalf, that stays; any other gets from both cells the same.
    void fill(const std::vector<Cell> &cells) {
        constexpr std::size_t GRAIN = 256;
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, cells.size(), GRAIN),
                                  [&](const auto &range) {
                                      for (std::size_t number = range.begin(); number != range.end(); ++number) {
                                          for (std::size_t plane = 0; plane < planes_; ++plane) {
                                              fill(cells[number], plane);
                                          }
                                      }
                                  });
    }

    void fill(const Cell &cell, std::size_t plane) {
        const int width = cell.x1 - cell.x0, height = cell.y1 - cell.y0;
        const float *const a = value(plane, at(cell.x0, cell.y0)), *const b = value(plane, at(cell.x1, cell.y0));
        const float *const c = value(plane, at(cell.x0, cell.y1)), *const d = value(plane, at(cell.x1, cell.y1));
        // The upper and right sides are the next cells', but for the last.
        const int last_x = cell.x1 == width_ - 1 ? width : width - 1;
        const int last_y = cell.y1 == height_ - 1 ? height : height - 1;
        for (int j = 0; j <= last_y; ++j) {
            const float v = height > 0 ? static_cast<float>(j) / static_cast<float>(height) : 0.0F;
            std::array<float, 4> left, slope;
            for (std::size_t i = 0; i < 4; ++i) {
                left[i] = a[i] + (c[i] - a[i]) * v;
                slope[i] = width > 0 ? (b[i] + (d[i] - b[i]) * v - left[i]) / static_cast<float>(width) : 0.0F;
            }
            const std::size_t row = at(cell.x0, cell.y0 + j);
            for (int x = 0; x <= last_x; ++x) {
                const std::size_t pixel = row + static_cast<std::size_t>(x);
                if (traced_[pixel] != 0) {
                    continue;
                }
                float *const to = value(plane, pixel);
                for (std::size_t i = 0; i < 4; ++i) {
                    to[i] = left[i] + slope[i] * static_cast<float>(x);
                }
            }
        }
    }

    // Whether a surface ends at a pixel or changes. Smoke is as it is, without the film's filter.
    [[nodiscard]] bool edge(int x, int y) const {
        const std::size_t centre = at(x, y);
        return std::any_of(WAYS.begin(), WAYS.end(), [&](const std::array<int, 2> &way) {
            // What is interpolated is smooth: as good as the pixel itself.
            const auto beside = [&](int i, int j) {
                const std::size_t pixel = clamped(i, j);
                return traced_[pixel] != 0 ? pixel : centre;
            };
            const std::size_t before = beside(x - way[0], y - way[1]), after = beside(x + way[0], y + way[1]);
            const float own = surface_[centre];
            return std::abs(surface_[before] + surface_[after] - 2.0F * own) > EDGE * own ||
                   distance_bends(before, centre, after);
        });
    }

    // One sample a pixel leaves stairs at edges. Half of a pixel's own colour and an eighth of each neighbour's beside
    // it come closest to what many samples and the film's filter make of an edge: measured by least squares.
    void soften() {
        std::vector<std::pair<std::size_t, std::array<float, 3>>> found;
        const std::size_t plane = planes_ - 1;
        for (const auto &[x, y] : all_) {
            if (!edge(x, y)) {
                continue;
            }
            const float *const own = value(plane, at(x, y));
            const std::array<const float *, 4> sides = {
                value(plane, clamped(x - 1, y)), value(plane, clamped(x + 1, y)), value(plane, clamped(x, y - 1)),
                value(plane, clamped(x, y + 1))};
            std::array<float, 3> mean;
            for (std::size_t c = 0; c < 3; ++c) {
                mean[c] = 0.5F * own[c] + 0.125F * (sides[0][c] + sides[1][c] + sides[2][c] + sides[3][c]);
            }
            found.emplace_back(at(x, y), mean);
        }
        for (const auto &[pixel, mean] : found) {
            std::copy(mean.begin(), mean.end(), value(plane, pixel));
        }
    }

    const InstructionSet &with_;
    const FrameView &view_;
    Output output_;
    int width_, height_;
    std::size_t planes_;
    int channels_;                // that count for edges
    float bright_ = 0.0F;         // the mean of the first pixels: of what is darker the error may be as large
    std::vector<float> values_;   // planes of RGBA
    std::vector<float> distance_; // of what is traced
    std::vector<float> surface_;  // of what is traced: Traced.surface
    std::vector<std::uint8_t> traced_;
    std::vector<Point> all_; // that are traced
};

} // namespace

std::vector<float> glance(const InstructionSet &with, const FrameView &view, Output output, int width, int height,
                          int spacing) {
    return Glance(with, view, output, width, height).run(spacing);
}

} // namespace sfumato
