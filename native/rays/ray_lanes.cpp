// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays, many absorbers or receivers at a time.
#include "rays/ray_kernels.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {
namespace {

using RaysText = text::RaysText<Real, Isa>;
using DepthRange = RaysText::DepthRange;
using Harmonic = RaysText::Harmonic;

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

// harmonic(1, z) or harmonic(1/2, z) of the text for z in [0, 1] only: sin pi u and cos pi u with u = z - 1/2 by
// polynomials, whose errors are below 2e-8, in a third of the time.
inline Harmonic unit_harmonic(bool half, Real z) {
    const Real u = z - 0.5F, x = u * u;
    Real sine(0.0776576603F), cosine(-0.0243963243F);
    for (const float c : {-0.598291286F, 2.55007752F, -5.16771008F, 3.14159264F}) {
        sine = xsimd::fma(sine, x, Real(c));
    }
    for (const float c : {0.234937314F, -1.335212F, 4.05870916F, -4.93480214F, 1.0F}) {
        cosine = xsimd::fma(cosine, x, Real(c));
    }
    sine = u * sine;
    Harmonic h;
    h.cosine = half ? -sine : 2.0F * sine * sine - 1.0F;
    h.sine = half ? cosine : -2.0F * sine * cosine;
    return h;
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

// Harmonic by harmonic over a piece of the ray that stays in registers and the nearest cache: one absorber's harmonics
// follow from each other, but those of different absorbers need not wait.
void harmonic_sums(const HarmonicSums &sums) {
    constexpr std::size_t BLOCKS = 8, PIECE = BLOCKS * static_cast<std::size_t>(LANES);
    DepthRange range;
    range.low = sums.low;
    range.high = sums.high;
    for (std::size_t start = 0; start < sums.absorbers; start += PIECE) {
        Real tau[BLOCKS];
        Harmonic first[BLOCKS], h[BLOCKS];
        const std::size_t left = std::min(PIECE, sums.absorbers - start);
        const std::size_t blocks = (left + LANES - 1) / LANES;
        float *out = sums.sums;
        Real all(0.0F);
        for (std::size_t b = 0; b < blocks; ++b) {
            const std::size_t done = b * LANES;
            tau[b] = load(sums.tau + start + done, left - done, 0.0F);
            const Real z = load(sums.depth + start + done, left - done, 0.0F);
            first[b] = h[b] = unit_harmonic(sums.half, RaysText().relative_depth(range, z));
            all = all + tau[b];
        }
        *out++ += sum_of_lanes(all);
        for (std::size_t k = 1; k <= sums.harmonics; ++k) {
            Real cosine(0.0F), sine(0.0F);
            for (std::size_t b = 0; b < blocks; ++b) {
                cosine = xsimd::fma(tau[b], h[b].cosine, cosine);
                sine = xsimd::fma(tau[b], h[b].sine, sine);
                h[b] = RaysText().next_harmonic(h[b], first[b]);
            }
            *out++ += sum_of_lanes(cosine);
            if (!sums.half) {
                *out++ += sum_of_lanes(sine);
            }
        }
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

inline Index byte_of(Index word, int byte) {
    return (word >> (8 * byte)) & Index(255);
}

// The head of a texel (basis.hpp): the range in 16 bits each, and the total as a half float, not negative.
struct Head {
    DepthRange range;
    Real total;
};

inline Head head_of(Index low_high, Index total) {
    Head head;
    const Index low = low_high & Index(65535), high = (low_high >> 16) & Index(65535);
    head.range.low = RaysText().stored_depth(xsimd::to_float(low));
    head.range.high = RaysText().stored_depth(xsimd::to_float(high));
    const Index exponent = (total >> 10) & Index(31), mantissa = total & Index(1023);
    const Real scale = xsimd::ldexp(Real(1.0F), xsimd::max(exponent, Index(1)) - Index(25));
    head.total = (xsimd::to_float(mantissa) + pick(xsimd::to_float(exponent) > 0.5F, 1024.0F, 0.0F)) * scale;
    return head;
}

} // namespace

void look_up_series(const SeriesLookUp &look_up) {
    for_receivers(look_up, [&](Index ray, Real z) {
        DepthRange range;
        range.low = gather(look_up.ranges, ray + ray);
        range.high = gather(look_up.ranges + 1, ray + ray);
        const Real d = RaysText().relative_depth(range, z);
        const Index first_of_ray = ray * Index(look_up.count);
        const auto coefficient = [&](int c) { return gather(look_up.coefficients + c, first_of_ray); };
        const Harmonic first = unit_harmonic(look_up.half, d);
        const Real a0 = coefficient(0) * (look_up.half ? 2.0F : 1.0F);
        Real tau = RaysText().integral_constant(a0, d);
        if (look_up.half) {
            Real next(0.0F), after(0.0F);
            for (int k = look_up.count - 1; k > 0; --k) {
                const Real c = coefficient(k) * (2.0F / (TWO_PI * static_cast<float>(k)));
                const Real here = RaysText().clenshaw(c, 2.0F * first.cosine, next, after);
                after = next;
                next = here;
            }
            tau = tau + first.sine * next;
        } else {
            Harmonic h = first;
            for (int k = 1; 2 * k < look_up.count; ++k) {
                tau = tau + RaysText().integral_harmonic(coefficient(2 * k - 1), coefficient(2 * k), h,
                                                         static_cast<float>(k));
                h = RaysText().next_harmonic(h, first);
            }
        }
        return RaysText().transmittance_of(RaysText().clamp_optical_depth(tau, a0));
    });
}

void look_up_texels(const TexelLookUp &look_up) {
    const auto words = [&](Index ray, Index word[RAY_WORDS]) {
        const Index first = ray * Index(RAY_WORDS);
        for (int w = 0; w < RAY_WORDS; ++w) {
            word[w] = Index::gather(look_up.texels + w, first);
        }
    };
    if (look_up.curve) {
        for_receivers(look_up, [&](Index ray, Real z) {
            Index word[RAY_WORDS];
            words(ray, word);
            const Head head = head_of(word[0], word[1]);
            const Real d = RaysText().relative_depth(head.range, z), total = RaysText().transmittance_of(head.total);
            RaysText::CurveSegment segment = RaysText().curve_start();
            Real depth_left(1.0F), share_left(1.0F);
#pragma GCC unroll 7
            for (int k = 0; k < 7; ++k) {
                const int z_at = 6 + k, t_at = 13 + k;
                depth_left = RaysText().next_left(depth_left, xsimd::to_float(byte_of(word[z_at / 4], z_at % 4)));
                share_left = RaysText().next_left(share_left, xsimd::to_float(byte_of(word[t_at / 4], t_at % 4)));
                segment = RaysText().curve_step(segment, d, depth_left, share_left);
            }
            return RaysText().curve_transmittance(z, head.range, RaysText().curve_inside(segment, d, total), total);
        });
        return;
    }
    for_receivers(look_up, [&](Index ray, Real z) {
        Index word[RAY_WORDS];
        words(ray, word);
        const Head head = head_of(word[0], word[1]);
        const Real d = RaysText().relative_depth(head.range, z);
        const Harmonic first = unit_harmonic(true, d);
        Real next(0.0F), after(0.0F);
#pragma GCC unroll 14
        for (int k = 14; k > 0; --k) {
            const Real ratio = RaysText().eight_bit_ratio(xsimd::to_float(byte_of(word[(5 + k) / 4], (5 + k) % 4)));
            const Real here = RaysText().clenshaw(ratio * (4.0F / (TWO_PI * static_cast<float>(k))),
                                                  2.0F * first.cosine, next, after);
            after = next;
            next = here;
        }
        // Of a total of one.
        return RaysText().transmittance_of(head.total * clamp(d + first.sine * next, 0.0F, 1.0F));
    });
}

extern const RayKernels ray_kernels{harmonic_sums, weigh_rows, look_up_series, look_up_texels};

} // namespace sfumato::SFUMATO_ISA
