// SPDX-License-Identifier: GPL-3.0-or-later
// The stage that merges what a march, particles, fragments and air send to the eye, front to back.
//
// Of each ray, let fragments before a place leave L of what is behind them, particles exp(-P), and grids, up to t, send
// R(t) and leave exp(-D(t)). Then between two fragments, in a slice of particles of optical depth p that would send s
// by itself, what is added is
//     L exp(-P) ( dR f(p) + exp(-D) s f(p + dD) ),    f(x) = (1 - exp(-x)) / x ,
// where f is what a stretch of optical depth x leaves, on the mean over the stretch, of what is sent in it. Air is as
// grids are, with dA for dR and E for D: in a stretch that is no longer than a step of the march, what is added is
//     L exp(-P) ( exp(-E) dR f(p + dE) + exp(-D) dA f(p + dD) + exp(-D - E) s f(p + dD + dE) ) .
#include "frame/layers.hpp"
#include "text/lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

constexpr float ENDLESS = std::numeric_limits<float>::max();

Real mean_left(Real depth) {
    const Real series = 1.0F - depth * (0.5F - depth * (1.0F / 6.0F - depth * (1.0F / 24.0F)));
    return pick(depth < 0.03F, series, (1.0F - exp(-depth)) / max(depth, 1e-30F));
}

template <int COLOURS>
struct Depth {
    Real of[COLOURS];
    [[nodiscard]] Real in(int colour) const { return of[COLOURS == 1 ? 0 : colour]; }
};

// The grids' smoke up to a place; places only move on.
template <int COLOURS>
class Grids {
public:
    struct Upto {
        Real radiance[3];
        Depth<COLOURS> depth;
    };

    explicit Grids(const Knots &knots) : knots_(knots) {}

    [[nodiscard]] bool any() const { return knots_.count > 0; }

    // From `t` on, where the next step begins or ends.
    [[nodiscard]] Real next(Real t) const {
        const Real past = pick(value(0, knot_) <= t, 1.0F, 0.0F);
        const Real number = xsimd::to_float(knot_) + past;
        const auto last = static_cast<float>(knots_.count - 1);
        const Index knot = truncate(min(number, last));
        const Real ends = value(0, knot), begins = ends - value(4 + COLOURS, knot);
        // Rays that meet nothing have steps of no length.
        return pick((number > last) | (ends <= t), ENDLESS, pick(t < begins, begins, ends));
    }

    Upto upto(Real t) {
        const Index last(knots_.count - 1);
        while (true) {
            const Real further =
                pick((value(0, knot_) < t) & (xsimd::to_float(knot_) < xsimd::to_float(last)), 1.0F, 0.0F);
            if (!xsimd::any(further > 0.0F)) {
                break;
            }
            knot_ = knot_ + truncate(further);
        }
        // Between two steps, where a march leaps, nothing is added.
        const Real share = clamp((t - value(0, knot_)) / max(value(4 + COLOURS, knot_), 1e-30F) + 1.0F, 0.0F, 1.0F);
        const Mask first = xsimd::to_float(knot_) < 0.5F;
        const Index before = max_index(knot_ - Index(1));
        const auto between = [&](int row) {
            const Real low = pick(first, 0.0F, value(row, before));
            return low + (value(row, knot_) - low) * share;
        };
        Upto out;
        for (int c = 0; c < 3; ++c) {
            out.radiance[c] = between(1 + c);
        }
        for (int c = 0; c < COLOURS; ++c) {
            out.depth.of[c] = between(4 + c);
        }
        return out;
    }

private:
    static Index max_index(Index i) { return xsimd::max(i, Index(0)); }
    [[nodiscard]] Real value(int row, Index knot) const {
        return gather(knots_.values.data() + static_cast<std::ptrdiff_t>(row) * MAX_LANES,
                      knot * Index(Knots::rows(COLOURS) * MAX_LANES) + truncate(lane_numbers()));
    }

    const Knots &knots_;
    Index knot_ = Index(0);
};

// The air up to a place; places only move on.
template <int COLOURS>
class Airs {
public:
    using Upto = typename Grids<COLOURS>::Upto;

    explicit Airs(const AirKnots &knots) : knots_(knots) {}

    [[nodiscard]] bool any() const { return knots_.count > 0; }

    Upto upto(Real t) {
        const auto last = static_cast<float>(knots_.count - 1);
        while (true) {
            const Real further = pick((value(0, 1) < t) & (knot_ + 1.0F < last), 1.0F, 0.0F);
            if (!xsimd::any(further > 0.0F)) {
                break;
            }
            knot_ = knot_ + further;
        }
        const Real low = value(0, 0), high = value(0, 1);
        const Real share = clamp((t - low) / max(high - low, 1e-30F), 0.0F, 1.0F);
        const auto between = [&](int row) {
            const Real before = value(row, 0);
            return before + (value(row, 1) - before) * share;
        };
        Upto out;
        for (int c = 0; c < 3; ++c) {
            out.radiance[c] = between(1 + c);
        }
        for (int c = 0; c < COLOURS; ++c) {
            out.depth.of[c] = between(4 + c);
        }
        return out;
    }

private:
    [[nodiscard]] Real value(int row, int after) const {
        return gather(knots_.row(after, row, COLOURS),
                      truncate(knot_) * Index((4 + COLOURS) * MAX_LANES) + truncate(lane_numbers()));
    }

    const AirKnots &knots_;
    Real knot_ = 0.0F;
};

// The fragments of all lanes in order: the first of each, then the second.
class Fragments {
public:
    explicit Fragments(Events &events) {
        for (int lane = 0; lane < LANES; ++lane) {
            sort_fragments(events.fragments[static_cast<std::size_t>(lane)]);
            rows_ = std::max(rows_, events.fragments[static_cast<std::size_t>(lane)].size());
        }
        values_.assign((rows_ + 1) * ROW, ENDLESS); // after the last comes none
        for (std::size_t lane = 0; lane < LANES; ++lane) {
            float *to = values_.data() + lane;
            for (const Fragment &fragment : events.fragments[lane]) {
                to[0] = fragment.distance;
                for (int c = 0; c < 3; ++c) {
                    to[(1 + c) * LANES] = fragment.radiance[c];
                    to[(4 + c) * LANES] = fragment.left[c];
                }
                to += ROW;
            }
        }
    }

    [[nodiscard]] bool any() const { return rows_ > 0; }
    // Of the next in each lane: the distance, then what it adds, then what it leaves.
    [[nodiscard]] Real next(int row) const {
        return gather(values_.data() + static_cast<std::ptrdiff_t>(row) * LANES,
                      at_ * Index(static_cast<int>(ROW)) + truncate(lane_numbers()));
    }
    void pass(Mask which) { at_ = at_ + truncate(pick(which, 1.0F, 0.0F)); }

private:
    static constexpr std::size_t ROW = std::size_t{7} * LANES;
    std::size_t rows_ = 0;
    std::vector<float> values_;
    Index at_ = Index(0);
};

template <int COLOURS>
class Merge {
public:
    Merge(Events &events, Real end)
        : slices_(events.slices), fragments_(events), grids_(events.knots), airs_(events.air), end_(end) {
        for (int c = 0; c < 3; ++c) {
            radiance_[c] = 0.0F;
            left_[c] = 1.0F;
            here_.radiance[c] = air_.radiance[c] = 0.0F;
        }
        for (int c = 0; c < COLOURS; ++c) {
            past_slices_.of[c] = 1.0F;
            here_.depth.of[c] = air_.depth.of[c] = 0.0F;
        }
    }

    void run() {
        const Real first = slices_.count > 0 ? Real::load_aligned(slices_.first) : Real(ENDLESS);
        const Real width = slices_.count > 0 ? Real::load_aligned(slices_.width) : Real(1.0F);
        within(-1, 0.0F, min(first, end_));
        Real near = first;
        for (int s = 0; s < slices_.count && !hidden(); ++s) {
            within(s, near, near + width);
            near = near + width;
        }
        within(-1, min(near, end_), end_);
        advance(-1, 0.0F, end_);
    }

    void store(Layers &out) const {
        for (int c = 0; c < 3; ++c) {
            radiance_[c].store_aligned(out.smoke[c]);
            through(c).store_aligned(out.through[c]);
        }
    }

private:
    [[nodiscard]] Real through(int c) const {
        const Real left = left_[c] * past_slices_.in(c)*exp(-here_.depth.in(c));
        return airs_.any() ? left * exp(-air_.depth.in(c)) : left;
    }
    [[nodiscard]] bool hidden() const {
        Real most = 0.0F;
        for (int c = 0; c < 3; ++c) {
            most = max(most, left_[c] * past_slices_.in(c));
        }
        return highest(most) < OPAQUE_LEFT;
    }
    static Real row_of(const std::vector<float> &rows, int row) {
        return Real::load_unaligned(rows.data() + static_cast<std::ptrdiff_t>(row) * MAX_LANES);
    }
    [[nodiscard]] bool particles_in(int slice) const {
        for (int c = 0; c < COLOURS && slice >= 0; ++c) {
            if (xsimd::any(row_of(slices_.depth, slice * COLOURS + c) > 0.0F)) {
                return true;
            }
        }
        return false;
    }

    // From one end of a slice, or of a stretch without particles (-1), to the other, with the fragments in it.
    void within(int slice, Real near, Real far) {
        Real at = near;
        const Real by = 1.0F / max(far - near, 1e-30F);
        while (fragments_.any()) {
            const Real distance = fragments_.next(0);
            const Mask met = (distance < far) & (distance < end_);
            if (!xsimd::any(met)) {
                break;
            }
            const Real to = pick(met, max(distance, at), at);
            advance(slice, (to - at) * by, to);
            for (int c = 0; c < 3; ++c) {
                const Real seen = through(c);
                radiance_[c] = radiance_[c] + pick(met, seen * fragments_.next(1 + c), 0.0F);
                left_[c] = left_[c] * pick(met, fragments_.next(4 + c), 1.0F);
            }
            fragments_.pass(met);
            at = to;
        }
        // What grids send before a slice is not behind any of it.
        const bool enters = slice + 1 < slices_.count && particles_in(slice + 1);
        if (particles_in(slice) || enters || airs_.any()) {
            advance(slice, (far - at) * by, far);
        }
    }

    // Through a share of a slice, which ends at `to`.
    void advance(int slice, Real share, Real to) {
        if (!airs_.any()) {
            step(slice, share, to);
            return;
        }
        to = max(min(to, end_), at_);
        const Real per_length = share / max(to - at_, 1e-30F);
        while (grids_.any()) {
            const Real next = min(grids_.next(at_), to);
            if (!xsimd::any(next < to)) {
                break;
            }
            step_in_air(slice, per_length * (next - at_), next);
        }
        step_in_air(slice, per_length * (to - at_), to);
    }

    void step_in_air(int slice, Real share, Real to) {
        const bool particles = particles_in(slice);
        typename Grids<COLOURS>::Upto grids = here_, air = airs_.upto(to);
        if (grids_.any()) {
            grids = grids_.upto(to);
        }
        for (int c = 0; c < 3; ++c) {
            const auto row = [&](const std::vector<float> &rows, int count) {
                return particles ? row_of(rows, count * slice + (count == 1 ? 0 : c)) * share : Real(0.0F);
            };
            const Real p = row(slices_.depth, COLOURS), sent = row(slices_.sent, 3);
            const Real d = grids.depth.in(c)-here_.depth.in(c), e = air.depth.in(c)-air_.depth.in(c);
            const Real past_grids = exp(-here_.depth.in(c)), past_air = exp(-air_.depth.in(c));
            Real sum = past_air * (grids.radiance[c] - here_.radiance[c]) * mean_left(p + e) +
                       past_grids * (air.radiance[c] - air_.radiance[c]) * mean_left(p + d);
            if (particles) {
                sum = sum + past_grids * past_air * sent * mean_left(p + d + e);
            }
            radiance_[c] = radiance_[c] + left_[c] * past_slices_.in(c)*sum;
        }
        for (int c = 0; c < COLOURS && particles; ++c) {
            past_slices_.of[c] = past_slices_.of[c] * exp(-row_of(slices_.depth, slice * COLOURS + c) * share);
        }
        here_ = grids;
        air_ = air;
        at_ = to;
    }

    // The same without air. What grids send on the way is added where something else follows.
    void step(int slice, Real share, Real to) {
        const bool particles = particles_in(slice);
        Depth<COLOURS> taken;
        for (int c = 0; c < COLOURS; ++c) {
            taken.of[c] = particles ? row_of(slices_.depth, slice * COLOURS + c) * share : Real(0.0F);
        }
        typename Grids<COLOURS>::Upto there = here_;
        if (grids_.any()) {
            there = grids_.upto(min(to, end_));
        }
        for (int c = 0; c < 3; ++c) {
            const Real seen = left_[c] * past_slices_.in(c);
            const Real grids = there.radiance[c] - here_.radiance[c];
            if (!particles) {
                radiance_[c] = radiance_[c] + seen * grids;
                continue;
            }
            const Real both = taken.in(c) + there.depth.in(c)-here_.depth.in(c);
            const Real sent = row_of(slices_.sent, 3 * slice + c) * share * exp(-here_.depth.in(c));
            radiance_[c] = radiance_[c] + seen * (grids * mean_left(taken.in(c)) + sent * mean_left(both));
        }
        for (int c = 0; c < COLOURS && particles; ++c) {
            past_slices_.of[c] = past_slices_.of[c] * exp(-taken.of[c]);
        }
        here_ = there;
    }

    const Slices &slices_;
    Fragments fragments_;
    Grids<COLOURS> grids_;
    Airs<COLOURS> airs_;
    Real end_;
    Real at_ = 0.0F;
    Real radiance_[3], left_[3];
    Depth<COLOURS> past_slices_;
    typename Grids<COLOURS>::Upto here_, air_; // up to at_
};

template <int COLOURS>
void merge_in(Layers &layers) {
    Merge<COLOURS> merge(*layers.events, Real::load_aligned(layers.distance));
    merge.run();
    merge.store(layers);
}

} // namespace

// Layers that a march has written stay where there is nothing else.
void merge(const FrameView &frame, const Packet & /*packet*/, Layers &layers) {
    if (!layers.events->any() && frame.air.empty()) {
        if (frame.seen_media.empty()) {
            for (int c = 0; c < 3; ++c) {
                Real(0.0F).store_aligned(layers.smoke[c]);
                Real(1.0F).store_aligned(layers.through[c]);
            }
        }
        return;
    }
    frame.grey ? merge_in<1>(layers) : merge_in<3>(layers);
}

} // namespace sfumato::SFUMATO_ISA
