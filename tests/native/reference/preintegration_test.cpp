// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of transfer functions, in closed forms.
#include "../support/reference_scenes.hpp"
#include "reference/preintegration.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

const std::vector<double> STOPS{0.0, 1.0}, RISING{0.0, 2.0}, EVEN{2.0, 2.0};
const std::vector<glm::dvec3> WHITE(2, glm::dvec3(1.0)), GROWING{glm::dvec3(0.0), glm::dvec3(1.0, 2.0, 3.0)};

TEST(Ramp, OfOneColourSendsItsOpacity) {
    const glm::dvec4 there = sent({STOPS, RISING, WHITE, true, false}, 0.0, 1.0, 3.0);
    EXPECT_NEAR(there.w, std::exp(-3.0), 1e-10);
    EXPECT_NEAR(there.x, 1.0 - std::exp(-3.0), 1e-9);
    EXPECT_NEAR(sent({STOPS, RISING, WHITE, true, false}, 1.0, -1.0, 3.0).w, std::exp(-1.5), 1e-10);
}

// int_0^1 t exp(-a t) dt = (1 - (1 + a) exp(-a)) / a^2
TEST(Ramp, OfGrowingEmissionInEvenExtinctionHasAClosedForm) {
    const double a = 2.0 * 1.5, wanted = 1.5 * (1.0 - (1.0 + a) * std::exp(-a)) / (a * a);
    EXPECT_NEAR(sent({STOPS, EVEN, GROWING, true, true}, 0.0, 1.0, 1.5).y, 2.0 * wanted, 1e-10);
    // From the other side the bright end is in front.
    const double mirrored = 1.5 * ((1.0 - std::exp(-a)) / a - (1.0 - (1.0 + a) * std::exp(-a)) / (a * a));
    EXPECT_NEAR(sent({STOPS, EVEN, GROWING, true, true}, 1.0, 0.0, 1.5).z, 3.0 * mirrored, 1e-10);
}

TEST(Ramp, OfConstantsHoldsAValueUpToTheNextStop) {
    const Ramp ramp{STOPS, RISING, WHITE, false, true};
    EXPECT_EQ(ramp(-0.1).w, 0.0);
    EXPECT_EQ(ramp(0.9999).w, 0.0);
    EXPECT_EQ(ramp(1.0).w, 2.0);
    EXPECT_NEAR(sent(ramp, 0.5, 1.5, 2.0).w, std::exp(-2.0), 1e-10);
}

TEST(Along, UniformSmokeIsBeersLaw) {
    const Medium medium = testing::uniform_medium({4, 4, 4}, 0.5F, glm::mat4(1.0F));
    const glm::dvec4 there = sent_along({STOPS, RISING, WHITE, true, false}, medium, {1.0, 2.0, 2.0}, {3.0, 2.0, 2.0});
    EXPECT_NEAR(there.w, std::exp(-2.0), 1e-9);
    EXPECT_NEAR(there.x, 1.0 - std::exp(-2.0), 1e-9);
}

TEST(PlainTable, ApproachesWhatEachEntrySends) {
    const Ramp ramp{STOPS, RISING, GROWING, true, false};
    const std::vector<glm::dvec4> coarse = table(ramp, 0.0, 1.0, 5, 2.0), fine = table(ramp, 0.0, 1.0, 65, 2.0);
    const glm::dvec4 exact = sent(ramp, 0.25, 1.0, 2.0);
    EXPECT_NEAR(fine[16 * 65 + 64].z, exact.z, 1e-3);
    EXPECT_LT(std::abs(fine[16 * 65 + 64].z - exact.z), 0.1 * std::abs(coarse[1 * 5 + 4].z - exact.z));
    EXPECT_NEAR(coarse[1 * 5 + 4].w, exact.w, 1e-12);
    EXPECT_NEAR(fine[32 * 65 + 32].z, 1.5 * (1.0 - std::exp(-2.0)), 1e-12);
}

} // namespace
} // namespace sfumato::reference
