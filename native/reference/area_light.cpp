// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/area_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

constexpr double PI = std::numbers::pi;
using glm::cross;
using glm::dot;
using glm::dvec3;
using Polygon = std::vector<dvec3>;

struct Rule {
    std::vector<double> nodes, weights; // on [-1, 1]
};

// Gauss and Legendre: the roots of the polynomial by Newton's method.
Rule gauss_legendre(int n) {
    Rule rule;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(PI * (i + 0.75) / (n + 0.5)), slope = 1.0;
        for (int step = 0; step < 100; ++step) {
            double p = 1.0, before = 0.0;
            for (int k = 1; k <= n; ++k) {
                const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
                before = p;
                p = next;
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        rule.nodes.push_back(x);
        rule.weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
    }
    return rule;
}

double integral(const Rule &rule, double from, double to, const std::function<double(double)> &f) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        sum += rule.weights[i] * f(0.5 * (from + to) + 0.5 * (to - from) * rule.nodes[i]);
    }
    return 0.5 * (to - from) * sum;
}

// Sutherland and Hodgman (1974).
Polygon clipped(const Polygon &polygon, const dvec3 &normal) {
    Polygon out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double ha = dot(a, normal), hb = dot(b, normal);
        if (ha >= 0.0) {
            out.push_back(a);
        }
        if ((ha < 0.0) != (hb < 0.0)) {
            out.push_back(a + (b - a) * (ha / (ha - hb)));
        }
    }
    return out;
}

Polygon visible(std::span<const dvec3> polygon, const dvec3 &axis, const Horizon &normal) {
    Polygon out(polygon.begin(), polygon.end());
    if (normal) {
        out = clipped(out, *normal);
    }
    return clipped(out, axis);
}

// (1 - z^N)/(1 - z^2) from x = 1 - z^2.
double boundary_integrand(double x, double order) {
    x = std::clamp(x, 0.0, 1.0);
    return x < 1e-300 ? 0.5 * order : -std::expm1(0.5 * order * std::log1p(-x)) / x;
}

// One edge of N M^n, whose ends lie in front of the axis: s int (1 - z^N)/(1 - z^2) d(phi).
double along_edge(const dvec3 &from, const dvec3 &to, const dvec3 &axis, double order) {
    static const Rule rule = gauss_legendre(24);
    const dvec3 normal = cross(from, to - from);
    const double length = glm::length(normal);
    if (length == 0.0) {
        return 0.0;
    }
    const dvec3 m = normal / length, g = cross(m, axis);
    const double s = dot(m, axis), c2 = dot(g, g);
    const double angle = std::atan2(length, dot(from, to));
    const double start = c2 > 1e-12 ? std::atan2(dot(from, g), dot(from, axis)) : 0.0;
    const auto f = [&](double phi) {
        const double sine = std::sin(phi);
        return boundary_integrand(s * s + c2 * sine * sine, order);
    };
    double sum = 0.0;
    for (const double side : {-1.0, 1.0}) { // panels outwards from the peak at phi = 0
        double inner = 0.0, outer = 1e-3 * std::max(std::abs(s), 1.0 / std::sqrt(order));
        while (inner < PI) {
            const double a = side > 0.0 ? inner : -outer, b = side > 0.0 ? outer : -inner;
            const double low = std::clamp(a, start, start + angle), high = std::clamp(b, start, start + angle);
            if (high > low) {
                sum += integral(rule, low, high, f);
            }
            inner = outer;
            outer *= 2.0;
        }
    }
    return s * sum;
}

dvec3 unit(const dvec3 &v) {
    return v / glm::length(v);
}

Horizon unit(const Horizon &normal) {
    return normal ? Horizon(unit(*normal)) : normal;
}

// k J_k = [a^(k-1) y] + (k-1) c^2 J_(k-2), summed over k = n-1, n-3, ...
double recurrence_along_edge(const dvec3 &from, const dvec3 &to, const dvec3 &axis, int exponent) {
    const dvec3 normal = cross(from, to - from);
    const double length = glm::length(normal);
    if (length == 0.0) {
        return 0.0;
    }
    const dvec3 m = normal / length, g = cross(m, axis);
    const double s = dot(m, axis), c2 = dot(g, g);
    const double a0 = dot(unit(from), axis), a1 = dot(unit(to), axis);
    const double y0 = dot(unit(from), g), y1 = dot(unit(to), g);
    const double angle = std::atan2(length, dot(from, to));
    double even = angle, odd = y1 - y0, sum = 0.0; // the last J of either parity
    for (int k = (exponent + 1) % 2; k <= exponent - 1; k += 2) {
        double &j = k % 2 == 0 ? even : odd;
        if (k >= 2) {
            j = (std::pow(a1, k - 1) * y1 - std::pow(a0, k - 1) * y0 + (k - 1) * c2 * j) / k;
        }
        sum += j;
    }
    const double cone = 2.0 * std::atan2(s * std::sin(angle), 1.0 + a0 + a1 + std::cos(angle));
    return s * sum + (exponent % 2 == 0 ? cone : 0.0);
}

double share(double n_times_moment) {
    return std::abs(n_times_moment) / (2.0 * PI);
}

double over_triangles(const Polygon &corners, const std::function<double(const dvec3 &)> &f) {
    static const Rule rule = gauss_legendre(64);
    double sum = 0.0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
        const dvec3 &a = corners[0], b = corners[i - 1] - a, c = corners[i] - corners[i - 1];
        const double flux = dot(a, cross(b, c)); // twice the area times the distance of the plane
        sum += integral(rule, 0.0, 1.0, [&](double p) {
            return p * integral(rule, 0.0, 1.0, [&](double q) {
                       const dvec3 x = a + b * p + c * (p * q);
                       const double r = glm::length(x);
                       return flux / (r * r * r) * f(x / r);
                   });
        });
    }
    return std::abs(sum);
}

double adaptive(const std::function<double(double)> &f, double from, double to, double whole, int depth) {
    static const Rule rule = gauss_legendre(12);
    const double middle = 0.5 * (from + to);
    const double left = integral(rule, from, middle, f), right = integral(rule, middle, to, f);
    if (depth == 0 || std::abs(left + right - whole) < 1e-13 * (1.0 + std::abs(whole))) {
        return left + right;
    }
    return adaptive(f, from, middle, left, depth - 1) + adaptive(f, middle, to, right, depth - 1);
}

} // namespace

double cosine_power(std::span<const dvec3> polygon, const dvec3 &axis, double exponent, const Horizon &normal) {
    const dvec3 r = unit(axis);
    const Polygon corners = visible(polygon, r, unit(normal));
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        sum += along_edge(corners[i], corners[(i + 1) % corners.size()], r, exponent + 1.0);
    }
    return share(sum);
}

double cosine_power_exact(std::span<const dvec3> polygon, const dvec3 &axis, int exponent, const Horizon &normal) {
    const dvec3 r = unit(axis);
    const Polygon corners = visible(polygon, r, unit(normal));
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        sum += recurrence_along_edge(corners[i], corners[(i + 1) % corners.size()], r, exponent);
    }
    return share(sum);
}

double cosine_power_by_area(std::span<const dvec3> polygon, const dvec3 &axis, double exponent, const Horizon &normal) {
    const dvec3 r = unit(axis);
    const auto power = [&](const dvec3 &u) { return std::pow(std::max(dot(u, r), 0.0), exponent); };
    return (exponent + 1.0) / (2.0 * PI) * over_triangles(visible(polygon, r, unit(normal)), power);
}

double double_moment_by_area(std::span<const dvec3> polygon, const dvec3 &axis, double exponent, const dvec3 &b) {
    const dvec3 r = unit(axis);
    const auto power = [&](const dvec3 &u) { return std::pow(std::max(dot(u, r), 0.0), exponent) * dot(u, b); };
    const Polygon corners = visible(polygon, r, {});
    const double positive = over_triangles(corners, [&](const dvec3 &u) { return std::max(power(u), 0.0); });
    const double whole = over_triangles(corners, [&](const dvec3 &u) { return std::abs(power(u)); });
    return 2.0 * positive - whole;
}

double cosine_power_of_ellipse(const dvec3 &centre, const dvec3 &u, const dvec3 &v, const dvec3 &axis, double exponent,
                               const Horizon &normal) {
    const dvec3 r = unit(axis);
    const double order = exponent + 1.0;
    std::vector<dvec3> planes{r};
    if (normal && glm::length(unit(*normal) - r) > 1e-12) {
        planes.push_back(unit(*normal));
    }
    const auto at = [&](double psi) { return centre + u * std::cos(psi) + v * std::sin(psi); };
    const double wound = dot(centre, cross(u, v)) < 0.0 ? -1.0 : 1.0;
    std::vector<double> cuts{0.0, 2.0 * PI};
    double sum = 0.0;
    for (const dvec3 &plane : planes) {
        const double c = dot(centre, plane), x = dot(u, plane), y = dot(v, plane), reach = std::hypot(x, y);
        if (std::abs(c) >= reach) {
            if (c < 0.0) {
                return 0.0;
            }
            continue;
        }
        // Out of the half space at `exit`, back at `entry`, and along the plane between, as far as the others allow.
        const double top = std::atan2(y, x), half = std::acos(-c / reach);
        const double exit = top + half, entry = top - half;
        for (const double cut : {exit, entry}) {
            const double turned = std::fmod(cut + 4.0 * PI, 2.0 * PI);
            cuts.push_back(turned);
        }
        dvec3 from = at(exit), to = at(entry);
        bool gone = false;
        for (const dvec3 &other : planes) {
            const double h0 = dot(from, other), h1 = dot(to, other);
            if (&other == &plane || (h0 >= 0.0 && h1 >= 0.0)) {
                continue;
            }
            gone = gone || (h0 < 0.0 && h1 < 0.0);
            const dvec3 crossing = from + (to - from) * (h0 / (h0 - h1));
            (h0 < 0.0 ? from : to) = crossing;
        }
        if (!gone) {
            sum += along_edge(from, to, r, order);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    const auto integrand = [&](double psi) {
        const dvec3 p = at(psi), slope = v * std::cos(psi) - u * std::sin(psi);
        const double a = dot(p, r);
        const dvec3 across = p - r * a;
        return boundary_integrand(dot(across, across) / dot(p, p), order) * dot(r, cross(p, slope)) / dot(p, p);
    };
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const dvec3 middle = at(0.5 * (cuts[i] + cuts[i + 1]));
        if (std::all_of(planes.begin(), planes.end(), [&](const dvec3 &plane) { return dot(middle, plane) >= 0.0; })) {
            constexpr int PANELS = 16; // an adaptive rule could miss a narrow peak
            for (int k = 0; k < PANELS; ++k) {
                const double step = (cuts[i + 1] - cuts[i]) / PANELS, from = cuts[i] + k * step;
                sum += adaptive(integrand, from, from + step, 1e300, 40);
            }
        }
    }
    return share(wound * sum);
}

double cosine_power_of_sphere(const dvec3 &centre, double radius, const dvec3 &axis, double exponent,
                              const Horizon &normal) {
    const double distance = glm::length(centre);
    const dvec3 towards = centre / distance;
    const dvec3 aside = std::abs(towards.x) < 0.5 ? dvec3(1.0, 0.0, 0.0) : dvec3(0.0, 1.0, 0.0);
    const dvec3 u = unit(cross(towards, aside)), v = cross(towards, u);
    const double sine = radius / distance, cosine = std::sqrt(1.0 - sine * sine);
    return cosine_power_of_ellipse(towards * cosine, u * sine, v * sine, axis, exponent, normal);
}

} // namespace sfumato::reference
