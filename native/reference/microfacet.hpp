// SPDX-License-Identifier: GPL-3.0-or-later
// What microfacets reflect of an area light, by quadrature: twice, in ways that share nothing but the BRDF.
#pragma once

#include <array>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato::reference {

enum class Facets { GGX, BECKMANN, BLINN_PHONG };

// A rough surface in its own frame, z the normal, and the unit vector to the eye, above it.
// Smith's masking, height-correlated; Blinn's exponent is 2 / alpha_x^2 - 2. `index` is the index of refraction whose
// reflectance the share below follows, or 0 for Schlick's (1 - v.h)^5.
struct RoughSurface {
    Facets facets = Facets::GGX;
    double alpha_x = 0.1, alpha_y = 0.1;
    glm::dvec3 view{0.0, 0.0, 1.0};
    double index = 0.0;
};

// How much of the way from its value straight on to 1 the reflectance has risen at an angle.
double fresnel_share(double cosine, double index);

// The BRDF times n.i for F = 1 and for F = fresnel_share(v.h); zeros below the horizon.
std::array<double, 2> rough_reflection(const RoughSurface &surface, const glm::dvec3 &i);

// For a reflectance of f0 straight on, from such a pair.
inline double with_f0(double plain, double fresnel, double f0) {
    return f0 * plain + (1.0 - f0) * fresnel;
}

// Convex polygons seen from the origin, of radiance 1; ellipses by centre and half axes. A sphere looks like the
// ellipse in which its cone of tangents meets the plane through the touching circle's middle: see disk_of_sphere.
struct DiskLight {
    glm::dvec3 centre{0.0}, u{0.0}, v{0.0};
};
DiskLight disk_of_sphere(const glm::dvec3 &centre, double radius);

// By the outline: L = 1/(2 pi) oint dalpha int_Q^1 W dq about the normal, on the plane of slopes divided by alpha,
// where q is the share of D beyond a slope and W = F G2 (v.h) / ((n.v) (n.h)). Adaptive; 1e-8.
std::array<double, 2> reflected_by_outline(const RoughSurface &surface, std::span<const glm::dvec3> polygon);
std::array<double, 2> reflected_by_outline(const RoughSurface &surface, const DiskLight &light);

// By the light's own area, Duffy (1982): adaptive squares. 1e-6 or so, and slow.
std::array<double, 2> reflected_by_area(const RoughSurface &surface, std::span<const glm::dvec3> polygon);
std::array<double, 2> reflected_by_area(const RoughSurface &surface, const DiskLight &light);

} // namespace sfumato::reference
