// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp's and a sun's light in air, along single rays.
#include "media/airlight.hpp"

#include "module/parts.hpp"
#include "module/rays.hpp"
#include "reference/airlight.hpp"

#include <numbers>

#include <glm/geometric.hpp>
#include <pybind11/stl.h>

namespace sfumato {
namespace {

using namespace arguments;

constexpr double FURTHEST = 1e9; // metres

// From places to places, alike in shape, (..., 3).
struct Ways {
    Ways(const py::object &given_start, const py::object &given_end)
        : start(any_array(given_start, "start")), end(any_array(given_end, "end")), shape(batch_of(start, "start")) {
        if (last_axis(start) != 3) {
            throw py::value_error("start has shape " + shape_of(start) + ", but its last axis must be 3");
        }
        if (end.ndim() != start.ndim() || !std::equal(end.shape(), end.shape() + end.ndim(), start.shape())) {
            throw py::value_error("end has shape " + shape_of(end) + ", but must have that of start, " +
                                  shape_of(start));
        }
        require_range(start, -FURTHEST, FURTHEST, "start");
        require_range(end, -FURTHEST, FURTHEST, "end");
    }

    // A number for each of them.
    template <typename Number, typename Sent>
    [[nodiscard]] py::array_t<Number> each(const Sent &sent) const {
        const auto point = [](const double *p) { return glm::dvec3(p[0], p[1], p[2]); };
        std::vector<Number> out(product(shape));
        {
            const double *from = start.data(), *to = end.data();
            const py::gil_scoped_release unlocked;
            for (Number &number : out) {
                number = sent(point(from), point(to));
                from += 3;
                to += 3;
            }
        }
        return to_numpy(std::move(out), shape);
    }

    Doubles start, end;
    std::vector<py::ssize_t> shape;
};

glm::dvec3 place_of(const Doubles &given, const std::string &name) {
    require_shape(given, {3}, name);
    require_range(given, -FURTHEST, FURTHEST, name);
    return {given.data()[0], given.data()[1], given.data()[2]};
}

glm::dvec3 direction_of(const Doubles &given, const std::string &name) {
    const glm::dvec3 direction = place_of(given, name);
    if (!(glm::length(direction) > 0.0)) {
        throw py::value_error(name + " is (0, 0, 0), but must have a length");
    }
    return glm::normalize(direction);
}

ScatteringAir air_of(double extinction, double anisotropy, const std::string &phase, double scale_height,
                     double ground) {
    require_range(extinction, 0.0, 1e6, "extinction");
    require_range(anisotropy, -0.9999, 0.9999, "anisotropy");
    require_range(scale_height, 0.0, FURTHEST, "scale_height");
    require_range(ground, -FURTHEST, FURTHEST, "ground");
    ScatteringAir air;
    air.extinction = static_cast<float>(extinction);
    air.phase =
        static_cast<PhaseFunction>(one_of<3>(phase, {"henyey-greenstein", "cornette-shanks", "rayleigh"}, "phase"));
    air.anisotropy = static_cast<float>(anisotropy);
    air.scale_height = scale_height;
    air.ground = ground;
    return air;
}

reference::GreyAir judged(const ScatteringAir &air) {
    return {double{air.extinction},
            double{air.anisotropy},
            air.phase == PhaseFunction::RAYLEIGH,
            air.phase == PhaseFunction::CORNETTE_SHANKS,
            air.scale_height,
            air.ground};
}

AirLamp lamp_of(const Doubles &position, double radius, const Doubles &direction, double cone, double blend) {
    constexpr double TURN = 2.0 * std::numbers::pi;
    require_range(radius, 0.0, FURTHEST, "radius");
    require_range(cone, 0.0, TURN, "cone");
    require_range(blend, 0.0, 1.0, "blend");
    AirLamp lamp;
    lamp.position = place_of(position, "position");
    lamp.radius = radius;
    lamp.axis = direction_of(direction, "direction");
    lamp.cone_cosine = cone < TURN ? std::cos(0.5 * cone) : -2.0;
    lamp.blend = static_cast<float>(blend);
    return lamp;
}

py::array_t<float> lamp_light(const py::object &start, const py::object &end, const Doubles &position,
                              double extinction, double anisotropy, const std::string &phase, double scale_height,
                              double ground, double radius, const Doubles &direction, double cone, double blend,
                              int points) {
    const Ways ways(start, end);
    const AirLamp lamp = lamp_of(position, radius, direction, cone, blend);
    const ScatteringAir air = air_of(extinction, anisotropy, phase, scale_height, ground);
    require_range(points, 1, 64, "points");
    const std::vector<GaussPoint> gauss = gauss_points(static_cast<std::size_t>(points));
    return ways.each<float>(
        [&](const glm::dvec3 &from, const glm::dvec3 &to) { return airlight(from, to, lamp, air, gauss); });
}

py::array_t<double> judged_lamp_light(const py::object &start, const py::object &end, const Doubles &position,
                                      double extinction, double anisotropy, const std::string &phase,
                                      double scale_height, double ground, double radius, const Doubles &direction,
                                      double cone, double blend) {
    const Ways ways(start, end);
    const AirLamp lamp = lamp_of(position, radius, direction, cone, blend);
    const reference::GreyAir air = judged(air_of(extinction, anisotropy, phase, scale_height, ground));
    const reference::Lamp same{lamp.position, lamp.radius, lamp.axis, lamp.cone_cosine, double{lamp.blend}};
    return ways.each<double>(
        [&](const glm::dvec3 &from, const glm::dvec3 &to) { return reference::airlight(from, to, same, air); });
}

AirPlate plate_of(const Doubles &position, const Doubles &across, const Doubles &up, double spread) {
    require_range(spread, 1e-3, std::numbers::pi, "spread");
    const AirPlate plate{place_of(position, "position"), place_of(across, "across"), place_of(up, "up"), spread};
    if (!(glm::length(glm::cross(plate.across, plate.up)) > 0.0)) {
        throw py::value_error("up has no part at right angles to across: the plate has no area");
    }
    return plate;
}

py::array_t<float> plate_light(const py::object &start, const py::object &end, const Doubles &position,
                               const Doubles &across, const Doubles &up, double extinction, double anisotropy,
                               const std::string &phase, double scale_height, double ground, double spread,
                               double error) {
    const Ways ways(start, end);
    const AirPlate plate = plate_of(position, across, up, spread);
    const ScatteringAir air = air_of(extinction, anisotropy, phase, scale_height, ground);
    require_range(error, 0.0, 1.0, "error");
    const std::vector<GaussPoint> gauss = gauss_points(16);
    return ways.each<float>([&](const glm::dvec3 &from, const glm::dvec3 &to) {
        return airlight(from, to, plate, air, gauss, static_cast<float>(error)).sent;
    });
}

py::array_t<double> judged_plate_light(const py::object &start, const py::object &end, const Doubles &position,
                                       const Doubles &across, const Doubles &up, double extinction, double anisotropy,
                                       const std::string &phase, double scale_height, double ground, double spread) {
    const Ways ways(start, end);
    const AirPlate plate = plate_of(position, across, up, spread);
    const reference::Plate same{plate.position, plate.across, plate.up, plate.spread};
    const reference::GreyAir air = judged(air_of(extinction, anisotropy, phase, scale_height, ground));
    return ways.each<double>(
        [&](const glm::dvec3 &from, const glm::dvec3 &to) { return reference::airlight(from, to, same, air); });
}

py::array_t<float> sun_light(const py::object &start, const py::object &end, const Doubles &direction,
                             double extinction, double anisotropy, const std::string &phase, double scale_height,
                             double ground) {
    const Ways ways(start, end);
    const glm::dvec3 towards = -direction_of(direction, "direction");
    const ScatteringAir air = air_of(extinction, anisotropy, phase, scale_height, ground);
    return ways.each<float>(
        [&](const glm::dvec3 &from, const glm::dvec3 &to) { return sunlight(from, to, towards, air); });
}

py::array_t<double> judged_sun_light(const py::object &start, const py::object &end, const Doubles &direction,
                                     double extinction, double anisotropy, const std::string &phase,
                                     double scale_height, double ground) {
    const Ways ways(start, end);
    const glm::dvec3 towards = -direction_of(direction, "direction");
    const reference::GreyAir air = judged(air_of(extinction, anisotropy, phase, scale_height, ground));
    return ways.each<double>(
        [&](const glm::dvec3 &from, const glm::dvec3 &to) { return reference::sunlight(from, to, towards, air); });
}

} // namespace

void bind_airlight(py::module_ &m) {
    m.def(
        "airlight", &lamp_light, py::arg("start"), py::arg("end"), py::arg("position"), py::arg("extinction"),
        py::arg("anisotropy") = 0.0, py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0,
        py::arg("ground") = 0.0, py::arg("radius") = 0.0, py::arg("direction") = std::array<double, 3>{0.0, 0.0, -1.0},
        py::arg("cone") = 2.0 * std::numbers::pi, py::arg("blend") = 0.0, py::arg("points") = 16,
        R"((...) float32: radiance that air sends from the ways start (..., 3) to end (..., 3), metres, to their starts, lit by
a lamp at position (3,) of intensity 1 W/sr without shadows, for a scattering of 1 per metre.

extinction, per metre; phase function "henyey-greenstein", "cornette-shanks" or "rayleigh". With a scale_height, metres,
extinction and scattering are those at the height `ground` times exp(-(z - ground) / scale_height), else the same everywhere.
The lamp is a sphere of this radius, in which the light comes from everywhere; a spot shines along direction (3,) into
a cone of the whole angle `cone`, radians, over whose share `blend` it fades in. Light scattered once, by so many
`points` of each part of a way that a lamp's surface or a cone's edge cuts off: 16 are off by 3e-4 of a point light at
most, for anisotropies of -.98 to .999 and optical depths of .1 to 200.

>>> round(float(airlight([0, 0, 0], [8, 0, 0], position=(4, 3, 0), extinction=0.1, anisotropy=0.8)), 5)
0.00888
)");
    m.def(
        "airlight_of_plate", &plate_light, py::arg("start"), py::arg("end"), py::arg("position"), py::arg("across"),
        py::arg("up"), py::arg("extinction"), py::arg("anisotropy") = 0.0, py::arg("phase") = "henyey-greenstein",
        py::arg("scale_height") = 0.0, py::arg("ground") = 0.0, py::arg("spread") = std::numbers::pi,
        py::arg("error") = 1e-3,
        R"((...) float32: the same of a rectangle with half axes across (3,) and up (3,), metres, of radiance 1 W/(m^2 sr),
that shines along their cross product into an angle `spread`, radians: as 16 to 256 points, which are enough where the
last doubling along both axes changed no more than `error` of what is sent.

>>> plate = dict(position=(0, 0, 2), across=(0.5, 0, 0), up=(0, -0.5, 0))
>>> round(float(airlight_of_plate([0, -4, 0], [0, 4, 0], **plate, extinction=0.1)), 4)
0.0368
)");
    m.def(
        "sunlight", &sun_light, py::arg("start"), py::arg("end"), py::arg("direction"), py::arg("extinction"),
        py::arg("anisotropy") = 0.0, py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0,
        py::arg("ground") = 0.0,
        R"((...) float32: the same of a sun that shines along direction (3,) with an irradiance of 1 W/m^2, in closed form.

Even air is endless and does not dim it: the irradiance is what arrives. With a scale_height the sun is dimmed by the air
above each place.

>>> round(float(sunlight([0, 0, 0], [8, 0, 0], (0, 0, -1), extinction=0.1)), 5)  # (1 - exp(-.8)) / .1 / 4 pi
0.43821
)");
}

void bind_reference_airlight(py::module_ &m) {
    m.def(
        "airlight", &judged_lamp_light, py::arg("start"), py::arg("end"), py::arg("position"), py::arg("extinction"),
        py::arg("anisotropy") = 0.0, py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0,
        py::arg("ground") = 0.0, py::arg("radius") = 0.0, py::arg("direction") = std::array<double, 3>{0.0, 0.0, -1.0},
        py::arg("cone") = 2.0 * std::numbers::pi, py::arg("blend") = 0.0,
        R"((...): what airlight() approximates, by adaptive quadrature along the ways and over the cap of the lamp that each
place sees.

>>> reference.airlight([0, 0, 0], [8, 0, 0], position=(4, 3, 0), extinction=0.1, anisotropy=0.8).round(5).tolist()
0.00888
)");
    m.def("airlight_of_plate", &judged_plate_light, py::arg("start"), py::arg("end"), py::arg("position"),
          py::arg("across"), py::arg("up"), py::arg("extinction"), py::arg("anisotropy") = 0.0,
          py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0, py::arg("ground") = 0.0,
          py::arg("spread") = std::numbers::pi,
          R"((...): what airlight_of_plate() approximates, by adaptive quadrature over the plate at each place of a way.

>>> plate = dict(position=(0, 0, 2), across=(0.5, 0, 0), up=(0, -0.5, 0))
>>> round(float(reference.airlight_of_plate([0, -4, 0], [0, 4, 0], **plate, extinction=0.1)), 4)
0.0368
)");
    m.def(
        "sunlight", &judged_sun_light, py::arg("start"), py::arg("end"), py::arg("direction"), py::arg("extinction"),
        py::arg("anisotropy") = 0.0, py::arg("phase") = "henyey-greenstein", py::arg("scale_height") = 0.0,
        py::arg("ground") = 0.0,
        R"((...): what sunlight() has in closed form, by adaptive quadrature of the density along the way and to the sun.

>>> reference.sunlight([0, 0, 0], [8, 0, 0], direction=(0, 0, -1), extinction=0.1).round(5).tolist()
0.43821
)");
}

} // namespace sfumato
