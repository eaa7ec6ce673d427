// SPDX-License-Identifier: GPL-3.0-or-later
#include "textures/image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

namespace sfumato {
namespace {

using Texel = std::array<float, 4>;
using Row = std::vector<Texel>;

double decoded(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

// sRGB's curve from bytes, between them, and back to the byte that is nearest as it is written.
class Curve {
public:
    Curve() {
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            ends_[i] = static_cast<float>(decoded((static_cast<double>(i) + 0.5) / 255.0));
        }
        ends_.back() = 2.0F;
        for (std::size_t i = 0; i < fine_.size(); ++i) {
            fine_[i] = static_cast<float>(decoded(static_cast<double>(i) / FINE));
        }
        std::uint8_t byte = 0;
        for (std::size_t i = 0; i < first_.size(); ++i) {
            while (static_cast<double>(ends_[byte]) < static_cast<double>(i) / STEPS) {
                ++byte;
            }
            first_[i] = byte;
        }
    }

    [[nodiscard]] float between(float encoded) const {
        if (encoded > 1.0F) {
            return std::pow((encoded + 0.055F) * (1.0F / 1.055F), 2.4F);
        }
        const float x = std::max(encoded, 0.0F) * FINE;
        const auto at = std::min(static_cast<std::size_t>(x), fine_.size() - 2);
        return fine_[at] + (fine_[at + 1] - fine_[at]) * (x - static_cast<float>(at));
    }

    [[nodiscard]] std::uint8_t to_byte(float linear) const {
        const float within = std::clamp(linear, 0.0F, 1.0F);
        std::uint8_t byte = first_[static_cast<std::size_t>(within * STEPS)];
        while (within > ends_[byte]) {
            ++byte;
        }
        return byte;
    }

private:
    static constexpr int FINE = 4096, STEPS = 4096;
    std::array<float, 256> ends_{}; // ends_: beyond which the next byte is nearer
    std::array<float, FINE + 1> fine_{};
    std::array<std::uint8_t, STEPS + 1> first_{};
};

const Curve &curve() {
    static const Curve the_curve;
    return the_curve;
}

// Of a texel as it is written: linear, and multiplied by alpha where that counts.
Texel light_of(const Texel &written, const ImageMeaning &meaning, const Curve &curve) {
    if (!meaning.curved) {
        return written;
    }
    const float alpha = written[3];
    if (!meaning.divided || alpha == 1.0F || !(alpha > 0.0F)) {
        return {curve.between(written[0]), curve.between(written[1]), curve.between(written[2]), alpha};
    }
    const float by = 1.0F / alpha;
    return {alpha * curve.between(written[0] * by), alpha * curve.between(written[1] * by),
            alpha * curve.between(written[2] * by), alpha};
}

std::uint8_t byte_of(float x) {
    return static_cast<std::uint8_t>(std::clamp(x, 0.0F, 1.0F) * 255.0F + 0.5F);
}

void add(Row &sum, const Row &row, float weight) {
    float *out = sum.front().data();
    const float *from = row.front().data();
    for (std::size_t i = 0; i < 4 * sum.size(); ++i) {
        out[i] += from[i] * weight;
    }
}

// Means of a row in half as many columns: of texels that lie across an edge, by the parts on either side.
void halve(const Row &row, Row &out) {
    if (row.size() == 2 * out.size()) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            for (std::size_t channel = 0; channel < 4; ++channel) {
                out[i][channel] = 0.5F * (row[2 * i][channel] + row[2 * i + 1][channel]);
            }
        }
        return;
    }
    const double ratio = static_cast<double>(row.size()) / static_cast<double>(out.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double begin = ratio * static_cast<double>(i),
                     end = std::min(begin + ratio, static_cast<double>(row.size()));
        Texel sum{};
        for (auto j = static_cast<std::size_t>(begin); static_cast<double>(j) < end; ++j) {
            const double part = std::min(end, static_cast<double>(j + 1)) - std::max(begin, static_cast<double>(j));
            for (std::size_t channel = 0; channel < 4; ++channel) {
                sum[channel] += static_cast<float>(part / ratio) * row[j][channel];
            }
        }
        out[i] = sum;
    }
}

// Takes the rows of the level before, one after another, and makes its own of them; so a pyramid needs but a few rows
// at a time in floats.
struct Halving {
    Halving(int from, int columns_from, int rows, int columns)
        : ratio(static_cast<double>(from) / rows), narrow(static_cast<std::size_t>(columns)),
          sum(static_cast<std::size_t>(columns)), same_width(columns == columns_from) {}

    // Calls done(row, number) for each row that is complete.
    template <typename Done>
    void take(const Row &row, const Done &done) {
        if (!same_width) {
            halve(row, narrow);
        }
        const Row &narrowed = same_width ? row : narrow;
        const double begin = taken++, end = ratio * (made + 1);
        const double part = std::min(begin + 1.0, end) - begin;
        add(sum, narrowed, static_cast<float>(part / ratio));
        if (begin + 1.0 > end - 1e-6) {
            done(sum, made++);
            std::ranges::fill(sum, Texel{});
            if (part < 1.0 - 1e-6) {
                add(sum, narrowed, static_cast<float>((1.0 - part) / ratio));
            }
        }
    }

    double ratio;
    Row narrow, sum;
    bool same_width;
    int taken = 0, made = 0;
};

} // namespace

void SurfaceImage::lay_out(int width, int height, ImageMeaning meaning) {
    width_ = width;
    height_ = height;
    meaning_ = meaning;
    starts_.assign(3 * static_cast<std::size_t>(LEVELS), 0);
    std::int32_t start = 0;
    for (;;) {
        const auto level = static_cast<std::size_t>(levels_++);
        starts_[level] = start;
        starts_[level + LEVELS] = width;
        starts_[level + 2 * static_cast<std::size_t>(LEVELS)] = height;
        start += width * height;
        if (width == 1 && height == 1) {
            break;
        }
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    starts_[static_cast<std::size_t>(levels_)] = start; // the end; there are never LEVELS of them
}

// written(y, row): a row of the picture as it is written. store(at, row): keeps a row of another level, from its first
// texel's number on: linear, and multiplied by alpha where that counts.
template <typename Written, typename Store>
void SurfaceImage::make_levels(const Written &written, const Store &store) const {
    if (levels_ == 1) {
        return;
    }
    const auto columns = [this](int level) { return starts_[static_cast<std::size_t>(level + LEVELS)]; };
    const auto rows = [this](int level) { return starts_[static_cast<std::size_t>(level + 2 * LEVELS)]; };
    std::vector<Halving> halvings;
    for (int level = 1; level < levels_; ++level) {
        halvings.emplace_back(rows(level - 1), columns(level - 1), rows(level), columns(level));
    }
    const auto take = [&](const auto &self, int level, const Row &row) -> void {
        if (level == levels_) {
            return;
        }
        halvings[static_cast<std::size_t>(level - 1)].take(row, [&](const Row &made, int number) {
            store(static_cast<std::size_t>(starts_[static_cast<std::size_t>(level)]) +
                      static_cast<std::size_t>(number) * made.size(),
                  made);
            self(self, level + 1, made);
        });
    };
    const auto width = static_cast<std::size_t>(width_);
    const Curve &curved = curve();
    if (!meaning_.curved || meaning_.closest) {
        Row row(width);
        for (int y = 0; y < height_; ++y) {
            written(static_cast<std::size_t>(y) * width, row);
            for (Texel &texel : row) {
                texel = light_of(texel, meaning_, curved);
            }
            take(take, 1, row);
        }
        return;
    }
    // Mixed as they are written, four texels show less between them than the mean of their light. Each of them loses a
    // share of that. Over the square between them the mean of a curve of what is bilinear is about a third of the
    // corners' and two thirds of the middle's.
    struct Line {
        Row written, light;
    };
    const auto read = [&](int y, Line &line) {
        line.written.resize(width);
        line.light.resize(width);
        written(static_cast<std::size_t>(y) * width, line.written);
        for (std::size_t x = 0; x < width; ++x) {
            line.light[x] = light_of(line.written[x], meaning_, curved);
        }
    };
    // What is lost above a line, from each texel to the next.
    const auto lose = [&](const Line &below, const Line &above, Row &lost) {
        lost.resize(width);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t next = x + 1 < width ? x + 1 : 0;
            Texel middle{}, mean{};
            for (std::size_t channel = 0; channel < 4; ++channel) {
                middle[channel] = 0.25F * (below.written[x][channel] + below.written[next][channel] +
                                           above.written[x][channel] + above.written[next][channel]);
                mean[channel] = 0.25F * (below.light[x][channel] + below.light[next][channel] +
                                         above.light[x][channel] + above.light[next][channel]);
            }
            middle = light_of(middle, meaning_, curved);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                lost[x][channel] = (2.0F / 3.0F) * (mean[channel] - middle[channel]);
            }
        }
    };
    Line first, here, above;
    Row lost_below, lost_above, row(width);
    read(height_ - 1, above);
    read(0, here);
    first = here;
    lose(above, here, lost_below);
    for (int y = 0; y < height_; ++y) {
        if (y + 1 < height_) {
            read(y + 1, above);
        } else {
            above = first;
        }
        lose(here, above, lost_above);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t before = x > 0 ? x - 1 : width - 1;
            for (std::size_t channel = 0; channel < 4; ++channel) {
                row[x][channel] =
                    here.light[x][channel] - 0.25F * (lost_below[x][channel] + lost_below[before][channel] +
                                                      lost_above[x][channel] + lost_above[before][channel]);
            }
        }
        take(take, 1, row);
        std::swap(here, above);
        std::swap(lost_below, lost_above);
    }
}

SurfaceImage::SurfaceImage(int width, int height, std::span<const std::uint8_t> texels, ImageMeaning meaning) {
    lay_out(width, height, meaning);
    bytes_.resize(static_cast<std::size_t>(starts_[static_cast<std::size_t>(levels_)]));
    // Each texel's four bytes become one integer, the first the lowest.
    for (std::size_t i = 0; i < texels.size() / 4; ++i) {
        const std::uint8_t *four = &texels[4 * i];
        bytes_[i] = static_cast<std::int32_t>(four[0] | (four[1] << 8U) | (four[2] << 16U) |
                                              (static_cast<std::uint32_t>(four[3]) << 24U));
    }
    const auto written = [&](std::size_t at, Row &row) {
        const std::uint8_t *from = &texels[4 * at];
        float *to = row.front().data();
        for (std::size_t i = 0; i < 4 * row.size(); ++i) {
            to[i] = static_cast<float>(from[i]) * (1.0F / 255.0F);
        }
    };
    const Curve &curved = curve();
    make_levels(written, [&](std::size_t at, const Row &row) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            const float alpha = row[i][3], by = meaning.divided && alpha > 0.0F ? 1.0F / alpha : 1.0F;
            std::uint32_t four = static_cast<std::uint32_t>(byte_of(alpha)) << 24U;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const float colour = row[i][channel] * by;
                const std::uint32_t byte = meaning.curved ? curved.to_byte(colour) : byte_of(colour);
                four |= byte << (8U * channel);
            }
            bytes_[at + i] = static_cast<std::int32_t>(four);
        }
    });
}

SurfaceImage::SurfaceImage(int width, int height, std::span<const float> texels, ImageMeaning meaning) {
    lay_out(width, height, meaning);
    floats_.resize(4 * static_cast<std::size_t>(starts_[static_cast<std::size_t>(levels_)]));
    std::ranges::copy(texels, floats_.begin());
    const auto written = [&](std::size_t at, Row &row) {
        std::memcpy(row.data(), &texels[4 * at], sizeof(Texel) * row.size());
    };
    make_levels(written, [this](std::size_t at, const Row &row) {
        std::memcpy(&floats_[4 * at], row.data(), sizeof(Texel) * row.size());
    });
}

ImageView SurfaceImage::view() const {
    ImageView out;
    out.bytes = bytes_.empty() ? nullptr : bytes_.data();
    out.floats = floats_.empty() ? nullptr : floats_.data();
    out.starts = starts_.data();
    out.width = width_;
    out.height = height_;
    out.levels = levels_;
    out.meaning = meaning_;
    return out;
}

} // namespace sfumato
