// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a packet of rays meets: no hit is lost, however near to another, and none comes twice.
#pragma once

#include "solids/hits_lanes.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

struct Hit {
    int lane;
    float distance;
    std::uint32_t place, triangle;
    float u, v;

    friend bool operator<(const Hit &a, const Hit &b) {
        return std::tie(a.lane, a.distance, a.place, a.triangle) < std::tie(b.lane, b.distance, b.place, b.triangle);
    }
};

// The share of light, of each of three colours, that passes straight through what is hit.
inline const float *transmittance_of(const SurfaceView &surfaces, const Hit &hit) {
    const PlaceView &place = surfaces.places[hit.place];
    const std::size_t own = place.material == nullptr ? 0 : place.material[hit.triangle];
    const std::size_t row = static_cast<std::size_t>(place.first_material) + own;
    return surfaces.properties + row * material_row::FLOATS + material_row::TRANSMITTANCE;
}

// Embree's filter: every hit is noted, and refused, so that the ray goes on.
inline void note_hits(const RTCFilterFunctionNArguments *arguments) {
    auto &hits = *static_cast<std::vector<Hit> *>(reinterpret_cast<const Asking *>(arguments->context)->who);
    const unsigned count = arguments->N;
    for (unsigned i = 0; i < count; ++i) {
        if (arguments->valid[i] == 0) {
            continue;
        }
        arguments->valid[i] = 0;
        const unsigned instance = RTCHitN_instID(arguments->hit, count, i, 0);
        const unsigned place =
            instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(arguments->hit, count, i);
        hits.push_back({static_cast<int>(RTCRayN_id(arguments->ray, count, i)), RTCRayN_tfar(arguments->ray, count, i),
                        place, RTCHitN_primID(arguments->hit, count, i), RTCHitN_u(arguments->hit, count, i),
                        RTCHitN_v(arguments->hit, count, i)});
    }
}

// Whether two hits are one: Embree may tell of a triangle twice, and a ray through the edge between two meets both.
inline bool is_same(const PlaceView *places, const Hit &a, const Hit &b) {
    constexpr float NEAR = 1e-5F; // of the way, and of a triangle
    const auto at_rim = [](const Hit &hit) { return std::min({hit.u, hit.v, 1.0F - hit.u - hit.v}) < NEAR; };
    if (a.place == b.place && a.triangle == b.triangle) {
        return true;
    }
    if (a.place != b.place || b.distance - a.distance > NEAR * b.distance || !at_rim(a) || !at_rim(b)) {
        return false;
    }
    const std::uint32_t *const first = places[a.place].triangles + std::size_t{3} * a.triangle;
    const std::uint32_t *const second = places[b.place].triangles + std::size_t{3} * b.triangle;
    return std::find_first_of(first, first + 3, second, second + 3) != first + 3;
}

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
    Rays<LANES>::filtered(valid, among.scene, !among.instanced, rays, note_hits, &hits);
    std::sort(hits.begin(), hits.end());
    std::size_t kept = 0;
    for (const Hit &hit : hits) {
        bool twice = false;
        for (std::size_t i = kept; i-- > 0 && !twice && hits[i].lane == hit.lane;) {
            if (hit.distance - hits[i].distance > 1e-5F * hit.distance) {
                break;
            }
            twice = is_same(places, hits[i], hit);
        }
        if (!twice) {
            hits[kept++] = hit;
        }
    }
    hits.resize(kept);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
