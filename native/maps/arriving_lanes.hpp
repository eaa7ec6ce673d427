// SPDX-License-Identifier: GPL-3.0-or-later
// What of one light reaches places in smoke.
#pragma once

#include "lights/lights_lanes.hpp"
#include "maps/map_kernels.hpp"
#include "maps/sampling.hpp"
#include "media/air_lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

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

// What sheets before a depth leave of each colour of light, filtered as solids are.
inline void left_by_sheets(const LightMapView &map, const Texels &texels, Real z, int colours, Real out[3]) {
    alignas(64) float depth[LANES], left[3][4][LANES];
    z.store_aligned(depth);
    for (int t = 0; t < 4; ++t) {
        alignas(64) std::int32_t at[LANES];
        texels.at[t].store_aligned(at);
        for (int lane = 0; lane < LANES; ++lane) {
            const std::uint32_t *const first = map.sheets.first + at[lane];
            const float *const begin = map.sheets.depth + first[0], *const end = map.sheets.depth + first[1];
            const float *const behind = std::upper_bound(begin, end, depth[lane]);
            for (int c = 0; c < colours; ++c) {
                left[c][t][lane] = behind == begin ? 1.0F : map.sheets.left[3 * (behind - map.sheets.depth - 1) + c];
            }
        }
    }
    for (int c = 0; c < colours; ++c) {
        Real values[4];
        for (int t = 0; t < 4; ++t) {
            values[t] = Real::load_aligned(left[c][t]);
        }
        out[c] = bilinear(texels, values);
    }
}

// What solids leave of the light at a place in the world. What sheets do is added to the depth. Not inlined: few ask.
[[gnu::noinline]] Real past_exactly(const ExactRays &rays, Real x, Real y, Real z, int colours, Real *depth) {
    ExactPacket packet;
    put({x, y, z}, packet);
    exact_open(rays, packet);
    for (int c = 0; c < colours; ++c) {
        depth[c] = depth[c] - log(max(Real::load_aligned(packet.out[c]), 1e-12F));
    }
    return Real::load_aligned(packet.out[3]);
}

struct Arriving {
    Real optical_depth[3];
    Real share; // of the light's falloff() that gets past solids and the edges of its cone
};

// Where a place lies on a map, behind the depth at which that begins. Elsewhere its body takes nothing.
inline Mask beneath(const vec3 &place) {
    return (place.z > 0.0F) & (min(place.x, place.y) >= 0.0F) & (max(place.x, place.y) <= 1.0F);
}

// Averages over the light's samples: of what each brings, what solids let through, and of that what smoke and sheets
// let through, as the optical depth of the mean transmittance. Behind solids nothing arrives, but between a lit cell
// and one behind a solid the smoke's own depth is what must be interpolated: there it is taken without the solids.
inline Arriving arriving(const ArrivingAt &at, const vec3 &world) {
    const LightView &light = *at.light;
    const int colours = at.grey ? 1 : 3;
    const auto bodies = static_cast<std::ptrdiff_t>(at.extinctions.size());
    Real past_solids = 0.0F, sent = 0.0F;
    Real past_smoke[3] = {0.0F, 0.0F, 0.0F}, unblocked[3] = {0.0F, 0.0F, 0.0F};
    Arriving out;
    const std::size_t first = at.only < 0 ? 0 : static_cast<std::size_t>(at.only);
    const std::size_t end = at.only < 0 ? light.samples.size() : first + 1;
    for (std::size_t j = first; j < end; ++j) {
        const LightMapView *maps = light.maps + static_cast<std::ptrdiff_t>(j) * bodies;
        const Real weight = sample_share(light, j, world);
        Real visible = weight;
        Real depth[3] = {0.0F, 0.0F, 0.0F};
        for (int m = 0; m < bodies; ++m) {
            if (maps[m].empty()) {
                continue;
            }
            const vec3 place = place_on(maps[m], world);
            if (m != at.own && maps[m].exact == nullptr && !xsimd::any(beneath(place))) {
                continue;
            }
            const Texels texels = locate(maps[m], place.x, place.y);
            const glm::vec3 &extinction = at.extinctions[static_cast<std::size_t>(m)];
            add_optical_depth(maps[m], texels, place, &extinction.x, colours, depth);
            if (m == at.own && maps[m].exact != nullptr) {
                visible = maps[m].exact->lit
                              ? weight * past_exactly(*maps[m].exact, world.x, world.y, world.z, colours, depth)
                              : Real(0.0F);
            } else if (m == at.own) {
                visible = weight * (1.0F - solid_occlusion(maps[m], texels, place.z));
                if (maps[m].sheets.first != nullptr) {
                    Real left[3];
                    left_by_sheets(maps[m], texels, place.z, colours, left);
                    for (int c = 0; c < colours; ++c) {
                        depth[c] = depth[c] - log(max(left[c], 1e-12F));
                    }
                }
            }
        }
        if (at.air != nullptr) {
            add_air(*at.air, light, light.samples[j], world, colours, depth);
        }
        past_solids = past_solids + visible;
        sent = sent + weight;
        for (int c = 0; c < colours; ++c) {
            out.optical_depth[c] = depth[c];
            if (end - first > 1) {
                const Real left = RaysText().transmittance_of(depth[c]);
                past_smoke[c] = past_smoke[c] + visible * left;
                unblocked[c] = unblocked[c] + weight * left;
            }
        }
    }
    out.share = past_solids;
    if (end - first > 1) {
        constexpr float LITTLE = 1e-6F, DARK = 1e-12F;
        for (int c = 0; c < colours; ++c) {
            const Real open = max(unblocked[c], DARK) / max(sent, DARK);
            const Real behind = max(past_smoke[c], DARK) / max(past_solids, DARK);
            out.optical_depth[c] = max(-log(pick(past_solids > sent * LITTLE, behind, open)), 0.0F);
        }
    }
    return out;
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
