// SPDX-License-Identifier: GPL-3.0-or-later
#include "rays/choose_basis.hpp"

#include "rays/curve.hpp"
#include "rays/learned_basis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sfumato {
namespace {

constexpr float Q = 3.0F; // standard deviations of RangeKind::BOTH

// Depths over the ray's own range, so that smoke which moves as a whole is judged as before; at least a sixteenth of
// the map, lest the 16 bits of a range decide.
std::array<float, 65> receivers(const Absorbers &ray) {
    const Range range = depth_range(ray, RangeKind::MINMAX, Q);
    const float width = std::max(range.high - range.low, 1.0F / 16.0F), middle = 0.5F * (range.low + range.high);
    std::array<float, 65> depths{};
    for (std::size_t k = 0; k < depths.size(); ++k) {
        depths[k] = middle + width * ((static_cast<float>(k) + 0.37F) / 65.0F - 0.5F);
    }
    return depths;
}

std::vector<Range> ranges_of(std::span<const Absorbers> rays, RangeKind kind) {
    std::vector<Range> ranges;
    for (const Absorbers &ray : rays) {
        ranges.push_back(depth_range(ray, kind, Q));
    }
    return ranges;
}

// The exact transmittance between vertices.
float on_curve(std::span<const CurveVertex> curve, double z) {
    const auto after =
        std::upper_bound(curve.begin(), curve.end(), z, [](double depth, const CurveVertex &v) { return depth < v.z; });
    if (after == curve.begin()) {
        return 1.0F;
    }
    const CurveVertex &before = *(after - 1);
    if (after == curve.end()) {
        return static_cast<float>(before.t);
    }
    return static_cast<float>(before.t + (after->t - before.t) * (z - before.z) / (after->z - before.z));
}

double squared_error(const Choice &choice, const Absorbers &ray) {
    const auto depths = receivers(ray);
    std::array<float, 65> found{};
    std::vector<std::uint8_t> texel(choice.bytes());
    store(choice, ray, texel);
    look_up(choice, texel, depths, found);
    const std::vector<CurveVertex> exact = exact_curve(ray);
    double sum = 0.0;
    for (std::size_t k = 0; k < depths.size(); ++k) {
        sum += std::pow(double{found[k]} - on_curve(exact, depths[k]), 2);
    }
    return sum / static_cast<double>(depths.size());
}

std::string thousandths(float error) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f", 1000.0 * double{error});
    return text.data();
}

} // namespace

std::string Choice::name() const {
    if (curve) {
        return "curve";
    }
    const std::array<const char *, 5> suffix = {"", "-range", "-moments", "-both", "-trimmed"};
    return series.basis().name + std::string(suffix[static_cast<std::size_t>(range)]);
}

std::size_t Choice::bytes() const {
    return curve ? CURVE_BYTES : texel_bytes(series);
}

void store(const Choice &choice, const Absorbers &ray, std::span<std::uint8_t> texel) {
    if (choice.curve) {
        fit_curve(exact_curve(ray), texel);
        return;
    }
    std::vector<float> coefficients(choice.series.count, 0.0F);
    const Range range = depth_range(ray, choice.range, Q);
    project(choice.series, ray, range, coefficients);
    pack(choice.series, coefficients, range, texel);
}

void look_up(const Choice &choice, std::span<const std::uint8_t> texels, std::span<const float> depth,
             std::span<float> out) {
    if (choice.curve) {
        curve_transmittance(texels, depth, out);
        return;
    }
    const std::size_t bytes = choice.bytes(), rays = texels.size() / bytes;
    const std::size_t receivers = depth.size() / std::max<std::size_t>(rays, 1);
    const RayEvaluator evaluate(choice.series, choice.evaluator);
    std::vector<float> coefficients(choice.series.count);
    for (std::size_t ray = 0; ray < rays; ++ray) {
        const Range range = unpack(choice.series, texels.subspan(ray * bytes, bytes), coefficients);
        evaluate(coefficients, range, depth.subspan(ray * receivers, receivers),
                 out.subspan(ray * receivers, receivers));
    }
}

Choice choose_basis(std::span<const Absorbers> rays, std::size_t bytes, bool additive) {
    std::vector<Absorbers> teachers, judges;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        (r % 2 == 0 ? teachers : judges).push_back(rays[r]);
    }
    if (judges.empty()) {
        judges = teachers;
    }
    std::vector<Choice> candidates; // the simplest first
    if (!additive && bytes >= CURVE_BYTES) {
        candidates.emplace_back().curve = true;
    }
    for (const BasisName name : {COSINE, LEARNED, FOURIER, PIECEWISE}) {
        for (const RangeKind range : {RangeKind::MINMAX, RangeKind::TRIMMED, RangeKind::BOTH}) {
            Choice &choice = candidates.emplace_back();
            choice.range = range;
            choice.series = {name, coefficients_in(name, bytes), {}};
            if (name == LEARNED) {
                choice.series = learn_basis(teachers, ranges_of(teachers, range), choice.series.count);
            }
        }
    }
    for (Choice &choice : candidates) {
        double sum = 0.0;
        for (const Absorbers &ray : judges) {
            sum += squared_error(choice, ray);
        }
        choice.error =
            static_cast<float>(std::sqrt(sum / static_cast<double>(std::max<std::size_t>(judges.size(), 1))));
    }
    // The simplest of those that are within a tenth of the best: a choice that hangs by less would change from frame to
    // frame, and the light with it.
    const auto worse = [](const Choice &a, const Choice &b) { return a.error < b.error; };
    const float least = std::min_element(candidates.begin(), candidates.end(), worse)->error;
    const auto simplest =
        std::find_if(candidates.begin(), candidates.end(), [&](const Choice &c) { return c.error <= 1.1F * least; });
    Choice best = *simplest;
    candidates.erase(simplest);
    const Choice &next = *std::min_element(candidates.begin(), candidates.end(), worse);
    if (!best.curve && best.series.name == LEARNED) { // now all rays may teach
        best.series = learn_basis(rays, ranges_of(rays, best.range), best.series.count);
    }
    best.reason = best.name() + ": RMS error of T " + thousandths(best.error) + "e-3 on " +
                  std::to_string(judges.size()) + " of the scene's rays at " + std::to_string(bytes) +
                  " bytes, against " + thousandths(next.error) + "e-3 of " + next.name();
    return best;
}

} // namespace sfumato
