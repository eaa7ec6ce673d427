// SPDX-License-Identifier: GPL-3.0-or-later
#include "solids/all_hits.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace sfumato {
namespace {

constexpr float NEAR = 1e-5F; // of the way, and of a triangle

} // namespace

void note_hits(const RTCFilterFunctionNArguments *arguments) {
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

bool is_same(const PlaceView *places, const Hit &a, const Hit &b) {
    const auto at_rim = [](const Hit &hit) { return std::min({hit.u, hit.v, 1.0F - hit.u - hit.v}) < NEAR; };
    if (a.place != b.place || std::abs(b.distance - a.distance) > NEAR * b.distance) {
        return false;
    }
    const std::uint32_t *const first = places[a.place].triangles + std::size_t{3} * a.triangle;
    const std::uint32_t *const second = places[b.place].triangles + std::size_t{3} * b.triangle;
    return at_rim(a) && at_rim(b) && std::find_first_of(first, first + 3, second, second + 3) != first + 3;
}

void settle(const PlaceView *places, std::vector<Hit> &hits) {
    std::sort(hits.begin(), hits.end(), [](const Hit &a, const Hit &b) {
        return std::tie(a.lane, a.distance, a.place, a.triangle) < std::tie(b.lane, b.distance, b.place, b.triangle);
    });
    std::size_t kept = 0;
    for (const Hit &hit : hits) {
        bool twice = false;
        for (std::size_t i = kept; i-- > 0 && !twice && hits[i].lane == hit.lane;) {
            if (hit.distance - hits[i].distance > NEAR * hit.distance) {
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

const float *properties_of(const SurfaceView &surfaces, const Hit &hit) {
    const PlaceView &place = surfaces.places[hit.place];
    const std::size_t own = place.material == nullptr ? 0 : place.material[hit.triangle];
    const std::size_t row = static_cast<std::size_t>(place.first_material) + own;
    return surfaces.properties + row * material_row::FLOATS;
}

void transmittances_of(const SurfaceView &surfaces, std::span<const Hit> hits, std::span<const glm::vec3> origins,
                       std::span<const glm::vec3> directions, std::vector<glm::vec3> &out, const InstructionSet &with) {
    out.clear();
    bool varies = false;
    for (const Hit &hit : hits) {
        const float *const row = properties_of(surfaces, hit), *const through = row + material_row::TRANSMITTANCE;
        out.emplace_back(through[0], through[1], through[2]);
        varies = varies || row[material_row::PATTERN] > 0.0F;
    }
    if (varies) {
        varying_kernels(with).transmittances(surfaces, hits, origins, directions, out);
    }
}

SFUMATO_DISPATCH(VaryingKernels, varying_kernels)

void all_hits(const SurfaceView &surfaces, const RayScene &among, const glm::vec3 &origin, const glm::vec3 &direction,
              float far, std::vector<Hit> &hits) {
    hits.clear();
    constexpr int LANES = 4; // of which the first is asked
    RTCRay4 rays{};
    rays.org_x[0] = origin.x;
    rays.org_y[0] = origin.y;
    rays.org_z[0] = origin.z;
    rays.dir_x[0] = direction.x;
    rays.dir_y[0] = direction.y;
    rays.dir_z[0] = direction.z;
    rays.tfar[0] = far;
    rays.mask[0] = 0xFFFFFFFFU;
    alignas(16) const int valid[LANES] = {-1, 0, 0, 0};
    Rays<LANES>::filtered(valid, among.scene, rays, note_hits, &hits);
    settle(surfaces.places, hits);
}

} // namespace sfumato
