// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/airlight.hpp"

#include "text/air_text.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

namespace sfumato {
namespace {

using Text = text::AirText<float>;

float phase_of(const ScatteringAir &air, float half_sine2, float half_cosine2) {
    switch (air.phase) {
    case PhaseFunction::CORNETTE_SHANKS:
        return Text().cornette_shanks(half_sine2, half_cosine2, air.anisotropy);
    case PhaseFunction::RAYLEIGH:
        return Text().rayleigh(half_cosine2 - half_sine2);
    case PhaseFunction::HENYEY_GREENSTEIN:
        break;
    }
    return Text().henyey_greenstein(half_sine2, half_cosine2, air.anisotropy);
}

// How much air there is along ways between two heights.
class Heights {
public:
    explicit Heights(const ScatteringAir &air)
        : inverse(air.scale_height > 0.0 ? 1.0 / air.scale_height : 0.0), ground(air.ground) {}

    // In scale heights above the ground.
    [[nodiscard]] float of(double z) const { return static_cast<float>((z - ground) * inverse); }
    [[nodiscard]] float column(double z, double end, float length) const {
        const float height = of(z);
        return Text().air_column(height, (of(end) - height) / std::max(length, 1e-20F), length);
    }
    [[nodiscard]] float climb(double slope) const { return static_cast<float>(slope * inverse); }

private:
    double inverse, ground;
};

// A lamp as a ray passes it.
class Passed {
public:
    // A cotangent of half its spread: the lamp is a piece of a plate.
    Passed(const glm::dvec3 &from, const glm::dvec3 &to, const AirLamp &passed, const ScatteringAir &scattering,
           std::optional<float> plate_spread = {})
        : lamp(passed), spread(plate_spread), air(scattering), heights(scattering), eye(from),
          length(glm::distance(from, to)), direction((to - from) / length),
          foot(glm::dot(passed.position - from, direction)),
          distance(static_cast<float>(glm::length(glm::cross(passed.position - from, direction)))),
          on_axis(glm::dot(from + foot * direction - passed.position, passed.axis)),
          along_axis(glm::dot(direction, passed.axis)),
          squeeze(Text().squeeze_of(scattering.phase == PhaseFunction::RAYLEIGH ? 0.0F : scattering.anisotropy)) {
        const double highest = std::max({from.z, to.z, passed.position.z});
        least_extinction = scattering.extinction * std::exp(-heights.of(highest));
    }

    [[nodiscard]] float sent(std::span<const GaussPoint> points) const {
        Text::RayPart whole{static_cast<float>(-foot), static_cast<float>(length - foot)};
        std::array<float, 4> kinks{whole.from, whole.from, whole.from, whole.from};
        const auto part_in_cone = [this](double cosine) {
            return Text().part_in_cone(distance, static_cast<float>(on_axis), static_cast<float>(along_axis),
                                       static_cast<float>(cosine));
        };
        if (lamp.cone_cosine >= 0.0) {
            const Text::RayPart lit = part_in_cone(lamp.cone_cosine);
            whole = {std::max(whole.from, lit.from), std::min(whole.to, lit.to)};
            const Text::RayPart bright =
                part_in_cone(lamp.cone_cosine + (1.0 - lamp.cone_cosine) * static_cast<double>(lamp.blend));
            kinks[0] = bright.from;
            kinks[1] = bright.to;
        }
        const Text::RayPart inside = Text().part_in_sphere(distance, static_cast<float>(lamp.radius));
        if (inside.from < inside.to) {
            kinks[2] = inside.from;
            kinks[3] = inside.to;
        }
        std::sort(kinks.begin(), kinks.end());
        float sum = 0.0F;
        Text::RayPart part = whole;
        for (std::size_t i = 0; i <= kinks.size() && part.from < whole.to; ++i) {
            part.to = i < kinks.size() ? std::clamp(kinks[i], part.from, whole.to) : whole.to;
            if (part.to > part.from) {
                const bool within = part.from >= inside.from && part.to <= inside.to;
                sum += within ? sent_within(part, points) : sent_outside(part, points);
                part.from = part.to;
            }
        }
        return sum;
    }

private:
    [[nodiscard]] float sent_outside(const Text::RayPart &part, std::span<const GaussPoint> points) const {
        const float until = Text().lit_until(distance, part.from, least_extinction, squeeze);
        const Text::LitStretch stretch = Text().lit_stretch(distance, part.from, std::min(part.to, until), squeeze);
        const auto radius = static_cast<float>(lamp.radius);
        float sum = 0.0F;
        for (const GaussPoint &point : points) {
            const Text::LitPoint lit = Text().lit_point(stretch, point.place);
            const float radius2 = lit.radius * lit.radius;
            const float wide = text::LightsText<float>().falloff(radius2, radius * radius) * radius2;
            const float way = radius > 0.0F ? Text().way_to_sphere(lit.radius, radius) : lit.radius;
            sum += point.weight * lit.weight * wide * phase_of(air, lit.half_sine2, lit.half_cosine2) *
                   left_at(lit.place, lit.radius, way);
        }
        return sum;
    }

    [[nodiscard]] float sent_within(const Text::RayPart &part, std::span<const GaussPoint> points) const {
        const auto radius2 = static_cast<float>(lamp.radius * lamp.radius);
        const float evenly = text::LightsText<float>().falloff(0.0F, radius2) * 0.25F * std::numbers::inv_pi_v<float>;
        float sum = 0.0F;
        for (const GaussPoint &point : points) {
            const float place = part.from + (part.to - part.from) * point.place;
            sum += point.weight * (part.to - part.from) * evenly *
                   left_at(place, std::sqrt(distance * distance + place * place), 0.0F);
        }
        return sum;
    }

    // The density there, times what air and cone leave of the light on its way there and to the eye.
    [[nodiscard]] float left_at(float place, float radius, float way) const {
        const double z = eye.z + direction.z * (foot + double{place});
        const float eye_depth = heights.column(eye.z, z, static_cast<float>(foot + double{place}));
        const float light_depth = heights.column(z, lamp.position.z, radius) * way / std::max(radius, 1e-20F);
        const auto beam = static_cast<float>(on_axis + along_axis * double{place}) / std::max(radius, 1e-20F);
        const float depth = heights.of(z) + air.extinction * (eye_depth + light_depth);
        if (spread) {
            return std::max(beam, 0.0F) * text::LightsText<float>().spread_fade(beam, *spread) * std::exp(-depth);
        }
        // Parts end at a hard edge, where rounding would put a point on either side.
        const bool faded = lamp.cone_cosine >= -1.0 && (lamp.blend > 0.0F || lamp.cone_cosine < 0.0);
        const float fade =
            faded ? text::LightsText<float>().spot_fade(beam, static_cast<float>(lamp.cone_cosine), lamp.blend) : 1.0F;
        return fade * std::exp(-depth);
    }

    const AirLamp &lamp;
    std::optional<float> spread;
    const ScatteringAir &air;
    Heights heights;
    glm::dvec3 eye;
    double length;
    glm::dvec3 direction;
    double foot;    // of the lamp on the ray, from the eye
    float distance; // of the lamp from the ray
    double on_axis; // of the foot along the spot's axis from the lamp
    double along_axis;
    float squeeze, least_extinction = 0.0F;
};

} // namespace

std::vector<GaussPoint> gauss_points(std::size_t count) {
    const auto n = static_cast<double>(count);
    std::vector<GaussPoint> points;
    for (std::size_t i = 0; i < count; ++i) {
        // Newton's steps to a zero of Legendre's polynomial, by its recurrence.
        double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5)), slope = 1.0;
        for (int step = 0; step < 8; ++step) {
            double value = 1.0, before = 0.0;
            for (std::size_t k = 1; k <= count; ++k) {
                const auto degree = static_cast<double>(k);
                const double next = ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * before) / degree;
                before = value;
                value = next;
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        points.push_back(
            {static_cast<float>(0.5 * (1.0 + x)), static_cast<float>(1.0 / ((1.0 - x * x) * slope * slope))});
    }
    return points;
}

float airlight(const glm::dvec3 &from, const glm::dvec3 &to, const AirLamp &lamp, const ScatteringAir &air,
               std::span<const GaussPoint> points) {
    return from == to ? 0.0F : Passed(from, to, lamp, air).sent(points);
}

PlateLight airlight(const glm::dvec3 &from, const glm::dvec3 &to, const AirPlate &plate, const ScatteringAir &air,
                    std::span<const GaussPoint> points, float error) {
    constexpr std::size_t MOST = 16; // along each axis
    if (from == to) {
        return {};
    }
    const glm::dvec3 area = 4.0 * glm::cross(plate.across, plate.up);
    const double tangent = std::tan(0.5 * plate.spread);
    const float cotangent = plate.spread < std::numbers::pi ? static_cast<float>(1.0 / tangent) : 0.0F;
    AirLamp piece;
    piece.axis = glm::normalize(area);
    piece.cone_cosine = std::max(std::cos(0.5 * plate.spread), 0.0);
    PlateLight light;
    for (std::size_t count = 1; count <= MOST; count *= 2) {
        const std::vector<GaussPoint> along = gauss_points(count);
        float sum = 0.0F;
        for (const GaussPoint &x : along) {
            for (const GaussPoint &y : along) {
                piece.position = plate.position + (2.0 * double{x.place} - 1.0) * plate.across +
                                 (2.0 * double{y.place} - 1.0) * plate.up;
                sum += x.weight * y.weight * Passed(from, to, piece, air, cotangent).sent(points);
            }
        }
        sum *= static_cast<float>(glm::length(area));
        const bool settled = count > 2 && sum > 0.0F && std::abs(sum - light.sent) <= error * sum;
        light = {sum, count * count};
        if (settled) {
            break;
        }
    }
    return light;
}

float sunlight(const glm::dvec3 &from, const glm::dvec3 &to, const glm::dvec3 &towards, const ScatteringAir &air) {
    const double length = glm::distance(from, to);
    if (!(length > 0.0)) {
        return 0.0F;
    }
    const Heights heights(air);
    const glm::dvec3 direction = (to - from) / length;
    const float column = heights.column(from.z, to.z, static_cast<float>(length));
    float front = 0.0F, back = air.extinction * column;
    if (air.scale_height > 0.0) {
        front += air.extinction * Text().air_column_above(heights.of(from.z), heights.climb(towards.z));
        back += air.extinction * Text().air_column_above(heights.of(to.z), heights.climb(towards.z));
    }
    const glm::dvec3 apart = 0.5 * (direction - towards), between = 0.5 * (direction + towards);
    return phase_of(air, static_cast<float>(glm::dot(apart, apart)), static_cast<float>(glm::dot(between, between))) *
           Text().lit_by_sun(column, front, back);
}

} // namespace sfumato
