// SPDX-License-Identifier: GPL-3.0-or-later
#include "basis.hpp"

#include "glsl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfumato {
namespace {

float number(std::size_t k) {
    return static_cast<float>(k);
}

void fourier_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    const glsl::Harmonic first = glsl::harmonic(1.0F, z);
    glsl::Harmonic h = first;
    f[0] = 2.0F;
    for (std::size_t k = 1; 2 * k < f.size(); ++k) {
        const float thickness = glsl::slab_factor(number(k), width);
        f[2 * k - 1] = glsl::project_cosine(1.0F, h, thickness);
        f[2 * k] = glsl::project_sine(1.0F, h, thickness);
        h = glsl::next_harmonic(h, first);
    }
}

void fourier_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    const glsl::Harmonic first = glsl::harmonic(1.0F, d);
    glsl::Harmonic h = first;
    g[0] = glsl::integral_constant(1.0F, d);
    for (std::size_t k = 1; 2 * k < g.size(); ++k) {
        g[2 * k - 1] = glsl::integral_harmonic(1.0F, 0.0F, h, number(k));
        g[2 * k] = glsl::integral_harmonic(0.0F, 1.0F, h, number(k));
        h = glsl::next_harmonic(h, first);
    }
}

void cosine_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    const glsl::Harmonic first = glsl::harmonic(0.5F, z);
    glsl::Harmonic h = first;
    f[0] = 1.0F;
    for (std::size_t k = 1; k < f.size(); ++k) {
        f[k] = glsl::project_cosine(1.0F, h, glsl::slab_factor(0.5F * number(k), width));
        h = glsl::next_harmonic(h, first);
    }
}

void cosine_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    const glsl::Harmonic first = glsl::harmonic(0.5F, d);
    glsl::Harmonic h = first;
    g[0] = d;
    for (std::size_t k = 1; k < g.size(); ++k) {
        g[k] = glsl::integral_half_harmonic(1.0F, h, number(k));
        h = glsl::next_harmonic(h, first);
    }
}

void piecewise_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    for (std::size_t k = 0; k < f.size(); ++k) {
        f[k] = glsl::slice_share(number(k), number(f.size()), z - 0.5F * width, z + 0.5F * width);
    }
}

void piecewise_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    for (std::size_t k = 0; k < g.size(); ++k) {
        g[k] = glsl::slice_integral(number(k), number(g.size()), d);
    }
}

// The mean of the table over the slab, cell by cell.
void learned_density(float z, float width, std::span<float> f, const Tables &tables) {
    const auto cells = number(tables.cells);
    const auto first = static_cast<std::size_t>(glsl::table_position(z - 0.5F * width, cells).cell);
    const auto last = static_cast<std::size_t>(glsl::table_position(z + 0.5F * width, cells).cell);
    std::fill(f.begin(), f.end(), 0.0F);
    float total = 0.0F;
    for (std::size_t cell = first; cell <= last; ++cell) {
        const float front = std::max(number(cell) / cells, z - 0.5F * width);
        const float back = std::min(number(cell + 1) / cells, z + 0.5F * width);
        const float share = first == last ? 1.0F : std::max(back - front, 0.0F);
        total += share;
        for (std::size_t k = 0; k < f.size(); ++k) {
            f[k] += share * tables.f[k * tables.cells + cell];
        }
    }
    for (float &value : f) {
        value /= total;
    }
}

void learned_integral(float d, std::span<float> g, const Tables &tables) {
    const glsl::TablePosition position = glsl::table_position(d, number(tables.cells));
    const auto cell = static_cast<std::size_t>(position.cell);
    for (std::size_t k = 0; k < g.size(); ++k) {
        const float *row = tables.g.data() + k * (tables.cells + 1) + cell;
        g[k] = row[0] + position.fraction * (row[1] - row[0]);
    }
}

glsl::DepthRange shared(const Range &range) {
    glsl::DepthRange out;
    out.low = range.low;
    out.high = range.high;
    return out;
}

Range ours(const glsl::DepthRange &range) {
    return {range.low, range.high};
}

float dot(std::span<const float> a, std::span<const float> b) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < a.size(); ++k) {
        sum += a[k] * b[k];
    }
    return sum;
}

} // namespace

const std::array<Basis, 4> BASES = {{
    {"fourier", true, true, fourier_density, fourier_integral},
    {"cosine", false, true, cosine_density, cosine_integral},
    {"piecewise", false, false, piecewise_density, piecewise_integral},
    {"learned", false, true, learned_density, learned_integral},
}};

void project(const Series &series, const Absorbers &absorbers, const Range &range, std::span<float> coefficients) {
    const Basis &basis = series.basis();
    const glsl::DepthRange depths = shared(range);
    const float width = absorbers.width / std::max(range.high - range.low, 1e-7F);
    std::vector<float> f(coefficients.size());
    for (std::size_t i = 0; i < absorbers.depth.size(); ++i) {
        basis.density(glsl::relative_depth(depths, absorbers.depth[i]), width, f, series.tables);
        for (std::size_t k = 0; k < f.size(); ++k) {
            coefficients[k] += absorbers.tau[i] * f[k];
        }
    }
}

float total_of(const Series &series, std::span<const float> coefficients) {
    std::vector<float> g(coefficients.size());
    series.basis().integral(1.0F, g, series.tables);
    const std::size_t carriers = series.basis().leading ? 1 : g.size();
    return std::max(dot(coefficients.first(carriers), std::span(g).first(carriers)), 0.0F);
}

void transmittance(const Series &series, std::span<const float> coefficients, const Range &range, Evaluator evaluator,
                   std::span<const float> depth, std::span<float> out) {
    constexpr std::size_t CELLS = 128;
    std::vector<float> g(coefficients.size());
    const auto integral = [&](float d) {
        series.basis().integral(d, g, series.tables);
        return dot(coefficients, g);
    };
    const float total = total_of(series, coefficients);
    std::array<float, CELLS + 1> table{};
    if (evaluator == Evaluator::MONOTONE) {
        for (std::size_t i = 1; i <= CELLS; ++i) {
            table[i] = std::max(table[i - 1], std::clamp(integral(number(i) / CELLS), 0.0F, total));
        }
        // The running minimum of the values themselves, from behind, where the total is exact.
        float least = total;
        table[CELLS] = total;
        for (std::size_t i = CELLS - 1; i > 0; --i) {
            least = std::min(least, std::clamp(integral(number(i) / CELLS), 0.0F, total));
            table[i] = 0.5F * (table[i] + least);
        }
    }
    const glsl::DepthRange depths = shared(range);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float d = glsl::relative_depth(depths, depth[i]);
        float tau = 0.0F;
        if (evaluator == Evaluator::MONOTONE) {
            const glsl::TablePosition at = glsl::table_position(d, CELLS);
            const auto cell = static_cast<std::size_t>(at.cell);
            tau = table[cell] + at.fraction * (table[cell + 1] - table[cell]);
        } else {
            tau = std::clamp(integral(d), 0.0F, total);
        }
        out[i] = glsl::transmittance_of(tau);
    }
}

void transmittance_before(const Series &series, std::span<const float> coefficients, const Range &range,
                          const Absorbers &receivers, std::span<float> out) {
    const Basis &basis = series.basis();
    const glsl::DepthRange depths = shared(range);
    const float width = receivers.width / std::max(range.high - range.low, 1e-7F);
    const float total = total_of(series, coefficients);
    std::vector<float> f(coefficients.size()), g(coefficients.size());
    for (std::size_t i = 0; i < receivers.depth.size(); ++i) {
        const float z = glsl::relative_depth(depths, receivers.depth[i]);
        basis.density(z, width, f, series.tables);
        basis.integral(z, g, series.tables);
        // S(z) is the sum of F_k(z) G_k(z) in any basis; in Fourier's that is the sum of self_harmonic().
        out[i] = glsl::transmittance_of(
            glsl::optical_depth_of_others(dot(coefficients, g), total, receivers.tau[i], dot(f, g)));
    }
}

Range depth_range(const Absorbers &absorbers, RangeKind kind, float q) {
    float nearest = std::numeric_limits<float>::max(), furthest = -1.0F;
    float s0 = 0.0F, s1 = 0.0F, s2 = 0.0F;
    for (std::size_t i = 0; i < absorbers.depth.size(); ++i) {
        const float z = absorbers.depth[i], tau = absorbers.tau[i];
        if (tau > 0.0F) {
            nearest = std::min(nearest, z - 0.5F * absorbers.width);
            furthest = std::max(furthest, z + 0.5F * absorbers.width);
        }
        s0 += tau;
        s1 += tau * z;
        s2 += tau * (z * z + absorbers.width * absorbers.width / 12.0F);
    }
    if (kind == RangeKind::WHOLE || furthest < nearest) { // nothing to hold: any range does
        return {};
    }
    const glsl::DepthRange padded = glsl::padded_range(nearest, furthest);
    const glsl::DepthRange moments = glsl::moment_range(s0, s1, s2, q);
    return storable(ours(kind == RangeKind::MINMAX    ? padded
                         : kind == RangeKind::MOMENTS ? moments
                                                      : glsl::common_range(padded, moments)));
}

} // namespace sfumato
