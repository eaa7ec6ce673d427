// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions and their tables, against Simpson's rule in double precision.
#include "../support/ramps.hpp"
#include "media/preintegration.hpp"
#include "media/preintegration_kernels.hpp"

#include <algorithm>
#include <random>

#include <glm/common.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

using testing::edges;
using testing::judged;
using testing::peaks;
using testing::smooth_ramp;
using testing::steps;

const std::vector<Ramp> &ramps() {
    static const std::vector<Ramp> all{smooth_ramp(), smooth_ramp(true), peaks(), peaks(true), steps(), edges()};
    return all;
}

double difference_of(const glm::dvec4 &a, const glm::dvec4 &b) {
    const glm::dvec4 apart = glm::abs(a - b);
    return std::max({apart.x, apart.y, apart.z, apart.w});
}

template <typename Real>
void check_moments(double tolerance) {
    using Text = text::PreintegrationText<Real>;
    for (const double tau : {0.0, 1e-6, 1e-3, 0.1, 0.7, 0.9999, 1.0001, 3.0, 20.0, 50.0, 200.0}) {
        const typename Text::Attenuation over = Text().attenuation_over(static_cast<Real>(tau));
        double mean = 0.0, tilt = 0.0, arc = 0.0, slant = 0.0;
        constexpr int N = 20'000;
        for (int i = 0; i < N; ++i) {
            const double t = (i + 0.5) / N, passed = std::exp(-tau * t) / N;
            mean += passed;
            tilt += passed * (t - 0.5);
            arc += passed * t * (1.0 - t);
            slant += passed * t * (1.0 - t) * (t - 0.5);
        }
        EXPECT_NEAR(over.mean, mean, tolerance) << tau;
        EXPECT_NEAR(over.tilt, tilt, tolerance) << tau;
        EXPECT_NEAR(over.arc, arc, tolerance) << tau;
        EXPECT_NEAR(over.slant, slant, tolerance) << tau;
        EXPECT_NEAR(over.behind, std::exp(-tau), tolerance) << tau;
    }
}

TEST(Attenuation, HasTheMomentsOfTheExponential) {
    check_moments<double>(3e-8); // the sum's own error at 200 is 4e-6 of its 5e-3
    check_moments<float>(1e-6);
}

TEST(TransferFunction, IsTheRampThatItWasGiven) {
    for (const Ramp &ramp : ramps()) {
        const TransferFunction transfer(ramp);
        for (int i = -10; i <= 110; ++i) {
            const double s = i / 100.0 + 1e-4;
            EXPECT_LT(difference_of(transfer.at(s), judged(ramp)(s)), 1e-12) << s;
        }
    }
}

TEST(TransferFunction, IntegratesExactly) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-0.2, 1.2);
    for (const Ramp &ramp : ramps()) {
        const TransferFunction transfer(ramp);
        for (int n = 0; n < 50; ++n) {
            const double a = uniform(generator), b = n % 2 == 0 ? uniform(generator) : a + 1e-5 * uniform(generator);
            constexpr int N = 20'000;
            glm::dvec4 mean(0.0);
            for (int i = 0; i < N; ++i) {
                mean += judged(ramp)(a + (b - a) * (i + 0.5) / N) / double{N};
            }
            EXPECT_LT(difference_of(transfer.mean(a, b), mean), 2e-4) << a << " to " << b; // a step, missed by half
            EXPECT_EQ(transfer.mean(b, a), transfer.mean(a, b));
            const glm::dvec4 both = transfer.integral(b) - transfer.integral(a);
            EXPECT_LT(difference_of(transfer.mean(a, b) * (b - a), both), 1e-14) << a << " to " << b;
        }
    }
}

TEST(TransferFunction, HasAMeanAcrossAStopHoweverCloseBothEnds) {
    const TransferFunction transfer(steps());
    for (double apart = 1e-3; apart > 1e-15; apart *= 0.1) {
        const Emitted mean = transfer.mean(0.42 - apart, 0.42 + apart);
        EXPECT_LT(difference_of(mean, 0.5 * (transfer.at(0.41) + transfer.at(0.43))), 1e-9 + 1e-16 / apart) << apart;
    }
}

TEST(TransferFunction, OfOneStopIsConstant) {
    const TransferFunction transfer({{0.5}, {2.0}, {glm::dvec3(1.0, 2.0, 3.0)}, true, false});
    EXPECT_EQ(transfer.at(-3.0), glm::dvec4(2.0, 4.0, 6.0, 2.0));
    EXPECT_EQ(transfer.integral(1.5), glm::dvec4(2.0, 4.0, 6.0, 2.0));
    EXPECT_EQ(transfer.mean(-1.0, 4.0), glm::dvec4(2.0, 4.0, 6.0, 2.0));
}

// Radiance is at most 1.5, where smoke is opaque; emission without extinction adds up to 3.
TEST(Stretch, SendsWhatSimpsonsRuleFinds) {
    std::mt19937 generator(8);
    std::uniform_real_distribution<double> uniform(-0.1, 1.1);
    for (const Ramp &ramp : ramps()) {
        for (const double depth : {0.01, 0.5, 3.0, 50.0}) {
            const TransferFunction transfer(ramp);
            const double scale = ramp.associated ? depth : 1.0;
            for (int n = 0; n < 30; ++n) {
                const double a = uniform(generator), b = uniform(generator);
                EXPECT_LT(
                    difference_of(sent_by(transfer, a, b, depth), reference::sent(judged(ramp), a, b, depth, 2000)),
                    1e-6 * std::max(scale, 1.0))
                    << a << " to " << b << " over " << depth;
            }
        }
    }
}

TEST(Stretch, OfOneColourIsOpacityTimesThatColour) {
    const Ramp ramp{
        {0.0, 0.4, 1.0}, {0.0, 3.0, 0.5}, std::vector<glm::dvec3>(3, glm::dvec3(0.2, 0.5, 1.0)), true, false};
    const Sent sent = sent_by(TransferFunction(ramp), 0.1, 0.9, 2.0);
    EXPECT_LT(difference_of(sent, {(1.0 - sent.w) * ramp.colour[0], sent.w}), 1e-6);
    EXPECT_LT(
        difference_of(sent, from_means(2.0 * TransferFunction(ramp).mean(0.1, 0.9), SelfAttenuation::MEAN_SOURCE)),
        1e-6);
}

// One piece, which hardly bends, of smoke that glows at one end.
TEST(Stretch, MayGlowUnevenlyWhereItBends) {
    const Ramp ramp{{0.0, 1.0}, {2.0, 2.0099}, {glm::dvec3(0.0), glm::dvec3(1.0, 2.0, 10.0)}, true, true};
    for (const double front : {0.0, 1.0}) {
        const Sent sent = sent_by(TransferFunction(ramp), front, 1.0 - front, 1.0);
        EXPECT_LT(difference_of(sent, reference::sent(judged(ramp), front, 1.0 - front, 1.0)), 1e-5);
    }
}

// However abrupt: of a wall, its front is seen.
TEST(Stretch, OfSmokeThatIsOpaqueAtOnceIsFinite) {
    for (const double depth : {1e3, 1e6, 1e30}) {
        const Sent sent = sent_by(TransferFunction(smooth_ramp()), 1.0, 0.0, depth);
        EXPECT_LT(sent.w, 1e-100);
        EXPECT_LT(difference_of(sent, glm::dvec4(smooth_ramp().colour[8], 0.0)), 0.02) << depth;
    }
}

glm::dvec4 entry(const PreintegratedTable &table, std::size_t step, std::size_t i, std::size_t j) {
    const float *const e = table.values().data() + ((step * table.entries() + i) * table.entries() + j) * 4;
    return {e[0], e[1], e[2], 1.0 - double{e[3]}};
}

TEST(Table, HasWhatSimpsonsRuleFindsInEveryEntry) {
    for (const Ramp &ramp : {smooth_ramp(), peaks(), steps(), testing::times(edges(), 0.5)}) {
        const std::vector<double> lengths{0.3, 2.0, 50.0};
        const PreintegratedTable table(ramp, 0.0, 1.0, 33, lengths, SelfAttenuation::FULL);
        for (std::size_t step = 0; step < lengths.size(); ++step) {
            double most = 0.0;
            for (std::size_t i = 0; i < 33; ++i) {
                for (std::size_t j = 0; j < 33; ++j) {
                    if (i != j) {
                        const auto wanted = reference::sent(judged(ramp), double(i) / 32.0, double(j) / 32.0,
                                                            lengths[step], lengths[step] > 10.0 ? 1000 : 200);
                        most = std::max(most, difference_of(entry(table, step, i, j), wanted) /
                                                  (ramp.associated ? std::max(lengths[step], 1.0) : 1.0));
                    }
                }
            }
            EXPECT_LT(most, 1e-6) << lengths[step] << " of the ramp with " << ramp.stops.size() << " stops";
        }
    }
}

// Some hundred entries of the largest table; 50 is the optical depth of a step where the peaks are highest.
TEST(Table, Of1024ValuesIsAsExact) {
    std::mt19937 generator(9);
    std::uniform_int_distribution<std::size_t> any(0, 1023);
    for (const double length : {1.0, 50.0}) {
        const Ramp ramp = peaks();
        const PreintegratedTable table(ramp, 0.0, 1.0, 1024, {length}, SelfAttenuation::FULL);
        EXPECT_TRUE(std::ranges::all_of(table.values(), [](float x) { return std::isfinite(x) && x >= 0.0F; }));
        for (int n = 0; n < 200; ++n) {
            const std::size_t i = any(generator), j = n % 2 == 0 ? any(generator) : std::min<std::size_t>(i + 1, 1023);
            if (i != j) {
                const auto wanted = reference::sent(judged(ramp), double(i) / 1023.0, double(j) / 1023.0, length);
                EXPECT_LT(difference_of(entry(table, 0, i, j), wanted), 1e-6) << i << ", " << j << ", " << length;
            }
        }
    }
}

// The judge's own table, slab by slab, has the error of its slabs, in which nothing changes; most in those alone.
TEST(Table, IsThatOfThePlainBuild) {
    const Ramp ramp = smooth_ramp();
    const PreintegratedTable table(ramp, 0.0, 1.0, 65, {2.0}, SelfAttenuation::FULL);
    const std::vector<glm::dvec4> plain = reference::table(judged(ramp), 0.0, 1.0, 65, 2.0);
    for (std::size_t i = 0; i < 65; ++i) {
        for (std::size_t j = 0; j < 65; ++j) {
            EXPECT_LT(difference_of(entry(table, 0, i, j), plain[i * 65 + j]), i + 1 == j || j + 1 == i ? 6e-3 : 3e-3)
                << i << ", " << j;
        }
    }
}

TEST(Table, WithoutSelfAttenuationKeepsAllThatIsEmitted) {
    const Ramp ramp = steps();
    const TransferFunction transfer(ramp);
    const PreintegratedTable none(ramp, 0.0, 1.0, 33, {4.0}, SelfAttenuation::NONE);
    const PreintegratedTable mixed(ramp, 0.0, 1.0, 33, {4.0}, SelfAttenuation::MEAN_SOURCE);
    const Emitted mean = transfer.mean(5.0 / 32.0, 27.0 / 32.0);
    const double opacity = 1.0 - std::exp(-4.0 * mean.w);
    EXPECT_LT(difference_of(entry(none, 0, 27, 5), {4.0 * glm::dvec3(mean), 1.0 - opacity}), 1e-6);
    EXPECT_LT(difference_of(entry(mixed, 0, 5, 27), {glm::dvec3(mean) / mean.w * opacity, 1.0 - opacity}), 1e-6);
}

// What a stop's neighbours enclose, and nothing else, is built again.
TEST(Table, RebuiltForAMovedStopIsTheTableOfTheNewRamp) {
    const std::size_t all = 2 * 257 * 257;
    for (const bool associated : {false, true}) {
        PreintegratedTable table(peaks(associated), 0.0, 1.0, 257, {1.0, 50.0}, SelfAttenuation::FULL);
        Ramp ramp = peaks(associated);
        ramp.stops[11] = 0.81; // between .77 and .83: what lies below is left
        const std::size_t built = table.rebuild(ramp);
        EXPECT_LT(built, all / 2);
        EXPECT_GT(built, all / 3); // 1 - .77^2 - .17^2 of them
        EXPECT_EQ(table.values(), PreintegratedTable(ramp, 0.0, 1.0, 257, {1.0, 50.0}, SelfAttenuation::FULL).values());
        EXPECT_EQ(table.rebuild(ramp), 0U);
    }
}

TEST(Table, RebuiltForAnyChangeIsTheTableOfTheNewRamp) {
    for (const SelfAttenuation how : {SelfAttenuation::FULL, SelfAttenuation::MEAN_SOURCE, SelfAttenuation::NONE}) {
        PreintegratedTable table(steps(), 0.0, 1.0, 70, {3.0}, how);
        std::vector<Ramp> next{steps(), steps(), peaks(), peaks(), smooth_ramp(), smooth_ramp(true)};
        next[0].stops[1] = 0.5;
        next[1].colour[2] = glm::dvec3(2.0);
        next[3].stops.erase(next[3].stops.begin() + 4); // of which the last values are left over
        next[3].extinction.erase(next[3].extinction.begin() + 4);
        next[3].colour.erase(next[3].colour.begin() + 4);
        for (const Ramp &ramp : next) {
            EXPECT_GT(table.rebuild(ramp), 0U);
            EXPECT_EQ(table.values(), PreintegratedTable(ramp, 0.0, 1.0, 70, {3.0}, how).values());
        }
    }
}

TEST(Table, IsReadBetweenItsEntries) {
    const PreintegratedTable table(smooth_ramp(), 0.0, 1.0, 257, {1.0, 2.0}, SelfAttenuation::FULL);
    EXPECT_LT(difference_of(table.look_up(0.25, 0.75, 1), entry(table, 1, 64, 192)), 1e-7);
    const glm::dvec4 exact = sent_by(TransferFunction(smooth_ramp()), 0.3141, 0.8765, 1.0);
    EXPECT_LT(difference_of(table.look_up(0.3141, 0.8765, 0), exact), 1e-4);
    EXPECT_LT(difference_of(table.look_up(-1.0, 7.0, 0), entry(table, 0, 0, 256)), 1e-7);
}

// All sets have the same text, and cut into as many pieces as one of their lanes asks for.
TEST(Kernels, OfEachInstructionSetSendTheSame) {
    std::vector<double> rising(32), falling(32), some(32);
    for (std::size_t k = 0; k < 32; ++k) {
        rising[k] = 0.1 * double(k);
        falling[k] = 3.0 - 0.05 * double(k);
        some[k] = double(k % 5);
    }
    SlabBatch batch;
    batch.slabs = {rising.data(),
                   falling.data(),
                   {some.data(), rising.data(), falling.data()},
                   {rising.data(), some.data(), rising.data()},
                   {falling.data(), rising.data(), some.data()}};
    batch.length = 0.7;
    batch.last = 32;
    std::vector<SlabSent> baseline(32);
    batch.out = baseline.data();
    preintegration_kernels(instruction_sets()[0]).send_slabs(batch);
    for (const InstructionSet &with : instruction_sets()) {
        std::vector<SlabSent> sent(32);
        batch.out = sent.data();
        preintegration_kernels(with).send_slabs(batch);
        for (std::size_t k = 0; k < 32; ++k) {
            EXPECT_NEAR(sent[k].behind, baseline[k].behind, 1e-14) << with.name;
            for (int c = 0; c < 4; ++c) {
                EXPECT_NEAR(sent[k].forwards[c], baseline[k].forwards[c], 2e-6) << with.name;
                EXPECT_NEAR(sent[k].backwards[c], baseline[k].backwards[c], 2e-6) << with.name;
            }
        }
    }
}

} // namespace
} // namespace sfumato
