// SPDX-License-Identifier: GPL-3.0-or-later
// The sums over a ray's absorbers, basis by basis, as fast as each allows. Basis::density says what they are sums of.
#include "rays/basis.hpp"
#include "rays/ray_kernels.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

// Absorbers in lanes. The width of all is the same, so that each harmonic is damped once for the ray.
void project_harmonics(const Absorbers &absorbers, const Range &range, float width, bool half,
                       std::span<float> coefficients) {
    const std::size_t harmonics = half ? coefficients.size() - 1 : coefficients.size() / 2;
    const std::size_t count = half ? harmonics + 1 : 2 * harmonics + 1;
    std::array<float, 64> few{};
    std::vector<float> many(count > few.size() ? count : 0);
    const std::span<float> sums = many.empty() ? std::span<float>(few).first(count) : std::span<float>(many);
    const float frequency = half ? 0.5F : 1.0F;
    ray_kernels().harmonic_sums({absorbers.depth.data(), absorbers.tau.data(), absorbers.depth.size(), range.low,
                                 range.high, half, harmonics, sums.data()});
    coefficients[0] += half ? sums[0] : 2.0F * sums[0];
    for (std::size_t k = 1; k <= harmonics; ++k) {
        const float thickness = width > 0.0F ? RaysText().slab_factor(frequency * static_cast<float>(k), width) : 1.0F;
        RaysText::Harmonic sum;
        if (half) {
            sum.cosine = sums[k];
            coefficients[k] += RaysText().project_cosine(1.0F, sum, thickness);
        } else {
            sum.cosine = sums[2 * k - 1];
            sum.sine = sums[2 * k];
            coefficients[2 * k - 1] += RaysText().project_cosine(1.0F, sum, thickness);
            coefficients[2 * k] += RaysText().project_sine(1.0F, sum, thickness);
        }
    }
}

// Only the slices that an absorber touches, in units of slices; floor() by conversion. slice_share() says the same.
void project_slices(const Absorbers &absorbers, const Range &range, float width, std::span<float> coefficients) {
    const auto n = static_cast<float>(coefficients.size());
    const float scale = n / std::max(range.high - range.low, 1e-7F), reach = 0.5F * n * width;
    const bool flat = reach < 5e-4F;
    const float share = flat ? 1.0F : 0.5F / reach;
    const auto slice = [n](float x) { return static_cast<std::size_t>(std::min(x, n - 0.5F)); };
    const auto spread = [&](float near, float far, float density) {
        for (std::size_t k = slice(near), last = slice(far); k <= last; ++k) {
            const auto front = static_cast<float>(k);
            coefficients[k] += density * (std::min(far, front + 1.0F) - std::max(near, front));
        }
    };
    for (std::size_t i = 0; flat && i < absorbers.depth.size(); ++i) {
        coefficients[slice(std::max((absorbers.depth[i] - range.low) * scale, 0.0F))] += absorbers.tau[i];
    }
    for (std::size_t i = 0; !flat && i < absorbers.depth.size(); ++i) {
        const float x = std::clamp((absorbers.depth[i] - range.low) * scale, 0.0F, n), tau = absorbers.tau[i];
        if (x >= reach && x <= n - reach) {
            spread(x - reach, x + reach, tau * share);
        } else { // what is outside lies at the ends
            const float near = std::max(x - reach, 0.0F), far = std::min(x + reach, n);
            spread(near, far, tau / (far - near));
        }
    }
}

// Each F_k steps from cell to cell, so what counts is how much lies in each cell. Sums in parts, which need not wait
// for each other.
void project_tables(const Tables &tables, const Absorbers &absorbers, const Range &range, float width,
                    std::span<float> coefficients) {
    constexpr std::size_t PARTS = 16;
    std::vector<float> cells(tables.cells, 0.0F);
    project_slices(absorbers, range, width, cells);
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        const float *const f = tables.f.data() + k * tables.cells;
        std::array<float, PARTS> sums{};
        for (std::size_t cell = 0; cell + PARTS <= tables.cells; cell += PARTS) {
            for (std::size_t part = 0; part < PARTS; ++part) {
                sums[part] += f[cell + part] * cells[cell + part];
            }
        }
        for (std::size_t cell = tables.cells / PARTS * PARTS; cell < tables.cells; ++cell) {
            sums[cell % PARTS] += f[cell] * cells[cell];
        }
        coefficients[k] += std::accumulate(sums.begin(), sums.end(), 0.0F);
    }
}

} // namespace

void project(const Series &series, const Absorbers &absorbers, const Range &range, std::span<float> coefficients) {
    const float width = absorbers.width / std::max(range.high - range.low, 1e-7F);
    switch (series.name) {
    case FOURIER:
    case COSINE:
        project_harmonics(absorbers, range, width, series.name == COSINE, coefficients);
        break;
    case PIECEWISE:
        project_slices(absorbers, range, width, coefficients);
        break;
    case LEARNED:
        project_tables(series.tables, absorbers, range, width, coefficients);
        break;
    }
}

} // namespace sfumato
