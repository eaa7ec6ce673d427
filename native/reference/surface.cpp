// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

Triangle corners(const Mesh &mesh, std::size_t index) {
    const glm::uvec3 &triangle = mesh.triangles[index];
    return {glm::dvec3(mesh.vertices[triangle.x]), glm::dvec3(mesh.vertices[triangle.y]),
            glm::dvec3(mesh.vertices[triangle.z])};
}

// Where a ray meets a triangle: the distance, and the barycentric weights of the second and the third corner.
struct Crossing {
    double distance = 0.0;
    double u = 0.0;
    double v = 0.0;
};

// Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997: origin + t direction =
// (1 - u - v) p0 + u p1 + v p2, solved by Cramer's rule. Both sides of the triangle count.
std::optional<Crossing> intersect(const Triangle &p, const glm::dvec3 &origin, const glm::dvec3 &direction) {
    const glm::dvec3 edge1 = p[1] - p[0];
    const glm::dvec3 edge2 = p[2] - p[0];
    const glm::dvec3 s = origin - p[0];
    const glm::dvec3 direction_x_edge2 = glm::cross(direction, edge2);
    const glm::dvec3 s_x_edge1 = glm::cross(s, edge1);
    const double determinant = glm::dot(edge1, direction_x_edge2);
    if (determinant == 0.0) {
        return std::nullopt; // parallel to the ray, or no area
    }
    const Crossing crossing{glm::dot(edge2, s_x_edge1) / determinant, glm::dot(s, direction_x_edge2) / determinant,
                            glm::dot(direction, s_x_edge1) / determinant};
    const bool inside = crossing.u >= 0.0 && crossing.v >= 0.0 && crossing.u + crossing.v <= 1.0;
    return inside ? std::optional(crossing) : std::nullopt;
}

Hit describe(const Mesh &mesh, std::size_t index, const Crossing &crossing, const glm::dvec3 &origin,
             const glm::dvec3 &direction) {
    const auto &normals = mesh.corner_normals[index];
    const Triangle p = corners(mesh, index);
    Hit hit;
    hit.distance = crossing.distance;
    hit.position = origin + crossing.distance * direction;
    hit.normal = glm::normalize((1.0 - crossing.u - crossing.v) * glm::dvec3(normals[0]) +
                                crossing.u * glm::dvec3(normals[1]) + crossing.v * glm::dvec3(normals[2]));
    hit.face = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    hit.albedo = glm::dvec3(mesh.albedo[mesh.material[index]]);
    // The corner normals, not the order of the corners, tell which side of the triangle is the front. The eye's side is
    // the triangle's own: near a silhouette the interpolated normal of the side we see may well point away from us.
    hit.face *= glm::dot(hit.face, hit.normal) < 0.0 ? -1.0 : 1.0;
    const double side = glm::dot(hit.face, direction) > 0.0 ? -1.0 : 1.0;
    hit.face *= side;
    hit.normal *= side;
    return hit;
}

} // namespace

std::optional<Hit> first_hit(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &direction, double reach) {
    std::optional<Hit> nearest;
    for (const Mesh &mesh : scene.meshes) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::optional<Crossing> crossing = intersect(corners(mesh, i), origin, direction);
            if (crossing && crossing->distance >= 0.0 && crossing->distance <= reach) {
                reach = crossing->distance;
                nearest = describe(mesh, i, *crossing, origin, direction);
            }
        }
    }
    return nearest;
}

bool occluded(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards, double distance) {
    // A triangle does not shade the points on it, nor a lamp the light on it: far more than rounding, far less than
    // anything one models.
    const double clearance = 1e-9 * (1.0 + glm::length(origin));
    for (const Mesh &mesh : scene.meshes) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::optional<Crossing> crossing = intersect(corners(mesh, i), origin, towards);
            if (crossing && crossing->distance > clearance && crossing->distance < distance - clearance) {
                return true;
            }
        }
    }
    return false;
}

glm::dvec3 visibility(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards, double distance) {
    if (occluded(scene, origin, towards, distance)) {
        return glm::dvec3(0.0);
    }
    if (distance < ENDLESS) {
        return transmittance(scene.media, origin, origin + distance * towards);
    }
    glm::dvec3 product(1.0);
    for (const Medium &medium : scene.media) {
        product *= transmittance_to_infinity(medium, origin, towards);
    }
    return product;
}

glm::dvec3 reflected(const Scene &scene, const Hit &hit, unsigned samples_per_axis) {
    glm::dvec3 irradiance(0.0);
    for (const Light &light : scene.lights) {
        for (const LightSample &sample : light_samples(light, hit.position, samples_per_axis)) {
            const double cosine = glm::dot(hit.normal, sample.towards);
            const bool faces = cosine > 0.0 && glm::dot(hit.face, sample.towards) > 0.0;
            if (faces && sample.irradiance != glm::dvec3(0.0)) {
                irradiance +=
                    cosine * sample.irradiance * visibility(scene, hit.position, sample.towards, sample.distance);
            }
        }
    }
    return hit.albedo / std::numbers::pi * irradiance;
}

} // namespace sfumato::reference
