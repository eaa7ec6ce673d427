// SPDX-License-Identifier: GPL-3.0-or-later
// The light of lamps and suns in air, in double precision and by quadrature alone.
#pragma once

#include <functional>

#include <glm/vec3.hpp>

namespace sfumato::reference {

// The integral of a function over [from, to] by Gauss' rule of seven points, of which each half is again cut in two
// until both rules agree within `error` of what they give together for the whole, or within as much of `floor`. Where
// the function may be narrow, cut it there.
double integral(const std::function<double(double)> &of, double from, double to, double error = 1e-10,
                double floor = 0.0);

struct GreyAir {
    double extinction = 0.0; // per metre, at the height `ground`
    double anisotropy = 0.0;
    bool rayleigh = false, cornette_shanks = false; // else Henyey and Greenstein's phase function
    double scale_height = 0.0, ground = 0.0;        // density exp(-(z - ground) / scale_height); a height of 0: even
};

struct Lamp {
    glm::dvec3 position{0.0};
    double radius = 0.0;
    glm::dvec3 axis{0.0, 0.0, -1.0};
    double cone_cosine = -2.0; // no spot
    double blend = 0.0;
};

double phase(const GreyAir &air, double cos_theta);

// Metres of air of density 1 between two places.
double column(const GreyAir &air, const glm::dvec3 &from, const glm::dvec3 &to);

// What reaches `from` of a lamp of intensity 1, scattered once on the way to `to` by air that scatters 1 per metre
// where its density is 1. A lamp with a radius is a sphere of even radiance, of which each place sees a cap; places in
// it have from everywhere what its surface has.
double airlight(const glm::dvec3 &from, const glm::dvec3 &to, const Lamp &lamp, const GreyAir &air);

// A rectangle of radiance 1 along the cross product of its half axes, which a grid narrows to an angle `spread`: in a
// direction at an angle a to that, 1 - tan(a) / tan(spread / 2) of it is left.
struct Plate {
    glm::dvec3 position{0.0};
    glm::dvec3 across{0.5, 0.0, 0.0}, up{0.0, 0.5, 0.0};
    double spread = 3.141592653589793;
};

// Likewise, by quadrature over the plate at each place; within 1e-4.
double airlight(const glm::dvec3 &from, const glm::dvec3 &to, const Plate &plate, const GreyAir &air);

// Of a sun of irradiance 1 in the unit direction `towards`, which air that is not even dims.
double sunlight(const glm::dvec3 &from, const glm::dvec3 &to, const glm::dvec3 &towards, const GreyAir &air);

} // namespace sfumato::reference
