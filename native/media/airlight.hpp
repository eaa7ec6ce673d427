// SPDX-License-Identifier: GPL-3.0-or-later
// What air scatters of a lamp's light along a ray, unshadowed: one ray at a time, for the console and for tests, from
// the text that frames use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

// Of an integral over (0, 1), exact for polynomials up to twice as many degrees as there are points, less one.
struct GaussPoint {
    float place = 0.5F, weight = 1.0F;
};
std::vector<GaussPoint> gauss_points(std::size_t count);

enum class PhaseFunction : std::uint8_t { HENYEY_GREENSTEIN, CORNETTE_SHANKS, RAYLEIGH };

struct ScatteringAir {
    float extinction = 0.0F; // per metre, at the height `ground`
    PhaseFunction phase = PhaseFunction::HENYEY_GREENSTEIN;
    float anisotropy = 0.0F;
    double scale_height = 0.0, ground = 0.0; // along +Z; a scale height of 0: even air
};

// A sphere that shines evenly, of intensity 1, and a spot where its cone is narrower than everything.
struct AirLamp {
    glm::dvec3 position{0.0};
    double radius = 0.0;
    glm::dvec3 axis{0.0, 0.0, -1.0}; // unit length
    double cone_cosine = -2.0; // of its edge; -2 for no spot. A wider one than a half-space is not cut at its edge.
    float blend = 0.0F;        // as in Light
};

// Radiance that reaches `from` from the way to `to`, for a scattering of 1 per metre where the
// density is 1. So many points for each part of the way that a cone's edge or a lamp's surface cuts off. In the
// lamp's sphere the light comes from everywhere, as much as on its surface, and has no way behind it.
float airlight(const glm::dvec3 &from, const glm::dvec3 &to, const AirLamp &lamp, const ScatteringAir &air,
               std::span<const GaussPoint> points);

// A rectangle that shines along the cross product of its half axes, of radiance 1 where it is brightest.
struct AirPlate {
    glm::dvec3 position{0.0};
    glm::dvec3 across{0.5, 0.0, 0.0}, up{0.0, 0.5, 0.0};
    double spread = 3.141592653589793; // as in Light
};

struct PlateLight {
    float sent = 0.0F;
    std::size_t points = 0; // on the plate
};

// The same of a plate, as so many points of it that four times fewer would make a difference of no more than `error` of
// what is sent, from 16 to 256.
PlateLight airlight(const glm::dvec3 &from, const glm::dvec3 &to, const AirPlate &plate, const ScatteringAir &air,
                    std::span<const GaussPoint> points, float error);

// Of a sun of irradiance 1, which stands in the unit direction `towards`; even air does not dim it.
float sunlight(const glm::dvec3 &from, const glm::dvec3 &to, const glm::dvec3 &towards, const ScatteringAir &air);

} // namespace sfumato
