// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of a curve's knots.
#include "rays/curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace sfumato {
namespace {

// Integrals of a polygon f(z), and of its products with z and itself, from its first vertex.
class Polygon {
public:
    explicit Polygon(std::vector<CurveVertex> given) : vertices(std::move(given)), sums(vertices.size()) {
        for (std::size_t i = 1; i < vertices.size(); ++i) {
            const auto [z0, a] = vertices[i - 1];
            const auto [z1, b] = vertices[i];
            const double h = z1 - z0;
            sums[i] = {sums[i - 1].f + 0.5 * h * (a + b),
                       sums[i - 1].fz + h * (a * (2.0 * z0 + z1) + b * (z0 + 2.0 * z1)) / 6.0,
                       sums[i - 1].ff + h * (a * a + a * b + b * b) / 3.0};
        }
    }

    // The squared distance between the polygon and its chord from vertex i to vertex k, integrated.
    [[nodiscard]] double chord_error(std::size_t i, std::size_t k) const {
        const auto [z0, a] = vertices[i];
        const auto [z1, b] = vertices[k];
        const double h = z1 - z0;
        if (!(h > 0.0)) {
            return 0.0; // a step differs from another nowhere but at its depth
        }
        const double ff = sums[k].ff - sums[i].ff, f = sums[k].f - sums[i].f, fz = sums[k].fz - sums[i].fz;
        const double products = (a * (z1 * f - fz) + b * (fz - z0 * f)) / h; // of f and the chord
        return std::max(ff - 2.0 * products + h * (a * a + a * b + b * b) / 3.0, 0.0);
    }

    // The integrals of f and f z up to any depth.
    [[nodiscard]] std::pair<double, double> up_to(double z) const {
        const auto after = std::upper_bound(vertices.begin(), vertices.end(), z,
                                            [](double depth, const CurveVertex &v) { return depth < v.z; });
        if (after == vertices.begin()) {
            return {0.0, 0.0};
        }
        const auto i = static_cast<std::size_t>(after - vertices.begin()) - 1;
        if (after == vertices.end()) {
            return {sums[i].f, sums[i].fz};
        }
        const auto [z0, a] = vertices[i];
        const double h = z - z0, b = a + (after->t - a) * h / (after->z - z0);
        return {sums[i].f + 0.5 * h * (a + b), sums[i].fz + h * (a * (2.0 * z0 + z) + b * (z0 + 2.0 * z)) / 6.0};
    }

    std::vector<CurveVertex> vertices;

private:
    struct Sums {
        double f = 0.0, fz = 0.0, ff = 0.0;
    };
    std::vector<Sums> sums;
};

// A first pass, front to back, drops vertices that lie on a line with their neighbours: most of those of smooth smoke,
// at a fraction of the price of what follows. A root mean square of 2e-4 decides, and more where much is left.
Polygon without_needless(const Polygon &polygon) {
    constexpr std::size_t MANY = 192;
    std::vector<CurveVertex> left;
    for (double needless = 3e-8; left.empty() || left.size() > MANY; needless *= 4.0) {
        left.assign(1, polygon.vertices.front());
        std::size_t last = 0;
        for (std::size_t i = 1; i < polygon.vertices.size(); ++i) {
            if (i + 1 == polygon.vertices.size() || polygon.chord_error(last, i + 1) > needless) {
                left.push_back(polygon.vertices[i]);
                last = i;
            }
        }
    }
    return Polygon(std::move(left));
}

// Visvalingam and Whyatt's way to simplify a line (1993), with the mean square error in the place of the area.
// Returns the indices of what is left, ends included. A search through all costs beats a heap at these sizes.
std::vector<std::size_t> simplify(const Polygon &polygon, std::size_t keep) {
    std::vector<std::size_t> left(polygon.vertices.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    std::vector<double> error(left.size(), 0.0); // of the chord from each to the next; neighbours have none
    std::vector<double> cost(left.size(), std::numeric_limits<double>::infinity()); // of taking each away
    const auto price = [&](std::size_t j) {
        if (j > 0 && j + 1 < left.size()) {
            cost[j] = polygon.chord_error(left[j - 1], left[j + 1]) - error[j - 1] - error[j];
        }
    };
    for (std::size_t j = 0; j < left.size(); ++j) {
        price(j);
    }
    while (left.size() > keep) {
        const auto at = std::min_element(cost.begin(), cost.end()) - cost.begin();
        left.erase(left.begin() + at);
        cost.erase(cost.begin() + at);
        error.erase(error.begin() + at);
        const auto j = static_cast<std::size_t>(at);
        error[j - 1] = polygon.chord_error(left[j - 1], left[j]);
        price(j - 1);
        price(j);
    }
    return left;
}

// Taking away one at a time ends in a good choice, not in the best. Each vertex in turn moves to wherever between its
// neighbours the error is least: a third less error in smooth smoke after three rounds, and hardly any in later ones.
void settle(const Polygon &polygon, std::vector<std::size_t> &chosen) {
    std::vector<std::size_t> last;
    for (int round = 0; round < 3 && last != chosen; ++round) {
        last = chosen;
        for (std::size_t j = 1; j + 1 < chosen.size(); ++j) {
            const std::size_t before = chosen[j - 1], after = chosen[j + 1];
            const auto error = [&](std::size_t i) {
                return polygon.chord_error(before, i) + polygon.chord_error(i, after);
            };
            double least = error(chosen[j]) * (1.0 - 1e-6); // rounding alone moves nothing
            for (std::size_t i = before + 1; i < after; ++i) {
                const double here = error(i);
                if (here < least) {
                    least = here;
                    chosen[j] = i;
                }
            }
        }
    }
}

// Values at the knots, whose ends stay, that bring the lines between them closest to the polygon in the mean square:
// the normal equations of hat functions, which are tridiagonal. Every value is drawn a little to the one it had, so
// that knots which nothing determines keep theirs.
void fit_values(const Polygon &polygon, std::vector<CurveVertex> &knots) {
    constexpr double PULL = 1e-7;
    const std::size_t n = knots.size();
    std::vector<double> diagonal(n, PULL), next(n, 0.0), right(n);
    for (std::size_t j = 0; j < n; ++j) {
        right[j] = PULL * knots[j].t;
    }
    for (std::size_t j = 0; j + 1 < n; ++j) {
        const double z0 = knots[j].z, z1 = knots[j + 1].z, h = z1 - z0;
        if (!(h > 0.0)) {
            continue;
        }
        const auto [f0, fz0] = polygon.up_to(z0);
        const auto [f1, fz1] = polygon.up_to(z1);
        const double rising = ((fz1 - fz0) - z0 * (f1 - f0)) / h;
        right[j] += (f1 - f0) - rising;
        right[j + 1] += rising;
        diagonal[j] += h / 3.0;
        diagonal[j + 1] += h / 3.0;
        next[j] = h / 6.0;
    }
    // Thomas's elimination of knots 1 to n - 2.
    right[1] -= next[0] * knots[0].t;
    right[n - 2] -= next[n - 2] * knots[n - 1].t;
    for (std::size_t j = 2; j + 1 < n; ++j) {
        const double w = next[j - 1] / diagonal[j - 1];
        diagonal[j] -= w * next[j - 1];
        right[j] -= w * right[j - 1];
    }
    for (std::size_t j = n - 2; j > 0; --j) {
        const double behind = j + 2 < n ? next[j] * knots[j + 1].t : 0.0;
        knots[j].t = (right[j] - behind) / diagonal[j];
    }
}

// The next of a row of numbers that rise to 1, in 255 steps of what is left to rise: see shaders/rays/curve.glsl.
std::uint8_t level(double last, double next) {
    const double share = (next - last) / std::max(1.0 - last, 1e-12);
    return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255.0));
}

double from_level(double last, std::uint8_t level) {
    return last + (1.0 - last) * level / 255.0;
}

} // namespace

void fit_curve(std::span<const CurveVertex> vertices, std::span<std::uint8_t> texel) {
    std::fill(texel.begin(), texel.end(), std::uint8_t{0});
    if (vertices.empty()) {
        write_head({}, 0.0F, texel);
        return;
    }
    const double last = std::max(vertices.back().t, 1e-38);
    const TexelHead head = write_head({static_cast<float>(vertices.front().z), static_cast<float>(vertices.back().z)},
                                      static_cast<float>(-std::log(last)), texel);
    const double end = std::exp(-double{head.total}), fall = std::max(1.0 - end, 1e-12);
    // Knots are chosen relative to the exact range, not to the stored one: so they stay when all of the ray moves.
    const double low = vertices.front().z, width = std::max(vertices.back().z - low, 1e-12);
    std::vector<CurveVertex> relative;
    relative.reserve(vertices.size());
    for (const CurveVertex &v : vertices) {
        relative.push_back({(v.z - low) / width, v.t});
    }
    const Polygon polygon(std::move(relative));
    const Polygon thinned = without_needless(polygon);
    std::vector<std::size_t> chosen = simplify(thinned, CURVE_KNOTS + 2);
    settle(thinned, chosen);
    std::vector<CurveVertex> knots;
    knots.reserve(chosen.size());
    for (const std::size_t i : chosen) {
        knots.push_back(thinned.vertices[i]);
    }
    std::array<std::uint8_t, CURVE_KNOTS> depths{}, values{};
    depths.fill(255); // few vertices leave knots over: they repeat the last
    values.fill(255);
    for (std::size_t j = 1; j + 1 < knots.size(); ++j) {
        depths[j - 1] = level(knots[j - 1].z, knots[j].z);
        knots[j].z = from_level(knots[j - 1].z, depths[j - 1]);
    }
    if (knots.size() > 2) {
        fit_values(polygon, knots);
    }
    double lost = 0.0; // the fit can turn the order of values, slightly; levels cannot
    for (std::size_t j = 1; j + 1 < knots.size(); ++j) {
        values[j - 1] = level(lost, (1.0 - knots[j].t) / fall);
        lost = from_level(lost, values[j - 1]);
    }
    std::copy(depths.begin(), depths.end(), texel.begin() + HEAD_BYTES);
    std::copy(values.begin(), values.end(), texel.begin() + HEAD_BYTES + CURVE_KNOTS);
}

} // namespace sfumato
