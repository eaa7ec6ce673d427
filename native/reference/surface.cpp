// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

namespace sfumato::reference {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

// One place of a shape.
struct Placed {
    const Shape &shape;
    const Materials &materials;
    glm::dmat4 to_world;
};

// Calls body(placed) for every place of every mesh.
template <typename Body>
void for_each_place(const Scene &scene, const Body &body) {
    for (const Instances &mesh : scene.meshes) {
        for (const glm::mat4 &to_world : mesh.to_world) {
            body(Placed{*mesh.shape, mesh.materials, glm::dmat4(to_world)});
        }
    }
}

Triangle corners(const Placed &mesh, std::size_t index) {
    const auto corner = [&mesh](std::uint32_t vertex) {
        return glm::dvec3(mesh.to_world * glm::dvec4(glm::dvec3(mesh.shape.vertices[vertex]), 1.0));
    };
    const glm::uvec3 &triangle = mesh.shape.triangles[index];
    return {corner(triangle.x), corner(triangle.y), corner(triangle.z)};
}

// The normals of a triangle's corners, in the shape's own space, not of unit length.
Triangle corner_normals(const Shape &shape, std::size_t index) {
    const glm::uvec3 &t = shape.triangles[index];
    if (!shape.corner_normals.empty()) {
        const auto &normals = shape.corner_normals[index];
        return {glm::dvec3(normals[0]), glm::dvec3(normals[1]), glm::dvec3(normals[2])};
    }
    if (!shape.vertex_normals.empty()) {
        const auto &normals = shape.vertex_normals;
        return {glm::dvec3(normals[t.x]), glm::dvec3(normals[t.y]), glm::dvec3(normals[t.z])};
    }
    const glm::dvec3 a(shape.vertices[t.x]), b(shape.vertices[t.y]), c(shape.vertices[t.z]);
    const glm::dvec3 flat = glm::cross(b - a, c - a);
    return {flat, flat, flat};
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

Hit describe(const Placed &mesh, std::size_t index, const Crossing &crossing, const glm::dvec3 &origin,
             const glm::dvec3 &direction) {
    const Triangle normals = corner_normals(mesh.shape, index);
    const Triangle p = corners(mesh, index);
    Hit hit;
    hit.distance = crossing.distance;
    hit.position = origin + crossing.distance * direction;
    // Interpolated in the shape's own space; into the world normals go with the inverse transpose.
    const glm::dvec3 normal =
        (1.0 - crossing.u - crossing.v) * normals[0] + crossing.u * normals[1] + crossing.v * normals[2];
    hit.normal = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(mesh.to_world))) * normal);
    hit.face = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    const std::vector<std::uint32_t> &material = mesh.shape.material;
    hit.albedo = glm::dvec3(mesh.materials.albedo[material.empty() ? 0 : material[index]]);
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
    for_each_place(scene, [&](const Placed &mesh) {
        for (std::size_t i = 0; i < mesh.shape.triangles.size(); ++i) {
            const std::optional<Crossing> crossing = intersect(corners(mesh, i), origin, direction);
            if (crossing && crossing->distance >= 0.0 && crossing->distance <= reach) {
                reach = crossing->distance;
                nearest = describe(mesh, i, *crossing, origin, direction);
            }
        }
    });
    return nearest;
}

bool occluded(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards, double distance) {
    // A triangle does not shade the points on it, nor a lamp the light on it: far more than rounding, far less than
    // anything one models.
    const double clearance = 1e-9 * (1.0 + glm::length(origin));
    bool met = false;
    for_each_place(scene, [&](const Placed &mesh) {
        for (std::size_t i = 0; !met && i < mesh.shape.triangles.size(); ++i) {
            const std::optional<Crossing> crossing = intersect(corners(mesh, i), origin, towards);
            met = crossing && crossing->distance > clearance && crossing->distance < distance - clearance;
        }
    });
    return met;
}

glm::dvec3 visibility(const Scene &scene, const glm::dvec3 &origin, const glm::dvec3 &towards, double distance) {
    if (occluded(scene, origin, towards, distance)) {
        return glm::dvec3(0.0);
    }
    if (distance < ENDLESS) {
        return transmittance(scene, origin, origin + distance * towards);
    }
    glm::dvec3 product(1.0);
    for (const Medium &medium : scene.media) {
        product *= transmittance_to_infinity(medium, origin, towards);
    }
    for (const Particles &particles : scene.particles) {
        double reach = 0.0;
        for (std::size_t i = 0; i < particles.points.size(); ++i) {
            const double away = glm::distance(origin, glm::dvec3(particles.points[i]));
            reach = std::max(reach, away + double{particles.radius[i]});
        }
        product *= transmittance(particles, origin, origin + reach * towards);
    }
    for (const Air &air : scene.air) {
        product *= transmittance_to_infinity(air, origin, towards);
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
