// SPDX-License-Identifier: GPL-3.0-or-later
// Where a packet of rays is in a fog.
#pragma once

#include "media/fog.hpp"
#include "solids/hits_lanes.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

// Before `far`; `hits` is memory to work in.
inline void fog_stretches(const FogView &fog, const vec3 &origin, const vec3 &direction, Real far, Mask asked,
                          std::vector<Hit> &hits, std::vector<FogStretch> &out) {
    hits.clear();
    out.clear();
    if (fog.scene.scene == nullptr || !xsimd::any(asked)) {
        return;
    }
    typename Rays<LANES>::Ray rays;
    set_rays(rays, fog.scene, origin, direction, 0.0F, std::numeric_limits<float>::infinity());
    std::array<FogRay, LANES> each;
    for (int lane = 0; lane < LANES; ++lane) {
        rays.id[lane] = static_cast<unsigned>(lane);
        each[static_cast<std::size_t>(lane)] = {{rays.org_x[lane], rays.org_y[lane], rays.org_z[lane]},
                                                {rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]}};
    }
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::filtered(valid, fog.scene.scene, rays, note_hits, &hits);
    stretches_of(fog, each, hits, out);
    alignas(64) float ends[LANES];
    far.store_aligned(ends);
    std::erase_if(out, [&ends](const FogStretch &stretch) { return !(stretch.near < ends[stretch.lane]); });
    for (FogStretch &stretch : out) {
        stretch.far = std::min(stretch.far, ends[stretch.lane]);
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
