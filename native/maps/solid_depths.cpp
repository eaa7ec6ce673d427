// SPDX-License-Identifier: GPL-3.0-or-later
// What stands on the rays of light maps.
#include "maps/light_map.hpp"
#include "maps/sheet_depths.hpp"
#include "maps/texel_ray.hpp"
#include "solids/all_hits.hpp"
#include "text/lights_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

using LightsText = text::LightsText<float>;

constexpr float NOTHING_LEFT = 1e-5F; // of light: what is further behind does not count

// The map depth of the first place at which a solid could stand between light and smoke.
double nearest_solid(const LightMap &map, const RayScene &solids, double nearest_distance) {
    if (map.radial) {
        return (nearest_distance - map.low.z) / (map.high.z - map.low.z);
    }
    RTCBounds bounds;
    rtcGetSceneBounds(solids.scene, &bounds);
    const glm::dvec3 low(bounds.lower_x, bounds.lower_y, bounds.lower_z);
    const glm::dvec3 high(bounds.upper_x, bounds.upper_y, bounds.upper_z);
    double nearest = 0.0; // of the solids' corner that is nearest to the light
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                           (corner & 4) != 0 ? high.z : low.z);
        nearest = std::min(nearest, (map.world_to_light * glm::dvec4(p, 1.0)).z - 1e-3);
    }
    return nearest;
}

} // namespace

TexelRay texel_ray(const LightMap &map, const glm::dmat4 &light_to_world, int x, int y) {
    const glm::dvec2 place((x + 0.5) / map.size.x, (y + 0.5) / map.size.y);
    if (!map.radial) {
        return {glm::dvec3(light_to_world * glm::dvec4(place, 0.0, 1.0)), glm::dvec3(light_to_world[2])};
    }
    const glm::dvec2 square = glm::dvec2(map.low) + place * glm::dvec2(map.high - map.low);
    const glm::vec3 local =
        LightsText().octahedral_direction({static_cast<float>(square.x), static_cast<float>(square.y)});
    const glm::dvec3 direction = glm::dmat3(light_to_world) * glm::dvec3(local);
    return {glm::dvec3(light_to_world[3]) + map.low.z * direction, (map.high.z - map.low.z) * direction};
}

SolidDepths find_solids(const LightMap &map, const RayScene &solids, double nearest_distance) {
    SolidDepths depths(map.texels(), std::numeric_limits<float>::max());
    if (solids.scene == nullptr) {
        return depths;
    }
    const double nearest = nearest_solid(map, solids, nearest_distance);
    const glm::dmat4 light_to_world = glm::inverse(map.world_to_light);
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        for (int x = 0; x < map.size.x; ++x) {
            const TexelRay ray = texel_ray(map, light_to_world, x, y);
            const double length = glm::length(ray.along);
            const float hit =
                first_hit(solids.scene, glm::vec3(ray.origin + nearest * ray.along), glm::vec3(ray.along / length));
            if (std::isfinite(hit)) {
                depths[static_cast<std::size_t>(y * map.size.x + x)] =
                    static_cast<float>(nearest + static_cast<double>(hit) / length);
            }
        }
    });
    return depths;
}

SheetDepths find_sheets(const LightMap &map, const SurfaceView &surfaces, const RayScene &sheets,
                        double nearest_distance) {
    const double nearest = nearest_solid(map, sheets, nearest_distance);
    const glm::dmat4 light_to_world = glm::inverse(map.world_to_light);
    std::vector<SheetDepths> rows(static_cast<std::size_t>(map.size.y));
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        SheetDepths &row = rows[static_cast<std::size_t>(y)];
        std::vector<Hit> hits;
        std::vector<glm::vec3> through;
        for (int x = 0; x < map.size.x; ++x) {
            row.first.push_back(static_cast<std::uint32_t>(row.depth.size()));
            const TexelRay ray = texel_ray(map, light_to_world, x, y);
            const double length = glm::length(ray.along);
            const glm::vec3 origin(ray.origin + nearest * ray.along), direction(ray.along / length);
            all_hits(surfaces, sheets, origin, direction, static_cast<float>((1.0 - nearest) * length), hits);
            glm::vec3 left(1.0F);
            transmittances_of(surfaces, hits, std::span(&origin, 1), std::span(&direction, 1), through);
            for (std::size_t i = 0; i < hits.size(); ++i) {
                const Hit &hit = hits[i];
                left *= through[i];
                row.depth.push_back(static_cast<float>(nearest + static_cast<double>(hit.distance) / length));
                row.left.push_back(left);
                if (std::max({left.x, left.y, left.z}) < NOTHING_LEFT) {
                    break;
                }
            }
        }
    });
    SheetDepths all;
    for (const SheetDepths &row : rows) {
        const auto before = static_cast<std::uint32_t>(all.depth.size());
        for (const std::uint32_t first : row.first) {
            all.first.push_back(before + first);
        }
        all.depth.insert(all.depth.end(), row.depth.begin(), row.depth.end());
        all.left.insert(all.left.end(), row.left.begin(), row.left.end());
    }
    all.first.push_back(static_cast<std::uint32_t>(all.depth.size()));
    return all;
}

} // namespace sfumato
