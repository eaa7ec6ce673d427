// SPDX-License-Identifier: GPL-3.0-or-later
// Light maps of primitives: every texel gathers what its ray meets, so any order of theirs gives the same map. Of a
// kind of primitive is asked where a ray crosses it: cross(primitive, rays).
#pragma once

#include "maps/map_kernels.hpp"
#include "rays/series_lanes.hpp"
#include "text/lanes.hpp"
#include "text/lights_text.hpp"
#include "text/media_text.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {
namespace {

using LightsText = text::LightsText<Real, Isa>;
using MediaText = text::MediaText<Real, Isa>;

constexpr int BLOCK = Bins::EDGE, PACKETS = BLOCK * BLOCK / LANES;
constexpr float PI = 3.14159265358979324F;

// Of some texels of a block.
struct TexelRays {
    const LightMapView &map;
    Real x, y;      // the texels' middles
    vec3 direction; // of radial maps
};

inline TexelRays rays_of(const LightMapView &map, int column, int row, int packet) {
    const int first = packet * LANES;
    const Real number = lane_numbers() + static_cast<float>(first % BLOCK);
    const Real rows = floor(number * (1.0F / BLOCK));
    TexelRays rays{map,
                   number - rows * float{BLOCK} + (static_cast<float>(column * BLOCK) + 0.5F),
                   rows + (static_cast<float>(row * BLOCK + first / BLOCK) + 0.5F),
                   {Real(0.0F), Real(0.0F), Real(1.0F)}};
    if (map.radial) {
        LightsText::Octahedral place;
        place.x = map.low[0] + rays.x * (1.0F / (static_cast<float>(map.width) * map.scale[0]));
        place.y = map.low[1] + rays.y * (1.0F / (static_cast<float>(map.height) * map.scale[1]));
        rays.direction = LightsText().octahedral_direction(place);
    }
    return rays;
}

// Where rays cross a primitive: the column, 0 where they do not meet it; and in the map's depth its middle, and half of
// its extent, over which it varies as a puff's does.
struct Crossing {
    Real column, depth, half;
    Mask met;
};

// What belongs to a block: a list of primitives.
template <typename Primitive>
struct Listed {
    const Splat<Primitive> &splat;
    std::uint32_t begin, end;

    Listed(const Splat<Primitive> &of, int column, int row) : splat(of) {
        const auto cell = [&of](int block) {
            return static_cast<int>(static_cast<float>(block * BLOCK) * of.bins.per_edge);
        };
        const int number = cell(row) * of.bins.columns + cell(column);
        begin = of.bins.begin[number];
        end = of.bins.begin[number + 1];
    }
    [[nodiscard]] std::int32_t number(std::uint32_t i) const {
        return splat.bins.ranks[i]; // as they came: bins without depths
    }
    [[nodiscard]] const Primitive &operator[](std::uint32_t i) const { return splat.primitives[number(i)]; }
};

struct Gathered {
    Real total = 0.0F;
    RaysText::DepthRange range;
    bool any = false;
};

// The first round: what range a series has to span.
template <typename Primitive>
Gathered gather_range(const Listed<Primitive> &list, const TexelRays &rays) {
    Gathered out;
    Real low(1e30F), high(-1e30F);
    for (std::uint32_t i = list.begin; i < list.end; ++i) {
        const Crossing at = cross(list[i], rays);
        if (!xsimd::any(at.met)) {
            continue;
        }
        out.any = true;
        out.total = out.total + at.column;
        low = pick(at.met, min(low, at.depth - at.half), low);
        high = pick(at.met, max(high, at.depth + at.half), high);
    }
    if (rays.map.shared) {
        out.range.low = 0.0F;
        out.range.high = 1.0F;
        return out;
    }
    // A ray that meets nothing has no range that counts; beyond the map nothing lies.
    const Mask smoky = high > low;
    out.range = RaysText().padded_range(pick(smoky, low, 0.0F), pick(smoky, high, 1.0F));
    out.range.low = max(out.range.low, 0.0F);
    out.range.high = max(min(out.range.high, 1.0F), out.range.low + 1e-4F);
    return out;
}

// Below this half of its extent, of the range, the sine and the cosine of a primitive's damping cancel; that much it is
// widened.
constexpr float LEAST_HALF = 0.016F;

// The second round. Of a primitive's harmonics k = 1, ..., sum(k, cosine, sine) has those of its middle, times its
// column and its damping, still without 1 / k^3.
template <BasisName BASIS, typename Primitive, typename Sum>
void gather_harmonics(const Listed<Primitive> &list, const TexelRays &rays, const RaysText::DepthRange &range,
                      int harmonics, const Sum &sum) {
    constexpr bool HALF = BASIS == COSINE;
    using Waves = std::conditional_t<HALF, Swinging, Turning>;
    const Real per_depth = 1.0F / (range.high - range.low);
    for (std::uint32_t i = list.begin; i < list.end; ++i) {
        const Crossing at = cross(list[i], rays);
        if (!xsimd::any(at.met)) {
            continue;
        }
        Waves wave(unit_harmonic(HALF, RaysText().relative_depth(range, at.depth)));
        const Real half = clamp(at.half * per_depth, LEAST_HALF, 0.5F);
        const Real x = half * (HALF ? PI : 2.0F * PI);
        const Harmonic unit = unit_harmonic(HALF, half);
        const Real twice = unit.cosine + unit.cosine;
        Real cosine = unit.cosine, sine = unit.sine, last_cosine(1.0F), last_sine(0.0F), kx = x;
        const Real weight = at.column * (3.0F / (x * x * x));
        for (int k = 1; k <= harmonics; ++k) {
            const Real share = weight * MediaText().puff_damping(sine, cosine, kx);
            if constexpr (HALF) {
                sum(k, share * wave.here.cosine, share);
            } else {
                sum(k, share * wave.here.cosine, share * wave.here.sine);
            }
            wave.next();
            const Real next_cosine = RaysText().next_cosine(twice, cosine, last_cosine);
            const Real next_sine = RaysText().next_cosine(twice, sine, last_sine);
            last_cosine = cosine;
            last_sine = sine;
            cosine = next_cosine;
            sine = next_sine;
            kx = kx + x;
        }
    }
}

// Into number `at` of the texels of some rays, where these are on the map.
template <typename Primitive>
void store(const Splat<Primitive> &splat, int column, int row, int packet, Real value, int at) {
    alignas(64) float lanes[LANES];
    value.store_aligned(lanes);
    const int stride = splat.map.stride();
    for (int lane = 0; lane < LANES; ++lane) {
        const int number = packet * LANES + lane, x = column * BLOCK + number % BLOCK, y = row * BLOCK + number / BLOCK;
        if (x < splat.map.width && y < splat.map.height) {
            splat.coefficients[(std::ptrdiff_t{y} * splat.map.width + x) * stride + at] = lanes[lane];
        }
    }
}

constexpr int MOST_COUNT = 64;

template <BasisName BASIS, typename Primitive>
void splat_packet(const Listed<Primitive> &list, int column, int row, int packet) {
    const Splat<Primitive> &splat = list.splat;
    const TexelRays rays = rays_of(splat.map, column, row, packet);
    const Gathered found = gather_range(list, rays);
    const int count = splat.map.count, head = splat.map.head();
    Real sums[MOST_COUNT];
    std::fill(sums, sums + count, Real(0.0F));
    if (found.any) {
        gather_harmonics<BASIS>(list, rays, found.range, BASIS == COSINE ? count - 1 : count / 2,
                                [&](int k, Real cosine, Real sine) {
                                    if constexpr (BASIS == COSINE) {
                                        sums[k] = sums[k] + cosine;
                                    } else {
                                        sums[2 * k - 1] = sums[2 * k - 1] + cosine;
                                        sums[2 * k] = sums[2 * k] + sine;
                                    }
                                });
    }
    store(splat, column, row, packet, found.total, 0);
    if (!splat.map.shared) {
        store(splat, column, row, packet, found.range.low, 1);
        store(splat, column, row, packet, 1.0F / (found.range.high - found.range.low), 2);
    }
    for (int i = 1; i < count; ++i) {
        const auto k = static_cast<float>(BASIS == COSINE ? i : (i + 1) / 2);
        const float scale = 2.0F / ((BASIS == COSINE ? PI : 2.0F * PI) * k * k * k * k);
        store(splat, column, row, packet, sums[i] * scale, head + i - 1);
    }
}

// Packets at a time whose sums stay in registers.
constexpr int COUNT = 7, GROUP = LANES == 16 ? 4 : 1, ROWS = LANES < BLOCK ? 1 : LANES / BLOCK;

// The paper's: of one range for all, what a primitive adds to any ray goes as its column. Asked for is the share of it
// on the rays of GROUP packets, each ROWS rows above the last: shares_of_column(primitive, rays, shares).
template <typename Primitive>
concept HasShares = requires(const Primitive &primitive, const TexelRays &rays, Real (&shares)[GROUP]) {
    shares_of_column(primitive, rays, shares);
};

template <HasShares Primitive>
void splat_published(const Listed<Primitive> &list, int column, int row, int packet) {
    const Splat<Primitive> &splat = list.splat;
    const TexelRays rays = rays_of(splat.map, column, row, packet);
    Real sums[GROUP][COUNT];
    for (auto &of_packet : sums) {
        std::fill(of_packet, of_packet + COUNT, Real(0.0F));
    }
    for (std::uint32_t i = list.begin; i < list.end; ++i) {
        const std::int32_t number = list.number(i);
        const float *const weights = splat.weights + std::ptrdiff_t{number} * Splat<Primitive>::WEIGHTS;
        Real shares[GROUP];
        shares_of_column(splat.primitives[number], rays, shares);
#pragma GCC unroll 4
        for (int p = 0; p < GROUP; ++p) {
#pragma GCC unroll 7
            for (int k = 0; k < COUNT; ++k) {
                sums[p][k] = xsimd::fma(shares[p], Real(weights[k]), sums[p][k]);
            }
        }
    }
    for (int p = 0; p < GROUP; ++p) {
        for (int k = 0; k < COUNT; ++k) {
            store(splat, column, row, packet + p, sums[p][k], k);
        }
    }
}

template <typename Primitive>
void splat_block(const Splat<Primitive> &splat, int column, int row) {
    const Listed<Primitive> list(splat, column, row);
    if constexpr (HasShares<Primitive>) {
        for (int packet = 0; splat.weights != nullptr && packet < PACKETS; packet += GROUP) {
            splat_published(list, column, row, packet);
        }
    }
    for (int packet = 0; splat.weights == nullptr && packet < PACKETS; ++packet) {
        if (splat.map.basis == COSINE) {
            splat_packet<COSINE>(list, column, row, packet);
        } else {
            splat_packet<FOURIER>(list, column, row, packet);
        }
    }
}

template <typename Primitive>
void meet_block(const Splat<Primitive> &splat, int column, int row, int packet, SplatAbsorbers &out) {
    const Listed<Primitive> list(splat, column, row);
    const TexelRays rays = rays_of(splat.map, column, row, packet);
    const std::size_t most = static_cast<std::size_t>(list.end - list.begin) * LANES;
    for (std::vector<float> *const values : {&out.depth, &out.half, &out.column}) {
        values->resize(std::max(values->size(), most));
    }
    out.count = 0;
    for (std::uint32_t i = list.begin; i < list.end; ++i) {
        const Crossing at = cross(list[i], rays);
        if (xsimd::any(at.met)) {
            const std::size_t first = LANES * out.count++;
            at.depth.store_unaligned(out.depth.data() + first);
            at.half.store_unaligned(out.half.data() + first);
            at.column.store_unaligned(out.column.data() + first);
        }
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
