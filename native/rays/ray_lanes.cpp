// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays, many absorbers or receivers at a time.
#include "rays/curve_lanes.hpp"
#include "rays/ray_kernels.hpp"
#include "rays/series_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {
namespace {

inline Real load_some(const float *from, std::size_t count, float otherwise) {
    alignas(64) float lanes[LANES];
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(LANES); ++lane) {
        lanes[lane] = lane < count ? from[lane] : otherwise;
    }
    return Real::load_aligned(lanes);
}

inline Real load(const float *from, std::size_t count, float otherwise) {
    return count >= static_cast<std::size_t>(LANES) ? Real::load_unaligned(from) : load_some(from, count, otherwise);
}

// Halves are added to halves, with bounds that the compiler knows. xsimd 8.1 has haddp(), which mixes up rows on
// AVX-512.
template <int WIDTH>
inline float sum_of(float *lanes) {
    if constexpr (WIDTH == 1) {
        return lanes[0];
    } else {
#pragma GCC unroll 8
        for (int lane = 0; lane < WIDTH / 2; ++lane) {
            lanes[lane] += lanes[lane + WIDTH / 2];
        }
        return sum_of<WIDTH / 2>(lanes);
    }
}

inline float sum_of_lanes(Real x) {
    alignas(64) float lanes[LANES];
    x.store_aligned(lanes);
    return sum_of<LANES>(lanes);
}

} // namespace

// Piece by piece, each of which stays in the nearest cache.
void harmonic_sums(const HarmonicSums &sums) {
    constexpr std::size_t BLOCKS = 8, PIECE = BLOCKS * static_cast<std::size_t>(LANES);
    DepthRange range;
    range.low = sums.low;
    range.high = sums.high;
    for (std::size_t start = 0; start < sums.absorbers; start += PIECE) {
        Real tau[BLOCKS], all(0.0F);
        std::array<Turning, BLOCKS> waves;
        const std::size_t left = std::min(PIECE, sums.absorbers - start);
        const std::size_t blocks = (left + LANES - 1) / LANES;
        for (std::size_t b = 0; b < blocks; ++b) {
            const std::size_t done = b * LANES;
            tau[b] = load(sums.tau + start + done, left - done, 0.0F);
            const Real z = load(sums.depth + start + done, left - done, 0.0F);
            waves[b] = Turning(unit_harmonic(sums.half, RaysText().relative_depth(range, z)));
            all = all + tau[b];
        }
        float *out = sums.sums;
        *out++ += sum_of_lanes(all);
        sum_harmonics(tau, waves.data(), blocks, sums.harmonics, [&](std::size_t, Real cosine, Real sine) {
            *out++ += sum_of_lanes(cosine);
            if (!sums.half) {
                *out++ += sum_of_lanes(sine);
            }
        });
    }
}

void weigh_rows(const WeightedRows &weighted) {
    for (std::size_t i = 0; i < weighted.width; i += LANES) {
        Real sum(0.0F);
        for (std::size_t k = 0; k < weighted.count; ++k) {
            sum = xsimd::fma(Real::load_unaligned(weighted.rows + k * weighted.width + i), Real(weighted.weights[k]),
                             sum);
        }
        sum.store_unaligned(weighted.out + i);
    }
}

namespace {

// What receivers share, whatever their rays are stored as: `at(rays, depth)` answers for as many as there are lanes.
template <typename LookUp, typename At>
inline void for_receivers(const LookUp &look_up, const At &at) {
    int ray = 0, of_ray = 0; // of the next receiver
    for (int i = 0; i < look_up.total; i += LANES) {
        alignas(64) std::int32_t rays[LANES];
        const int count = std::min(LANES, look_up.total - i);
        for (int lane = 0; lane < LANES; ++lane) {
            rays[lane] = ray;
            of_ray += lane < count - 1 || count == LANES ? 1 : 0; // lanes to spare repeat the last
            ray += of_ray == look_up.receivers ? 1 : 0;
            of_ray = of_ray == look_up.receivers ? 0 : of_ray;
        }
        const Real light =
            at(Index::load_aligned(rays), load(look_up.depth + i, static_cast<std::size_t>(count), 0.0F));
        if (count == LANES) {
            light.store_unaligned(look_up.out + i);
        } else {
            alignas(64) float lanes[LANES];
            light.store_aligned(lanes);
            std::copy_n(lanes, count, look_up.out + i);
        }
    }
}

} // namespace

void look_up_series(const SeriesLookUp &look_up) {
    for_receivers(look_up, [&](Index ray, Real z) {
        DepthRange range;
        range.low = gather(look_up.ranges, ray + ray);
        range.high = gather(look_up.ranges + 1, ray + ray);
        const Real d = RaysText().relative_depth(range, z);
        const Index first_of_ray = ray * Index(look_up.count);
        const auto number = [&](int k) {
            const int divisor = look_up.half ? k : k + k % 2; // twice the pair's number
            return gather(look_up.coefficients + k, first_of_ray) * (2.0F / (TWO_PI * static_cast<float>(divisor)));
        };
        const Real total = gather(look_up.coefficients, first_of_ray) * (look_up.half ? 1.0F : 0.5F);
        const Real tau = look_up.half ? integral_of<COSINE>(total, look_up.count, d, number, {})
                                      : integral_of<FOURIER>(total, look_up.count, d, number, {});
        return RaysText().transmittance_of(tau);
    });
}

void look_up_texels(const TexelLookUp &look_up) {
    if (look_up.curve) {
        for_receivers(look_up, [&](Index ray, Real z) { return curve_at(look_up.texels, ray * Index(RAY_WORDS), z); });
        return;
    }
    for_receivers(look_up, [&](Index ray, Real z) {
        Index word[RAY_WORDS];
        read_words(look_up.texels, ray * Index(RAY_WORDS), word);
        const Head head = head_of(word[0], word[1]);
        const Real d = RaysText().relative_depth(head.range, z);
        const Harmonic first = unit_harmonic(true, d);
        Real next(0.0F), after(0.0F);
#pragma GCC unroll 14
        for (int k = 14; k > 0; --k) { // integral_of<COSINE>() of a total of one, with the bytes' places known
            const Real ratio = RaysText().eight_bit_ratio(xsimd::to_float(byte_of(word[(5 + k) / 4], (5 + k) % 4)));
            const Real here = RaysText().clenshaw(ratio * (4.0F / (TWO_PI * static_cast<float>(k))),
                                                  2.0F * first.cosine, next, after);
            after = next;
            next = here;
        }
        return RaysText().transmittance_of(head.total * clamp(d + first.sine * next, 0.0F, 1.0F));
    });
}

extern const RayKernels ray_kernels{harmonic_sums, weigh_rows, look_up_series, look_up_texels};

} // namespace sfumato::SFUMATO_ISA
