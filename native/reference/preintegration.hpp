// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke whose extinction and emission are functions of one number, in double precision and without a table.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace sfumato {

struct Medium; // scene/scene.hpp

} // namespace sfumato

namespace sfumato::reference {

// Beyond its first and last stop it goes on as it is there.
struct Ramp {
    std::span<const double> stops; // rising
    std::span<const double> extinction;
    std::span<const glm::dvec3> colour; // the emission; or what times the extinction is the emission
    bool linear = true;                 // else the value of a stop holds up to the next
    bool associated = true;

    // Emission and extinction at a value.
    [[nodiscard]] glm::dvec4 operator()(double s) const;
};

// What a length of smoke sends to the eye, radiance and transmittance, where the value goes straight from `front` to
// `back`: Simpson's rule in `intervals` parts between any two stops, extinction and emission alike.
glm::dvec4 sent(const Ramp &ramp, double front, double back, double length, int intervals = 400);

// Of the segment from `from` to `to`, where the value is the medium's density: straight lines between so many points of
// each cell's cubic.
glm::dvec4 sent_along(const Ramp &ramp, const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to,
                      int points = 256);

// The table of the first, `entries` values from `low` to `high` in front and behind, in the plainest way: each entry by
// itself, slab by slab, in each of which extinction and emission are what they are in its middle. (front, back).
std::vector<glm::dvec4> table(const Ramp &ramp, double low, double high, int entries, double length);

} // namespace sfumato::reference
