// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/rays/opacity.glsl: the Fourier series of an absorption function, one lane wide and many.
#include "rays/opacity.hpp"
#include "reference/reference.hpp"
#include "text/dispatch.hpp"
#include "text/rays_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using RaysText = text::RaysText<float>;

struct Fragments {
    std::vector<float> depth;
    std::vector<float> tau;

    void add(float d, float optical_depth) {
        depth.push_back(d);
        tau.push_back(optical_depth);
    }
};

Fragments random_fragments(int count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    Fragments fragments;
    for (int i = 0; i < count; ++i) {
        const float depth = uniform(generator);
        fragments.add(depth, RaysText().optical_depth_of(uniform(generator)));
    }
    return fragments;
}

std::vector<float> series_of(const Fragments &fragments, std::size_t count, float width = 0.0F) {
    std::vector<float> coefficients(count, 0.0F);
    add_to_series(fragments.depth, fragments.tau, width, coefficients);
    return coefficients;
}

float transmittance(const std::vector<float> &coefficients, float depth) {
    float out = -1.0F;
    series_transmittance(coefficients, {&depth, 1}, {&out, 1});
    return out;
}

double exact(const Fragments &fragments, double depth) {
    std::vector<reference::Fragment> absorbers;
    for (std::size_t i = 0; i < fragments.depth.size(); ++i) {
        absorbers.push_back({double{fragments.depth[i]}, 1.0 - std::exp(-double{fragments.tau[i]})});
    }
    return reference::transmittance(absorbers, depth);
}

TEST(Series, IsExactAtBothEnds) {
    for (const int fragments : {1, 5, 64}) {
        const Fragments ray = random_fragments(fragments, 11);
        for (const std::size_t count : {1U, 3U, 7U, 31U, 63U}) {
            const std::vector<float> series = series_of(ray, count);
            EXPECT_EQ(transmittance(series, 0.0F), 1.0F);
            const double total = exact(ray, 1.0);
            EXPECT_NEAR(transmittance(series, 1.0F), total, 1e-4 * total) << fragments << " in " << count;
        }
    }
}

TEST(Series, OfTwoSetsIsTheSumOfTheirSeries) {
    const Fragments a = random_fragments(9, 12), b = random_fragments(20, 13);
    Fragments both = a;
    for (std::size_t i = 0; i < b.depth.size(); ++i) {
        both.add(b.depth[i], b.tau[i]);
    }
    const std::vector<float> series_a = series_of(a, 31), series_b = series_of(b, 31), together = series_of(both, 31);
    for (std::size_t c = 0; c < 31; ++c) {
        EXPECT_NEAR(together[c], series_a[c] + series_b[c], 1e-4) << "coefficient " << c;
    }
    EXPECT_GT(together[0], 10.0F);
}

// Moving an absorber by delta turns its k-th harmonic, a + i b, by 2 pi k delta.
TEST(Series, TurnsWhenTheSmokeMoves) {
    Fragments here, there;
    here.add(0.30F, 1.5F);
    there.add(0.37F, 1.5F);
    const std::vector<float> before = series_of(here, 31, 0.1F), after = series_of(there, 31, 0.1F);
    EXPECT_EQ(before[0], after[0]);
    for (std::size_t k = 1; k <= 15; ++k) {
        const double turn = 2.0 * std::numbers::pi * 0.07 * double(k);
        const double a = double{before[2 * k - 1]}, b = double{before[2 * k]};
        EXPECT_NEAR(after[2 * k - 1], a * std::cos(turn) - b * std::sin(turn), 1e-5) << "harmonic " << k;
        EXPECT_NEAR(after[2 * k], b * std::cos(turn) + a * std::sin(turn), 1e-5) << "harmonic " << k;
    }
}

// Light cannot be gained, nor can more be lost than all absorbers take together, however opaque they are.
TEST(Transmittance, StaysBetweenThatOfAllAbsorbersAndOne) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        Fragments ray = random_fragments(3, seed);
        ray.add(0.5F, RaysText().optical_depth_of(1.0F));
        for (const std::size_t count : {3U, 7U, 31U}) {
            const std::vector<float> series = series_of(ray, count);
            const float least = transmittance(series, 1.0F), all = RaysText().transmittance_of(0.5F * series[0]);
            EXPECT_NEAR(least, all, 1e-6F * all); // two exponentials
            for (int i = 0; i <= 200; ++i) {
                const float t = transmittance(series, float(i) / 200.0F);
                EXPECT_LE(t, 1.0F);
                EXPECT_GE(t, least);
            }
        }
    }
}

// Smoke drawn from a normal distribution, 64 particles a ray: the root mean square error over 65 depths of 150 rays.
double error_in_smoke(std::size_t count) {
    std::mt19937 generator(14);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::normal_distribution<double> normal;
    double sum = 0.0;
    for (int r = 0; r < 150; ++r) {
        const double centre = 0.3 + 0.4 * uniform(generator), width = 0.06 + 0.08 * uniform(generator);
        Fragments ray;
        for (int i = 0; i < 64; ++i) {
            const double depth = std::clamp(centre + width * normal(generator), 0.001, 0.999);
            ray.add(float(depth), RaysText().optical_depth_of(float(0.03 + 0.04 * uniform(generator))));
        }
        const std::vector<float> series = series_of(ray, count);
        for (int k = 0; k < 65; ++k) {
            const double depth = (k + 0.37) / 65.0;
            sum += std::pow(double{transmittance(series, float(depth))} - exact(ray, depth), 2);
        }
    }
    return std::sqrt(sum / (150.0 * 65.0));
}

TEST(Transmittance, OfSmokeConvergesToTheProductOverItsParticles) {
    double last = 1.0; // measured: 0.084, 0.028, 0.015, 0.010, 0.007
    for (const std::size_t count : {3U, 7U, 15U, 31U, 63U}) {
        const double error = error_in_smoke(count);
        EXPECT_LT(error, 0.9 * last) << count << " coefficients";
        last = error;
    }
    // The same smoke in an independent program, in double and with other random numbers: 0.026 and 0.014.
    EXPECT_NEAR(error_in_smoke(7), 0.026, 0.004);
    EXPECT_NEAR(error_in_smoke(15), 0.014, 0.002);
}

// A slab is many flat particles side by side.
TEST(SlabFactor, IsTheMeanOverTheSlab) {
    for (const float width : {0.001F, 0.02F, 0.13F, 0.5F}) {
        for (const float k : {1.0F, 3.0F, 8.0F, 31.0F}) {
            double mean = 0.0;
            for (int i = 0; i < 10'000; ++i) {
                const double z = 0.4 + double{width} * ((i + 0.5) / 10'000 - 0.5);
                mean += std::cos(2.0 * std::numbers::pi * double{k} * z) / 10'000;
            }
            const float centre = RaysText().harmonic(k, 0.4F).cosine;
            EXPECT_NEAR(RaysText().slab_factor(k, width) * centre, mean, 2e-5)
                << "width " << width << ", harmonic " << k;
        }
    }
    EXPECT_NEAR(RaysText().slab_factor(31.0F, 0.0F), 1.0F, 1e-7);
}

// The angle 2 pi z is rounded once, by up to 2.4e-7, and each step turns by that much too far or not far enough.
TEST(Harmonics, FromAngleSumsAreTheHarmonics) {
    std::mt19937 generator(15);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    for (int i = 0; i < 1000; ++i) {
        const float z = uniform(generator);
        const RaysText::Harmonic first = RaysText().harmonic(1.0F, z);
        RaysText::Harmonic h = first;
        for (int k = 1; k <= 31; ++k) {
            const double angle = 2.0 * std::numbers::pi * k * double{z};
            EXPECT_NEAR(h.cosine, std::cos(angle), 5e-7 * k) << "harmonic " << k << " at " << z;
            EXPECT_NEAR(h.sine, std::sin(angle), 5e-7 * k) << "harmonic " << k << " at " << z;
            h = RaysText().next_harmonic(h, first);
        }
    }
}

// Eq 3 with the receiver's own coefficients, at its own depth, in double.
TEST(SelfShare, IsTheSeriesOfAReceiverAtItsOwnDepth) {
    for (int i = 0; i <= 100; ++i) {
        const float z = float(i) / 100.0F;
        const RaysText::Harmonic first = RaysText().harmonic(1.0F, z);
        RaysText::Harmonic h = first;
        float found = z;
        double wanted = double{z};
        for (int k = 1; k <= 7; ++k) {
            const double angle = 2.0 * std::numbers::pi * k * double{z};
            const double a = 2.0 * std::cos(angle), b = 2.0 * std::sin(angle);
            wanted += (a * std::sin(angle) + b * (1.0 - std::cos(angle))) / (2.0 * std::numbers::pi * k);
            found += RaysText().self_harmonic(h, float(k));
            EXPECT_NEAR(found, wanted, 3e-6) << "harmonic " << k << " at " << z;
            h = RaysText().next_harmonic(h, first);
        }
    }
}

TEST(OpticalDepth, IsUndoneByTransmittanceAndFiniteForTheOpaque) {
    EXPECT_EQ(RaysText().optical_depth_of(0.0F), 0.0F);
    for (const float alpha : {0.01F, 0.3F, 0.5F, 0.9F, 0.999F}) {
        EXPECT_NEAR(RaysText().transmittance_of(RaysText().optical_depth_of(alpha)), 1.0F - alpha, 1e-6) << alpha;
    }
    EXPECT_NEAR(RaysText().optical_depth_of(1.0F), 20.0 * std::numbers::ln2, 0.05);
}

TEST(InstructionSets, AreListedWithTheWidestLast) {
    int lanes = 0;
    for (const InstructionSet &set : instruction_sets()) {
        EXPECT_GT(set.lanes, lanes);
        lanes = set.lanes;
    }
    EXPECT_EQ(instruction_set().lanes, lanes);
    EXPECT_LE(lanes, MAX_LANES);
}

} // namespace
} // namespace sfumato
