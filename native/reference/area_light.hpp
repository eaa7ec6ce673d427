// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of area lights: int over the light's directions, in double precision. Lights are seen from the origin and
// have radiance 1; winding does not matter. What lies behind the plane of `axis`, or below that of `normal`, is cut
// off.
#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>

namespace sfumato::reference {

using Horizon = std::optional<glm::dvec3>;

// (n + 1)/(2 pi) int (u.axis)^n du over a convex polygon, for real n > 0: quadrature along its edges, with panels that
// halve towards the peak.
double cosine_power(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, double exponent,
                    const Horizon &normal = {});

// The same for whole n >= 0 by Arvo's recurrence (1995), which is exact.
double cosine_power_exact(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, int exponent,
                          const Horizon &normal = {});

// The same by quadrature over the polygon's plane, cut into triangles: no theorem of Stokes. For n up to a few hundred.
double cosine_power_by_area(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, double exponent,
                            const Horizon &normal = {});

// int (u.axis)^n (u.b) du by that quadrature.
double double_moment_by_area(std::span<const glm::dvec3> polygon, const glm::dvec3 &axis, double exponent,
                             const glm::dvec3 &b);

// The same over the ellipse centre + u cos + v sin, by adaptive quadrature along its outline; and over a sphere that
// does not hold the origin, whose outline is a circle.
double cosine_power_of_ellipse(const glm::dvec3 &centre, const glm::dvec3 &u, const glm::dvec3 &v,
                               const glm::dvec3 &axis, double exponent, const Horizon &normal = {});
double cosine_power_of_sphere(const glm::dvec3 &centre, double radius, const glm::dvec3 &axis, double exponent,
                              const Horizon &normal = {});

} // namespace sfumato::reference
