// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace sfumato::reference {
namespace {

// Two unit vectors at right angles to an axis and to each other.
struct Plane {
    explicit Plane(const glm::dvec3 &axis) {
        const glm::dvec3 other = std::abs(axis.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
        tangent = glm::normalize(glm::cross(other, axis));
        bitangent = glm::cross(axis, tangent);
    }

    glm::dvec3 at(const glm::dvec2 &point) const { return point.x * tangent + point.y * bitangent; }

    glm::dvec3 tangent;
    glm::dvec3 bitangent;
};

// The middles of per_axis x per_axis equal squares that fill [-1, 1]^2.
std::vector<glm::dvec2> strata(unsigned per_axis) {
    std::vector<glm::dvec2> middles;
    for (unsigned j = 0; j < per_axis; ++j) {
        for (unsigned i = 0; i < per_axis; ++i) {
            middles.push_back((2.0 * glm::dvec2(i, j) + 1.0) / double(per_axis) - 1.0);
        }
    }
    return middles;
}

// Shirley and Chiu, "A low distortion map between disk and square", 1997: [-1, 1]^2 to the unit disk, area to area.
glm::dvec2 concentric(const glm::dvec2 &square) {
    const double quarter = std::numbers::pi / 4.0;
    const bool wide = std::abs(square.x) > std::abs(square.y);
    const double radius = wide ? square.x : square.y;
    if (radius == 0.0) {
        return glm::dvec2(0.0);
    }
    const double phi = wide ? quarter * square.y / square.x : quarter * (2.0 - square.x / square.y);
    return radius * glm::dvec2(std::cos(phi), std::sin(phi));
}

// A cap of the unit sphere, 1 - cos(angle) = `height` high around the axis, from the unit disk, area to area: by
// Archimedes the area up to an angle goes with the height there, so the height is the square of the disk's radius.
glm::dvec3 on_cap(const glm::dvec3 &axis, const Plane &plane, double height, const glm::dvec2 &disk) {
    const double below = glm::dot(disk, disk) * height;
    return (1.0 - below) * axis + std::sqrt(height * (2.0 - below)) * plane.at(disk);
}

std::vector<LightSample> sun_samples(const Light &sun, unsigned per_axis) {
    const glm::dvec3 axis = -glm::normalize(glm::dvec3(sun.direction));
    if (sun.angle == 0.0F) {
        return {{axis, ENDLESS, glm::dvec3(sun.strength)}};
    }
    // Constant radiance over a cone gives each piece of it an irradiance in proportion to its area when projected on
    // the plane that faces the sun. The cone's projection is a disk of radius sin(angle / 2): equal areas, equal parts.
    const double radius = std::sin(0.5 * double{sun.angle});
    const Plane plane(axis);
    std::vector<LightSample> samples;
    for (const glm::dvec2 &square : strata(per_axis)) {
        const glm::dvec2 disk = radius * concentric(square);
        const double height = std::sqrt(1.0 - glm::dot(disk, disk));
        const glm::dvec3 part = glm::dvec3(sun.strength) / double(per_axis * per_axis);
        samples.push_back({plane.at(disk) + height * axis, ENDLESS, part / height});
    }
    return samples;
}

// Of equal parts of the whole sphere: by the height of a direction, and by its angle around.
std::vector<LightSample> sky_samples(const Light &sky, unsigned per_axis) {
    std::vector<LightSample> samples;
    const double solid_angle = 4.0 * std::numbers::pi / double(2 * per_axis * per_axis);
    for (const glm::dvec2 &square : strata(per_axis)) {
        for (const double half : {0.0, 1.0}) {
            const double angle = std::numbers::pi * (0.5 * (square.x + 1.0) + half);
            const double across = std::sqrt(1.0 - square.y * square.y);
            const glm::dvec3 towards(across * std::cos(angle), across * std::sin(angle), square.y);
            const glm::dvec3 radiance = sky.image ? sky_radiance(*sky.image, towards) * double{sky.gain}
                                                  : glm::dvec3(sky.strength) / (4.0 * std::numbers::pi);
            samples.push_back({towards, ENDLESS, radiance * solid_angle});
        }
    }
    return samples;
}

// What the cone of a spot leaves of the light that travels in the unit direction `along`: a smooth step in the cosine
// of its angle to the axis, as in Cycles, from 0 on the cone to 1 at the share `blend` of the way to the axis.
double spot_factor(const Light &spot, const glm::dvec3 &along) {
    if (spot.cone >= 2.0F * std::numbers::pi_v<float>) {
        return 1.0;
    }
    const double edge = std::cos(0.5 * double{spot.cone});
    const double inside = glm::dot(along, glm::normalize(glm::dvec3(spot.direction))) - edge;
    const double fade = (1.0 - edge) * double{spot.blend};
    if (fade == 0.0) {
        return inside >= 0.0 ? 1.0 : 0.0;
    }
    const double t = std::clamp(inside / fade, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

std::vector<LightSample> sphere_samples(const Light &light, const glm::dvec3 &position, unsigned per_axis) {
    const glm::dvec3 intensity(light.strength);
    const glm::dvec3 offset = glm::dvec3(light.position) - position;
    const double distance = glm::length(offset);
    const glm::dvec3 axis = distance > 0.0 ? offset / distance : glm::dvec3(0.0, 0.0, 1.0);
    const double radius{light.radius};
    if (radius == 0.0) {
        const double factor = spot_factor(light, -axis) / (distance * distance);
        return distance > 0.0 ? std::vector<LightSample>{{axis, distance, factor * intensity}}
                              : std::vector<LightSample>{};
    }
    // From outside, the sphere fills a cone whose sine is radius over distance; from inside, everything.
    const bool outside = distance >= radius;
    const double sine = outside ? radius / distance : 1.0;
    const double height = outside ? sine * sine / (1.0 + std::sqrt(1.0 - sine * sine)) : 2.0; // 1 - cos, no rounding
    // Its radiance is constant, and the disk that it shows from afar has the intensity that is asked for.
    const glm::dvec3 radiance = intensity / (std::numbers::pi * radius * radius);
    const double solid_angle = 2.0 * std::numbers::pi * height / double(per_axis * per_axis); // of each sample
    const Plane plane(axis);
    std::vector<LightSample> samples;
    for (const glm::dvec2 &square : strata(per_axis)) {
        const glm::dvec3 towards = on_cap(axis, plane, height, concentric(square));
        const double along = glm::dot(offset, towards);
        const double half_chord = std::sqrt(std::max(0.0, along * along - distance * distance + radius * radius));
        samples.push_back({towards, outside ? along - half_chord : along + half_chord,
                           spot_factor(light, -towards) * solid_angle * radiance});
    }
    return samples;
}

// What the spread leaves of the light at a cosine to the way that the light faces. The blades of a honeycomb in front
// of a lamp hide a share of it that grows with the tangent.
double spread_factor(const Light &light, double cosine) {
    if (light.spread >= std::numbers::pi_v<float>) {
        return 1.0;
    }
    const double tangent = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
    return std::max(0.0, 1.0 - tangent / std::tan(0.5 * double{light.spread}));
}

std::vector<LightSample> area_samples(const Light &light, const glm::dvec3 &position, unsigned per_axis) {
    const bool ellipse = light.kind == Light::Kind::ELLIPSE;
    const glm::dvec3 across(light.across), up(light.up), facing = glm::normalize(glm::dvec3(light.direction));
    const double area = (ellipse ? std::numbers::pi : 4.0) * glm::length(across) * glm::length(up);
    std::vector<LightSample> samples;
    for (const glm::dvec2 &square : strata(per_axis)) {
        const glm::dvec2 point = ellipse ? concentric(square) : square;
        const glm::dvec3 offset = glm::dvec3(light.position) + point.x * across + point.y * up - position;
        const double distance = glm::length(offset);
        if (distance == 0.0) {
            continue;
        }
        const glm::dvec3 towards = offset / distance;
        const double cosine = -glm::dot(facing, towards);
        const double factor = cosine > 0.0 ? cosine * spread_factor(light, cosine) : 0.0;
        const double part = area / double(per_axis * per_axis);
        samples.push_back({towards, distance, factor * part / (distance * distance) * glm::dvec3(light.strength)});
    }
    return samples;
}

// A triangle from the unit square, area to area: sides of a parallelogram, of which one half is folded onto the other.
glm::dvec3 in_triangle(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c, glm::dvec2 unit) {
    if (unit.x + unit.y > 1.0) {
        unit = 1.0 - unit;
    }
    return a + unit.x * (b - a) + unit.y * (c - a);
}

// Two triangles, each in as many parts, on both sides.
std::vector<LightSample> polygon_samples(const Light &light, const glm::dvec3 &position, unsigned per_axis) {
    const std::array<glm::dvec3, 4> p{light.corners[0], light.corners[1], light.corners[2], light.corners[3]};
    std::vector<LightSample> samples;
    for (std::size_t corner = 1; corner < 3; ++corner) {
        const glm::dvec3 across = glm::cross(p[corner] - p[0], p[corner + 1] - p[0]);
        const double part = 0.5 * glm::length(across) / double(per_axis * per_axis);
        if (part == 0.0) {
            continue;
        }
        for (const glm::dvec2 &square : strata(per_axis)) {
            const glm::dvec3 offset = in_triangle(p[0], p[corner], p[corner + 1], 0.5 * square + 0.5) - position;
            const double distance = glm::length(offset);
            if (distance == 0.0) {
                continue;
            }
            const double cosine = std::abs(glm::dot(glm::normalize(across), offset / distance));
            const glm::dvec3 irradiance = cosine * part / (distance * distance) * glm::dvec3(light.strength);
            samples.push_back({offset / distance, distance, irradiance});
        }
    }
    return samples;
}

} // namespace

glm::dvec3 sky_radiance(const SkyImage &image, const glm::dvec3 &towards) {
    const double u = 0.5 - std::atan2(towards.y, towards.x) / (2.0 * std::numbers::pi);
    const double v = std::acos(std::clamp(towards.z / glm::length(towards), -1.0, 1.0)) / std::numbers::pi;
    const double x = u * image.width - 0.5, y = v * image.height - 0.5;
    const auto texel = [&image](double column, double row) {
        const bool beyond = row < 0.0 || row >= image.height; // a pole: there lies the other half of its row
        const int width = image.width, there = static_cast<int>(column) + (beyond ? width / 2 : 0);
        return glm::dvec3(
            image.at((there % width + width) % width, std::clamp(static_cast<int>(row), 0, image.height - 1)));
    };
    const double left = std::floor(x), top = std::floor(y);
    const auto along = [&](double row) { return glm::mix(texel(left, row), texel(left + 1.0, row), x - left); };
    return glm::mix(along(top), along(top + 1.0), y - top);
}

std::vector<LightSample> light_samples(const Light &light, const glm::dvec3 &position, unsigned per_axis) {
    switch (light.kind) {
    case Light::Kind::SUN:
        return sun_samples(light, per_axis);
    case Light::Kind::SPHERE:
        return sphere_samples(light, position, per_axis);
    case Light::Kind::RECTANGLE:
    case Light::Kind::ELLIPSE:
        return area_samples(light, position, per_axis);
    case Light::Kind::POLYGON:
        return polygon_samples(light, position, per_axis);
    case Light::Kind::SKY:
        return sky_samples(light, per_axis);
    }
    return {};
}

} // namespace sfumato::reference
