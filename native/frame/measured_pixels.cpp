// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/measured_pixels.hpp"

#include "frame/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// How wrong a pixel may be: where it differs from those around it by a part of that, and a little of what it is.
class Doubt {
public:
    Doubt(std::span<const float> picture, int width, int height) : picture_(picture), width_(width), height_(height) {}
    [[nodiscard]] double operator()(int x, int y) const {
        constexpr double OF_CONTRAST = 0.1, OF_ITSELF = 0.01;
        double contrast = 0.0;
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height_ - 1); ++j) {
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width_ - 1); ++i) {
                contrast = std::max(contrast, std::abs(at(i, j) - at(x, y)));
            }
        }
        return OF_CONTRAST * contrast + OF_ITSELF * std::abs(at(x, y));
    }

private:
    [[nodiscard]] double at(int x, int y) const {
        const float *const rgba =
            picture_.data() +
            4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
        return (double{rgba[0]} + double{rgba[1]} + double{rgba[2]}) / 3.0;
    }
    std::span<const float> picture_;
    int width_, height_;
};

// Of each class a few are chosen at least. From the class EDGES on, pixels differ much from those around them.
constexpr std::size_t CLASSES = 8, LEAST = 4, EDGES = 5;

} // namespace

double brightness(std::span<const float> picture) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); i += 4) {
        sum += double{picture[i]} + double{picture[i + 1]} + double{picture[i + 2]};
    }
    return std::max(sum / (0.75 * static_cast<double>(picture.size())), 1e-30);
}

std::vector<PixelClass> measured_pixels(std::span<const float> picture, int width, int height, int count,
                                        std::uint64_t seed) {
    const double least = 0.003 * brightness(picture); // doubts twice as large are another class, and so on
    const Doubt doubt(picture, width, height);
    std::vector<std::uint8_t> classes(picture.size() / 4);
    std::vector<std::array<double, CLASSES>> rows(static_cast<std::size_t>(height)); // sums of their doubts
    oneapi::tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const double own = doubt(x, y) + 0.25 * least;
            const double octave = own < least ? 0.0 : 1.0 + std::floor(std::log2(own / least));
            const auto of = std::min(static_cast<std::size_t>(octave), CLASSES - 1);
            classes[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                static_cast<std::uint8_t>(of);
            rows[static_cast<std::size_t>(y)][of] += own;
        }
    });
    std::array<double, CLASSES> sums{};
    double sum = 0.0;
    for (const std::array<double, CLASSES> &row : rows) {
        for (std::size_t i = 0; i < CLASSES; ++i) {
            sums[i] += row[i];
            sum += row[i];
        }
    }
    std::vector<PixelClass> out(CLASSES);
    for (const std::uint8_t of : classes) {
        ++out[of].count;
    }
    std::array<std::size_t, CLASSES> chosen{};
    std::array<std::uint64_t, CLASSES> limit{}; // the lowest numbers, and some to spare
    for (std::size_t i = 0; i < CLASSES; ++i) {
        const auto share = static_cast<std::size_t>(std::ceil(count * sums[i] / sum));
        chosen[i] = std::min(std::max(share, LEAST), out[i].count);
        const double spare = (4.0 * static_cast<double>(chosen[i]) + 64.0) / static_cast<double>(out[i].count + 1);
        limit[i] = spare < 1.0 ? static_cast<std::uint64_t>(spare * 0x1p64) : ~std::uint64_t{0};
        out[i].edges = i >= EDGES;
    }
    std::array<std::vector<std::pair<std::uint64_t, std::size_t>>, CLASSES> lowest;
    for (std::size_t pixel = 0; pixel < classes.size(); ++pixel) {
        const std::uint64_t number = mixed(mixed(mixed(seed) ^ PLACES) ^ pixel);
        if (number <= limit[classes[pixel]]) {
            lowest[classes[pixel]].emplace_back(number, pixel);
        }
    }
    for (std::size_t i = 0; i < CLASSES; ++i) {
        std::sort(lowest[i].begin(), lowest[i].end());
        for (std::size_t k = 0; k < std::min(chosen[i], lowest[i].size()); ++k) {
            out[i].chosen.push_back(lowest[i][k].second);
        }
    }
    std::erase_if(out, [](const PixelClass &own) { return own.chosen.empty(); });
    return out;
}

} // namespace sfumato
