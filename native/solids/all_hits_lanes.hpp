// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a packet of rays meets.
#pragma once

#include "solids/all_hits.hpp"
#include "solids/hits_lanes.hpp"

#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

// All hits before `far`, lane by lane, near first.
inline void all_hits(const PlaceView *places, const RayScene &among, const vec3 &origin, const vec3 &direction,
                     Real far, Mask asked, std::vector<Hit> &hits) {
    hits.clear();
    if (among.scene == nullptr || !xsimd::any(asked)) {
        return;
    }
    typename Rays<LANES>::Ray rays;
    set_rays(rays, origin, direction, 0.0F, far);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.id[lane] = static_cast<unsigned>(lane);
    }
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::filtered(valid, among.scene, rays, note_hits, &hits);
    settle(places, hits);
}

// What sheets let through of the light that comes to `point` from so far away, in each colour; all where none is asked.
inline vec3 past_sheets(const SurfaceView &surfaces, const RayScene &sheets, const vec3 &point, const vec3 &direction,
                        Real distance, Mask asked) {
    std::vector<Hit> hits;
    all_hits(surfaces.places, sheets, point, direction, distance, asked, hits);
    alignas(64) float left[3][LANES];
    std::fill_n(&left[0][0], 3 * LANES, 1.0F);
    for (const Hit &hit : hits) {
        const float *const through = transmittance_of(surfaces, hit);
        for (int c = 0; c < 3; ++c) {
            left[c][hit.lane] *= through[c];
        }
    }
    return {Real::load_aligned(left[0]), Real::load_aligned(left[1]), Real::load_aligned(left[2])};
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
