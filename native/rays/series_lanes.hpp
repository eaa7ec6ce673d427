// SPDX-License-Identifier: GPL-3.0-or-later
// Series in lanes, for whatever a lane is: an absorber or a receiver of one ray, or a ray of a map.
#pragma once

#include "rays/basis.hpp"
#include "text/lanes.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace sfumato::SFUMATO_ISA {
namespace {

using RaysText = text::RaysText<Real, Isa>;
using DepthRange = RaysText::DepthRange;
using Harmonic = RaysText::Harmonic;

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

// ---- Projection ----

// One absorber's harmonics, the next from the last. Turning is exact for any number of them.
struct Turning {
    Turning() = default;
    explicit Turning(Harmonic unit) : first(unit), here(unit) {}
    void next() { here = RaysText().next_harmonic(here, first); }

    Harmonic first, here;
};

// A quarter of the price, for few cosines alone: the error grows with the square of their number.
struct Swinging {
    Swinging() = default;
    explicit Swinging(Harmonic unit) : twice(unit.cosine + unit.cosine), last(1.0F) { here.cosine = unit.cosine; }
    void next() {
        const Real next = RaysText().next_cosine(twice, here.cosine, last);
        last = here.cosine;
        here.cosine = next;
    }

    Real twice, last;
    Harmonic here;
};

// add(k, sum of tau cos, sum of tau sin) for the harmonics k = 1, ... of `blocks` times as many absorbers as there are
// lanes: one absorber's harmonics follow from each other, but those of different absorbers need not wait.
template <typename Waves, typename Add>
inline void sum_harmonics(const Real *tau, Waves *waves, std::size_t blocks, std::size_t harmonics, const Add &add) {
    for (std::size_t k = 1; k <= harmonics; ++k) {
        Real cosine(0.0F), sine(0.0F);
        for (std::size_t b = 0; b < blocks; ++b) {
            cosine = xsimd::fma(tau[b], waves[b].here.cosine, cosine);
            if constexpr (std::is_same_v<Waves, Turning>) {
                sine = xsimd::fma(tau[b], waves[b].here.sine, sine);
            }
            waves[b].next();
        }
        add(k, cosine, sine);
    }
}

// ---- Evaluation ----

// The sum of c_k G_k(d). `total` is the optical depth behind everything, and number(k) gives of coefficient k > 0
//     Fourier  a_j / (2 pi j), b_j / (2 pi j), in turn    cosine   c_k / (pi k)
//     slices   the sum of all slices before slice k       learned  c_k
// so that nothing is left to divide. Of slices, k is a number for each lane.
template <BasisName BASIS, typename Number>
inline Real integral_of(Real total, int count, Real d, const Number &number, const TablesView &tables) {
    Real sum;
    if constexpr (BASIS == FOURIER) {
        Turning wave(unit_harmonic(false, d));
        sum = total * d;
        for (int k = 1; k + 1 < count; k += 2) {
            sum = sum + RaysText().integral_of_pair(number(k), number(k + 1), wave.here);
            wave.next();
        }
    } else if constexpr (BASIS == COSINE) {
        const Harmonic first = unit_harmonic(true, d);
        const Real twice = first.cosine + first.cosine;
        Real next(0.0F), after(0.0F);
        for (int k = count - 1; k > 0; --k) {
            const Real here = RaysText().clenshaw(number(k), twice, next, after);
            after = next;
            next = here;
        }
        sum = total * d + next * first.sine;
    } else if constexpr (BASIS == PIECEWISE) {
        const RaysText::TablePosition at = RaysText().table_position(d, static_cast<float>(count));
        const Index slice = truncate(at.cell);
        const Real before = pick(at.cell < 0.5F, 0.0F, number(xsimd::max(slice, Index(1))));
        const Real after = pick(at.cell > static_cast<float>(count) - 1.5F, total,
                                number(xsimd::min(slice + Index(1), Index(std::max(count - 1, 1)))));
        sum = before + (after - before) * at.fraction;
    } else {
        const RaysText::TablePosition at = RaysText().table_position(d, static_cast<float>(tables.cells));
        const Index cell = truncate(at.cell);
        sum = Real(0.0F);
        for (int k = 0; k < count; ++k) {
            const float *row = tables.g + static_cast<std::ptrdiff_t>(k) * (tables.cells + 1);
            const Real before = gather(row, cell), after = gather(row + 1, cell);
            sum = sum + (k == 0 ? total : number(k)) * (before + (after - before) * at.fraction);
        }
    }
    return clamp(sum, 0.0F, total);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
