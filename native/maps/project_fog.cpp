// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/project_fog.hpp"

#include "maps/column_rays.hpp"
#include "maps/texel_ray.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

// The stretches of a row of texels, whose rays are one depth of the map long.
std::vector<FogStretch> stretches_in_row(const LightMap &map, const glm::dmat4 &light_to_world, const FogView &fog,
                                         int y) {
    constexpr int LANES = 4;
    std::vector<FogStretch> row, found;
    std::vector<Hit> hits;
    std::array<FogRay, LANES> rays;
    for (int first = 0; first < map.size.x; first += LANES) {
        const int count = std::min(LANES, map.size.x - first);
        for (int i = 0; i < count; ++i) {
            const TexelRay ray = texel_ray(map, light_to_world, first + i, y);
            rays[static_cast<std::size_t>(i)] = {glm::vec3(ray.origin), glm::vec3(ray.along)};
        }
        follow(fog, std::span(rays).first(static_cast<std::size_t>(count)), hits, found);
        for (const FogStretch &stretch : found) {
            row.push_back({first + stretch.lane, stretch.near, stretch.far});
        }
    }
    return row;
}

// One ray's. Evenly filled slices of its range hold what stretches have in common with them; one stretch is one slice.
void take_ray(std::span<const FogStretch> stretches, const LightMap &map, ColumnRay &ray) {
    constexpr int SLICES = 64;
    ray.depth.clear();
    ray.column.clear();
    ray.total = 0.0F;
    float low = 1.0F, high = 0.0F;
    for (const FogStretch &stretch : stretches) {
        ray.total += (stretch.far - stretch.near) * static_cast<float>(map.length);
        low = std::min(low, stretch.near);
        high = std::max(high, stretch.far);
    }
    ray.range = {0.0F, 1.0F};
    if (!(ray.total > 0.0F)) {
        return;
    }
    constexpr float LEAST = 1e-4F;
    const Range own{low, std::max(high, low + LEAST)};
    ray.range = map.shared ? ray.range : own;
    const int slices = stretches.size() == 1 ? 1 : SLICES;
    ray.slice = (own.high - own.low) / static_cast<float>(slices);
    for (int i = 0; i < slices; ++i) {
        const float near = own.low + ray.slice * static_cast<float>(i), far = near + ray.slice;
        float inside = 0.0F;
        for (const FogStretch &stretch : stretches) {
            inside += std::max(std::min(far, stretch.far) - std::max(near, stretch.near), 0.0F);
        }
        if (inside > 0.0F) {
            ray.depth.push_back(0.5F * (near + far));
            ray.column.push_back(inside * static_cast<float>(map.length));
        }
    }
}

LightMap projected(LightMap map, const Fog &fog) {
    const glm::dmat4 light_to_world = glm::inverse(map.world_to_light);
    std::vector<std::vector<FogStretch>> rows(static_cast<std::size_t>(map.size.y));
    std::atomic<bool> even = true; // on each ray, from where it begins to where it ends
    oneapi::tbb::parallel_for(0, map.size.y, [&](int y) {
        std::vector<FogStretch> &row = rows[static_cast<std::size_t>(y)];
        row = stretches_in_row(map, light_to_world, fog.view(), y);
        const auto same = [](const FogStretch &a, const FogStretch &b) { return a.lane == b.lane; };
        if (std::adjacent_find(row.begin(), row.end(), same) != row.end()) {
            even = false;
        }
    });
    if (even && !map.shared && !map.curved && map.series.name != LEARNED) {
        map.series.count = 1; // its own range says it all
    }
    ColumnRays rays;
    rays.strips = map.size.y;
    rays.for_rays = [&](int y, const UseRay &use) {
        const std::vector<FogStretch> &row = rows[static_cast<std::size_t>(y)];
        ColumnRay ray;
        auto begin = row.begin();
        for (int x = 0; x < map.size.x; ++x) {
            const auto end = std::find_if(begin, row.end(), [x](const FogStretch &s) { return s.lane != x; });
            take_ray({begin, end}, map, ray);
            use(static_cast<std::size_t>(y * map.size.x + x), ray);
            begin = end;
        }
    };
    fill(map, rays);
    return map;
}

} // namespace

Body body_of(const std::shared_ptr<const Fog> &fog, int texels) {
    const FogBox box = fog->box();
    const glm::dvec3 extent = glm::dvec3(box.high) - glm::dvec3(box.low);
    const double longest = std::max({extent.x, extent.y, extent.z});
    const double around = 1e-4 * longest; // so that no wall of it is the map's own
    Body body;
    body.cell_size = longest / texels;
    body.cells = (extent + 2.0 * around) / body.cell_size;
    body.cells_to_world =
        glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(box.low) - around), glm::dvec3(body.cell_size));
    body.extinction = fog->extinction();
    body.anisotropy = fog->air.anisotropy;
    body.visibility = fog->air.visibility;
    body.followed = true;
    const glm::vec3 &most = body.extinction;
    body.takes_light = std::max({most.x, most.y, most.z}) > 0.0F;
    body.identify = [shape = fog->air.shape, to_world = fog->air.to_world](Key &key) {
        key.part(shape).numbers(std::span<const float>(&to_world.front()[0].x, 16 * to_world.size()));
    };
    body.project = [fog](LightMap plan, const InstructionSet & /*with*/) { return projected(std::move(plan), *fog); };
    return body;
}

} // namespace sfumato
