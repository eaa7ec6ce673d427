// SPDX-License-Identifier: GPL-3.0-or-later
// How reflectance rises towards grazing angles: what optics fixes, what the judge says, and what rounding may do.
#include "lights/microfacet.hpp"
#include "reference/microfacet.hpp"
#include "text/microfacets_text.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using MicrofacetsText = text::MicrofacetsText<float>;

// Every curve: Schlick's, and from nearly no boundary to far beyond diamond.
constexpr std::array<float, 9> INDICES{0.0F, 1.000001F, 1.001F, 1.05F, 1.2F, 1.45F, 2.0F, 10.0F, 1000.0F};
constexpr int STEPS = 4096;

// An index of 1000 leaves reflectance 0.4 % to rise in, of which the share is: one unit in the last place is 1.5e-5.
float rounding(float index) {
    return index > 100.0F ? 2e-4F : index > 5.0F ? 1e-5F : 2e-6F;
}

float cosine_at(int step) {
    return static_cast<float>(step) / STEPS;
}

TEST(FresnelShare, BeginsAtNothingAndEndsAtAll) {
    for (const float index : INDICES) {
        EXPECT_NEAR(MicrofacetsText().fresnel_share(1.0F, index), 0.0F, rounding(index)) << index;
        EXPECT_NEAR(MicrofacetsText().fresnel_share(0.0F, index), 1.0F, rounding(index)) << index;
        EXPECT_NEAR(reference::fresnel_share(1.0, index), 0.0, 1e-9) << index;
        EXPECT_NEAR(reference::fresnel_share(0.0, index), 1.0, 1e-9) << index;
    }
}

TEST(FresnelShare, RisesAllTheWayToGrazing) {
    for (const float index : INDICES) {
        float before = 2.0F;
        for (int step = 0; step <= STEPS; ++step) {
            const float share = MicrofacetsText().fresnel_share(cosine_at(step), index);
            ASSERT_LE(share, before + rounding(index)) << index << " " << cosine_at(step);
            before = share;
        }
    }
}

TEST(FresnelShare, DipsBeforeTheEdge) {
    // Kutz, Hasan and Edmondson (2021): nothing straight on and at the edge, and deepest where the cosine is 1/7.
    const auto dip = [](float cosine) { return MicrofacetsText().fresnel_share(cosine, DIP_BEFORE_EDGE); };
    EXPECT_EQ(dip(1.0F), 0.0F);
    EXPECT_EQ(dip(0.0F), 0.0F);
    EXPECT_NEAR(dip(1.0F / 7.0F), 1.0F, 1e-6F);
    for (int step = 0; step <= STEPS; ++step) {
        const double cosine = cosine_at(step);
        ASSERT_NEAR(dip(cosine_at(step)), 7.0 * cosine * std::pow((1.0 - cosine) * 7.0 / 6.0, 6.0), 2e-6) << cosine;
    }
}

TEST(FresnelShare, BrewstersAngleLeavesOnePolarisation) {
    // Where tan(angle) is the index, nothing is reflected of what is polarised in the plane of incidence, and of the
    // rest
    // ((n^2 - 1) / (n^2 + 1))^2.
    for (const double n : {1.05, 1.2, 1.45, 2.0}) {
        const double rest = (n * n - 1.0) / (n * n + 1.0), f0 = (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
        const double want = (0.5 * rest * rest - f0) / (1.0 - f0), cosine = 1.0 / std::sqrt(1.0 + n * n);
        EXPECT_NEAR(reference::fresnel_share(cosine, n), want, 1e-12);
        EXPECT_NEAR(MicrofacetsText().fresnel_share(static_cast<float>(cosine), static_cast<float>(n)), want, 1e-6);
    }
}

TEST(FresnelShare, WithoutABoundaryNothingIsReflected) {
    for (int step = 0; step <= STEPS; ++step) {
        EXPECT_EQ(MicrofacetsText().fresnel_share(cosine_at(step), 1.0F), 0.0F);
        EXPECT_EQ(reference::fresnel_share(cosine_at(step), 1.0), 0.0);
    }
    for (const double cosine : {0.05, 0.1, 0.5}) {
        EXPECT_LT(MicrofacetsText().fresnel_share(static_cast<float>(cosine), 1.0001F), 0.01F);
        EXPECT_GT(MicrofacetsText().fresnel_share(static_cast<float>(cosine), 1.0001F), 0.0F);
    }
}

TEST(FresnelShare, ZeroAsksForSchlicksFifthPower) {
    EXPECT_NEAR(MicrofacetsText().fresnel_share(0.5F, 0.0F), 1.0F / 32.0F, 1e-8F);
    EXPECT_NEAR(reference::fresnel_share(0.5, 0.0), 1.0 / 32.0, 1e-15);
}

TEST(FresnelShare, RoundingStaysSmall) {
    for (const float index : INDICES) {
        for (int step = 0; step <= STEPS; ++step) {
            // Evenly, and ever closer to grazing.
            for (const float cosine : {cosine_at(step), std::exp2(-0.02F * static_cast<float>(step))}) {
                const double want = reference::fresnel_share(cosine, index);
                ASSERT_NEAR(MicrofacetsText().fresnel_share(cosine, index), want, rounding(index))
                    << index << " " << cosine;
            }
        }
    }
}

TEST(FresnelShare, IsNeverMoreThanAllNorLessThanNothing) {
    constexpr std::size_t COUNT = 1 << 14;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    const std::array<float, 8> values{0.0F, -0.0F, 1.0F, -1.0F, 1e-8F, 1e8F, std::numeric_limits<float>::quiet_NaN(),
                                      0.5F};
    for (const float index : INDICES) {
        for (const bool wild : {false, true}) {
            std::vector<float> quads(12 * COUNT), views(3 * COUNT), alphas(2 * COUNT), out(2 * COUNT);
            for (std::vector<float> *numbers : {&quads, &views, &alphas}) {
                for (float &x : *numbers) {
                    x = wild && random() % 3 == 0 ? values[random() % values.size()] : uniform(random);
                }
            }
            MicrofacetBatch<float> batch;
            batch.count = COUNT;
            batch.lights = quads.data();
            batch.width = 12;
            batch.view = {views.data(), 3};
            batch.alpha = {alphas.data(), 2};
            batch.index = index;
            batch.out = out.data();
            reflect(batch);
            for (std::size_t k = 0; k < COUNT; ++k) {
                ASSERT_TRUE(out[2 * k] >= out[2 * k + 1] && out[2 * k + 1] >= 0.0F)
                    << index << ": " << out[2 * k] << " " << out[2 * k + 1];
            }
        }
    }
}

} // namespace
} // namespace sfumato
