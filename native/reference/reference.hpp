// SPDX-License-Identifier: GPL-3.0-or-later
// The judge: the answers that the methods approximate, in double precision, as plainly as the textbook states them.
// It shares scene.hpp with the methods and nothing else, so that a mistake in one cannot excuse itself in the other.
// Everything takes a valid scene and is slow: every ray visits every triangle and every cell in its way.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace sfumato {

struct Air; // scene/scene.hpp
struct Camera;
struct Light;
struct Medium;
struct Particles;
struct Scene;
struct SkyImage;

} // namespace sfumato

namespace sfumato::reference {

constexpr double ENDLESS = std::numeric_limits<double>::infinity();

// ---- Smoke (reference_medium.cpp) ----

// Density at a point in world space: trilinear between the cell centres, where samples off the grid are zero. So it
// fades to zero over the half cell inside and the half cell outside each face of the grid.
double density(const Medium &medium, const glm::dvec3 &world);
// The scattering coefficient there, per metre.
glm::dvec3 scattering(const Medium &medium, const glm::dvec3 &world);

// What the smoke there sends by itself into each direction, per metre.
glm::dvec3 emission(const Medium &medium, const glm::dvec3 &world);

// Where the segment from `from` (0) to `to` (1) crosses planes through cell centres, in order, both ends included.
// Between two neighbours in this list the density is one polynomial, a cubic in the distance.
std::vector<double> cell_crossings(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to);

// The integral of the density along the segment, in metres times density. Exact but for rounding.
double column(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to);

// The part of the light that crosses the smoke between two points, for each colour: Beer and Lambert.
glm::dvec3 transmittance(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &to);

// The same through all of them, wherever they overlap: the product of their parts.
glm::dvec3 transmittance(std::span<const Medium> media, const glm::dvec3 &from, const glm::dvec3 &to);

// The same through one, for a ray that leaves `from` in the unit direction `towards` and never ends.
glm::dvec3 transmittance_to_infinity(const Medium &medium, const glm::dvec3 &from, const glm::dvec3 &towards);

// ---- Particles (particles.cpp) ----

// What one particle takes at a point, per metre in the strongest colour: its optical depth through the middle, of
// -ln(1 - opacity), is 4/3 R times that in its middle, from where it falls as 1 - (r / R)^2. An opacity of 1 is taken
// for 1 - 2^-20.
double extinction(const Particles &particles, std::size_t index, const glm::dvec3 &world);
// All of them, in each colour: what they scatter, per metre.
glm::dvec3 scattering(const Particles &particles, const glm::dvec3 &world);

// Where along the segment from `from` (0) to `to` (1) a particle begins and ends, in order, for all that are met.
std::vector<double> crossings(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to);

// The integral of the extinction along the segment, in each colour. Exact but for rounding.
glm::dvec3 optical_depth(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to);
glm::dvec3 transmittance(const Particles &particles, const glm::dvec3 &from, const glm::dvec3 &to);

// ---- Air (world_air.cpp) ----

glm::dvec3 transmittance(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to);
// Towards a sun, whose irradiance is that which arrives: even air of the world lets all of it through, and air that
// ends with height what is left by that above.
glm::dvec3 transmittance_to_infinity(const Air &air, const glm::dvec3 &from, const glm::dvec3 &towards);
// What it scatters there at an angle, per metre and steradian, of light of irradiance 1; and what it emits, per metre.
glm::dvec3 scattered(const Air &air, const glm::dvec3 &world, double cos_theta);
glm::dvec3 emission(const Air &air, const glm::dvec3 &world);

// ---- Air in a closed mesh (fog.cpp) ----

// How often the mesh winds around a point, in one of its places, whichever way: 1 inside.
double winding(const Air &air, std::size_t place, const glm::dvec3 &world);
// How many of its places hold a point.
double places_around(const Air &air, const glm::dvec3 &world);
// Where along the segment from `from` (0) to `to` (1) it crosses a wall, in order.
std::vector<double> crossings(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to);
// The way inside along it, metres, as often as places overlap. Exact but for rounding.
double way_inside(const Air &air, const glm::dvec3 &from, const glm::dvec3 &to);

// Through all smoke, particles and air.
glm::dvec3 transmittance(const Scene &scene, const glm::dvec3 &from, const glm::dvec3 &to);

// Henyey and Greenstein (1941), per steradian. cos_theta is the cosine between the directions in which the light
// travels before and after it scatters, and g in (-1, 1) is its mean.
double henyey_greenstein(double cos_theta, double g);

// A surface without thickness that crosses a ray at `depth` and lets 1 - alpha of the light through.
struct Fragment {
    double depth = 0.0;
    double alpha = 0.0;
};

// The part of the light left behind every fragment with depth <= d. Their order does not matter.
double transmittance(std::span<const Fragment> fragments, double d);

// ---- Hair (strand.cpp) ----

// A dielectric cylinder: Chiang, Bitterli, Tappan and Burley, "A practical and controllable hair and fur model for
// production path tracing", 2016.
struct Strand {
    glm::dvec3 absorption{0.0};                                // optical depth of a radius
    double longitudinal = 0.3, azimuthal = 0.3, primary = 0.3; // roughness, of the last that which is reflected at once
    double tilt = 0.0;                                         // of the cuticle's scales, radians
    double index = 1.55;
};

// What it sends to the eye where it is met at h in (-1, 1), of light of irradiance 1: elevations over the plane across
// the strand, radians, and the angle around it from the eye to the light.
glm::dvec3 sent(const Strand &strand, double h, double eye, double light, double around);

// ---- Lights (reference_light.cpp) ----

// A part of a light, as seen from a point.
struct LightSample {
    glm::dvec3 towards{0.0};    // the unit direction from the point to the light
    double distance = ENDLESS;  // to the light, metres
    glm::dvec3 irradiance{0.0}; // unoccluded, W/m^2, on a surface there that faces the direction; smoke has no face,
                                // and this is its fluence
};

// per_axis squared parts of a light, or one when it has no extent. Each stands for an equal part of a sun's disk, of
// the solid angle of a sphere (seen from inside: of all directions), and of the area of a rectangle, an ellipse or a
// triangle; a polygon is two of those. These are midpoints: one is the centre, and close to a large light it takes
// many. A part at `position` itself is left out.
// Of an equirectangular picture in a direction.
glm::dvec3 sky_radiance(const SkyImage &image, const glm::dvec3 &towards);
std::vector<LightSample> light_samples(const Light &light, const glm::dvec3 &position, unsigned per_axis);

// ---- Surfaces (reference_surface.cpp) ----

// What a ray meets first.
struct Hit {
    double distance = 0.0; // along the ray, metres
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0}; // the corner normals, interpolated, for the side of the triangle that the eye sees
    glm::dvec3 face{0.0};   // the triangle's own normal, on that side
    glm::dvec3 albedo{0.0};
};

// The first triangle on the ray from `origin` in the unit direction `direction`, no further than `reach` metres.
std::optional<Hit> first_hit(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &direction, double reach);

// Whether a triangle stands between `origin` and the point `distance` metres away in the unit direction `towards`. Both
// of them may lie on triangles.
bool occluded(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards, double distance = ENDLESS);

// The part of the light from that point that reaches `origin`: past the solids and through the smoke.
glm::dvec3 visibility(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards,
                      double distance = ENDLESS);

// Radiance that leaves a diffuse surface (Lambert) in the light of all lights.
glm::dvec3 reflected(const Scene &scene, const Hit &hit, unsigned samples_per_axis);

// ---- Images (reference.cpp) ----

struct Settings {
    unsigned sun_samples_per_axis = 8;   // of each light, the sun or any other, as seen from a surface
    double step = 0.01;                  // metres, the longest step along a view ray: well below the size of a cell
    unsigned light_samples_per_axis = 1; // of each light, as seen from the smoke; 1: its centre
};

// The image of the scene with single scattering, and what smoke emits: width x height pixels from the lower left, one
// ray through the centre of each. RGB is radiance, premultiplied. Alpha is 1 on a surface, elsewhere what the smoke
// keeps from the background, averaged over the colours. The eye sees no lights. Throws std::invalid_argument for
// settings that cannot be used.
std::vector<glm::dvec4> render(const Scene &scene, const Camera &camera, unsigned width, unsigned height,
                               const Settings &settings);

} // namespace sfumato::reference
