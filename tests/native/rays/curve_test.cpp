// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/rays/curve.glsl, the fit of its knots, and the choice between curves and bases.
#include "rays/choose_basis.hpp"
#include "rays/curve.hpp"
#include "support/ray_profiles.hpp"

#include <array>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using Texel = std::array<std::uint8_t, CURVE_BYTES>;

Texel texel_of(const Profile &ray) {
    Texel texel{};
    fit_curve(exact_curve(ray.absorbers()), texel);
    return texel;
}

std::vector<float> light(const Profile &ray, const std::vector<float> &depths) {
    std::vector<float> out(depths.size());
    curve_transmittance(texel_of(ray), depths, out);
    return out;
}

TEST(ExactCurve, OfParticlesIsTheReferenceAtEveryStep) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Profile ray = cloud(seed);
        const auto curve = exact_curve(ray.absorbers());
        ASSERT_EQ(curve.size(), 2 * ray.depth.size());
        for (std::size_t i = 1; i < curve.size(); i += 2) {
            EXPECT_EQ(curve[i].z, curve[i - 1].z);
            EXPECT_NEAR(curve[i].t, ray.exact(curve[i].z), 1e-6);
            EXPECT_NEAR(curve[i - 1].t, ray.exact(curve[i].z - 1e-9), 1e-6);
        }
    }
}

// Two slabs that overlap: tau = 4 over [.2, .6] and 1 over [.5, .9].
TEST(ExactCurve, OfSlabsIsBeerAndLambert) {
    const Profile slabs{{0.4F, 0.7F}, {4.0F, 1.0F}, 0.4F};
    for (const CurveVertex &v : exact_curve(slabs.absorbers())) {
        const double tau = 4.0 * std::clamp((v.z - 0.2) / 0.4, 0.0, 1.0) + std::clamp((v.z - 0.5) / 0.4, 0.0, 1.0);
        EXPECT_NEAR(v.t, std::exp(-tau), 1e-5);
    }
    const auto curve = exact_curve(slabs.absorbers());
    for (std::size_t i = 1; i < curve.size(); ++i) {
        EXPECT_LE(std::log(curve[i - 1].t / curve[i].t), 0.1251);
    }
}

TEST(Curve, IsExactAtBothEndsAndNeverBrightens) {
    std::vector<float> depths;
    for (int i = 0; i <= 1000; ++i) {
        depths.push_back(float(i) / 1000.0F);
    }
    for (unsigned seed = 0; seed < 200; ++seed) {
        Profile ray = cloud(seed);
        ray.depth.resize(1 + seed % 64);
        ray.tau.resize(ray.depth.size());
        ray.tau[0] += seed % 5 == 0 ? 13.9F : 0.0F; // opaque
        ray.width = seed % 3 == 0 ? 0.001F : 0.0F;
        const auto t = light(ray, depths);
        EXPECT_EQ(t.front(), 1.0F);
        EXPECT_NEAR(t.back(), std::exp(-ray.total()), 2e-4);
        for (std::size_t i = 1; i < t.size(); ++i) {
            EXPECT_LE(t[i], t[i - 1] + 2e-7F) << "seed " << seed << " at " << depths[i];
            EXPECT_GE(t[i], t.back() - 2e-7F);
        }
    }
}

// Steps cost two knots, and only their values are rounded: to 1/255 of what the whole ray takes.
TEST(Curve, HoldsThreeLayersExactly) {
    const Profile ray{{0.7F, 0.15F, 0.4F}, {0.5F, 0.7F, 1.2F}, 0.0F};
    for (const float d : {0.0F, 0.149F, 0.151F, 0.3F, 0.39F, 0.41F, 0.6F, 0.699F, 0.701F, 1.0F}) {
        EXPECT_NEAR(light(ray, {d})[0], ray.exact(double{d}), 0.5 / 255.0 + 2e-4) << d;
    }
}

TEST(Curve, IsCloseInSmoke) {
    // measured: 0.0076, and 0.0083 before the knots settle; seven Fourier coefficients 0.026
    EXPECT_LT(error_in_clouds(light), 0.0080);
}

// exp(-4 z): the best nine straight pieces would be off by about 1.5e-3 at most.
TEST(Curve, IsCloseInEvenSmoke) {
    const Profile slab{{0.5F}, {4.0F}, 1.0F};
    double sum = 0.0;
    for (int i = 0; i < 500; ++i) {
        const float d = (float(i) + 0.5F) / 500.0F;
        sum += std::pow(double{light(slab, {d})[0]} - std::exp(-4.0 * double{d}), 2);
    }
    EXPECT_LT(std::sqrt(sum / 500.0), 0.003);
}

TEST(Curve, DoesNotMindTheOrder) {
    const Profile ray = cloud(7);
    Profile turned = ray;
    std::reverse(turned.depth.begin(), turned.depth.end());
    std::reverse(turned.tau.begin(), turned.tau.end());
    EXPECT_EQ(texel_of(ray), texel_of(turned));
}

// The knots are relative to the ray's own range: smoke that moves keeps them. Depths here are exact in
// binary, but not in the 16 bits of a stored range.
TEST(Curve, MovesWithTheSmoke) {
    Profile ray = cloud(8);
    for (float &z : ray.depth) {
        z = std::round((0.3F + 0.2F * z) * 1048576.0F) / 1048576.0F;
    }
    Profile moved = ray;
    for (float &z : moved.depth) {
        z += 104859.0F / 1048576.0F;
    }
    const Texel here = texel_of(ray), there = texel_of(moved);
    EXPECT_TRUE(std::equal(here.begin() + 4, here.end(), there.begin() + 4));
    EXPECT_NE(here[0] + 256 * here[1], there[0] + 256 * there[1]);
}

// Sums of half floats stall here (the reference text: T stops at .6).
TEST(Curve, HoldsTwentyThousandFaintLayers) {
    Profile ray;
    for (int i = 0; i < 20'000; ++i) {
        ray.depth.push_back((float(i) + 0.5F) / 20'000.0F);
        ray.tau.push_back(-std::log1p(-2e-4F));
    }
    double sum = 0.0;
    for (int i = 0; i <= 50; ++i) {
        const float d = float(i) / 50.0F;
        const double error = double{light(ray, {d})[0]} - std::pow(1.0 - 2e-4, 20'000.0 * double{d});
        EXPECT_NEAR(error, 0.0, 0.01) << d;
        sum += error * error;
    }
    EXPECT_LT(std::sqrt(sum / 51.0), 0.004);
}

TEST(Curve, OfNothingIsLight) {
    for (const Profile &clear : {Profile{{}, {}, 0.0F}, Profile{{0.5F}, {0.0F}, 0.0F}}) {
        for (const float d : {0.0F, 0.5F, 1.0F}) {
            EXPECT_EQ(light(clear, {d})[0], 1.0F);
        }
    }
}

std::vector<Profile> clouds() {
    std::vector<Profile> rays;
    for (unsigned seed = 0; seed < 24; ++seed) {
        rays.push_back(cloud(seed));
    }
    return rays;
}

// Views of the rays, which must outlive them.
std::vector<Absorbers> absorbers_of(const std::vector<Profile> &rays) {
    std::vector<Absorbers> sample;
    for (const Profile &ray : rays) {
        sample.push_back(ray.absorbers());
    }
    return sample;
}

TEST(Choice, IsTheSameEachTimeAndNamesItsReason) {
    const auto rays = clouds();
    const auto sample = absorbers_of(rays);
    const Choice best = choose_basis(sample, 20, false), series = choose_basis(sample, 20, true);
    EXPECT_TRUE(best.curve);
    EXPECT_FALSE(series.curve);
    EXPECT_LT(best.error, series.error);
    EXPECT_EQ(series.bytes(), 20U);
    EXPECT_EQ(choose_basis(sample, 20, true).reason, series.reason);
    EXPECT_NE(series.reason.find("12 of the scene's rays"), std::string::npos) << series.reason;
    EXPECT_FALSE(choose_basis(sample, 12, false).curve); // which would take 20
    EXPECT_LE(choose_basis(sample, 12, false).bytes(), 12U);
}

// What comes back from bytes is what was measured.
TEST(Choice, StoresAsItWasJudged) {
    const auto rays = clouds();
    const auto sample = absorbers_of(rays);
    const Choice choice = choose_basis(sample, 20, true);
    const double error = error_in_clouds([&](const Profile &ray, const std::vector<float> &depths) {
        std::vector<std::uint8_t> texel(choice.bytes());
        std::vector<float> out(depths.size());
        store(choice, ray.absorbers(), texel);
        look_up(choice, texel, depths, out);
        return out;
    });
    EXPECT_LT(error, choice.error); // whose receivers all stand in smoke
    EXPECT_GT(error, 0.5F * choice.error);
}

} // namespace
} // namespace sfumato
