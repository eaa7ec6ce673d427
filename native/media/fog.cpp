// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/fog.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sfumato {
namespace {

// Six times, of what is inside if corners run counterclockwise, seen from outside. Relative to the middle, since what
// is left of an open mesh should not depend on where it stands.
double volume_of(const Shape &shape) {
    glm::dvec3 middle(0.0);
    for (const glm::vec3 &vertex : shape.vertices) {
        middle += glm::dvec3(vertex) / static_cast<double>(shape.vertices.size());
    }
    double sum = 0.0;
    for (const glm::uvec3 &triangle : shape.triangles) {
        const glm::dvec3 a = glm::dvec3(shape.vertices[triangle.x]) - middle,
                         b = glm::dvec3(shape.vertices[triangle.y]) - middle,
                         c = glm::dvec3(shape.vertices[triangle.z]) - middle;
        sum += glm::dot(a, glm::cross(b, c));
    }
    return sum;
}

FogBox box_of(const Shape &shape, const glm::mat4 &to_world) {
    constexpr float FAR = std::numeric_limits<float>::max();
    FogBox box{glm::vec3(FAR), glm::vec3(-FAR)};
    for (const glm::vec3 &vertex : shape.vertices) {
        const glm::vec3 place(to_world * glm::vec4(vertex, 1.0F));
        box = {glm::min(box.low, place), glm::max(box.high, place)};
    }
    return box;
}

bool is_in(const FogBox &box, const glm::vec3 &point) {
    return glm::all(glm::lessThanEqual(box.low, point)) && glm::all(glm::lessThanEqual(point, box.high));
}

// Which way a ray crosses what it hits: 1 where it goes in, -1 where it comes out.
int entry(const FogView &fog, const FogRay &ray, const Hit &hit) {
    const PlaceView &place = fog.places[hit.place];
    const std::uint32_t *const corners = place.triangles + std::size_t{3} * hit.triangle;
    const auto corner = [&](int i) {
        const float *const v = place.vertices + std::size_t{3} * corners[i];
        return glm::dvec3(v[0], v[1], v[2]);
    };
    const glm::dvec3 flat = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const float *const m = place.normals_to_world;
    double facing = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double normal = double{m[axis]} * flat.x + double{m[3 + axis]} * flat.y + double{m[6 + axis]} * flat.z;
        facing += normal * double{ray.direction[axis]};
    }
    return facing * double{fog.outwards} < 0.0 ? 1 : -1;
}

struct Crossing {
    Hit hit;
    int entry;
};

// The crossings of one ray with one place, near first.
void append_stretches(std::span<const Crossing> crossings, bool may_start_inside, std::vector<FogStretch> &out) {
    int sum = 0;
    for (const Crossing &crossing : crossings) {
        sum += crossing.entry;
    }
    int depth = may_start_inside ? -sum : std::min(-sum, 0);
    const int least = std::min(depth, 0);
    float since = 0.0F;
    for (const auto &[hit, entry] : crossings) {
        const bool inside = depth > 0;
        depth = std::max(depth + entry, least);
        if (!inside && depth > 0) {
            since = hit.distance;
        } else if (inside && depth <= 0 && hit.distance > since) {
            out.push_back({hit.lane, since, hit.distance});
        }
    }
}

} // namespace

FogBox Fog::box() const {
    FogBox all = boxes.front();
    for (const FogBox &box : boxes) {
        all = {glm::min(all.low, box.low), glm::max(all.high, box.high)};
    }
    return all;
}

std::vector<std::shared_ptr<const Fog>> fogs_of(std::span<const Air> air, Solids &solids) {
    std::vector<std::shared_ptr<const Fog>> out;
    for (const Air &each : air) {
        if (!each.shape || each.shape->triangles.empty()) {
            continue;
        }
        Fog fog;
        fog.air = each;
        // What is flat holds nothing.
        std::erase_if(fog.air.to_world, [](const glm::mat4 &m) {
            return !(std::abs(glm::determinant(glm::dmat3(glm::dmat4(m)))) > 0.0);
        });
        const glm::vec3 worth = fog.extinction() + each.emission;
        if (fog.air.to_world.empty() || !(std::max({worth.x, worth.y, worth.z}) > 0.0F)) {
            continue;
        }
        Instances mesh;
        mesh.shape = each.shape;
        mesh.to_world = fog.air.to_world;
        const std::span<const Instances> one(&mesh, 1);
        fog.places = solids.places(Divided::sheets(one), {true});
        for (const glm::mat4 &to_world : fog.air.to_world) {
            fog.views.push_back(view_of(*each.shape, to_world, 0));
            fog.boxes.push_back(box_of(*each.shape, to_world));
        }
        fog.outwards = volume_of(*each.shape) < 0.0 ? -1.0F : 1.0F;
        out.push_back(std::make_shared<const Fog>(std::move(fog)));
    }
    return out;
}

void stretches_of(const FogView &fog, std::span<const FogRay> rays, std::vector<Hit> &hits,
                  std::vector<FogStretch> &out) {
    out.clear();
    std::sort(hits.begin(), hits.end(), [](const Hit &a, const Hit &b) {
        return std::tie(a.lane, a.place, a.distance, a.triangle) < std::tie(b.lane, b.place, b.distance, b.triangle);
    });
    std::vector<Crossing> crossings;
    for (std::size_t first = 0, end = 0; first < hits.size(); first = end) {
        const Hit &one = hits[first];
        const FogRay &ray = rays[static_cast<std::size_t>(one.lane)];
        crossings.clear();
        for (; end < hits.size() && hits[end].lane == one.lane && hits[end].place == one.place; ++end) {
            const Crossing next{hits[end], entry(fog, ray, hits[end])};
            const bool twice = std::any_of(crossings.begin(), crossings.end(), [&](const Crossing &known) {
                return known.entry == next.entry && is_same(fog.places, known.hit, next.hit);
            });
            if (!twice) {
                crossings.push_back(next);
            }
        }
        append_stretches(crossings, is_in(fog.boxes[one.place], ray.origin), out);
    }
    std::sort(out.begin(), out.end(), [](const FogStretch &a, const FogStretch &b) {
        return std::tie(a.lane, a.near, a.far) < std::tie(b.lane, b.near, b.far);
    });
}

void follow(const FogView &fog, std::span<const FogRay> rays, std::vector<Hit> &hits, std::vector<FogStretch> &out) {
    constexpr int LANES = 4;
    hits.clear();
    RTCRay4 packet{};
    alignas(16) int valid[LANES] = {0, 0, 0, 0};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        packet.org_x[i] = rays[i].origin.x;
        packet.org_y[i] = rays[i].origin.y;
        packet.org_z[i] = rays[i].origin.z;
        packet.dir_x[i] = rays[i].direction.x;
        packet.dir_y[i] = rays[i].direction.y;
        packet.dir_z[i] = rays[i].direction.z;
        packet.tfar[i] = std::numeric_limits<float>::infinity();
        packet.mask[i] = 0xFFFFFFFFU;
        packet.id[i] = static_cast<unsigned>(i);
        valid[i] = -1;
    }
    Rays<LANES>::filtered(valid, fog.scene.scene, packet, note_hits, &hits);
    stretches_of(fog, rays, hits, out);
}

} // namespace sfumato
