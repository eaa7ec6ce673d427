// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/media/march.glsl, medium.glsl and phase.glsl: light scattered once, against closed forms.
#include "reference/reference.hpp"
#include "text/march_text.hpp"
#include "text/media_text.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

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

// ---- The whole march, of one lane: uniform cubes of 100 cells, a metre each, in the light of one sun ----

struct Cubes {
    using Colour = float;
    using Place = glm::vec3;
    struct Arriving {
        float depth, share;
    };
    static constexpr int MEDIA = 2;

    int count = 1;
    float density = 1.0F;                      // of each, per metre
    float first = 0.0F;                        // where the first begins; the next one begins a metre further
    float full = 0.0F;                         // cells before that are known to be empty
    int asked = 0;                             // how often density was looked up
    std::vector<std::array<float, 3>> knots{}; // where a step ends, the radiance and the optical depth up to there
    float glow = 0.0F;                         // of each

    void note_step(float /*k*/, const glm::vec3 & /*world*/) const {}
    void leave_knot(float t, float /*step*/, const glm::vec3 &radiance, float depth) {
        knots.push_back({t, radiance.x, depth});
    }

    [[nodiscard]] int media_count() const { return count; }
    [[nodiscard]] float begin(int m) const { return first + static_cast<float>(m); }
    [[nodiscard]] glm::vec3 to_grid(int m, const glm::vec3 &p) const {
        return 100.0F * glm::vec3(p.x - begin(m), p.y + 0.5F, p.z + 0.5F);
    }
    [[nodiscard]] glm::vec3 along_grid(int /*m*/, const glm::vec3 &v) const { return 100.0F * v; }
    [[nodiscard]] glm::vec3 grid_size(int /*m*/) const { return {100.0F, 100.0F, 100.0F}; }
    [[nodiscard]] float clearance_at(int /*m*/, const glm::vec3 &cell) const {
        return cell.x < full ? full - cell.x : -1.0F;
    }
    [[nodiscard]] glm::vec3 place_at(int /*m*/, const glm::vec3 &cell) const { return cell; }
    float density_at(int /*m*/, const glm::vec3 &cell) {
        ++asked;
        return cell.x < full ? 0.0F : density;
    }
    [[nodiscard]] bool emits(int /*m*/) const { return glow > 0.0F; }
    [[nodiscard]] float glow_at(int /*m*/, const glm::vec3 &cell) const { return cell.x < full ? 0.0F : glow; }
    [[nodiscard]] float last_row(int /*m*/) const { return 2.0F; }
    [[nodiscard]] glm::vec3 emission_row(int m, float row) const {
        return {6.0F * row, m == 0 ? 0.0F : row * row, 0.0F};
    }
    [[nodiscard]] float longest_step(int /*m*/) const { return 1.0F; }
    [[nodiscard]] float extinction_of(int /*m*/) const { return 1.0F; }
    [[nodiscard]] glm::vec3 scattering_at(int m, const glm::vec3 &) const { return {1.0F, 0.5F, m == 0 ? 0.0F : 1.0F}; }
    [[nodiscard]] glm::vec3 scattering_of(int m) const { return scattering_at(m, {}); }
    [[nodiscard]] bool classified(int /*m*/) const { return false; }
    [[nodiscard]] bool splits(int /*m*/) const { return false; }
    [[nodiscard]] glm::vec3 ramp_row(int /*m*/, float /*row*/) const { return {}; }
    [[nodiscard]] float last_part(int /*m*/) const { return 0.0F; }
    [[nodiscard]] float anisotropy_of(int /*m*/) const { return 0.0F; }
    [[nodiscard]] Arriving light_at(int /*m*/, const glm::vec3 & /*place*/, int /*light*/) const {
        return {std::log(2.0F), 0.5F};
    }
    [[nodiscard]] Arriving light_along(int m, const glm::vec3 &place, const glm::vec3 & /*world*/, int light) const {
        return light_at(m, place, light);
    }
    [[nodiscard]] int light_count() const { return 1; }
    [[nodiscard]] bool is_parallel(int /*light*/) const { return true; }
    [[nodiscard]] glm::vec3 light_direction(int /*light*/) const { return {0.0F, 0.0F, -1.0F}; }
    [[nodiscard]] glm::vec3 light_position(int /*light*/) const { return {0.0F, 0.0F, 0.0F}; }
    [[nodiscard]] float light_size2(int /*light*/) const { return 0.0F; }
    [[nodiscard]] float light_concentration(int /*light*/) const { return 1.0F; }
    [[nodiscard]] glm::vec3 light_strength(int /*light*/) const {
        return glm::vec3(4.0F * 4.0F * std::numbers::pi_v<float>);
    }
};

using MarchText = text::MarchText<float, text::OneLane, Cubes>;
const MarchText::Ray AHEAD{{-3.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, 10.0F};

// Half of half of 4 arrives everywhere: what is scattered is 1 - transmittance.
TEST(March, OfAUniformCubeIsWhatItTakesFromTheRay) {
    for (const float density : {0.1F, 1.0F, 8.0F}) {
        MarchText text{{1, density, 0.25F}};
        const MarchText::Smoke smoke = text.march(AHEAD, 10.0F);
        const double sent = 1.0 - std::exp(-double{density});
        EXPECT_NEAR(smoke.depth, density, 1e-5 * density);
        EXPECT_NEAR(smoke.radiance.x, sent, 2e-5 * sent);
        EXPECT_NEAR(smoke.radiance.y, 0.5 * sent, 2e-5 * sent);
        EXPECT_EQ(smoke.radiance.z, 0.0F);
        EXPECT_NEAR(text.march(AHEAD, 3.75F).depth, 0.5F * density, 1e-5F * density) << "up to a surface inside";
        EXPECT_EQ(text.march(AHEAD, 3.0F).depth, 0.0F) << "a surface before it";
    }
}

// Without a transfer function both marches are one, but for where steps begin and end.
TEST(March, OfRampsIsTheSameWhereThereIsNone) {
    MarchText text{{2, 1.0F, 0.25F}}, ramped{{2, 1.0F, 0.25F}};
    const MarchText::Smoke wanted = text.march(AHEAD, 10.0F), smoke = ramped.march_ramped(AHEAD, 10.0F);
    EXPECT_NEAR(smoke.depth, wanted.depth, 1e-4F);
    EXPECT_NEAR(smoke.radiance.x, wanted.radiance.x, 1e-4F);
    EXPECT_NEAR(smoke.radiance.z, wanted.radiance.z, 1e-4F);
}

TEST(March, GoesThroughAllMediaInTheOrderOfTheRay) {
    MarchText text{{2, 1.0F, 0.0F}};
    const MarchText::Smoke smoke = text.march(AHEAD, 10.0F);
    const double sent = 1.0 - std::exp(-2.0), behind = std::exp(-1.0) * (1.0 - std::exp(-1.0));
    EXPECT_NEAR(smoke.depth, 2.0F, 1e-5F);
    EXPECT_NEAR(smoke.radiance.x, sent, 2e-5);
    EXPECT_NEAR(smoke.radiance.z, behind, 2e-5) << "only the second one scatters blue";
}

TEST(March, LeavesWhatItHasMetSoFar) {
    MarchText text{{1, 2.0F, 0.25F}};
    const MarchText::Smoke smoke = text.march(AHEAD, 10.0F);
    ASSERT_EQ(text.knots.size(), 100U) << "at the end of each step";
    for (const auto &[t, radiance, depth] : text.knots) {
        const double inside = double{t} - 3.25;
        EXPECT_NEAR(double{depth}, 2.0 * inside, 1e-5);
        EXPECT_NEAR(double{radiance}, 1.0 - std::exp(-2.0 * inside), 2e-5);
    }
    EXPECT_EQ(text.knots.back(), (std::array{4.25F, smoke.radiance.x, smoke.depth}));
}

TEST(March, LeapsOverWhatIsEmptyAndStopsWhereNothingIsSeen) {
    MarchText empty{{1, 1.0F, 0.0F, 60.0F}};
    EXPECT_NEAR(empty.march(AHEAD, 10.0F).depth, 0.4F, 1e-5F);
    EXPECT_EQ(empty.asked, 40) << "a step a cell, where there is smoke";
    MarchText dense{{1, 100.0F, 0.0F}};
    const MarchText::Smoke smoke = dense.march(AHEAD, 10.0F);
    EXPECT_EQ(dense.asked, 12) << "to an optical depth of 12, one a cell";
    EXPECT_NEAR(smoke.radiance.x, 1.0, 1e-4) << "what lies behind is e^-12 of it";
}

// A glow of 3/4 is half way between the rows 1 and 2.
TEST(March, OfSmokeThatGlowsAddsWhatItsOwnDepthLeaves) {
    for (const float density : {0.0F, 0.1F, 2.0F}) {
        MarchText dark{{2, density, 0.0F}}, text{{2, density, 0.0F}};
        text.glow = 0.75F;
        const glm::vec3 sent = text.march(AHEAD, 10.0F).radiance - dark.march(AHEAD, 10.0F).radiance;
        const double d = density, mean = d > 0.0 ? (1.0 - std::exp(-d)) / d : 1.0;
        EXPECT_NEAR(sent.x, 9.0 * mean * (1.0 + std::exp(-d)), 1e-3) << "both emit red";
        EXPECT_NEAR(sent.y, 2.5 * mean * std::exp(-d), 1e-4) << "the second one, green";
        EXPECT_EQ(sent.z, 0.0F);
        EXPECT_NEAR(text.march(AHEAD, 3.5F).radiance.x - dark.march(AHEAD, 3.5F).radiance.x,
                    9.0 * (d > 0.0 ? (1.0 - std::exp(-0.5 * d)) / d : 0.5), 1e-3)
            << "up to a surface inside";
    }
}

} // namespace
} // namespace sfumato
