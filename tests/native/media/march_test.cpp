// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/media/medium.glsl and shaders/media/phase.glsl: light scattered once, against closed forms.
#include "reference/reference.hpp"
#include "text/media_text.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using MediaText = text::MediaText<float>;

// A homogeneous slab of optical depth tau, cut into equal steps. The light has crossed tau_light(x) when it arrives
// at optical depth x from the eye.
template <typename TauLight>
double scattered(double tau, int steps, const TauLight &tau_light, float albedo = 1.0F) {
    float sum = 0.0F, tau_eye = 0.0F;
    const auto step = float(tau / steps);
    for (int k = 0; k < steps; ++k) {
        const double middle = tau * (k + 0.5) / steps;
        sum += MediaText().scattered_by_step(albedo * step, step, tau_eye, float(tau_light(middle)));
        tau_eye += step;
    }
    return double{sum};
}

// In even light a slab sends on what it takes out, whatever the steps.
TEST(March, InEvenLightIsOneMinusTransmittance) {
    for (const double tau : {1e-4, 0.1, 1.0, 5.0, 20.0}) {
        for (const int steps : {25, 64, 200}) {
            const double expected = 0.7 * (1.0 - std::exp(-tau));
            EXPECT_NEAR(scattered(tau, steps, [](double) { return -std::log(0.7); }), expected, 1e-5 * expected)
                << tau << " in " << steps;
            EXPECT_NEAR(scattered(
                            tau, steps, [](double) { return 0.0; }, 0.7F),
                        expected, 1e-5 * expected)
                << tau << " in " << steps;
        }
    }
    // The bounds that medium.glsl gives for a single step, on top of rounding.
    EXPECT_NEAR(scattered(1.0, 1, [](double) { return 0.0; }), 1.0 - std::exp(-1.0), 1e-7);
    EXPECT_NEAR(scattered(4.0, 1, [](double) { return 0.0; }), 1.0 - std::exp(-4.0), 5e-4);
}

// Straight back, the light crosses everything twice: (1 - exp(-2 tau)) / 2. The midpoint's error falls fourfold when
// the steps are halved.
TEST(March, StraightBackConvergesToTheSecondOrder) {
    const auto tau_light = [](double depth) { return depth; };
    const double tau = 3.0, expected = 0.5 * (1.0 - std::exp(-2.0 * tau));
    double last = 0.0;
    for (const int steps : {8, 16, 32, 64}) {
        const double error = std::abs(scattered(tau, steps, tau_light) - expected);
        if (steps > 8) {
            EXPECT_NEAR(last / error, 4.0, 0.3) << steps;
        }
        last = error;
    }
    EXPECT_LT(last, 2e-4);
}

// Straight on, each path crosses the whole slab once: tau exp(-tau).
TEST(March, StraightOnCrossesTheSlabOnce) {
    const double tau = 2.0;
    const auto tau_light = [tau](double depth) { return tau - depth; };
    EXPECT_NEAR(scattered(tau, 256, tau_light), tau * std::exp(-tau), 1e-5);
}

TEST(MarchSteps, AreNoLongerThanAskedAndNoMoreThanNeeded) {
    EXPECT_EQ(MediaText().march_steps(0.0F, 0.1F), 1.0F);
    EXPECT_EQ(MediaText().march_steps(0.05F, 0.1F), 1.0F);
    float sum = 0.0F;
    for (int steps = 1; steps <= 100; ++steps) {
        sum += 0.1F;
        EXPECT_EQ(MediaText().march_steps(sum, 0.1F), float(steps)); // not one more for a rounding error
    }
    for (float stretch = 0.01F; stretch < 7.0F; stretch *= 1.07F) {
        const float steps = MediaText().march_steps(stretch, 0.1F);
        EXPECT_LE(stretch / steps, 0.1F * 1.002F) << stretch;
        EXPECT_GE(stretch / 0.1F, steps - 1.0F) << stretch;
    }
}

TEST(HenyeyGreenstein, IsNormalisedAndItsMeanCosineIsG) {
    for (const float g : {-0.7F, 0.0F, 0.3F, 0.85F}) {
        const int count = 100'000;
        double total = 0.0, mean = 0.0;
        for (int i = 0; i < count; ++i) {
            const double cosine = -1.0 + 2.0 * (i + 0.5) / count;
            const double ring = 2.0 * std::numbers::pi * (2.0 / count);
            const double p = double{MediaText().henyey_greenstein(float(cosine), g)};
            EXPECT_NEAR(p, reference::henyey_greenstein(double{float(cosine)}, double{g}), 2e-5 * p);
            total += ring * p;
            mean += ring * p * cosine;
        }
        EXPECT_NEAR(total, 1.0, 1e-5) << "g = " << g;
        EXPECT_NEAR(mean, g, 1e-5) << "g = " << g;
    }
}

} // namespace
} // namespace sfumato
