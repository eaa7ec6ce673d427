// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/map_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr std::size_t LANES = 64; // neighbouring floats that are filtered side by side

// A mean over 2 reach + 1 texels, and one more at either end with the weight `ends` in [0, 1).
struct Box {
    std::ptrdiff_t reach = 0;
    double ends = 0.0;
};

// BOXES of them make a bell within 7 % of its height, at a price that does not depend on its width, and keep densities
// positive. Their variance is exact for any deviation because of the fractional ends: Gwosdek, Grewenig, Bruhn and
// Weickert, "Theoretical Foundations of Gaussian Convolution by Extended Box Filtering", 2011, eqs 13-14.
Box extended_box(double deviation) {
    const double variance = deviation * deviation / BOXES;
    const double r = std::floor(0.5 * std::sqrt(12.0 * variance + 1.0) - 0.5);
    const double ends = (2.0 * r + 1.0) * (r * (r + 1.0) / 3.0 - variance) / (2.0 * (variance - (r + 1.0) * (r + 1.0)));
    return {static_cast<std::ptrdiff_t>(r), std::max(ends, 0.0)};
}

// `lanes` lines of `length` floats each, side by side; `stride` floats lead from one to the next of a line. Sums run in
// double, so that what enters them leaves them again but for 1e-16 of the largest.
void filter_lines(const float *in, float *out, std::size_t length, std::size_t stride, std::size_t lanes,
                  const Box &box) {
    std::array<double, LANES> sum{};
    const auto last = static_cast<std::ptrdiff_t>(length);
    const double weight = 1.0 / (2.0 * static_cast<double>(box.reach) + 1.0 + 2.0 * box.ends);
    static constexpr std::array<float, LANES> NOTHING{};
    const auto texel = [&](std::ptrdiff_t i) {
        return i < 0 || i >= last ? NOTHING.data() : in + i * static_cast<std::ptrdiff_t>(stride);
    };
    for (std::ptrdiff_t i = 0; i < std::min(box.reach, last); ++i) {
        const float *next = texel(i);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            sum[lane] += double{next[lane]};
        }
    }
    for (std::ptrdiff_t i = 0; i < last; ++i) {
        const float *next = texel(i + box.reach), *gone = texel(i - box.reach - 1), *end = texel(i + box.reach + 1);
        float *to = out + i * static_cast<std::ptrdiff_t>(stride);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            sum[lane] += double{next[lane]} - double{gone[lane]};
            to[lane] = static_cast<float>(weight * (sum[lane] + box.ends * (double{gone[lane]} + double{end[lane]})));
        }
    }
}

void filter_rows(const float *in, float *out, const MapSize &size, const Box &box) {
    oneapi::tbb::parallel_for(std::size_t{0}, size.height, [&](std::size_t y) {
        const std::size_t row = y * size.width * size.count;
        for (std::size_t c = 0; c < size.count; c += LANES) {
            filter_lines(in + row + c, out + row + c, size.width, size.count, std::min(LANES, size.count - c), box);
        }
    });
}

void filter_columns(const float *in, float *out, const MapSize &size, const Box &box) {
    const std::size_t row = size.width * size.count;
    oneapi::tbb::parallel_for(std::size_t{0}, (row + LANES - 1) / LANES, [&](std::size_t block) {
        const std::size_t c = block * LANES;
        filter_lines(in + c, out + c, size.height, row, std::min(LANES, row - c), box);
    });
}

// The weights of texels 2 i, 2 i + 1 and 2 i + 2 in texel i of a line of half the length.
std::array<float, 3> halving_weights(std::size_t i, std::size_t length) {
    if (length == 1) {
        return {1.0F, 0.0F, 0.0F};
    }
    if (length % 2 == 0) {
        return {0.5F, 0.5F, 0.0F};
    }
    const std::size_t half = length / 2;
    const auto n = static_cast<double>(length), m = static_cast<double>(half), at = static_cast<double>(i);
    return {static_cast<float>((m - at) / n), static_cast<float>(m / n), static_cast<float>((at + 1.0) / n)};
}

} // namespace

void filter_map(std::span<const float> in, std::span<float> out, const MapSize &size, FilterKind kind, double width) {
    const Box box =
        kind == FilterKind::BOX ? Box{static_cast<std::ptrdiff_t>((width - 1.0) / 2.0), 0.0} : extended_box(width);
    std::vector<float> between(in.size());
    const float *from = in.data();
    for (int pass = 0; pass < (kind == FilterKind::BOX ? 1 : BOXES); ++pass) {
        filter_rows(from, between.data(), size, box);
        filter_columns(between.data(), out.data(), size, box);
        from = out.data();
    }
}

MapSize half_size(const MapSize &size) {
    return {std::max<std::size_t>(size.height / 2, 1), std::max<std::size_t>(size.width / 2, 1), size.count};
}

void halve_map(std::span<const float> in, std::span<float> out, const MapSize &size) {
    const MapSize half = half_size(size);
    oneapi::tbb::parallel_for(std::size_t{0}, half.height, [&](std::size_t y) {
        const std::array<float, 3> down = halving_weights(y, size.height);
        for (std::size_t x = 0; x < half.width; ++x) {
            const std::array<float, 3> across = halving_weights(x, size.width);
            float *to = out.data() + (y * half.width + x) * size.count;
            std::fill_n(to, size.count, 0.0F);
            for (std::size_t dy = 0; dy < 3; ++dy) {
                for (std::size_t dx = 0; dx < 3; ++dx) {
                    const float weight = down[dy] * across[dx];
                    if (!(weight > 0.0F)) {
                        continue; // it may not exist
                    }
                    const float *from = in.data() + ((2 * y + dy) * size.width + 2 * x + dx) * size.count;
                    for (std::size_t c = 0; c < size.count; ++c) {
                        to[c] += weight * from[c];
                    }
                }
            }
        }
    });
}

std::vector<Range> shared_ranges(std::span<const Absorbers> rays, const MapSize &size, RangeKind kind, float q,
                                 std::size_t tile, std::size_t reach) {
    constexpr float FAR = std::numeric_limits<float>::max();
    constexpr Range NONE{FAR, -FAR};
    std::vector<Range> own(rays.size(), NONE); // a clear ray asks for no room
    oneapi::tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t r) {
        if (std::any_of(rays[r].tau.begin(), rays[r].tau.end(), [](float tau) { return tau > 0.0F; })) {
            own[r] = depth_range(rays[r], kind, q);
        }
    });
    const std::size_t side = tile == 0 ? std::max({size.height, size.width, std::size_t{1}}) : tile;
    std::vector<Range> out(rays.size());
    for (std::size_t top = 0; top < size.height; top += side) {
        for (std::size_t left = 0; left < size.width; left += side) {
            const std::size_t bottom = std::min(top + side, size.height), right = std::min(left + side, size.width);
            Range all = NONE;
            for (std::size_t y = top - std::min(top, reach); y < std::min(bottom + reach, size.height); ++y) {
                for (std::size_t x = left - std::min(left, reach); x < std::min(right + reach, size.width); ++x) {
                    all.low = std::min(all.low, own[y * size.width + x].low);
                    all.high = std::max(all.high, own[y * size.width + x].high);
                }
            }
            for (std::size_t y = top; y < bottom; ++y) {
                std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(y * size.width + left), right - left,
                            all.low <= all.high ? all : Range{});
            }
        }
    }
    return out;
}

} // namespace sfumato
