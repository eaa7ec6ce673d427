// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/gloss_curves.hpp"

#include "text/microfacets_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sfumato {
namespace {

using Text = text::MicrofacetsText<double>;
using dvec3 = glm::dvec3;

// Of light from all sides: what is reflected for F = 1, and weighted by Fresnel's share.
struct Albedo {
    double plain = 0.0, fresnel = 0.0;
};

// The mean over the facets that the eye sees (Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps",
// 2023), at the middles of equal parts of the cap; both halves of it are alike.
Albedo albedo(double alpha, double index, double cosine) {
    constexpr int RINGS = 24, SPOKES = 12;
    const dvec3 view(std::sqrt(std::max(1.0 - cosine * cosine, 0.0)), 0.0, cosine);
    Text::Microfacets m = Text().microfacets(BRDF_GGX, view, alpha, alpha);
    m.index = index;
    const dvec3 seen = Text().unit(Text().times(m.rough, m.view));
    Albedo sum;
    for (int ring = 0; ring < RINGS; ++ring) {
        const double z = (1.0 - (ring + 0.5) / RINGS) * (1.0 + seen.z) - seen.z;
        const double across = std::sqrt(std::max(1.0 - z * z, 0.0));
        for (int spoke = 0; spoke < SPOKES; ++spoke) {
            const double turn = std::numbers::pi * (spoke + 0.5) / SPOKES;
            const dvec3 cap(across * std::cos(turn) + seen.x, across * std::sin(turn), z + seen.z);
            const dvec3 facet = Text().times(m.rough, cap);
            const Text::Reflection one = Text().masking_at(m, facet, glm::dot(m.view, facet));
            sum.plain += one.plain;
            sum.fresnel += one.fresnel;
        }
    }
    // masking_at gives G2 / n.v, and those seen have been divided by G1 already.
    const double each = m.view_reach / (RINGS * SPOKES);
    return {sum.plain * each, sum.fresnel * each};
}

// The mean over the hemisphere of a function of the cosine to the normal, weighted by that.
template <typename Function>
double mean(const Function &function, int steps) {
    double sum = 0.0;
    for (int k = 0; k < steps; ++k) {
        const double cosine = (k + 0.5) / steps;
        sum += 2.0 * cosine * function(cosine) / steps;
    }
    return sum;
}

std::array<Albedo, CURVE_POINTS> albedos(double alpha, double index) {
    std::array<Albedo, CURVE_POINTS> at;
    for (int k = 0; k < CURVE_POINTS; ++k) {
        at[k] = albedo(alpha, index, static_cast<double>(k) / (CURVE_POINTS - 1));
    }
    return at;
}

double mean_plain(const std::array<Albedo, CURVE_POINTS> &at) {
    return mean(
        [&](double cosine) {
            const double place = cosine * (CURVE_POINTS - 1);
            const int k = std::min(static_cast<int>(place), CURVE_POINTS - 2);
            return std::lerp(at[k].plain, at[k + 1].plain, place - k);
        },
        64);
}

double mean_share(double index) {
    return mean([index](double cosine) { return Text().fresnel_share(cosine, index); }, 64);
}

} // namespace

GlossCurves gloss_curves(const Gloss &gloss) {
    GlossCurves out;
    out.left.fill(1.0F);
    const double alpha = std::sqrt(static_cast<double>(gloss.alpha[0]) * static_cast<double>(gloss.alpha[1]));
    if (alpha <= 0.0) {
        return out;
    }
    const bool leaves_rest = gloss.below == Below::REST;
    const auto share = static_cast<double>(gloss.share);
    out.left.fill(gloss.below == Below::NOTHING ? 1.0F - gloss.share : 1.0F);
    for (auto &gain : out.gain) {
        gain.fill(gloss.share);
    }
    if (!leaves_rest && !gloss.lossless) {
        return out;
    }
    const std::array<Albedo, CURVE_POINTS> at = albedos(alpha, gloss.index);
    const double plain = mean_plain(at);
    const double rise = gloss.edge * mean_share(gloss.index), dip = mean_share(DIP_BEFORE_EDGE);
    for (int c = 0; c < 3; ++c) {
        const double f0 = gloss.reflectance[c];
        // What comes out of each unit lost between facets.
        const double again =
            gloss.lossless ? Text().sent_again(f0 + (1.0 - f0) * rise - gloss.dip[c] * dip, plain) : 0.0;
        for (int k = 0; k < CURVE_POINTS; ++k) {
            const double once = at[k].plain, gain = Text().gain_of_again(again, once);
            out.gain[c][k] = static_cast<float>(share * gain);
            if (leaves_rest) {
                const double reflected =
                    Text().reflected_by_layer(f0, gloss.edge, once, at[k].fresnel, gloss.lossless ? once * gain : 1.0);
                out.left[k] = std::min(out.left[k], static_cast<float>(1.0 - share * reflected));
            }
        }
    }
    return out;
}

GlossTable gloss_table(const Gloss &gloss) {
    GlossTable out;
    out.edge = gloss.edge;
    out.lossless = gloss.lossless;
    out.leaves_rest = gloss.below == Below::REST;
    out.leaves_all = gloss.below == Below::ALL;
    out.rise = gloss.edge * static_cast<float>(mean_share(gloss.index));
    out.dip = static_cast<float>(mean_share(DIP_BEFORE_EDGE));
    for (int i = 0; i < GlossTable::ROUGHNESSES; ++i) {
        const double share = static_cast<double>(i) / (GlossTable::ROUGHNESSES - 1);
        const double rough = std::lerp(double{GlossTable::FIRST_ROUGHNESS}, double{GlossTable::LAST_ROUGHNESS}, share);
        const std::array<Albedo, CURVE_POINTS> at = albedos(rough * rough, gloss.index);
        out.mean[i] = static_cast<float>(mean_plain(at));
        for (int k = 0; k < CURVE_POINTS; ++k) {
            out.plain[i * CURVE_POINTS + k] = static_cast<float>(at[k].plain);
            out.fresnel[i * CURVE_POINTS + k] = static_cast<float>(at[k].fresnel);
        }
    }
    return out;
}

} // namespace sfumato
