// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/basis.hpp"

#include "rays/ray_kernels.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

float number(std::size_t k) {
    return static_cast<float>(k);
}

void fourier_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    const RaysText::Harmonic first = RaysText().harmonic(1.0F, z);
    RaysText::Harmonic h = first;
    f[0] = 2.0F;
    for (std::size_t k = 1; 2 * k < f.size(); ++k) {
        const float thickness = RaysText().slab_factor(number(k), width);
        f[2 * k - 1] = RaysText().project_cosine(1.0F, h, thickness);
        f[2 * k] = RaysText().project_sine(1.0F, h, thickness);
        h = RaysText().next_harmonic(h, first);
    }
}

void fourier_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    const RaysText::Harmonic first = RaysText().harmonic(1.0F, d);
    RaysText::Harmonic h = first;
    g[0] = RaysText().integral_constant(1.0F, d);
    for (std::size_t k = 1; 2 * k < g.size(); ++k) {
        g[2 * k - 1] = RaysText().integral_harmonic(1.0F, 0.0F, h, number(k));
        g[2 * k] = RaysText().integral_harmonic(0.0F, 1.0F, h, number(k));
        h = RaysText().next_harmonic(h, first);
    }
}

void cosine_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    const RaysText::Harmonic first = RaysText().harmonic(0.5F, z);
    RaysText::Harmonic h = first;
    f[0] = 1.0F;
    for (std::size_t k = 1; k < f.size(); ++k) {
        f[k] = RaysText().project_cosine(1.0F, h, RaysText().slab_factor(0.5F * number(k), width));
        h = RaysText().next_harmonic(h, first);
    }
}

void cosine_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    const RaysText::Harmonic first = RaysText().harmonic(0.5F, d);
    RaysText::Harmonic h = first;
    g[0] = d;
    for (std::size_t k = 1; k < g.size(); ++k) {
        g[k] = RaysText().integral_half_harmonic(1.0F, h, number(k));
        h = RaysText().next_harmonic(h, first);
    }
}

void piecewise_density(float z, float width, std::span<float> f, const Tables & /*unused*/) {
    for (std::size_t k = 0; k < f.size(); ++k) {
        f[k] = RaysText().slice_share(number(k), number(f.size()), z - 0.5F * width, z + 0.5F * width);
    }
}

void piecewise_integral(float d, std::span<float> g, const Tables & /*unused*/) {
    for (std::size_t k = 0; k < g.size(); ++k) {
        g[k] = RaysText().slice_integral(number(k), number(g.size()), d);
    }
}

// The mean of the table over the slab, cell by cell.
void learned_density(float z, float width, std::span<float> f, const Tables &tables) {
    const auto cells = number(tables.cells);
    const auto first = static_cast<std::size_t>(RaysText().table_position(z - 0.5F * width, cells).cell);
    const auto last = static_cast<std::size_t>(RaysText().table_position(z + 0.5F * width, cells).cell);
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
    const RaysText::TablePosition position = RaysText().table_position(d, number(tables.cells));
    const auto cell = static_cast<std::size_t>(position.cell);
    for (std::size_t k = 0; k < g.size(); ++k) {
        const float *row = tables.g.data() + k * (tables.cells + 1) + cell;
        g[k] = row[0] + position.fraction * (row[1] - row[0]);
    }
}

RaysText::DepthRange shared(const Range &range) {
    RaysText::DepthRange out;
    out.low = range.low;
    out.high = range.high;
    return out;
}

Range ours(const RaysText::DepthRange &range) {
    return {range.low, range.high};
}

constexpr std::size_t CELLS = 128; // of the monotone evaluator's table

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

float total_of(const Series &series, std::span<const float> coefficients) {
    if (series.basis().leading) { // G_0(1) c_0
        return std::max(coefficients[0] * (series.name == FOURIER ? 0.5F : 1.0F), 0.0F);
    }
    return std::max(std::accumulate(coefficients.begin(), coefficients.end(), 0.0F), 0.0F); // slices
}

RayEvaluator::RayEvaluator(const Series &of, Evaluator how) : series(of), evaluator(how) {
    if (evaluator == Evaluator::MONOTONE) {
        std::vector<float> g(series.count);
        edges.resize(series.count * CELLS);
        for (std::size_t i = 0; i < CELLS; ++i) {
            series.basis().integral(number(i) / CELLS, g, series.tables);
            for (std::size_t k = 0; k < g.size(); ++k) {
                edges[k * CELLS + i] = g[k];
            }
        }
    }
}

void RayEvaluator::operator()(std::span<const float> coefficients, const Range &range, std::span<const float> depth,
                              std::span<float> out) const {
    if (evaluator == Evaluator::MONOTONE) {
        monotone(coefficients, range, depth, out);
        return;
    }
    const bool half = series.name == COSINE;
    if (half || series.name == FOURIER) {
        const std::array<float, 2> ends{range.low, range.high};
        const auto all = static_cast<int>(depth.size());
        ray_kernels().look_up_series({coefficients.data(), ends.data(), static_cast<int>(series.count), half,
                                      depth.data(), out.data(), all, all});
        return;
    }
    std::vector<float> g(coefficients.size());
    const float total = total_of(series, coefficients);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        series.basis().integral(RaysText().relative_depth(shared(range), depth[i]), g, series.tables);
        out[i] = RaysText().transmittance_of(std::clamp(dot(coefficients, g), 0.0F, total));
    }
}

void RayEvaluator::monotone(std::span<const float> coefficients, const Range &range, std::span<const float> depth,
                            std::span<float> out) const {
    const float total = total_of(series, coefficients);
    std::array<float, CELLS + 1> tau{}, most{}, least{};
    ray_kernels().weigh_rows({edges.data(), coefficients.data(), coefficients.size(), CELLS, tau.data()});
    for (float &value : tau) {
        value = std::clamp(value, 0.0F, total);
    }
    least.back() = total;
    for (std::size_t i = 1; i < CELLS; ++i) { // from both ends at once: neither waits for the other
        most[i] = std::max(most[i - 1], tau[i]);
        least[CELLS - i] = std::min(least[CELLS - i + 1], tau[CELLS - i]);
    }
    for (std::size_t i = 1; i < CELLS; ++i) {
        tau[i] = 0.5F * (most[i] + least[i]);
    }
    tau.front() = 0.0F; // both ends are exact
    tau.back() = total;
    const float scale = CELLS / std::max(range.high - range.low, 1e-7F); // relative_depth() and table_position() in one
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float x = std::clamp((depth[i] - range.low) * scale, 0.0F, number(CELLS));
        const std::size_t cell = std::min(static_cast<std::size_t>(x), CELLS - 1);
        out[i] = RaysText().transmittance_of(tau[cell] + (x - number(cell)) * (tau[cell + 1] - tau[cell]));
    }
}

void transmittance(const Series &series, std::span<const float> coefficients, const Range &range, Evaluator evaluator,
                   std::span<const float> depth, std::span<float> out) {
    RayEvaluator(series, evaluator)(coefficients, range, depth, out);
}

void transmittance_before(const Series &series, std::span<const float> coefficients, const Range &range,
                          const Absorbers &receivers, std::span<float> out) {
    const Basis &basis = series.basis();
    const RaysText::DepthRange depths = shared(range);
    const float width = receivers.width / std::max(range.high - range.low, 1e-7F);
    const float total = total_of(series, coefficients);
    std::vector<float> f(coefficients.size()), g(coefficients.size());
    for (std::size_t i = 0; i < receivers.depth.size(); ++i) {
        const float z = RaysText().relative_depth(depths, receivers.depth[i]);
        basis.density(z, width, f, series.tables);
        basis.integral(z, g, series.tables);
        // S(z) is the sum of F_k(z) G_k(z) in any basis; in Fourier's that is the sum of self_harmonic().
        out[i] = RaysText().transmittance_of(
            RaysText().optical_depth_of_others(dot(coefficients, g), total, receivers.tau[i], dot(f, g)));
    }
}

namespace {

RaysText::DepthRange trimmed_range(const Absorbers &absorbers, RaysText::DepthRange otherwise) {
    std::vector<std::size_t> order(absorbers.depth.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return absorbers.depth[a] < absorbers.depth[b]; });
    double total = 0.0;
    for (const float tau : absorbers.tau) {
        total += double{tau};
    }
    const auto edge = [&](auto first, auto last, double most) { // the absorber with which `most` is passed
        double sum = 0.0;
        return std::find_if(first, last, [&](std::size_t i) { return (sum += double{absorbers.tau[i]}) > most; });
    };
    const auto front = edge(order.begin(), order.end(), double{RaysText().trimmed_before(static_cast<float>(total))});
    const auto back = edge(order.rbegin(), order.rend(), double{RaysText().trimmed_behind(static_cast<float>(total))});
    if (front == order.end() || back == order.rend() || absorbers.depth[*front] > absorbers.depth[*back]) {
        return otherwise; // hardly anything at all
    }
    return RaysText().padded_range(absorbers.depth[*front] - 0.5F * absorbers.width,
                                   absorbers.depth[*back] + 0.5F * absorbers.width);
}

} // namespace

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
    const RaysText::DepthRange padded = RaysText().padded_range(nearest, furthest);
    const RaysText::DepthRange moments = RaysText().moment_range(s0, s1, s2, q);
    return storable(ours(kind == RangeKind::MINMAX    ? padded
                         : kind == RangeKind::MOMENTS ? moments
                         : kind == RangeKind::TRIMMED ? trimmed_range(absorbers, padded)
                                                      : RaysText().common_range(padded, moments)));
}

} // namespace sfumato
