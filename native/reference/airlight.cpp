// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/airlight.hpp"

#include "reference/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

constexpr double PI = std::numbers::pi;

double gauss7(const std::function<double(double)> &of, double from, double to) {
    constexpr std::array<double, 4> PLACES{0.0, 0.4058451513773972, 0.7415311855993945, 0.9491079123427585};
    constexpr std::array<double, 4> WEIGHTS{0.4179591836734694, 0.3818300505051189, 0.2797053914892766,
                                            0.1294849661688697};
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = WEIGHTS[0] * of(middle);
    for (std::size_t i = 1; i < PLACES.size(); ++i) {
        sum += WEIGHTS[i] * (of(middle - half * PLACES[i]) + of(middle + half * PLACES[i]));
    }
    return half * sum;
}

double refined(const std::function<double(double)> &of, double from, double to, double known, double allowed,
               int deepest) {
    const double middle = 0.5 * (from + to), low = gauss7(of, from, middle), high = gauss7(of, middle, to);
    if (deepest == 0 || std::abs(low + high - known) <= allowed) {
        return low + high;
    }
    return refined(of, from, middle, low, allowed, deepest - 1) + refined(of, middle, to, high, allowed, deepest - 1);
}

double density(const GreyAir &air, double z) {
    return air.scale_height > 0.0 ? std::exp(-(z - air.ground) / air.scale_height) : 1.0;
}

double spot(const Lamp &lamp, const glm::dvec3 &along) {
    if (lamp.cone_cosine < -1.0) {
        return 1.0;
    }
    const double above = glm::dot(along, lamp.axis) - lamp.cone_cosine;
    const double t = std::clamp(above / std::max((1.0 - lamp.cone_cosine) * lamp.blend, 1e-12), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Where a line from a place relative to a cone's tip meets the double cone, two numbers or none.
std::vector<double> on_cone(const glm::dvec3 &from, const glm::dvec3 &direction, const glm::dvec3 &axis,
                            double cosine) {
    const double u = glm::dot(from, axis), v = glm::dot(direction, axis), c2 = cosine * cosine;
    const double a = v * v - c2, b = u * v - c2 * glm::dot(from, direction), c = u * u - c2 * glm::dot(from, from);
    const double root2 = b * b - a * c;
    if (root2 < -1e-9 * b * b || a == 0.0) { // a half-space has one root twice
        return {};
    }
    const double root = std::sqrt(std::max(root2, 0.0));
    return {(-b - root) / a, (-b + root) / a};
}

// Irradiance on whatever faces the light there, times phase function, times what is left on the way there. `back` is
// the direction from the place to the eye.
double scattered_at(const glm::dvec3 &place, const glm::dvec3 &back, const Lamp &lamp, const GreyAir &air) {
    const glm::dvec3 way = place - lamp.position;
    const double r = glm::length(way);
    if (r <= lamp.radius) {
        return 2.0 / (lamp.radius * lamp.radius) / (4.0 * PI);
    }
    const glm::dvec3 along = way / r;
    const double cone = spot(lamp, along);
    if (lamp.radius == 0.0) {
        const double depth = air.extinction * column(air, place, lamp.position);
        return cone * phase(air, glm::dot(along, back)) * std::exp(-depth) / (r * r);
    }
    // Its radiance is 1 / (pi R^2). Rings of the cap that is seen, by the angle at which their rays meet the sphere.
    const glm::dvec3 other = std::abs(along.x) < 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(along, other)), y = glm::cross(along, x);
    constexpr int TURNS = 12;
    const auto ring = [&](double angle_there) {
        const double sine = lamp.radius / r * std::sin(angle_there), cosine = std::sqrt(1.0 - sine * sine);
        const double to = r * cosine - lamp.radius * std::cos(angle_there);
        const double solid_angle = 2.0 * PI * sine * lamp.radius / r * std::cos(angle_there) / cosine;
        double sum = 0.0;
        for (int turn = 0; turn < TURNS; ++turn) {
            const double angle = 2.0 * PI * (turn + 0.5) / TURNS;
            const glm::dvec3 travel = cosine * along + sine * (std::cos(angle) * x + std::sin(angle) * y);
            sum += phase(air, glm::dot(travel, back)) *
                   std::exp(-air.extinction * column(air, place, place - to * travel));
        }
        return sum * solid_angle / TURNS;
    };
    return cone * integral(ring, 0.0, 0.5 * PI, 1e-8) / (PI * lamp.radius * lamp.radius);
}

} // namespace

double integral(const std::function<double(double)> &of, double from, double to, double error, double floor) {
    const double known = gauss7(of, from, to);
    return refined(of, from, to, known, error * std::max(std::abs(known), floor) + 1e-300, 40);
}

double phase(const GreyAir &air, double cos_theta) {
    const double g = air.anisotropy, rayleigh = 3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta);
    if (air.rayleigh) {
        return rayleigh;
    }
    const double part = air.cornette_shanks ? 4.0 * PI * rayleigh * 2.0 / (2.0 + g * g) : 1.0;
    return part * henyey_greenstein(cos_theta, g);
}

double column(const GreyAir &air, const glm::dvec3 &from, const glm::dvec3 &to) {
    const double length = glm::distance(from, to);
    if (!(air.scale_height > 0.0)) {
        return length;
    }
    return length * integral([&](double t) { return density(air, glm::mix(from.z, to.z, t)); }, 0.0, 1.0);
}

double airlight(const glm::dvec3 &from, const glm::dvec3 &to, const Lamp &lamp, const GreyAir &air) {
    const double length = glm::distance(from, to);
    const glm::dvec3 direction = (to - from) / length;
    const double foot = glm::dot(lamp.position - from, direction);
    const double distance = glm::distance(lamp.position, from + foot * direction);
    // Narrow around the foot, by powers of two of the lamp's distance and of that by the phase function's peak.
    std::vector<double> cuts{0.0, length};
    const auto cut = [&](double at) {
        if (at > 0.0 && at < length) {
            cuts.push_back(at);
        }
    };
    for (int doubling = 0; doubling < 50; ++doubling) {
        const double step = std::ldexp(1e-4 * std::max(distance, 1e-9 * length), doubling);
        cut(foot - step);
        cut(foot + step);
        cut(step);
    }
    cut(foot);
    const double chord2 = lamp.radius * lamp.radius - distance * distance;
    if (chord2 > 0.0) {
        cut(foot - std::sqrt(chord2));
        cut(foot + std::sqrt(chord2));
    }
    if (lamp.cone_cosine >= -1.0) {
        for (const double cosine : {lamp.cone_cosine, lamp.cone_cosine + (1.0 - lamp.cone_cosine) * lamp.blend}) {
            for (const double at : on_cone(from - lamp.position, direction, lamp.axis, cosine)) {
                cut(at);
            }
        }
    }
    std::sort(cuts.begin(), cuts.end());
    const auto at = [&](double t) {
        const glm::dvec3 place = from + t * direction;
        return density(air, place.z) * scattered_at(place, -direction, lamp, air) *
               std::exp(-air.extinction * column(air, from, place));
    };
    double sum = 0.0, greatest = 0.0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        greatest = std::max(greatest, gauss7(at, cuts[i], cuts[i + 1]));
    }
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        sum += integral(at, cuts[i], cuts[i + 1], 1e-8, greatest);
    }
    return sum;
}

double airlight(const glm::dvec3 &from, const glm::dvec3 &to, const Plate &plate, const GreyAir &air) {
    const double length = glm::distance(from, to);
    const glm::dvec3 direction = (to - from) / length, area = 4.0 * glm::cross(plate.across, plate.up);
    const glm::dvec3 axis = glm::normalize(area);
    const double cotangent = plate.spread < PI ? 1.0 / std::tan(0.5 * plate.spread) : 0.0;
    const auto at = [&](double t) {
        const glm::dvec3 place = from + t * direction;
        const auto from_point = [&](double x, double y) {
            const glm::dvec3 point = plate.position + x * plate.across + y * plate.up, way = place - point;
            const double r = glm::length(way), cosine = glm::dot(way, axis) / r;
            if (cosine <= 1e-9) {
                return 0.0;
            }
            const double left = 1.0 - std::sqrt(1.0 - std::min(cosine * cosine, 1.0)) / cosine * cotangent;
            return std::max(left, 0.0) * cosine / (r * r) * phase(air, -glm::dot(way, direction) / r) *
                   std::exp(-air.extinction * column(air, place, point));
        };
        const auto row = [&](double y) {
            return integral([&](double x) { return from_point(x, y); }, -1.0, 1.0, 1e-5, 1e-6);
        };
        return density(air, place.z) * std::exp(-air.extinction * column(air, from, place)) *
               integral(row, -1.0, 1.0, 1e-5, 1e-6);
    };
    // Where it crosses the plate's plane, and by powers of two around the plate's foot.
    std::vector<double> cuts{0.0, length};
    const auto cut = [&](double t) {
        if (t > 0.0 && t < length) {
            cuts.push_back(t);
        }
    };
    cut(glm::dot(plate.position - from, axis) / glm::dot(direction, axis));
    const double foot = glm::dot(plate.position - from, direction);
    const double distance = glm::distance(plate.position, from + foot * direction);
    cut(foot);
    for (int doubling = 0; doubling < 30; ++doubling) {
        const double step = std::ldexp(0.1 * distance, doubling);
        cut(foot - step);
        cut(foot + step);
    }
    std::sort(cuts.begin(), cuts.end());
    double greatest = 0.0, sum = 0.0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        greatest = std::max(greatest, gauss7(at, cuts[i], cuts[i + 1]));
    }
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        sum += integral(at, cuts[i], cuts[i + 1], 1e-4, greatest);
    }
    return sum * 0.25 * glm::length(area);
}

double sunlight(const glm::dvec3 &from, const glm::dvec3 &to, const glm::dvec3 &towards, const GreyAir &air) {
    const double length = glm::distance(from, to);
    const glm::dvec3 direction = (to - from) / length;
    // As far as 60 scale heights up; below the horizon no sun shines.
    const double far = air.scale_height > 0.0 ? 60.0 * air.scale_height / std::max(towards.z, 1e-9) : 0.0;
    if (air.scale_height > 0.0 && !(towards.z > 0.0)) {
        return 0.0;
    }
    const auto at = [&](double t) {
        const glm::dvec3 place = from + t * direction;
        return density(air, place.z) *
               std::exp(-air.extinction * (column(air, from, place) + column(air, place, place + far * towards)));
    };
    return phase(air, glm::dot(direction, towards)) * integral(at, 0.0, length);
}

} // namespace sfumato::reference
