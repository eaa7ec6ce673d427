// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/learned_basis.hpp"

#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

using Matrix = std::vector<double>; // square, row after row

// Optical depth down to each of the depths 1/cells, 2/cells, ..., 1 of the range.
std::vector<double> cumulative(const Absorbers &ray, const Range &range, std::size_t cells) {
    std::vector<double> curve(cells, 0.0);
    RaysText::DepthRange depths;
    depths.low = range.low;
    depths.high = range.high;
    for (std::size_t i = 0; i < ray.depth.size(); ++i) {
        const float z = RaysText().relative_depth(depths, ray.depth[i]);
        curve[static_cast<std::size_t>(RaysText().table_position(z, static_cast<float>(cells)).cell)] += ray.tau[i];
    }
    std::partial_sum(curve.begin(), curve.end(), curve.begin());
    return curve;
}

// Eigenvectors of a symmetric matrix as the columns of the result: Jacobi's rotations, sweep by sweep (Golub and
// Van Loan, Matrix Computations, section 8.5). The matrix ends up diagonal.
Matrix eigenvectors(Matrix &a, std::size_t n) {
    Matrix v(n * n, 0.0);
    double norm = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        v[i * n + i] = 1.0;
        norm += a[i * n + i];
    }
    for (int sweep = 0; sweep < 30; ++sweep) {
        double off = 0.0;
        for (std::size_t p = 0; p < n; ++p) {
            for (std::size_t q = p + 1; q < n; ++q) {
                const double apq = a[p * n + q];
                off = std::max(off, std::abs(apq));
                if (std::abs(apq) <= 1e-15 * norm) {
                    continue;
                }
                const double theta = 0.5 * (a[q * n + q] - a[p * n + p]) / apq;
                const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
                const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
                for (std::size_t k = 0; k < n; ++k) {
                    const double akp = a[k * n + p], akq = a[k * n + q];
                    a[k * n + p] = c * akp - s * akq;
                    a[k * n + q] = s * akp + c * akq;
                }
                for (std::size_t k = 0; k < n; ++k) {
                    const double apk = a[p * n + k], aqk = a[q * n + k];
                    a[p * n + k] = c * apk - s * aqk;
                    a[q * n + k] = s * apk + c * aqk;
                    const double vkp = v[k * n + p], vkq = v[k * n + q];
                    v[k * n + p] = c * vkp - s * vkq;
                    v[k * n + q] = s * vkp + c * vkq;
                }
            }
        }
        if (off <= 1e-14 * norm) {
            break;
        }
    }
    return v;
}

} // namespace

Series learn_basis(std::span<const Absorbers> rays, std::span<const Range> ranges, std::size_t count,
                   std::size_t cells) {
    std::vector<std::vector<double>> curves;
    std::vector<double> mean(cells, 0.0);
    for (std::size_t r = 0; r < rays.size(); ++r) {
        curves.push_back(cumulative(rays[r], ranges[r], cells));
        for (std::size_t m = 0; m < cells; ++m) {
            mean[m] += curves[r][m];
        }
    }
    const double all = mean.back();
    for (std::size_t m = 0; m < cells; ++m) { // without smoke: even absorption
        mean[m] = all > 0.0 ? mean[m] / all : static_cast<double>(m + 1) / static_cast<double>(cells);
    }
    Matrix covariance(cells * cells, 0.0);
    for (const std::vector<double> &curve : curves) {
        for (std::size_t i = 0; i < cells; ++i) {
            const double ri = curve[i] - curve.back() * mean[i];
            for (std::size_t j = 0; j < cells; ++j) {
                covariance[i * cells + j] += ri * (curve[j] - curve.back() * mean[j]);
            }
        }
    }
    const Matrix vectors = eigenvectors(covariance, cells);
    std::vector<std::size_t> order(cells);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return covariance[a * cells + a] > covariance[b * cells + b];
    });

    Series series{LEARNED, count, {cells, {}, {}}};
    Tables &tables = series.tables;
    tables.f.assign(count * cells, 0.0F);
    tables.g.assign(count * (cells + 1), 0.0F);
    const double noise = 1e-12 * std::max(covariance[order[0] * cells + order[0]], 1e-30);
    for (std::size_t k = 0; k < count; ++k) {
        std::vector<double> g = mean;
        if (k > 0) {
            const std::size_t column = k - 1 < cells ? order[k - 1] : 0;
            if (k - 1 >= cells || covariance[column * cells + column] <= noise) {
                continue; // fewer rays than functions: the rest stays zero
            }
            for (std::size_t m = 0; m < cells; ++m) {
                g[m] = vectors[m * cells + column];
            }
            g.back() = 0.0; // but for rounding it is
            const auto largest =
                std::max_element(g.begin(), g.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
            if (*largest < 0.0) { // an eigenvector has no sign of its own
                std::transform(g.begin(), g.end(), g.begin(), [](double x) { return -x; });
            }
        }
        // The projection of a ray's cumulative curve, less its mean shape, as a sum over its absorbers.
        double tail = k == 0 ? 0.0 : -std::inner_product(g.begin(), g.end(), mean.begin(), 0.0);
        for (std::size_t m = cells; m-- > 0;) {
            tail += k == 0 ? 0.0 : g[m];
            tables.f[k * cells + m] = k == 0 ? 1.0F : static_cast<float>(tail);
            tables.g[k * (cells + 1) + m + 1] = static_cast<float>(g[m]);
        }
    }
    return series;
}

} // namespace sfumato
