// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/transparency.hpp"

#include "text/oit_text.hpp"

#include <algorithm>
#include <array>
#include <limits>

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

// The nearest fragments, layer by layer, nearest first.
class Nearest {
public:
    explicit Nearest(std::size_t layers_at_most) : most(layers_at_most) {}

    // Keeps the layers nearest; order of submission does not matter, since depths are those that are stored.
    void add(float z, float tau) {
        const auto end = layers.begin() + static_cast<std::ptrdiff_t>(count);
        const auto at = std::find_if(layers.begin(), end, [z](const Layer &layer) { return layer.depth >= z; });
        if (at != end && at->depth == z) {
            at->tau += double{tau};
        } else if (count < most) {
            std::move_backward(at, end, end + 1);
            *at = {z, double{tau}};
            ++count;
        } else if (at != end) {
            std::move_backward(at, end - 1, end);
            *at = {z, double{tau}};
        }
    }

    // To what is stored, once all fragments are there.
    void store() {
        for (std::size_t i = 0; i < count; ++i) {
            Layer &layer = layers[i];
            layer.before = passed;
            layer.alpha = OitText().stored_opacity(
                OitText().opacity_level(1.0F - OitText().transmittance_of(static_cast<float>(layer.tau))));
            passed *= 1.0F - layer.alpha;
        }
    }

    // What a fragment is seen as, or a negative number where it is behind all layers.
    [[nodiscard]] float seen(float z, float tau) const {
        for (std::size_t i = 0; i < count; ++i) {
            const Layer &layer = layers[i];
            if (layer.depth == z) {
                return OitText().seen_in_layer(tau, static_cast<float>(layer.tau), layer.alpha, layer.before);
            }
        }
        return -1.0F;
    }

    [[nodiscard]] float last() const { return count > 0 ? layers[count - 1].depth : 0.0F; }
    [[nodiscard]] bool behind(float z) const { return count == most && (most == 0 || z > last()); }

    float passed = 1.0F; // of the light, by all layers

private:
    struct Layer {
        float depth = 0.0F;
        double tau = 0.0;
        float alpha = 0.0F, before = 1.0F;
    };
    std::array<Layer, MOST_NEAREST + 1> layers{};
    std::size_t most, count = 0;
};

float half(double coefficient) {
    return glm::unpackHalf1x16(glm::packHalf1x16(static_cast<float>(std::clamp(coefficient, -65504.0, 65504.0))));
}

// All other fragments.
class Tail {
public:
    // `nearest` and `furthest` of them, behind the layer at `last`.
    Tail(float nearest, float furthest, float last)
        : range(OitText().stored_tail_range(OitText().tail_range(nearest, furthest, last), last)) {}

    void add(float z, float tau, std::size_t harmonics) {
        sum += double{tau};
        add_harmonics(sums, harmonics, tau, OitText().relative_depth(range, z));
    }

    void store(std::size_t harmonics) {
        const auto stored = [this](double coefficient) {
            return OitText().eight_bit_ratio(
                OitText().tail_level(static_cast<float>(coefficient), 2.0F * static_cast<float>(sum)));
        };
        for (std::size_t k = 0; k < harmonics; ++k) {
            pairs[k] = {stored(sums[k][0]), stored(sums[k][1])};
        }
        total = OitText().stored_total(OitText().total_level(static_cast<float>(sum)));
    }

    [[nodiscard]] float seen(float z, float alpha, std::size_t harmonics) const {
        const float d = OitText().relative_depth(range, z);
        OitText::TailDepth depth = OitText().tail_depth_start(total, d);
        const Harmonic first = OitText().harmonic(1.0F, d);
        Harmonic h = first;
        for (std::size_t k = 0; k < harmonics; ++k) {
            depth = OitText().tail_depth_step(depth, total, pairs[k][0], pairs[k][1], h, number(k + 1));
            h = OitText().next_harmonic(h, first);
        }
        return OitText().seen_in_tail(alpha, OitText().optical_depth_of(alpha), depth, total);
    }

    OitText::DepthRange range;
    float total = 0.0F; // optical depth, once stored
    Pairs<float> pairs; // of which only as many as are stored are there, as shares of 2 total

private:
    double sum = 0.0;
    Pairs<double> sums{};
};

} // namespace

glm::vec4 composite_nearest(const PixelFragments &fragments, std::size_t nearest, std::size_t harmonics) {
    const auto each = [&](const auto &body) {
        for (std::size_t i = 0; i < fragments.depth.size(); ++i) {
            const float tau = OitText().optical_depth_of(fragments.alpha[i]);
            if (tau > 0.0F) {
                body(OitText().fragment_depth(fragments.depth[i]), tau, i);
            }
        }
    };
    Nearest layers(nearest);
    each([&](float z, float tau, std::size_t) { layers.add(z, tau); });
    layers.store();

    float low = std::numeric_limits<float>::max(), high = 0.0F;
    each([&](float z, float, std::size_t) {
        if (layers.behind(z)) {
            low = std::min(low, z);
            high = std::max(high, z);
        }
    });
    const bool has_tail = low <= high;
    Tail tail(has_tail ? low : 0.0F, high, layers.last());
    if (has_tail) {
        each([&](float z, float tau, std::size_t) {
            if (layers.behind(z)) {
                tail.add(z, tau, harmonics);
            }
        });
        tail.store(harmonics);
    }

    Seen near, far;
    each([&](float z, float tau, std::size_t i) {
        if (layers.behind(z)) {
            far.add(fragments.colour[i], tail.seen(z, fragments.alpha[i], harmonics));
        } else {
            near.add(fragments.colour[i], layers.seen(z, tau));
        }
    });
    const float left = left_by(fragments);
    const float of_tail = OitText().tail_opacity(layers.passed, tail.total, far.weight());
    const float scale = OitText().nearest_scale(left, layers.passed, of_tail);
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
