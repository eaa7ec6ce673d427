// SPDX-License-Identifier: GPL-3.0-or-later
// Lighting the cells of a medium: what of one light reaches each of them.
#include "maps/arriving_lanes.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {
namespace {

// Whether interpolation in a brick that holds smoke can reach any of these cells: an empty cell beside smoke counts.
inline Mask within_reach(const ClearanceView &bricks, const vec3 &p) {
    Mask reached(false);
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [corner](int axis) { return (corner >> axis & 1) != 0 ? 1.0F : -1.0F; };
        reached = reached | (clearance_at(bricks, {p.x + side(0), p.y + side(1), p.z + side(2)}) < 0.0F);
    }
    return reached;
}

// The centres of the next cells of a box from `at` on, row after row: of those behind its end, anywhere. The rows of a
// brick are short, so packets do not end with them.
vec3 next_centres(const LightBox &box, glm::ivec3 &at) {
    const auto advance = [&](int cells) {
        at.x += cells;
        if (at.x == box.size.x) {
            at.x = 0;
            at.y = at.y + 1 == box.size.y ? 0 : at.y + 1;
            at.z += at.y == 0 ? 1 : 0;
        }
    };
    if (at.x + LANES <= box.size.x) {
        const glm::vec3 first = glm::vec3(box.first + at) + 0.5F;
        advance(LANES);
        return {lane_numbers() + first.x, Real(first.y), Real(first.z)};
    }
    alignas(64) float centres[3][LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        for (int axis = 0; axis < 3; ++axis) {
            centres[axis][lane] = static_cast<float>(box.first[axis] + at[axis]) + 0.5F;
        }
        advance(1);
    }
    return {Real::load_aligned(centres[0]), Real::load_aligned(centres[1]), Real::load_aligned(centres[2])};
}

} // namespace

void light_box(const LightBox &box) {
    const int colours = box.at.grey ? 1 : 3, channels = colours + 1;
    const std::ptrdiff_t cells = std::ptrdiff_t{box.size.x} * box.size.y * box.size.z;
    glm::ivec3 at(0);
    for (std::ptrdiff_t cell = 0; cell < cells; cell += LANES) {
        const vec3 p = next_centres(box, at);
        const Mask reached = within_reach(box.clearance, p);
        if (!xsimd::any(reached)) {
            continue;
        }
        const Arriving light = arriving(box.at, transform_point(box.grid_to_world, p));
        alignas(64) float lanes[4][LANES];
        // A root r, of which the depth is r (r + 1), is what is straight between cells: in dense smoke, where depth
        // grows as the square of the way from where it begins, it is nearly the depth's own root; in thin smoke the
        // depth.
        for (int c = 0; c < colours; ++c) {
            pick(reached, sqrt(light.optical_depth[c] + 0.25F) - 0.5F, 0.0F).store_aligned(lanes[c]);
        }
        pick(reached, light.share, 0.0F).store_aligned(lanes[colours]);
        for (int lane = 0; lane < LANES && cell + lane < cells; ++lane) {
            for (int c = 0; c < channels; ++c) {
                box.values[(cell + lane) * channels + c] = lanes[c][lane];
            }
        }
    }
}

} // namespace sfumato::SFUMATO_ISA
