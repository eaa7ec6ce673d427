// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/microfacet.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

using glm::dvec3;
using std::numbers::pi;
using Pair = std::array<double, 2>;

Pair operator+(const Pair &a, const Pair &b) {
    return {a[0] + b[0], a[1] + b[1]};
}
Pair operator*(double k, const Pair &a) {
    return {k * a[0], k * a[1]};
}

// Gauss and Legendre's nodes in [-1, 1], by Newton's method.
struct Gauss {
    std::vector<double> x, w;
    explicit Gauss(int n) {
        for (int k = 0; k < n; ++k) {
            double t = std::cos(pi * (k + 0.75) / (n + 0.5)), slope = 1.0;
            for (int step = 0; step < 100; ++step) {
                double p = 1.0, before = 0.0;
                for (int j = 0; j < n; ++j) {
                    const double next = ((2.0 * j + 1.0) * t * p - j * before) / (j + 1.0);
                    before = p;
                    p = next;
                }
                slope = n * (t * p - before) / (t * t - 1.0);
                t -= p / slope;
                if (std::abs(p / slope) < 1e-15) {
                    break;
                }
            }
            x.push_back(t);
            w.push_back(2.0 / ((1.0 - t * t) * slope * slope));
        }
    }
};

// ---- The BRDF ----

// Smith's Lambda, by the tangent that a direction has on the surface scaled by alpha.
double lambda(Facets facets, double alpha_tangent) {
    if (facets == Facets::GGX) {
        return 0.5 * (std::sqrt(1.0 + alpha_tangent * alpha_tangent) - 1.0);
    }
    // Walter et al. (2007), below eq 27.
    const double a = 1.0 / std::max(alpha_tangent, 1e-300);
    return a < 1.6 ? (1.0 + 2.276 * a + 2.577 * a * a) / (3.535 * a + 2.181 * a * a) - 1.0 : 0.0;
}

double alpha_tangent(const RoughSurface &s, const dvec3 &d) {
    return std::hypot(s.alpha_x * d.x, s.alpha_y * d.y) / d.z;
}

double masked(const RoughSurface &s, const dvec3 &i) {
    return 1.0 / (1.0 + lambda(s.facets, alpha_tangent(s, s.view)) + lambda(s.facets, alpha_tangent(s, i)));
}

double density(const RoughSurface &s, const dvec3 &h) {
    const double x = h.x / (s.alpha_x * h.z), y = h.y / (s.alpha_y * h.z), z4 = h.z * h.z * h.z * h.z;
    const double scale = 1.0 / (pi * s.alpha_x * s.alpha_y * z4);
    switch (s.facets) {
    case Facets::BECKMANN:
        return scale * std::exp(-x * x - y * y);
    case Facets::BLINN_PHONG: {
        const double n = 2.0 / (s.alpha_x * s.alpha_x) - 2.0;
        return (n + 2.0) / (2.0 * pi) * std::pow(h.z, n);
    }
    default:
        return scale / ((1.0 + x * x + y * y) * (1.0 + x * x + y * y));
    }
}

Pair with_fresnel(const RoughSurface &s, double value, double cosine) {
    return {value, value * fresnel_share(cosine, s.index)};
}

// ---- Outlines ----

// A piece of the outline above the horizon: x(t) and its derivative, t in [0, 1].
using Piece = std::function<std::pair<dvec3, dvec3>(double)>;

Piece segment(const dvec3 &a, const dvec3 &b) {
    return [a, b](double t) { return std::pair(a + t * (b - a), b - a); };
}

std::vector<dvec3> above_horizon(std::span<const dvec3> polygon) {
    std::vector<dvec3> out;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const dvec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        if (a.z >= 0.0) {
            out.push_back(a);
        }
        if ((a.z < 0.0) != (b.z < 0.0)) {
            dvec3 crossing = a + a.z / (a.z - b.z) * (b - a);
            crossing.z = 0.0;
            out.push_back(crossing);
        }
    }
    return out;
}

// The light's coordinates with x up the slope: what is above the horizon is x >= start.
struct Uphill {
    dvec3 x, y;
    double start = -1.0;
};

Uphill uphill(const DiskLight &light) {
    const double rise = std::hypot(light.u.z, light.v.z);
    Uphill out{light.u, light.v, light.centre.z > 0.0 ? -1.0 : 1.0};
    if (rise > 0.0) {
        out.x = (light.u.z * light.u + light.v.z * light.v) / rise;
        out.y = (light.u.z * light.v - light.v.z * light.u) / rise;
        out.start = std::clamp(-light.centre.z / rise, -1.0, 1.0);
    }
    return out;
}

std::vector<Piece> outline(std::span<const dvec3> polygon) {
    const std::vector<dvec3> points = above_horizon(polygon);
    std::vector<Piece> pieces;
    for (std::size_t k = 0; k < points.size(); ++k) {
        pieces.push_back(segment(points[k], points[(k + 1) % points.size()]));
    }
    return pieces;
}

std::vector<Piece> outline(const DiskLight &light) {
    const Uphill up = uphill(light);
    const double end = std::acos(up.start);
    std::vector<Piece> pieces;
    for (int k = -2; k < 2; ++k) {
        pieces.emplace_back([=, centre = light.centre](double t) {
            const double angle = 0.5 * end * (k + t);
            const dvec3 slope = std::cos(angle) * up.y - std::sin(angle) * up.x;
            return std::pair(centre + std::cos(angle) * up.x + std::sin(angle) * up.y, 0.5 * end * slope);
        });
    }
    const dvec3 chord = std::sin(end) * up.y, middle = light.centre + up.start * up.x;
    pieces.push_back(segment(middle + chord, middle - chord));
    return pieces;
}

// int_Q^1 W dq along a ray of slopes, from none to r (in units of alpha), divided by r^2.
Pair along_ray(const RoughSurface &s, double cosine, double sine, double r) {
    static const Gauss gauss(32);
    const bool tails = s.facets == Facets::GGX;
    // A variable in which the integrand is smooth and the tail is no longer than need be.
    const double end = tails ? std::asinh(r) : std::min(r, s.facets == Facets::BECKMANN ? 6.5 : 30.0);
    Pair sum{0.0, 0.0};
    for (std::size_t k = 0; k < gauss.x.size(); ++k) {
        const double t = 0.5 * end * (1.0 + gauss.x[k]);
        const double x = tails ? std::sinh(t) : t;
        double fall = 0.0; // -dq/dt
        if (tails) {
            fall = 2.0 * x * std::cosh(t) / ((1.0 + x * x) * (1.0 + x * x));
        } else if (s.facets == Facets::BECKMANN) {
            fall = 2.0 * x * std::exp(-x * x);
        } else {
            const double a2 = s.alpha_x * s.alpha_x;
            fall = 2.0 * x * std::pow(1.0 + a2 * x * x, -1.0 / a2 - 1.0);
        }
        const dvec3 h = glm::normalize(dvec3(s.alpha_x * x * cosine, s.alpha_y * x * sine, 1.0));
        const double along = glm::dot(s.view, h);
        const dvec3 i = 2.0 * along * h - s.view;
        if (i.z > 0.0) {
            const double weight = masked(s, i) * along / (s.view.z * h.z);
            sum = sum + (0.5 * end * gauss.w[k] * fall) * with_fresnel(s, weight, along);
        }
    }
    return 1.0 / std::max(r * r, 1e-300) * sum;
}

Pair at_outline(const RoughSurface &s, const Piece &piece, double t) {
    const auto [x, slope] = piece(t);
    const double length = glm::length(x);
    const dvec3 h = x + length * s.view, dh = slope + glm::dot(x, slope) / length * s.view;
    const double px = h.x / (s.alpha_x * h.z), py = h.y / (s.alpha_y * h.z);
    const double qx = (dh.x / s.alpha_x - px * dh.z) / h.z, qy = (dh.y / s.alpha_y - py * dh.z) / h.z;
    const double r = std::hypot(px, py), scale = 1.0 / std::max(r, 1e-300);
    return (px * qy - py * qx) * along_ray(s, px * scale, py * scale, r);
}

Pair gauss_on(const std::function<Pair(double)> &f, double a, double b) {
    static const Gauss gauss(8);
    Pair sum{0.0, 0.0};
    for (std::size_t k = 0; k < gauss.x.size(); ++k) {
        sum = sum + 0.5 * (b - a) * gauss.w[k] * f(0.5 * (a + b) + 0.5 * (b - a) * gauss.x[k]);
    }
    return sum;
}

Pair adaptive(const std::function<Pair(double)> &f, double a, double b, const Pair &whole, double tolerance,
              int depth) {
    const double middle = 0.5 * (a + b);
    const Pair left = gauss_on(f, a, middle), right = gauss_on(f, middle, b), both = left + right;
    if (depth == 0 || std::abs(both[0] - whole[0]) < tolerance) {
        return both;
    }
    return adaptive(f, a, middle, left, tolerance, depth - 1) + adaptive(f, middle, b, right, tolerance, depth - 1);
}

Pair integral(const std::function<Pair(double)> &f, double tolerance) {
    // Four panels to begin with, so that a peak between the nodes of one is not missed.
    Pair sum{0.0, 0.0};
    constexpr int PANELS = 4;
    for (int k = 0; k < PANELS; ++k) {
        const double a = static_cast<double>(k) / PANELS, b = static_cast<double>(k + 1) / PANELS;
        sum = sum + adaptive(f, a, b, gauss_on(f, a, b), tolerance, 40);
    }
    return sum;
}

Pair along_outline(const RoughSurface &s, const std::vector<Piece> &pieces) {
    Pair sum{0.0, 0.0};
    for (const Piece &piece : pieces) {
        sum = sum + integral([&](double t) { return at_outline(s, piece, t); }, 1e-9);
    }
    return {std::abs(sum[0]) / (2.0 * pi), std::abs(sum[1]) / (2.0 * pi)};
}

// ---- Areas ----

// f over the unit square, halved in both directions until it no longer matters.
Pair on_square(const std::function<Pair(double, double)> &f, double u0, double u1, double v0, double v1) {
    return gauss_on([&](double u) { return gauss_on([&](double v) { return f(u, v); }, v0, v1); }, u0, u1);
}

Pair over_square(const std::function<Pair(double, double)> &f, double u0, double u1, double v0, double v1,
                 const Pair &whole, double tolerance, int depth) {
    const double u = 0.5 * (u0 + u1), v = 0.5 * (v0 + v1);
    const std::array<std::array<double, 4>, 4> parts{{{u0, u, v0, v}, {u, u1, v0, v}, {u0, u, v, v1}, {u, u1, v, v1}}};
    std::array<Pair, 4> values;
    Pair sum{0.0, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
        values[k] = on_square(f, parts[k][0], parts[k][1], parts[k][2], parts[k][3]);
        sum = sum + values[k];
    }
    if (depth == 0 || std::abs(sum[0] - whole[0]) < tolerance) {
        return sum;
    }
    Pair finer{0.0, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
        finer = finer + over_square(f, parts[k][0], parts[k][1], parts[k][2], parts[k][3], values[k], 0.5 * tolerance,
                                    depth - 1);
    }
    return finer;
}

Pair over_unit_square(const std::function<Pair(double, double)> &f) {
    Pair sum{0.0, 0.0};
    constexpr int PANELS = 4;
    for (int j = 0; j < PANELS * PANELS; ++j) {
        const int row = j / PANELS, column = j % PANELS;
        const double u = static_cast<double>(column) / PANELS, v = static_cast<double>(row) / PANELS;
        const double d = 1.0 / PANELS;
        sum = sum + over_square(f, u, u + d, v, v + d, on_square(f, u, u + d, v, v + d), 1e-8, 12);
    }
    return sum;
}

// The reflection of the light's element at x, whose area vector is `area`.
Pair element(const RoughSurface &s, const dvec3 &x, const dvec3 &area) {
    const double distance2 = glm::dot(x, x), distance = std::sqrt(distance2);
    return std::abs(glm::dot(area, x)) / (distance2 * distance) * rough_reflection(s, x / distance);
}

} // namespace

double fresnel_share(double cosine, double index) {
    const double c = std::clamp(cosine, 0.0, 1.0);
    if (index == 0.0) {
        return std::pow(1.0 - c, 5);
    }
    if (index == 1.0) {
        return 0.0; // nothing is reflected, nor does anything change at grazing angles but at 0
    }
    // Snell's law, and the amplitudes across the plane of incidence and in it.
    const double refracted = std::sqrt(1.0 - (1.0 - c * c) / (index * index));
    const double across = (c - index * refracted) / (c + index * refracted);
    const double within = (index * c - refracted) / (index * c + refracted);
    const double straight_on = (index - 1.0) / (index + 1.0), f0 = straight_on * straight_on;
    // From an index of 2 + sqrt 3 on, the latter falls at first faster than the former rises: no share is negative.
    return std::max((0.5 * (across * across + within * within) - f0) / (1.0 - f0), 0.0);
}

std::array<double, 2> rough_reflection(const RoughSurface &surface, const dvec3 &i) {
    if (!(i.z > 0.0)) {
        return {0.0, 0.0};
    }
    const dvec3 h = glm::normalize(i + surface.view);
    const double value = density(surface, h) * masked(surface, i) / (4.0 * surface.view.z);
    return with_fresnel(surface, value, glm::dot(h, surface.view));
}

DiskLight disk_of_sphere(const dvec3 &centre, double radius) {
    const double distance = glm::length(centre), sine = radius / distance;
    const dvec3 axis = centre / distance;
    const dvec3 aside = std::abs(axis.x) < 0.6 ? dvec3(1.0, 0.0, 0.0) : dvec3(0.0, 1.0, 0.0);
    const dvec3 u = glm::normalize(glm::cross(axis, aside));
    const double tangent = sine / std::sqrt(1.0 - sine * sine);
    return {axis, tangent * u, tangent * glm::cross(axis, u)};
}

std::array<double, 2> reflected_by_outline(const RoughSurface &surface, std::span<const dvec3> polygon) {
    return along_outline(surface, outline(polygon));
}

std::array<double, 2> reflected_by_outline(const RoughSurface &surface, const DiskLight &light) {
    return along_outline(surface, outline(light));
}

std::array<double, 2> reflected_by_area(const RoughSurface &surface, std::span<const dvec3> polygon) {
    const std::vector<dvec3> points = above_horizon(polygon);
    Pair sum{0.0, 0.0};
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
        const dvec3 a = points[k] - points[0], b = points[k + 1] - points[k], area = glm::cross(a, b);
        sum = sum + over_unit_square(
                        [&](double u, double v) { return u * element(surface, points[0] + u * (a + v * b), area); });
    }
    return sum;
}

std::array<double, 2> reflected_by_area(const RoughSurface &surface, const DiskLight &light) {
    const Uphill up = uphill(light);
    const dvec3 area = glm::cross(up.x, up.y);
    return over_unit_square([&](double u, double v) {
        // Strips across the slope, their ends at cos(t) so that the rim's root is smooth.
        const double t = pi * u, half = 0.5 * (1.0 - up.start), x = up.start + half * (1.0 - std::cos(t));
        const double wide = std::sqrt(std::max(1.0 - x * x, 0.0)), y = wide * (2.0 * v - 1.0);
        return (pi * half * std::sin(t) * 2.0 * wide) * element(surface, light.centre + x * up.x + y * up.y, area);
    });
}

} // namespace sfumato::reference
