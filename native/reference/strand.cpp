// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <glm/exponential.hpp>

namespace sfumato::reference {
namespace {

constexpr double PI = std::numbers::pi;

// I_0(x) / e^x, by the integral that defines it.
double bessel(double x) {
    constexpr int STEPS = 400;
    double sum = 0.0;
    for (int i = 0; i < STEPS; ++i) {
        sum += std::exp(x * (std::cos(PI * (i + 0.5) / STEPS) - 1.0));
    }
    return sum / STEPS;
}

// Eq 7 of the paper, of d'Eon et al. (2011), for elevations.
double along(double light, double eye, double variance) {
    const double x = std::cos(light) * std::cos(eye) / variance, y = std::sin(light) * std::sin(eye) / variance;
    // sinh(1 / v) 2 v without its overflow
    const double whole = variance * (1.0 - std::exp(-2.0 / variance));
    return bessel(x) * std::exp(x - y - 1.0 / variance) / whole;
}

double logistic(double x, double scale) {
    const double e = std::exp(-std::abs(x) / scale);
    return e / (scale * (1.0 + e) * (1.0 + e));
}

// The logistic distribution cut to half a turn on either side.
double around_lobe(double angle, double scale) {
    const double inside = 1.0 - 2.0 / (1.0 + std::exp(PI / scale));
    return logistic(std::remainder(angle, 2.0 * PI), scale) / inside;
}

double fresnel(double cosine, double index) {
    const double sine = std::sqrt(1.0 - cosine * cosine) / index, inside = std::sqrt(1.0 - sine * sine);
    const double s = (cosine - index * inside) / (cosine + index * inside);
    const double p = (index * cosine - inside) / (index * cosine + inside);
    return 0.5 * (s * s + p * p);
}

} // namespace

glm::dvec3 sent(const Strand &strand, double h, double eye, double light, double around) {
    const auto variance_of = [](double r) {
        return std::pow(0.726 * r + 0.812 * r * r + 3.7 * std::pow(r, 20.0), 2.0);
    };
    const double variance = variance_of(strand.longitudinal), r = strand.azimuthal;
    const double scale = std::sqrt(PI / 8.0) * (0.265 * r + 1.194 * r * r + 5.372 * std::pow(r, 22.0));
    const double across = std::cos(eye) / std::sqrt(strand.index * strand.index - std::sin(eye) * std::sin(eye));
    const double outer = std::asin(h), inner = std::asin(h * across);
    const double way = 2.0 * std::cos(inner) / std::cos(std::asin(std::sin(eye) / strand.index));
    const double f = fresnel(std::cos(eye) * std::cos(outer), strand.index);
    const glm::dvec3 left = glm::exp(-strand.absorption * way);
    const std::array<glm::dvec3, 3> attenuation = {glm::dvec3(f), (1.0 - f) * (1.0 - f) * left,
                                                   (1.0 - f) * (1.0 - f) * left * left * f};
    const std::array<double, 3> turned = {2.0, -1.0, -4.0},
                                variances = {variance_of(strand.primary), 0.25 * variance, 4.0 * variance};
    glm::dvec3 sum = attenuation[2] * left * f / (1.0 - left * f) * along(light, eye, 4.0 * variance) / (2.0 * PI);
    for (std::size_t p = 0; p < 3; ++p) {
        const double number = static_cast<double>(p), middle = 2.0 * number * inner - 2.0 * outer + number * PI;
        // Beyond straight along the strand an elevation comes back on its other side.
        const double elevation = std::asin(std::sin(light + turned[p] * strand.tilt));
        sum += attenuation[p] * along(elevation, eye, variances[p]) * around_lobe(around - middle, scale);
    }
    return sum;
}

} // namespace sfumato::reference
