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

} // namespace
} // namespace sfumato::SFUMATO_ISA
