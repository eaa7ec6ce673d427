// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/body.hpp"

#include "maps/light_map.hpp"
#include "media/medium.hpp"
#include "solids/surfaces.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sfumato {

std::array<glm::dvec3, 8> Body::corners() const {
    std::array<glm::dvec3, 8> out;
    for (std::size_t i = 0; i < 8; ++i) {
        const glm::dvec3 upper((i & 1) != 0 ? 1.0 : 0.0, (i & 2) != 0 ? 1.0 : 0.0, (i & 4) != 0 ? 1.0 : 0.0);
        out[i] = glm::dvec3(cells_to_world * glm::dvec4(upper * cells, 1.0));
    }
    return out;
}

Body body_of(const CroppedMedium &medium) {
    Body body;
    body.cells_to_world = medium.grid_to_world;
    body.cells = glm::dvec3(medium.grid->resolution);
    body.cell_size = medium.cell_size / (medium.ramp ? medium.ramp->fineness : 1.0);
    body.extinction = medium.extinction;
    body.anisotropy = medium.anisotropy;
    body.visibility = medium.visibility;
    body.takes_light = medium.takes_light();
    body.identify = [grid = medium.grid, ramp = medium.ramp, place = medium.grid_to_world,
                     strongest = medium.strongest()](Key &key) {
        key.part(grid).number(strongest).numbers(std::span<const double>(&place[0].x, 16));
        if (ramp) {
            key.numbers(std::span<const float>(ramp->densities()));
        }
    };
    body.project = [grid = medium.grid, ramp = medium.ramp, place = medium.grid_to_world,
                    strongest = medium.strongest()](LightMap plan, const InstructionSet &with) {
        return projected(std::move(plan), *grid, ramp.get(), place, strongest, with);
    };
    return body;
}

std::optional<Body> air_body(const Surfaces &surfaces, std::span<const Body> bodies, int texels) {
    std::optional<Box> box = surfaces.bounds();
    for (const Body &body : bodies) {
        for (const glm::dvec3 &corner : body.corners()) {
            box = box ? Box{glm::min(box->low, corner), glm::max(box->high, corner)} : Box{corner, corner};
        }
    }
    if (!box) {
        return std::nullopt;
    }
    glm::dvec3 extent = box->high - box->low;
    const double longest = std::max({extent.x, extent.y, extent.z, 1e-6}), cell = longest / texels;
    // A floor is as thick as a cell, and its shadow ends within the box.
    const glm::dvec3 low = box->low - cell;
    extent += 2.0 * cell;
    Body body;
    body.clear = body.followed = true;
    for (int axis = 0; axis < 3; ++axis) {
        body.cells_to_world[axis][axis] = cell;
    }
    body.cells_to_world[3] = glm::dvec4(low, 1.0);
    body.cells = extent / cell;
    body.cell_size = cell;
    body.visibility.hides = 0;
    body.scatters = false;
    body.identify = [](Key & /*key*/) {};
    return body;
}

Ball ball_of(const Body &body) {
    Ball ball{glm::dvec3(body.cells_to_world * glm::dvec4(0.5 * body.cells, 1.0)), 0.0};
    for (const glm::dvec3 &corner : body.corners()) {
        ball.radius = std::max(ball.radius, glm::distance(ball.middle, corner));
    }
    return ball;
}

} // namespace sfumato
