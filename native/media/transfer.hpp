// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions: extinction and emission of smoke as functions of one number s.
#pragma once

#include "text/preintegration_text.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace sfumato {

// What a unit of length emits, RGB, and extinction per unit of length, the last number.
using Emitted = glm::dvec4;

// A transfer function as it is given. Below the first stop and from the last on it is what it is there.
struct Ramp {
    std::vector<double> stops; // one at least, each above the one before
    std::vector<double> extinction;
    // Associated: the emission; else the radiance of the smoke where it is opaque, of which the product with the
    // extinction is the emission.
    std::vector<glm::dvec3> colour;
    bool linear = true; // else the value of a stop holds up to the next
    bool associated = true;

    bool operator==(const Ramp &) const = default;
};

class TransferFunction {
public:
    using Text = text::PreintegrationText<double>;

    explicit TransferFunction(Ramp given);

    [[nodiscard]] const Ramp &ramp() const { return given; }
    [[nodiscard]] Emitted at(double s) const { return at(part_of(s), s); }
    // From the first stop to s: exact, linear or constant. Negative below the first stop.
    [[nodiscard]] Emitted integral(double s) const;
    // Over all between two values, in either order; at a value where they are one.
    [[nodiscard]] Emitted mean(double a, double b) const;

    // Parts end at the stops: 0 lies before the first one, and so on.
    [[nodiscard]] std::size_t part_of(double s) const;
    [[nodiscard]] double clamped(std::size_t part, double s) const; // to the part
    // Beyond its ends a part goes on as its own polynomial.
    [[nodiscard]] Emitted at(std::size_t part, double s) const;
    // A stretch of a ray on which s goes from `front` to `back`, both in one part.
    [[nodiscard]] Text::Stretch stretch(std::size_t part, double front, double back, double length) const;

private:
    // first + gain u + bow u (1 - u), where u goes from 0 at `from` to 1 at `from + width`.
    struct Part {
        double from = 0.0, width = 1.0;
        Emitted first{0.0}, gain{0.0}, bow{0.0};
        Emitted before{0.0}; // the integral up to `from`
    };

    Ramp given;
    std::vector<Part> parts;
};

// Radiance, and the transmittance of what it came through.
using Sent = glm::dvec4;

inline Sent before(const Sent &front, const Sent &behind) {
    return {glm::dvec3(front) + front.w * glm::dvec3(behind), front.w * behind.w};
}
constexpr Sent CLEAR{0.0, 0.0, 0.0, 1.0};

// A stretch cut into as many pieces as its bend asks for.
Sent sent_by(const TransferFunction::Text::Stretch &stretch);

// A stretch on which s is linear: cut at every stop that it meets.
Sent sent_by(const TransferFunction &transfer, double front, double back, double length);

// The values between which two transfer functions differ; nothing, first above second, where they do not.
std::pair<double, double> difference(const Ramp &a, const Ramp &b);

} // namespace sfumato
