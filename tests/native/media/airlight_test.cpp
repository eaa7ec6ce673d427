// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp's and a sun's light in air against the judge's quadrature.
#include "media/airlight.hpp"
#include "reference/airlight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr double PI = std::numbers::pi;

reference::GreyAir judged(const ScatteringAir &air) {
    return {double{air.extinction},
            double{air.anisotropy},
            air.phase == PhaseFunction::RAYLEIGH,
            air.phase == PhaseFunction::CORNETTE_SHANKS,
            air.scale_height,
            air.ground};
}

reference::Lamp judged(const AirLamp &lamp) {
    return {lamp.position, lamp.radius, lamp.axis, lamp.cone_cosine, double{lamp.blend}};
}

struct Ray {
    glm::dvec3 from, to;
};

// Rays that pass the origin at a thousandth to half of `reach`, from and to anywhere up to `reach` from there.
class Rays {
public:
    explicit Rays(double reach) : most(reach) {}
    Ray operator()() {
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        const glm::dvec3 along = glm::normalize(glm::dvec3(uniform(random), uniform(random), uniform(random)));
        const glm::dvec3 other(uniform(random), uniform(random), uniform(random));
        const double distance = most * 0.5 * std::pow(0.002, 0.5 + 0.5 * uniform(random));
        const glm::dvec3 foot = distance * glm::normalize(glm::cross(along, other));
        const double a = most * uniform(random), b = most * uniform(random);
        return {foot + std::min(a, b) * along, foot + std::max(a, b) * along};
    }

private:
    double most;
    std::mt19937 random{7};
};

struct Off {
    double p95 = 0.0, most = 0.0;
};

Off relative_errors(const AirLamp &lamp, const ScatteringAir &air, double reach, int rays, std::size_t points) {
    Rays next(reach);
    const std::vector<GaussPoint> gauss = gauss_points(points);
    std::vector<double> errors;
    for (int i = 0; i < rays; ++i) {
        const Ray ray = next();
        const double wanted = reference::airlight(ray.from, ray.to, judged(lamp), judged(air));
        const double found = airlight(ray.from, ray.to, lamp, air, gauss);
        if (wanted > 1e-30) { // less is less than single precision has
            errors.push_back(std::abs(found / wanted - 1.0));
        } else {
            EXPECT_LE(found, 1e-29);
        }
    }
    if (errors.size() < 10) {
        ADD_FAILURE() << "only " << errors.size() << " rays are lit";
        return {1.0, 1.0};
    }
    std::sort(errors.begin(), errors.end());
    return {errors[errors.size() * 95 / 100], errors.back()};
}

TEST(GaussPoints, IntegratePolynomials) {
    for (const std::size_t count : {1U, 2U, 7U, 16U, 64U}) {
        double mean = 0.0, high = 0.0;
        const auto degree = static_cast<double>(2 * count - 1);
        for (const GaussPoint &point : gauss_points(count)) {
            mean += double{point.weight};
            high += double{point.weight} * std::pow(double{point.place}, degree);
        }
        EXPECT_NEAR(mean, 1.0, 1e-6) << count;
        EXPECT_NEAR(high * (degree + 1.0), 1.0, 2e-5) << count;
    }
}

// The measure that frames are built on. By evenly spaced points, or after s = h tan(phi), some of these are off by
// more than a tenth.
TEST(Airlight, OfAPointIsThatOfTheQuadratureForEveryPeakAndDepth) {
    for (const double reach : {0.1, 2.0, 20.0, 200.0}) {
        for (const float g : {-0.98F, -0.5F, 0.0F, 0.3F, 0.76F, 0.98F, 0.999F}) {
            const Off off = relative_errors({}, {1.0F, PhaseFunction::HENYEY_GREENSTEIN, g}, reach, 60, 16);
            EXPECT_LE(off.p95, 1e-4) << "reach " << reach << ", g " << g;
            EXPECT_LE(off.most, 2e-4) << "reach " << reach << ", g " << g;
        }
        const Off molecules = relative_errors({}, {1.0F, PhaseFunction::RAYLEIGH}, reach, 60, 16);
        const Off dust = relative_errors({}, {1.0F, PhaseFunction::CORNETTE_SHANKS, 0.76F}, reach, 60, 16);
        EXPECT_LE(std::max(molecules.p95, dust.p95), 2e-4) << reach;
        EXPECT_LE(std::max(molecules.most, dust.most), 5e-4) << reach;
    }
}

TEST(Airlight, OfASpotIsCutAtItsCone) {
    AirLamp lamp;
    lamp.axis = glm::normalize(glm::dvec3(1.0, 2.0, -2.0));
    for (const double angle : {0.2, 0.5, 1.5, PI / 2.0}) {
        for (const float blend : {0.0F, 0.15F, 1.0F}) {
            lamp.cone_cosine = std::cos(angle);
            lamp.blend = blend;
            const Off off = relative_errors(lamp, {0.2F, PhaseFunction::HENYEY_GREENSTEIN, 0.6F}, 20.0, 200, 16);
            EXPECT_LE(off.p95, 2e-4) << angle << ", " << blend;
            EXPECT_LE(off.most, 5e-4) << angle << ", " << blend;
        }
    }
}

TEST(Airlight, OfASphereHasItsSizeAndGoesOnWithin) {
    for (const double radius : {0.02, 0.5, 6.0}) {
        AirLamp lamp;
        lamp.radius = radius;
        const Off clear = relative_errors(lamp, {1e-4F}, 10.0, 10, 16);
        EXPECT_LE(clear.most, 5e-4) << radius;
        // The way of the light is a mean one.
        const Off dim = relative_errors(lamp, {0.1F}, 10.0, 10, 16);
        EXPECT_LE(dim.most, 0.05 * 0.1 * radius + 5e-4) << radius;
    }
}

// A plate above the origin, of which rays cross the plane beside it, behind it and through it.
TEST(Airlight, OfAPlateTakesAsManyPointsAsItNeeds) {
    std::mt19937 random{5};
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const std::vector<GaussPoint> points = gauss_points(16);
    for (const double spread : {PI, 2.0, 0.5}) {
        const AirPlate plate{{0.1, 0.0, 0.2}, {0.6, 0.0, 0.0}, {0.0, -0.3, 0.0}, spread};
        const reference::Plate same{plate.position, plate.across, plate.up, plate.spread};
        const ScatteringAir air{0.3F, PhaseFunction::HENYEY_GREENSTEIN, 0.6F};
        for (int ray = 0; ray < 3; ++ray) {
            const glm::dvec3 from(3.0 * uniform(random), -4.0, uniform(random) - 1.0);
            const glm::dvec3 to(3.0 * uniform(random), 4.0, uniform(random) - 1.0);
            const double wanted = reference::airlight(from, to, same, judged(air));
            const PlateLight found = airlight(from, to, plate, air, points, 1e-3F);
            EXPECT_NEAR(double{found.sent}, wanted, 2e-3 * wanted + 1e-6)
                << "spread " << spread << ", " << found.points;
            EXPECT_LE(found.points, spread < PI ? 256 : 64);
        }
    }
}

TEST(Airlight, FollowsAirThatFallsOffWithHeight) {
    AirLamp lamp;
    for (const double height : {3.0, 8.0, 100.0}) {
        for (const float g : {0.0F, 0.76F}) {
            const ScatteringAir air{0.3F, PhaseFunction::HENYEY_GREENSTEIN, g, height, -1.0};
            const Off off = relative_errors(lamp, air, 10.0, 40, 16);
            EXPECT_LE(off.p95, 2e-4) << height << ", " << g;
            EXPECT_LE(off.most, 2e-3) << height << ", " << g; // twenty metres through three of scale height
        }
    }
}

TEST(Airlight, OnTheRayOrAtTheEyeIsFinite) {
    const std::vector<GaussPoint> points = gauss_points(16);
    const ScatteringAir air{0.5F, PhaseFunction::HENYEY_GREENSTEIN, 0.9F};
    const AirLamp lamp;
    for (const double end : {-1.0, 0.0, 1.0, 1e-30, 1e6}) {
        const float sent = airlight({-1.0, 0.0, 0.0}, {end, 0.0, 0.0}, lamp, air, points);
        EXPECT_TRUE(std::isfinite(sent) && sent >= 0.0F) << end << ": " << sent;
    }
    EXPECT_TRUE(std::isfinite(airlight({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, lamp, air, points)));
    // Behind the end of the way, where there is a limit: half a metre of air, straight ahead.
    const double wanted = reference::airlight({-1.0, 1e-7, 0.0}, {-0.5, 1e-7, 0.0}, judged(lamp), judged(air));
    EXPECT_NEAR(airlight({-1.0, 0.0, 0.0}, {-0.5, 0.0, 0.0}, lamp, air, points) / wanted, 1.0, 1e-4);
}

TEST(Sunlight, HasAClosedFormInAirThatFallsOffToo) {
    const double scale = 7.0;
    for (const double elevation : {0.05, 0.6, 1.5}) {
        const glm::dvec3 towards(std::cos(elevation), 0.0, std::sin(elevation));
        for (const double climb : {-0.9, -0.02, -1e-7, 0.0, 1e-7, 0.3, 1.0}) {
            const glm::dvec3 from(0.0, 0.0, 11.0);
            const glm::dvec3 to = from + 10.0 * glm::dvec3(0.0, std::sqrt(1.0 - climb * climb), climb);
            const ScatteringAir air{0.2F, PhaseFunction::HENYEY_GREENSTEIN, 0.9F, scale, 2.0};
            const double wanted = reference::sunlight(from, to, towards, judged(air));
            EXPECT_NEAR(sunlight(from, to, towards, air) / wanted, 1.0, 2e-5) << elevation << ", " << climb;
        }
    }
    const ScatteringAir even{0.2F};
    EXPECT_NEAR(double{sunlight(glm::dvec3(0.0), {3.0, 4.0, 0.0}, {0.0, 0.0, 1.0}, even)},
                (1.0 - std::exp(-1.0)) / 0.2 / (4.0 * PI), 1e-7);
}

TEST(Sunlight, BelowTheHorizonIsNone) {
    const ScatteringAir air{0.2F, PhaseFunction::RAYLEIGH, 0.0F, 7.0, 0.0};
    EXPECT_EQ(sunlight(glm::dvec3(0.0), {5.0, 0.0, 5.0}, {1.0, 0.0, 0.0}, air), 0.0F);
}

} // namespace
} // namespace sfumato
