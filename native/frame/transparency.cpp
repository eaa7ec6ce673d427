// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/transparency.hpp"

#include "text/oit_text.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/gtc/packing.hpp>

namespace sfumato {
namespace {

using OitText = text::OitText<float>;
using Harmonic = OitText::Harmonic;

float number(std::size_t k) {
    return static_cast<float>(k);
}

// Sums over fragments are in double precision: in single, the order of submission would now and then decide between
// two levels of what is kept.

// Radiance and weights.
struct Seen {
    void add(const glm::vec3 &radiance, float weight) {
        colour += double{weight} * glm::dvec3(radiance);
        sum += double{weight};
    }
    // What the colours come to, times what their weights are to be multiplied by.
    [[nodiscard]] glm::vec3 times(float scale) const { return glm::vec3(colour) * scale; }
    [[nodiscard]] float weight() const { return static_cast<float>(sum); }

private:
    glm::dvec3 colour{0.0};
    double sum = 0.0;
};

// The share of light that all fragments let through.
float left_by(const PixelFragments &fragments) {
    double tau = 0.0;
    for (const float alpha : fragments.alpha) {
        tau += double{OitText().optical_depth_of(alpha)};
    }
    return OitText().transmittance_of(static_cast<float>(tau));
}

glm::vec4 normalised(const Seen &seen, float left) {
    return {seen.times(OitText().normalised(left, seen.weight())), 1.0F - left};
}

struct Fragment {
    float z, alpha, tau;
    glm::vec3 colour;
};

// a_k, b_k of harmonics 1, 2, ...
template <class Number>
using Pairs = std::array<std::array<Number, 2>, MOST_HARMONICS>;

void add_harmonics(Pairs<double> &pairs, std::size_t harmonics, float tau, float z) {
    const Harmonic first = OitText().harmonic(1.0F, z);
    Harmonic h = first;
    for (std::size_t k = 0; k < harmonics; ++k) {
        pairs[k][0] += double{OitText().project_cosine(tau, h, 1.0F)};
        pairs[k][1] += double{OitText().project_sine(tau, h, 1.0F)};
        h = OitText().next_harmonic(h, first);
    }
}

// The nearest layers. They are found as the GPU finds them, one behind the other, so that order does not matter.
class Nearest {
public:
    Nearest(std::span<const Fragment> fragments, std::size_t most) {
        for (; count < most; ++count) {
            float depth = BEHIND_ALL;
            for (const Fragment &fragment : fragments) {
                depth = fragment.z > end && fragment.z < depth ? fragment.z : depth;
            }
            if (depth == BEHIND_ALL) {
                return;
            }
            last = depth;
            add_layer(fragments);
        }
    }

    [[nodiscard]] bool before(float z) const { return z <= end; }

    // Of a fragment that is not behind the layers.
    [[nodiscard]] float seen(const Fragment &fragment) const {
        std::size_t i = 0;
        while (fragment.z > layers[i].end) {
            ++i;
        }
        return OitText().seen_in_layer(fragment.alpha, layers[i].level, layers[i].before);
    }

    float passed = 1.0F; // of the light, by all layers
    float tau = 0.0F;    // of all layers
    float last = 0.0F;   // the depth of the last

private:
    static constexpr float BEHIND_ALL = 2.0F;
    struct Layer {
        float end = 0.0F, level = 0.0F, before = 1.0F;
    };

    void add_layer(std::span<const Fragment> fragments) {
        const float start = end;
        end = OitText().layer_end(last);
        double sum = 0.0;
        for (const Fragment &fragment : fragments) {
            sum += fragment.z > start && fragment.z <= end ? double{fragment.tau} : 0.0;
        }
        const float light = OitText().transmittance_of(static_cast<float>(sum));
        layers[count] = {end, OitText().opacity_level(1.0F - light), passed};
        const float alpha = OitText().stored_opacity(layers[count].level);
        passed *= 1.0F - alpha;
        tau += OitText().optical_depth_of(alpha);
    }

    std::array<Layer, MOST_NEAREST> layers{};
    std::size_t count = 0;
    float end = -1.0F; // of the last layer
};

float half(double coefficient) {
    return glm::unpackHalf1x16(glm::packHalf1x16(static_cast<float>(std::clamp(coefficient, -65504.0, 65504.0))));
}

// The fragments behind them.
class Tail {
public:
    Tail(std::span<const Fragment> behind, float last, std::size_t of) : harmonics(of) {
        float low = 1.0F, high = 0.0F;
        double sum = 0.0;
        for (const Fragment &fragment : behind) {
            low = std::min(low, fragment.z);
            high = std::max(high, fragment.z);
            sum += double{fragment.tau};
        }
        range = OitText().stored_tail_range(OitText().tail_range(low, high, last), last);
        Pairs<double> sums{};
        for (const Fragment &fragment : behind) {
            add_harmonics(sums, harmonics, fragment.tau, OitText().relative_depth(range, fragment.z));
        }
        const auto stored = [sum](double coefficient) {
            const auto a0 = static_cast<float>(2.0 * sum);
            return OitText().eight_bit_ratio(OitText().tail_level(static_cast<float>(coefficient), a0));
        };
        for (std::size_t k = 0; k < harmonics; ++k) {
            pairs[k] = {stored(sums[k][0]), stored(sums[k][1])};
        }
    }

    // `total`: the tail's optical depth.
    [[nodiscard]] float seen(const Fragment &fragment, float total) const {
        const float d = OitText().relative_depth(range, fragment.z);
        OitText::TailDepth depth = OitText().tail_depth_start(total, d);
        const Harmonic first = OitText().harmonic(1.0F, d);
        Harmonic h = first;
        for (std::size_t k = 0; k < harmonics; ++k) {
            depth = OitText().tail_depth_step(depth, total, pairs[k][0], pairs[k][1], h, number(k + 1));
            h = OitText().next_harmonic(h, first);
        }
        return OitText().seen_in_tail(fragment.alpha, depth, total);
    }

private:
    std::size_t harmonics;
    OitText::DepthRange range{};
    Pairs<float> pairs{}; // shares of twice the tail's optical depth
};

} // namespace

glm::vec4 composite_nearest(const PixelFragments &pixel, std::size_t nearest, std::size_t harmonics) {
    std::vector<Fragment> fragments;
    fragments.reserve(pixel.depth.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < pixel.depth.size(); ++i) {
        const float tau = OitText().optical_depth_of(pixel.alpha[i]);
        if (tau > 0.0F) {
            fragments.push_back({OitText().fragment_depth(pixel.depth[i]), pixel.alpha[i], tau, pixel.colour[i]});
            sum += double{tau};
        }
    }
    const float all = OitText().stored_total(OitText().total_level(static_cast<float>(sum)));
    const Nearest layers(fragments, nearest);
    const auto behind =
        std::partition(fragments.begin(), fragments.end(), [&](const Fragment &f) { return layers.before(f.z); });
    const Tail tail({behind, fragments.end()}, layers.last, harmonics);
    const float total = OitText().tail_total(all, layers.tau);

    Seen near, far;
    std::for_each(fragments.begin(), behind, [&](const Fragment &f) { near.add(f.colour, layers.seen(f)); });
    std::for_each(behind, fragments.end(), [&](const Fragment &f) { far.add(f.colour, tail.seen(f, total)); });
    const float left = OitText().transmittance_of(all);
    const float of_tail = OitText().tail_opacity(layers.passed, total, far.weight());
    const float scale = OitText().layers_scale(left, near.weight(), of_tail);
    return {near.times(scale) + far.times(scale * OitText().tail_scale(of_tail, far.weight())), 1.0F - left};
}

glm::vec4 composite_fourier(const PixelFragments &fragments, std::size_t terms, float sigma) {
    double constant = 0.0;
    Pairs<double> pairs{};
    for (std::size_t i = 0; i < fragments.depth.size(); ++i) {
        const float tau = OitText().optical_depth_of(fragments.alpha[i]);
        constant += 2.0 * double{tau};
        add_harmonics(pairs, terms - 1, tau, fragments.depth[i]);
    }
    std::array<float, 2 * MOST_HARMONICS + 1> series{};
    series[0] = half(constant);
    for (std::size_t k = 1; k < terms; ++k) {
        series[2 * k - 1] = half(pairs[k - 1][0]);
        series[2 * k] = half(pairs[k - 1][1]);
    }
    average_series(std::span(series).first(2 * terms - 1), sigma);

    Seen seen;
    for (std::size_t i = 0; i < fragments.depth.size(); ++i) {
        const float d = fragments.depth[i];
        const Harmonic first = OitText().harmonic(1.0F, d);
        Harmonic h = first;
        float tau = OitText().integral_constant(series[0], d);
        for (std::size_t k = 1; k < terms; ++k) {
            tau += OitText().integral_harmonic(series[2 * k - 1], series[2 * k], h, number(k));
            h = OitText().next_harmonic(h, first);
        }
        seen.add(fragments.colour[i],
                 OitText().seen_of(fragments.alpha[i], OitText().clamp_optical_depth(tau, series[0])));
    }
    return normalised(seen, OitText().transmittance_of(0.5F * series[0]));
}

glm::vec4 composite_weighted(const PixelFragments &fragments) {
    Seen seen;
    for (std::size_t i = 0; i < fragments.depth.size(); ++i) {
        const float alpha = fragments.alpha[i];
        seen.add(fragments.colour[i], alpha * OitText().blended_weight(alpha, fragments.depth[i]));
    }
    return normalised(seen, left_by(fragments));
}

void average_series(std::span<float> coefficients, float p) {
    const float terms = number(coefficients.size() / 2 + 1);
    for (std::size_t c = 1; c < coefficients.size(); ++c) {
        coefficients[c] *= OitText().sigma_factor(number((c + 1) / 2), terms, p);
    }
}

} // namespace sfumato
