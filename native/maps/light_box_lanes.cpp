// SPDX-License-Identifier: GPL-3.0-or-later
// Lighting the cells of a medium: what of one light reaches each of them.
#include "lights/lights_lanes.hpp"
#include "maps/map_kernels.hpp"
#include "maps/sampling.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {
namespace {

// The share of light that solids keep back: 0 before the first solid of each texel, 1 behind, filtered bilinearly
// (Reeves, Salesin and Cook 1987). The softening over one texel stands for a small light's extent.
inline Real solid_occlusion(const LightMapView &map, const Texels &texels, Real z) {
    Real occluded[4];
    for (int t = 0; t < 4; ++t) {
        occluded[t] = pick(z < gather(map.solid_depth, texels.at[t]), 0.0F, 1.0F);
    }
    return bilinear(texels, occluded);
}

// Whether interpolation in a brick that holds smoke can reach any of these cells: an empty cell beside smoke counts.
inline Mask within_reach(const ClearanceView &bricks, const vec3 &p) {
    Mask reached(false);
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [corner](int axis) { return (corner >> axis & 1) != 0 ? 1.0F : -1.0F; };
        reached = reached | (clearance_at(bricks, {p.x + side(0), p.y + side(1), p.z + side(2)}) < 0.0F);
    }
    return reached;
}

struct Arriving {
    Real optical_depth[3];
    Real share; // of the light's falloff() that gets past solids and the edges of its cone
};

// Averages over the light's samples: of what each brings, what solids let through, and of that what smoke lets through,
// as the optical depth of the mean transmittance. Behind solids nothing arrives, but between a lit cell and one behind
// a solid the smoke's own depth is what must be interpolated: there it is taken without the solids.
Arriving arriving(const LightBox &box, const vec3 &world) {
    const LightView &light = *box.light;
    const int colours = box.grey ? 1 : 3;
    const auto media = static_cast<std::ptrdiff_t>(box.media.size());
    Real past_solids = 0.0F, sent = 0.0F;
    Real past_smoke[3] = {0.0F, 0.0F, 0.0F}, unblocked[3] = {0.0F, 0.0F, 0.0F};
    Arriving out;
    for (std::size_t j = 0; j < light.samples.size(); ++j) {
        const LightMapView *maps = light.maps + static_cast<std::ptrdiff_t>(j) * media;
        const Real weight = sample_share(light, light.samples[j], world);
        Real visible = weight;
        Real depth[3] = {0.0F, 0.0F, 0.0F};
        for (int m = 0; m < media; ++m) {
            if (maps[m].empty()) {
                continue;
            }
            const vec3 place = place_on(maps[m], world);
            const Texels texels = locate(maps[m], place.x, place.y);
            const float *extinction = box.media[static_cast<std::size_t>(m)].extinction;
            add_optical_depth(maps[m], texels, place, extinction, colours, depth);
            if (m == box.own) {
                visible = weight * (1.0F - solid_occlusion(maps[m], texels, place.z));
            }
        }
        past_solids = past_solids + visible;
        sent = sent + weight;
        for (int c = 0; c < colours; ++c) {
            out.optical_depth[c] = depth[c];
            if (light.samples.size() > 1) {
                const Real left = RaysText().transmittance_of(depth[c]);
                past_smoke[c] = past_smoke[c] + visible * left;
                unblocked[c] = unblocked[c] + weight * left;
            }
        }
    }
    out.share = past_solids;
    if (light.samples.size() > 1) {
        constexpr float LITTLE = 1e-6F, DARK = 1e-12F;
        for (int c = 0; c < colours; ++c) {
            const Real open = max(unblocked[c], DARK) / max(sent, DARK);
            const Real behind = max(past_smoke[c], DARK) / max(past_solids, DARK);
            out.optical_depth[c] = max(-log(pick(past_solids > sent * LITTLE, behind, open)), 0.0F);
        }
    }
    return out;
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
    const MediumView &own = box.media[static_cast<std::size_t>(box.own)];
    const int colours = box.grey ? 1 : 3, channels = colours + 1;
    const std::ptrdiff_t cells = std::ptrdiff_t{box.size.x} * box.size.y * box.size.z;
    glm::ivec3 at(0);
    for (std::ptrdiff_t cell = 0; cell < cells; cell += LANES) {
        const vec3 p = next_centres(box, at);
        const Mask reached = within_reach(own.clearance, p);
        if (!xsimd::any(reached)) {
            continue;
        }
        const Arriving light = arriving(box, transform_point(box.grid_to_world, p));
        alignas(64) float lanes[4][LANES];
        for (int c = 0; c < colours; ++c) {
            pick(reached, light.optical_depth[c], 0.0F).store_aligned(lanes[c]);
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
