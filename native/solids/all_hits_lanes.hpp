// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a packet of rays meets.
#pragma once

#include "solids/all_hits.hpp"
#include "solids/hits_lanes.hpp"
#include "solids/varying_lanes.hpp"

#include <algorithm>
#include <span>
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
    set_rays(rays, among, origin, direction, 0.0F, far);
    for (int lane = 0; lane < LANES; ++lane) {
        rays.id[lane] = static_cast<unsigned>(lane);
    }
    alignas(64) int valid[LANES];
    valid_lanes(asked, valid);
    Rays<LANES>::filtered(valid, among.scene, rays, note_hits, &hits);
    settle(places, hits);
}

// VaryingKernels::transmittances. Apart, as vary().
[[gnu::noinline]] inline void varying_transmittances(const SurfaceView &view, std::span<const Hit> hits,
                                                     std::span<const glm::vec3> origins,
                                                     std::span<const glm::vec3> directions, std::span<glm::vec3> out) {
    PatternRegisters registers;
    for (std::size_t first = 0; first < hits.size(); first += LANES) {
        const auto some = hits.subspan(first, std::min(hits.size() - first, std::size_t{LANES}));
        Met met;
        alignas(64) float position[3][LANES], towards[3][LANES], through[3][LANES];
        alignas(64) std::int32_t rows[LANES];
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            const Hit &hit = some[std::min(lane, some.size() - 1)];
            const auto ray = static_cast<std::size_t>(hit.lane);
            for (int axis = 0; axis < 3; ++axis) {
                position[axis][lane] = origins[ray][axis] + directions[ray][axis] * hit.distance;
                towards[axis][lane] = directions[ray][axis];
            }
            met.hit[lane] = true;
            met.place[lane] = hit.place;
            met.triangle[lane] = hit.triangle;
            met.u[lane] = hit.u;
            met.v[lane] = hit.v;
            rows[lane] = static_cast<std::int32_t>(properties_of(view, hit) - view.properties);
        }
        const auto loaded = [](const float(&v)[3][LANES]) {
            return vec3(Real::load_aligned(v[0]), Real::load_aligned(v[1]), Real::load_aligned(v[2]));
        };
        Slots slots(view.properties, Index::load_aligned(rows));
        PatternPacket packet;
        place_point(view, met, loaded(position), packet);
        turn_to_eye(view, met, loaded(towards), packet);
        for_each_varying(view, slots, Mask(true), [&](const Varying &varying, Mask where) {
            const Pattern &pattern = *varying.pattern;
            ask(view, met, where, packet);
            run_pattern(pattern, pattern.dimming, packet, registers);
            for (const Pattern::Output &output : pattern.outputs) {
                if (output.slot >= pattern_slot::TRANSMITTANCE && output.slot < pattern_slot::TRANSMITTANCE + 3) {
                    slots.set(where, output.slot, Real::load_aligned(registers.of[output.from]));
                }
            }
        });
        const vec3 left = slots.colour(pattern_slot::TRANSMITTANCE);
        left.x.store_aligned(through[0]);
        left.y.store_aligned(through[1]);
        left.z.store_aligned(through[2]);
        for (std::size_t lane = 0; lane < some.size(); ++lane) {
            out[first + lane] = {through[0][lane], through[1][lane], through[2][lane]};
        }
    }
}

// What sheets let through of the light that comes to `point` from so far away, in each colour; all where none is asked.
inline vec3 past_sheets(const SurfaceView &surfaces, const RayScene &sheets, const vec3 &point, const vec3 &direction,
                        Real distance, Mask asked) {
    std::vector<Hit> hits;
    all_hits(surfaces.places, sheets, point, direction, distance, asked, hits);
    alignas(64) float left[3][LANES];
    std::fill_n(&left[0][0], 3 * LANES, 1.0F);
    std::vector<glm::vec3> all;
    bool varies = false;
    for (const Hit &hit : hits) {
        const float *const row = properties_of(surfaces, hit), *const through = row + material_row::TRANSMITTANCE;
        all.emplace_back(through[0], through[1], through[2]);
        varies = varies || row[material_row::PATTERN] > 0.0F;
    }
    if (varies) {
        alignas(64) float from[3][LANES], to[3][LANES];
        glm::vec3 origins[LANES], directions[LANES];
        for (int axis = 0; axis < 3; ++axis) {
            axis_of(point, axis).store_aligned(from[axis]);
            axis_of(direction, axis).store_aligned(to[axis]);
        }
        for (int lane = 0; lane < LANES; ++lane) {
            origins[lane] = {from[0][lane], from[1][lane], from[2][lane]};
            directions[lane] = {to[0][lane], to[1][lane], to[2][lane]};
        }
        varying_transmittances(surfaces, hits, origins, directions, all);
    }
    for (std::size_t i = 0; i < hits.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            left[c][hits[i].lane] *= all[i][c];
        }
    }
    return {Real::load_aligned(left[0]), Real::load_aligned(left[1]), Real::load_aligned(left[2])};
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
