// SPDX-License-Identifier: GPL-3.0-or-later
// Coefficients of a ray in a few bytes.
#include "rays/basis.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/packing.hpp>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

void put(std::span<std::uint8_t> texel, std::size_t at, unsigned value) {
    texel[at] = static_cast<std::uint8_t>(value & 255U);
    texel[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

unsigned get(std::span<const std::uint8_t> texel, std::size_t at) {
    return static_cast<unsigned>(texel[at]) | (static_cast<unsigned>(texel[at + 1]) << 8U);
}

// max |F_k|, the largest ratio of a coefficient to the total.
float bound(const Series &series, std::size_t k) {
    if (series.name != LEARNED) {
        return series.name == PIECEWISE ? 1.0F : 2.0F;
    }
    const float *row = series.tables.f.data() + k * series.tables.cells;
    float largest = 1e-20F;
    for (std::size_t cell = 0; cell < series.tables.cells; ++cell) {
        largest = std::max(largest, std::abs(row[cell]));
    }
    return largest;
}

} // namespace

Range storable(const Range &range) {
    return {RaysText().stored_depth(std::floor(RaysText().depth_code(range.low))),
            RaysText().stored_depth(std::ceil(RaysText().depth_code(range.high)))};
}

TexelHead write_head(const Range &range, float total, std::span<std::uint8_t> texel) {
    put(texel, 0, static_cast<unsigned>(std::floor(RaysText().depth_code(range.low))));
    put(texel, 2, static_cast<unsigned>(std::ceil(RaysText().depth_code(range.high))));
    put(texel, 4, glm::packHalf1x16(std::min(total, 65504.0F)));
    return read_head(texel);
}

TexelHead read_head(std::span<const std::uint8_t> texel) {
    const auto depth = [&](std::size_t at) { return RaysText().stored_depth(static_cast<float>(get(texel, at))); };
    return {{depth(0), depth(2)}, glm::unpackHalf1x16(static_cast<std::uint16_t>(get(texel, 4)))};
}

std::size_t texel_bytes(const Series &series) {
    return HEAD_BYTES + series.count - (series.basis().leading ? 1 : 0);
}

std::size_t coefficients_in(BasisName name, std::size_t bytes) {
    const std::size_t count = bytes - HEAD_BYTES + (BASES[name].leading ? 1 : 0);
    return BASES[name].odd && count % 2 == 0 ? count - 1 : count;
}

void pack(const Series &series, std::span<const float> coefficients, const Range &range,
          std::span<std::uint8_t> texel) {
    const float total = write_head(range, total_of(series, coefficients), texel).total;
    std::size_t at = HEAD_BYTES;
    for (std::size_t k = series.basis().leading ? 1 : 0; k < series.count; ++k) {
        const float ratio = coefficients[k] / std::max(total * bound(series, k), 1e-30F);
        texel[at++] = static_cast<std::uint8_t>(RaysText().eight_bit_level(ratio));
    }
}

Range unpack(const Series &series, std::span<const std::uint8_t> texel, std::span<float> coefficients) {
    const TexelHead head = read_head(texel);
    std::size_t at = HEAD_BYTES;
    for (std::size_t k = 0; k < series.count; ++k) {
        coefficients[k] = k == 0 && series.basis().leading
                              ? head.total * (series.name == FOURIER ? 2.0F : 1.0F)
                              : head.total * bound(series, k) * RaysText().eight_bit_ratio(texel[at++]);
    }
    // Rounded slices need not add up to the total.
    const float sum = total_of(series, coefficients);
    if (!series.basis().leading && sum > 0.0F) {
        for (float &c : coefficients) {
            c *= head.total / sum;
        }
    }
    return head.range;
}

} // namespace sfumato
