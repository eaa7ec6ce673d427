// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/light.hpp"

#include "maps/body.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

// Half the angle at which smoke sees a light, at most.
double half_angle(const LightView &light, const Ball &ball, double cell) {
    const double distance = glm::distance(ball.middle, glm::dvec3(light.position)) - ball.radius;
    return double{light.radius} / (light.kind == Light::Kind::SUN ? 1.0 : std::max(distance, cell));
}

// A lattice of `count` points that share the square [-1, 1]^2 evenly (Fibonacci's), each with its mirror image, so that
// the middle of them is the middle of the light.
glm::dvec2 on_square(int i, int count) {
    const double from_middle = i - 0.5 * (count - 1);
    const double turn = std::numbers::phi * from_middle + 0.5;
    return 2.0 * glm::dvec2(from_middle / count, turn - std::floor(turn) - 0.5);
}

// One of `count` directions that share the sphere evenly (Fibonacci's lattice).
glm::dvec3 on_sphere(int i, int count) {
    const double height = 1.0 - (2.0 * i + 1.0) / count, angle = 2.0 * std::numbers::pi * std::numbers::phi * i;
    const double across = std::sqrt(1.0 - height * height);
    return {across * std::cos(angle), across * std::sin(angle), height};
}

// Of the eighths of the sphere between the planes of the world's axes: the horizon, which parts most skies, is one.
constexpr int OCTANTS = 8;
int octant_of(const glm::dvec3 &towards) {
    return (towards.x < 0.0 ? 1 : 0) + (towards.y < 0.0 ? 2 : 0) + (towards.z < 0.0 ? 4 : 0);
}

// The unit vector on the side of `axis`, another, whose part across it is given.
glm::dvec3 on_dome(const glm::dvec3 &axis, const glm::dvec3 &across) {
    return across + axis * std::sqrt(std::max(1.0 - glm::dot(across, across), 0.0));
}

} // namespace

glm::dmat3 axes_of(const glm::dvec3 &direction) {
    const glm::dvec3 along = glm::normalize(direction);
    const glm::dvec3 helper = std::abs(along.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 across = glm::normalize(glm::cross(helper, along));
    return {across, glm::cross(along, across), along};
}

bool meets(const LightView &light, const glm::dvec3 &sample, const Ball &ball) {
    if (light.parallel()) {
        return true;
    }
    const glm::dvec3 across = ball.middle - sample;
    const double distance = glm::length(across), along = glm::dot(across, glm::dvec3(light.direction));
    if (light.kind == Light::Kind::POLYGON) {
        return true;
    }
    if (light.kind != Light::Kind::SPHERE) {
        return along > -ball.radius;
    }
    if (light.cone_cosine <= -1.0F || light.oval || distance <= ball.radius) {
        return true;
    }
    const double cone = std::acos(std::clamp(double{light.cone_cosine}, -1.0, 1.0));
    return std::acos(std::clamp(along / distance, -1.0, 1.0)) - std::asin(ball.radius / distance) < cone;
}

LightView view_of(const Light &light, double cell) {
    LightView view;
    static_cast<Light &>(view) = light;
    const double least = 0.25 * cell;
    double size = 0.0;
    switch (light.kind) {
    case Light::Kind::SUN: {
        const glm::dmat3 axes = axes_of(glm::dvec3(light.direction));
        // Of a cone's projection on the plane that faces the sun, equal areas bring equal parts of the irradiance.
        const double radius = std::sin(0.5 * double{light.angle});
        view.across = glm::vec3(axes[0] * radius);
        view.up = glm::vec3(axes[1] * radius);
        view.radius = static_cast<float>(radius);
        break;
    }
    case Light::Kind::SKY:
        view.radius = 0.0F;
        break;
    case Light::Kind::SPHERE:
        view.facing2 = light.facing_disk ? light.radius * light.radius : 0.0F;
        view.cone_cosine =
            light.cone < 2.0F * std::numbers::pi_v<float> ? std::cos(0.5F * light.cone) : view.cone_cosine;
        size = double{light.radius};
        break;
    case Light::Kind::RECTANGLE:
    case Light::Kind::ELLIPSE: {
        const double edges = glm::length(glm::dvec3(light.across)) * glm::length(glm::dvec3(light.up));
        const double area = (light.kind == Light::Kind::ELLIPSE ? std::numbers::pi : 4.0) * edges;
        view.area = static_cast<float>(area);
        view.radius = static_cast<float>(std::sqrt(area / std::numbers::pi));
        view.spread_cotangent = light.spread < std::numbers::pi_v<float> ? 1.0F / std::tan(0.5F * light.spread) : 0.0F;
        size = double{view.radius};
        break;
    }
    case Light::Kind::POLYGON: {
        const glm::dvec3 a(light.corners[0]), b(light.corners[1]), c(light.corners[2]), d(light.corners[3]);
        const glm::dvec3 first = 0.5 * glm::cross(b - a, c - a), second = 0.5 * glm::cross(c - a, d - a);
        const double of_first = glm::length(first), area = of_first + glm::length(second);
        view.position = glm::vec3((a + c + glm::mix(d, b, of_first / area)) / 3.0);
        view.direction = glm::vec3(glm::normalize(first + second));
        view.area = static_cast<float>(area);
        view.radius = static_cast<float>(std::sqrt(area / std::numbers::pi));
        size = double{view.radius};
        break;
    }
    }
    view.size2 = static_cast<float>(std::max(size * size, least * least));
    return view;
}

LightView white_surroundings() {
    LightView light;
    light.kind = Light::Kind::SKY;
    light.strength = glm::vec3(4.0F * std::numbers::pi_v<float>);
    return light;
}

int sky_samples(int most) {
    return 2 * most;
}

std::vector<Light> parts_of_sky(const Light &light, const Sky *sky) {
    std::vector<Light> parts;
    for (int octant = 0; octant < OCTANTS && light.reach.smoke; ++octant) {
        Light &part = parts.emplace_back(light);
        part.octant = octant;
        part.reach.diffuse = part.reach.gloss = part.reach.plate = false;
    }
    for (const Sky::Sun &sun : sky == nullptr ? std::span<const Sky::Sun>{} : sky->suns()) {
        Light &part = parts.emplace_back();
        part.kind = Light::Kind::SUN;
        part.strength = sun.irradiance * light.gain;
        part.direction = -sun.towards;
        part.angle = sun.angle;
        part.reach = light.reach;
    }
    return parts;
}

std::vector<glm::dvec3> sky_fluence(const LightView &light, int most) {
    const int count = sky_samples(most);
    if (light.sky == nullptr) {
        return {static_cast<std::size_t>(count), glm::dvec3(light.strength) / static_cast<double>(count)};
    }
    std::vector<glm::dvec3> towards;
    for (int i = 0; i < count; ++i) {
        towards.push_back(on_sphere(i, count));
    }
    return light.sky->fluence(towards);
}

void weigh_sky(LightView &light, std::span<const glm::dvec3> fluence, std::vector<float> &shares) {
    const double gain = light.sky == nullptr ? 1.0 : double{light.gain};
    glm::dvec3 all(0.0), moment(0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < fluence.size(); ++i) {
        const glm::dvec3 towards = on_sphere(static_cast<int>(i), static_cast<int>(fluence.size()));
        if (light.octant < 0 || light.octant == octant_of(towards)) {
            const double each = (fluence[i].x + fluence[i].y + fluence[i].z) / 3.0;
            shares.push_back(static_cast<float>(each));
            all += fluence[i] * gain;
            moment += towards * each;
            sum += each;
        }
    }
    for (float &share : shares) {
        share = sum > 0.0 ? static_cast<float>(share / sum) : 0.0F;
    }
    light.shares = shares;
    light.strength = glm::vec3(all);
    const double length = glm::length(moment);
    if (light.octant >= 0 && length > 0.0) {
        light.direction = glm::vec3(-moment / length);
        light.concentration = static_cast<float>(length / sum);
    } else {
        light.concentration = 0.0F;
    }
}

double shadow_blur(const LightView &light, const Body &body) {
    const Ball ball = ball_of(body);
    // Along an axis that of a disk is half its radius. Of the plume's shadow in suns of 2 to 23 degrees, in it and on a
    // floor, half the ball's radius of air leaves the least error; no one width suits all depths.
    return 0.5 * half_angle(light, ball, body.cell_size) * 0.5 * ball.radius;
}

glm::vec3 light_point(const LightView &light, std::span<const Body> bodies, const glm::dvec2 &square) {
    const glm::dvec3 position(light.position), towards(-glm::dvec3(light.direction)), across(light.across),
        up(light.up);
    const LightsText::DiskPoint on_disk =
        LightsText().point_on_disk(static_cast<float>(square.x), static_cast<float>(square.y));
    const glm::dvec2 disk(on_disk.x, on_disk.y);
    switch (light.kind) {
    case Light::Kind::SUN:
        return on_dome(towards, across * disk.x + up * disk.y);
    case Light::Kind::SKY:
        break;
    case Light::Kind::SPHERE: {
        // The disk that the sphere shows to the smoke.
        const glm::dvec3 middle = bodies.empty() ? position + towards : ball_of(bodies.front()).middle;
        const glm::dvec3 look = middle - position;
        const glm::dmat3 axes = axes_of(glm::length(look) > 0.0 ? look : towards);
        return position + double{light.radius} * (axes[0] * disk.x + axes[1] * disk.y);
    }
    case Light::Kind::RECTANGLE:
        return position + across * square.x + up * square.y;
    case Light::Kind::ELLIPSE:
        return position + across * disk.x + up * disk.y;
    case Light::Kind::POLYGON: {
        const glm::vec2 unit(0.5 * square + 0.5);
        const auto &c = light.corners;
        return LightsText().point_on_quad(c[0], c[1], c[2], c[3], unit.x, unit.y);
    }
    }
    return light.position;
}

std::vector<glm::vec3> light_samples(const LightView &light, std::span<const Body> bodies, int most, bool in_air) {
    // How far the shadow of one point of the smoke spreads over as much air as the smoke is wide, in cells.
    double blur = in_air && bodies.empty() && light.radius > 0.0F ? 1e3 : 0.0;
    for (const Body &body : bodies) {
        const Ball ball = ball_of(body);
        blur = std::max(blur, 4.0 * half_angle(light, ball, body.cell_size) * ball.radius / body.cell_size);
    }
    // Shadows three cells apart melt into one.
    const int count = std::clamp(static_cast<int>(std::ceil(std::pow(std::min(blur / 3.0, 1e3), 2.0))), 1, most);
    std::vector<glm::vec3> samples;
    if (light.surrounds()) {
        for (int i = 0; i < sky_samples(most); ++i) {
            const glm::dvec3 towards = on_sphere(i, sky_samples(most));
            if (light.octant < 0 || light.octant == octant_of(towards)) {
                samples.emplace_back(towards);
            }
        }
        return samples;
    }
    for (int i = 0; i < count; ++i) {
        samples.push_back(light_point(light, bodies, on_square(i, count)));
    }
    return samples;
}

} // namespace sfumato
