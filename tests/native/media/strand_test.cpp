// SPDX-License-Identifier: GPL-3.0-or-later
// What a strand of hair sends, beside Chiang's model in double precision, point by point.
#include "reference/reference.hpp"
#include "text/strands_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using StrandsText = text::StrandsText<float>;

constexpr double PI = std::numbers::pi;

StrandsText::Fibre fibre_of(const reference::Strand &strand) {
    StrandsText text;
    StrandsText::Fibre fibre;
    fibre.absorption = glm::vec3(strand.absorption);
    fibre.variance = text.fibre_variance(static_cast<float>(strand.longitudinal));
    fibre.primary = text.fibre_variance(static_cast<float>(strand.primary));
    fibre.scale = text.fibre_scale(static_cast<float>(strand.azimuthal));
    fibre.tilt = static_cast<float>(std::sin(strand.tilt));
    fibre.index = static_cast<float>(strand.index);
    return fibre;
}

glm::dvec3 ours(const reference::Strand &strand, double low, double high, double eye, double light, double around) {
    StrandsText text;
    const StrandsText::Fibre fibre = fibre_of(strand);
    const auto look =
        text.strand_look(fibre, static_cast<float>(std::sin(eye)), static_cast<float>(low), static_cast<float>(high));
    return glm::dvec3(text.strand_sent(fibre, look, static_cast<float>(std::sin(light)), static_cast<float>(around)));
}

// The mean over a part of the width, by points.
glm::dvec3 points(const reference::Strand &strand, double low, double high, double eye, double light, double around) {
    constexpr int COUNT = 400;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < COUNT; ++i) {
        sum += reference::sent(strand, low + (high - low) * (i + 0.5) / COUNT, eye, light, around);
    }
    return sum / double{COUNT};
}

struct Draw {
    reference::Strand strand;
    double eye, light, around;
};

Draw draw(std::mt19937 &generator) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Draw out;
    for (int c = 0; c < 3; ++c) {
        out.strand.absorption[c] = 3.0 * unit(generator);
    }
    out.strand.longitudinal = 0.1 + 0.6 * unit(generator);
    out.strand.primary = 0.1 + 0.6 * unit(generator);
    out.strand.azimuthal = 0.15 + 0.6 * unit(generator);
    out.strand.tilt = 0.1 * (unit(generator) - 0.5);
    out.eye = 1.2 * (2.0 * unit(generator) - 1.0);
    out.light = 1.2 * (2.0 * unit(generator) - 1.0);
    out.around = 2.0 * PI * unit(generator);
    return out;
}

// Of a thin strand, as a root mean square of what all draws send; and the worst of them.
TEST(Strand, AllOfItsWidthIsChiangsModel) {
    std::mt19937 generator(5);
    double error = 0.0, whole = 0.0, worst = 0.0, largest = 0.0;
    for (int i = 0; i < 200; ++i) {
        const Draw d = draw(generator);
        const glm::dvec3 a = ours(d.strand, -1.0, 1.0, d.eye, d.light, d.around);
        const glm::dvec3 b = points(d.strand, -1.0, 1.0, d.eye, d.light, d.around);
        error += glm::dot(a - b, a - b);
        whole += glm::dot(b, b);
        worst = std::max(worst, glm::length(a - b));
        largest = std::max(largest, glm::length(b));
    }
    RecordProperty("rmse", std::to_string(std::sqrt(error / whole)));
    RecordProperty("worst", std::to_string(worst / largest));
    EXPECT_LT(std::sqrt(error / whole), 0.013);
    EXPECT_LT(worst / largest, 0.012);
}

// Of a wide one, whose small part is seen: there the model is not averaged.
TEST(Strand, AtOnePlaceOfItsWidthToo) {
    std::mt19937 generator(6);
    std::uniform_real_distribution<double> across(-0.95, 0.95);
    for (int i = 0; i < 400; ++i) {
        const Draw d = draw(generator);
        const double h = across(generator);
        const glm::dvec3 a = ours(d.strand, h - 1e-3, h + 1e-3, d.eye, d.light, d.around);
        const glm::dvec3 b = reference::sent(d.strand, h, d.eye, d.light, d.around);
        EXPECT_LT(glm::length(a - b), 2e-3 * glm::length(b) + 1e-4) << h;
    }
}

// The light from all sides, of radiance 1: nothing is lost, however narrow the lobes.
TEST(Strand, AWhiteFurnaceStaysWhite) {
    for (const double roughness : {0.1, 0.3, 0.7, 1.0}) {
        for (const double eye : {0.0, 0.5, 1.1}) {
            reference::Strand strand;
            strand.longitudinal = strand.primary = strand.azimuthal = roughness;
            constexpr int ELEVATIONS = 400, TURNS = 200;
            double sum = 0.0;
            for (int i = 0; i < ELEVATIONS; ++i) {
                const double sine = -1.0 + 2.0 * (i + 0.5) / ELEVATIONS;
                for (int k = 0; k < TURNS; ++k) {
                    sum += ours(strand, -1.0, 1.0, eye, std::asin(sine), 2.0 * PI * (k + 0.5) / TURNS).x;
                }
            }
            EXPECT_NEAR(sum * 4.0 * PI / (ELEVATIONS * TURNS), 1.0, 0.01) << roughness << " " << eye;
        }
    }
}

TEST(Strand, NothingIsLostInRoundingHoweverSmooth) {
    reference::Strand strand;
    for (const double roughness : {0.001, 0.01, 1.0}) {
        strand.longitudinal = strand.primary = strand.azimuthal = roughness;
        for (const double angle : {-1.5707, -0.3, 0.0, 1.5707}) {
            for (double around = -9.0; around < 9.0; around += 0.37) {
                const glm::dvec3 sent = ours(strand, -1.0, 1.0, angle, -angle, around);
                EXPECT_TRUE(std::isfinite(sent.x) && sent.x >= 0.0) << roughness << " " << angle << " " << around;
            }
        }
    }
}

// Light from the left is worth as much to an eye on the right as the other way about: what strands take and send, where
// scales do not tilt and the elevations are alike, on which the model's attenuation depends.
TEST(Strand, IsReciprocalAtEqualElevations) {
    std::mt19937 generator(7);
    for (int i = 0; i < 50; ++i) {
        Draw d = draw(generator);
        d.strand.tilt = 0.0;
        const glm::dvec3 there = ours(d.strand, -1.0, 1.0, d.eye, d.eye, d.around);
        const glm::dvec3 back = ours(d.strand, -1.0, 1.0, d.eye, d.eye, -d.around);
        EXPECT_LT(glm::length(there - back), 1e-3 * glm::length(there) + 1e-5);
    }
}

// A white matt cylinder in light from all sides sends it all; and its lit part shrinks with the turn of the light.
TEST(Strand, AMattOneObeysLambert) {
    StrandsText text;
    for (const auto &[low, high] : {std::pair(-1.0F, 1.0F), std::pair(0.2F, 0.5F), std::pair(-0.9F, -0.8F)}) {
        const auto look = text.strand_look(fibre_of({}), 0.3F, low, high);
        for (const float around : {0.3F, -2.0F, 3.0F, 6.5F}) {
            double mean = 0.0;
            constexpr int COUNT = 2000;
            for (int i = 0; i < COUNT; ++i) {
                const double h = double{low} + double{high - low} * (i + 0.5) / COUNT;
                mean += std::max(std::cos(-std::asin(h) - double{around}), 0.0) * std::cos(0.4) / PI / COUNT;
            }
            EXPECT_NEAR(double{text.matt_strand(look, std::sin(0.4F), around)}, mean, 2e-4) << low << " " << around;
        }
    }
}

} // namespace
} // namespace sfumato
