// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of light in air, in closed forms.
#include "reference/airlight.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace sfumato::reference {
namespace {

constexpr double PI = std::numbers::pi;

TEST(Airlight, PhaseFunctionsAddUpToOne) {
    for (const double g : {-0.9, 0.0, 0.5}) {
        for (const bool cornette_shanks : {false, true}) {
            const GreyAir air{1.0, g, false, cornette_shanks};
            EXPECT_NEAR(2.0 * PI * integral([&](double mu) { return phase(air, mu); }, -1.0, 1.0), 1.0, 1e-9) << g;
        }
    }
    EXPECT_NEAR(2.0 * PI * integral([](double mu) { return phase({1.0, 0.9, true}, mu); }, -1.0, 1.0), 1.0, 1e-9);
    EXPECT_NEAR(phase({1.0, 0.0, false, true}, 0.3), phase({1.0, 0.0, true}, 0.3), 1e-15);
}

// int ds / (h^2 + s^2)
TEST(Airlight, InClearAirIsAnAngle) {
    const double wanted = (std::atan(5.0 / 0.01) + std::atan(3.0 / 0.01)) / 0.01 / (4.0 * PI);
    EXPECT_NEAR(airlight({-3.0, 0.01, 0.0}, {5.0, 0.01, 0.0}, Lamp{}, {}) / wanted, 1.0, 1e-9);
}

// A ray straight towards the lamp: exp(-beta (t + (d - t))) / (d - t)^2 integrates to exp(-beta d) (1 / (d - l) - 1 /
// d).
TEST(Airlight, StraightAheadIsElementary) {
    const GreyAir air{0.7, 0.5};
    const double peak = (1.0 - 0.25) / (4.0 * PI * 0.125);
    const double wanted = peak * std::exp(-0.7 * 4.0) * (1.0 / 1.0 - 1.0 / 4.0);
    EXPECT_NEAR(airlight({-4.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, Lamp{}, air) / wanted, 1.0, 1e-9);
}

// A sphere's radiance 1 / (pi R^2) from a solid angle of 2 pi (1 - cos).
TEST(Airlight, OfASphereIsItsSolidAngle) {
    Lamp lamp;
    lamp.radius = 0.6;
    const double far = airlight({1.0, 0.0, 0.0}, {1.0, 1e-4, 0.0}, lamp, {}) / 1e-4;
    EXPECT_NEAR(far, 2.0 * (1.0 - 0.8) / 0.36 / (4.0 * PI), 1e-7);
    const double within = airlight({0.1, 0.0, 0.0}, {0.3, 0.0, 0.0}, lamp, {}) / 0.2;
    EXPECT_NEAR(within, 2.0 / 0.36 / (4.0 * PI), 1e-9);
}

// A square of half width a from a height z over its middle fills a solid angle of 4 asin(a^2 / (a^2 + z^2)).
TEST(Airlight, OfAPlateIsItsSolidAngle) {
    Plate plate;
    plate.across = {0.8, 0.0, 0.0};
    plate.up = {0.0, 0.8, 0.0};
    const double sent = airlight({0.0, -5e-4, 0.6}, {0.0, 5e-4, 0.6}, plate, {}) / 1e-3;
    EXPECT_NEAR(sent, 4.0 * std::asin(0.64) / (4.0 * PI), 1e-5);
    EXPECT_EQ(airlight({0.0, -1.0, -0.6}, {0.0, 1.0, -0.6}, plate, {}), 0.0);
    // Half of what a point of it sends is left where tan(a) is half of tan(spread / 2).
    plate.across *= 1e-3;
    plate.up *= 1e-3;
    const double all = airlight({1.0, 0.0, 2.0}, {1.0, 0.0, 2.1}, plate, {});
    plate.spread = 2.0 * std::atan(1.0);
    EXPECT_NEAR(airlight({1.0, 0.0, 2.0}, {1.0, 0.0, 2.1}, plate, {}) / all, 1.0 - 1.0 / 2.05, 1e-3);
}

TEST(Airlight, OfASpotEndsAtItsCone) {
    Lamp lamp;
    lamp.cone_cosine = std::cos(0.5);
    // One metre below the lamp, from far left to far right: as much as two angles of half a radian.
    EXPECT_NEAR(airlight({-9.0, 0.0, -1.0}, {9.0, 0.0, -1.0}, lamp, {}), 2.0 * 0.5 / (4.0 * PI), 1e-9);
}

TEST(Airlight, ColumnsOfExponentialAirEnd) {
    const GreyAir air{1.0, 0.0, false, false, 2.0, 1.0};
    EXPECT_NEAR(column(air, {0.0, 0.0, 1.0}, {0.0, 0.0, 81.0}), 2.0, 1e-9);
    EXPECT_NEAR(column(air, {0.0, 0.0, 3.0}, {5.0, 0.0, 3.0}), 5.0 * std::exp(-1.0), 1e-12);
}

TEST(Sunlight, OfEvenAirIsBeersLaw) {
    const GreyAir air{0.5, 0.0};
    EXPECT_NEAR(sunlight({0.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, {0.0, 0.0, 1.0}, air),
                (1.0 - std::exp(-2.0)) / 0.5 / (4.0 * PI), 1e-10);
}

// All of a vertical way under a sun in the zenith: the density's integral up to H of exp(-beta H) on each way down.
TEST(Sunlight, ThroughAllAirIsElementary) {
    const GreyAir air{0.3, 0.0, false, false, 2.0, 0.0};
    const double wanted = 2.0 * std::exp(-0.3 * 2.0) / (4.0 * PI);
    EXPECT_NEAR(sunlight({0.0, 0.0, 0.0}, {0.0, 0.0, 100.0}, {0.0, 0.0, 1.0}, air), wanted, 1e-8);
}

} // namespace
} // namespace sfumato::reference
