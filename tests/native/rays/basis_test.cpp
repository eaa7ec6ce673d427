// SPDX-License-Identifier: GPL-3.0-or-later
// shaders/rays/basis.glsl and the table of bases: what algebra says of any basis, and what holds for each.
#include "rays/basis.hpp"
#include "rays/learned_basis.hpp"
#include "support/ray_profiles.hpp"

#include <numeric>
#include <string>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

Series learned(std::size_t count, RangeKind kind = RangeKind::WHOLE) {
    std::vector<Profile> rays;
    std::vector<Absorbers> absorbers;
    std::vector<Range> ranges;
    for (unsigned seed = 100; seed < 140; ++seed) {
        rays.push_back(cloud(seed));
    }
    for (const Profile &ray : rays) {
        absorbers.push_back(ray.absorbers());
        ranges.push_back(depth_range(ray.absorbers(), kind, 3.0F));
    }
    return learn_basis(absorbers, ranges, count);
}

class EveryBasis : public testing::TestWithParam<BasisName> {
protected:
    static Series series(std::size_t count = 15) {
        return GetParam() == LEARNED ? learned(count) : Series{GetParam(), count, {}};
    }
    static std::vector<float> coefficients(const Series &series, const Profile &ray, const Range &range = {}) {
        std::vector<float> c(series.count, 0.0F);
        project(series, ray.absorbers(), range, c);
        return c;
    }
    static std::vector<float> light(const Series &series, const Profile &ray, const Range &range, Evaluator evaluator,
                                    const std::vector<float> &depths) {
        std::vector<float> out(depths.size());
        transmittance(series, coefficients(series, ray, range), range, evaluator, depths, out);
        return out;
    }
};

std::vector<float> grid(int cells) {
    std::vector<float> depths;
    for (int i = 0; i <= cells; ++i) {
        depths.push_back(float(i) / float(cells));
    }
    return depths;
}

// What makes coefficients of a density in the basis come back: the integral of F_j dG_k is 1 for j = k, else 0.
TEST_P(EveryBasis, IsBiorthogonal) {
    constexpr int CELLS = 64 * 15 * 4; // cuts at the steps of slices and tables
    const Series s = series();
    std::vector<double> products(s.count * s.count, 0.0);
    std::vector<float> f(s.count), before(s.count), after(s.count);
    for (int i = 0; i < CELLS; ++i) {
        s.basis().density((float(i) + 0.5F) / CELLS, 0.0F, f, s.tables);
        s.basis().integral(float(i) / CELLS, before, s.tables);
        s.basis().integral(float(i + 1) / CELLS, after, s.tables);
        for (std::size_t j = 0; j < s.count; ++j) {
            for (std::size_t k = 0; k < s.count; ++k) {
                products[j * s.count + k] += double{f[j]} * (double{after[k]} - double{before[k]});
            }
        }
    }
    for (std::size_t j = 0; j < s.count; ++j) {
        for (std::size_t k = 0; k < s.count; ++k) {
            EXPECT_NEAR(products[j * s.count + k], j == k ? 1.0 : 0.0, 2e-4) << j << ", " << k;
        }
    }
}

// However the sums are taken, and for numbers of absorbers that no number of lanes divides.
TEST_P(EveryBasis, ProjectsTheSumOfItsDensities) {
    std::mt19937 generator(31);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    const Range range{0.2F, 0.7F};
    for (const std::size_t count : {0U, 1U, 3U, 17U, 64U, 301U}) {
        for (const float width : {0.0F, 0.05F}) {
            Profile ray{{}, {}, width};
            for (std::size_t i = 0; i < count; ++i) {
                ray.depth.push_back(uniform(generator));
                ray.tau.push_back(uniform(generator));
            }
            const Series s = series();
            std::vector<double> sums(s.count, 0.0);
            std::vector<float> f(s.count);
            for (std::size_t i = 0; i < count; ++i) {
                const float z = std::clamp((ray.depth[i] - range.low) / (range.high - range.low), 0.0F, 1.0F);
                s.basis().density(z, width / (range.high - range.low), f, s.tables);
                for (std::size_t k = 0; k < s.count; ++k) {
                    sums[k] += double{ray.tau[i]} * double{f[k]};
                }
            }
            const auto c = coefficients(s, ray, range);
            for (std::size_t k = 0; k < s.count; ++k) {
                EXPECT_NEAR(c[k], sums[k], 2e-6 * double(count + 10)) << k << " of " << count << " " << width;
            }
        }
    }
}

// What of a slab, or of a whole one, lies outside the range counts at its ends, and is not lost.
TEST_P(EveryBasis, HoldsTheTotalOfSlabsThatItsRangeCuts) {
    const Profile ray{{0.1F, 0.25F, 0.3F, 0.69F, 0.72F, 0.95F}, {0.5F, 0.25F, 0.125F, 0.5F, 0.25F, 0.125F}, 0.11F};
    const Series s = series();
    EXPECT_NEAR(total_of(s, coefficients(s, ray, {0.25F, 0.7F})), 1.75, 1e-5);
}

TEST_P(EveryBasis, IsExactBeforeAndBehindItsRange) {
    for (const Range range : {Range{0.0F, 1.0F}, Range{0.25F, 0.75F}, Range{0.5F, 0.5F}}) {
        for (const Evaluator evaluator : {Evaluator::CLAMP, Evaluator::MONOTONE}) {
            const Profile ray = cloud(1);
            const auto t = light(series(), ray, range, evaluator, {0.0F, range.high + 1e-5F, 1.0F});
            EXPECT_NEAR(t[0], 1.0F, 1e-6F);
            EXPECT_NEAR(t[1], std::exp(-ray.total()), 1e-4);
            EXPECT_NEAR(t[2], std::exp(-ray.total()), 1e-5);
        }
    }
}

TEST_P(EveryBasis, OfTwoSetsIsTheSum) {
    const Profile a = cloud(2), b = cloud(3);
    Profile both = a;
    both.depth.insert(both.depth.end(), b.depth.begin(), b.depth.end());
    both.tau.insert(both.tau.end(), b.tau.begin(), b.tau.end());
    const Series s = series();
    const Range range{0.1F, 0.9F};
    const auto ca = coefficients(s, a, range), cb = coefficients(s, b, range), c = coefficients(s, both, range);
    for (std::size_t k = 0; k < s.count; ++k) {
        EXPECT_NEAR(c[k], ca[k] + cb[k], 2e-5F) << k;
    }
}

TEST_P(EveryBasis, DoesNotMindTheOrder) {
    const Profile ray = cloud(4);
    Profile turned = ray;
    std::reverse(turned.depth.begin(), turned.depth.end());
    std::reverse(turned.tau.begin(), turned.tau.end());
    const Series s = series();
    const auto a = coefficients(s, ray), b = coefficients(s, turned);
    for (std::size_t k = 0; k < s.count; ++k) {
        EXPECT_NEAR(a[k], b[k], 2e-5F) << k;
    }
}

// A slab is many flat particles side by side.
TEST_P(EveryBasis, OfASlabIsTheMeanOverIt) {
    constexpr int PARTS = 4000;
    const Series s = series();
    const Profile slab{{0.4F}, {2.0F}, 0.17F};
    Profile parts;
    for (int i = 0; i < PARTS; ++i) {
        parts.depth.push_back(0.4F + 0.17F * ((float(i) + 0.5F) / PARTS - 0.5F));
        parts.tau.push_back(2.0F / PARTS);
    }
    const auto whole = coefficients(s, slab), sum = coefficients(s, parts);
    for (std::size_t k = 0; k < s.count; ++k) {
        EXPECT_NEAR(whole[k], sum[k], 2e-3F) << k;
    }
}

TEST_P(EveryBasis, NeverBrightensWithDepthWhenMonotone) {
    const auto depths = grid(300);
    for (unsigned seed = 10; seed < 40; ++seed) {
        const Profile ray = cloud(seed);
        const auto t = light(series(7), ray, {}, Evaluator::MONOTONE, depths);
        for (std::size_t i = 1; i < t.size(); ++i) {
            EXPECT_LE(t[i], t[i - 1] + 1e-6F);
        }
        EXPECT_LE(t.front(), 1.0F);
        EXPECT_GE(t.back(), float(std::exp(-ray.total())) * 0.9999F);
    }
}

TEST_P(EveryBasis, ApproachesTheReferenceAsCoefficientsGrow) {
    double last = 1.0;
    for (const std::size_t count : {5U, 11U, 23U}) {
        const Series s = series(count);
        const double error = error_in_clouds([&](const Profile &ray, const std::vector<float> &depths) {
            return light(s, ray, {}, Evaluator::CLAMP, depths);
        });
        EXPECT_LT(error, 0.8 * last) << count;
        last = error;
    }
    EXPECT_LT(last, 0.02);
}

// Half a level of the largest that the total allows, and a half float's rounding of that total.
TEST_P(EveryBasis, LosesHalfALevelInEightBits) {
    const Series s = series();
    const Profile ray = cloud(5);
    const Range range = depth_range(ray.absorbers(), RangeKind::WHOLE, 3.0F);
    const auto c = coefficients(s, ray, range);
    std::vector<std::uint8_t> texel(texel_bytes(s));
    std::vector<float> back(s.count), f(s.count), most(s.count, 0.0F);
    pack(s, c, range, texel);
    const Range stored = unpack(s, texel, back);
    EXPECT_EQ(stored.low, 0.0F);
    EXPECT_EQ(stored.high, 1.0F);
    for (const float z : grid(2000)) {
        s.basis().density(z, 0.0F, f, s.tables);
        for (std::size_t k = 0; k < s.count; ++k) {
            most[k] = std::max(most[k], std::abs(f[k]));
        }
    }
    float furthest = 0.0F;
    for (std::size_t k = 0; k < s.count; ++k) {
        const float level = total_of(s, c) * most[k] / 127.0F;
        EXPECT_NEAR(back[k], c[k], 0.5F * level + 0.02F * std::abs(c[k]) + 1e-6F) << k; // 0.02: slices are rescaled
        furthest = std::max(furthest, std::abs(back[k] - c[k]) / level);
    }
    EXPECT_GT(furthest, 0.1F); // levels there are
    EXPECT_NEAR(total_of(s, back), total_of(s, c), total_of(s, c) / 2048.0F);
}

TEST_P(EveryBasis, FitsTwentyBytes) {
    const std::size_t count = coefficients_in(GetParam(), 20);
    EXPECT_EQ(count, GetParam() == PIECEWISE ? 14U : 15U);
    EXPECT_EQ(texel_bytes({GetParam(), count, {}}), 20U);
}

std::string name_of(const testing::TestParamInfo<BasisName> &info) {
    return BASES[info.param].name;
}

INSTANTIATE_TEST_SUITE_P(Bases, EveryBasis, testing::Values(FOURIER, COSINE, PIECEWISE, LEARNED), name_of);

TEST(Learned, NeedsFewerCoefficientsThanFourier) {
    const auto error_of = [](const Series &s) {
        return error_in_clouds([&](const Profile &ray, const std::vector<float> &depths) {
            std::vector<float> c(s.count, 0.0F), out(depths.size());
            project(s, ray.absorbers(), {}, c);
            transmittance(s, c, {}, Evaluator::CLAMP, depths, out);
            return out;
        });
    };
    EXPECT_LT(error_of(learned(7)), 0.9 * error_of({FOURIER, 7, {}})); // measured: 0.021 against 0.026
}

TEST(Learned, IsTheSameEachTime) {
    const Series a = learned(9), b = learned(9);
    EXPECT_EQ(a.tables.f, b.tables.f);
    EXPECT_EQ(a.tables.g, b.tables.g);
}

TEST(Learned, OfOneRayHasOneFunction) {
    const Profile ray = cloud(6);
    const std::vector<Absorbers> rays{ray.absorbers()};
    const std::vector<Range> ranges(1);
    const Series s = learn_basis(rays, ranges, 4);
    std::vector<float> c(4, 0.0F);
    project(s, ray.absorbers(), {}, c);
    EXPECT_NEAR(c[0], ray.total(), 1e-5);
    for (std::size_t k = 1; k < 4; ++k) {
        EXPECT_NEAR(c[k], 0.0F, 1e-4F);
    }
}

TEST(Ranges, HoldWhatTheySay) {
    for (unsigned seed = 0; seed < 30; ++seed) {
        const Profile ray = cloud(seed);
        const auto [least, most] = std::minmax_element(ray.depth.begin(), ray.depth.end());
        const Range all = depth_range(ray.absorbers(), RangeKind::MINMAX, 3.0F);
        const float pad = 0.05F * (*most - *least) + 0.001F;
        EXPECT_NEAR(all.low, *least - pad, 3e-5F);
        EXPECT_NEAR(all.high, *most + pad, 3e-5F);
        EXPECT_LE(all.low, *least - pad + 1e-7F); // rounded outwards
        EXPECT_GE(all.high, *most + pad - 1e-7F);
        double s1 = 0.0, s2 = 0.0;
        for (std::size_t i = 0; i < 64; ++i) {
            s1 += double{ray.tau[i]} * double{ray.depth[i]};
            s2 += double{ray.tau[i]} * double{ray.depth[i]} * double{ray.depth[i]};
        }
        const double mean = s1 / ray.total(), deviation = std::sqrt(s2 / ray.total() - mean * mean);
        const Range near = depth_range(ray.absorbers(), RangeKind::MOMENTS, 2.0F);
        EXPECT_NEAR(near.low, mean - 2.0 * deviation - 0.001, 1e-4);
        EXPECT_NEAR(near.high, mean + 2.0 * deviation + 0.001, 1e-4);
        const Range both = depth_range(ray.absorbers(), RangeKind::BOTH, 2.0F);
        EXPECT_EQ(both.low, std::max(all.low, near.low));
        EXPECT_EQ(both.high, std::min(all.high, near.high));
    }
}

// A core between .4 and .6 in thin smoke that reaches from end to end, front to back and back to front.
TEST(Ranges, LeaveThinEndsOut) {
    for (const float total : {0.1F, 1.0F, 10.0F}) {
        Profile ray;
        for (int i = 0; i < 1000; ++i) {
            const float z = (float(i) + 0.5F) / 1000.0F;
            ray.depth.push_back(z);
            ray.tau.push_back(total * (std::abs(z - 0.5F) < 0.1F ? 0.998F / 200.0F : 0.002F / 800.0F));
        }
        const Range trimmed = depth_range(ray.absorbers(), RangeKind::TRIMMED, 3.0F);
        const Range all = depth_range(ray.absorbers(), RangeKind::MINMAX, 3.0F);
        EXPECT_NEAR(all.low, -0.05F, 2e-3F);
        double front = 0.0, behind = 0.0;
        for (std::size_t i = 0; i < ray.depth.size(); ++i) {
            front += ray.depth[i] < trimmed.low ? double{ray.tau[i]} : 0.0;
            behind += ray.depth[i] > trimmed.high ? double{ray.tau[i]} : 0.0;
        }
        EXPECT_LE(front, 0.002 * std::min(double{total}, 1.0));
        EXPECT_LE(behind, 0.002 * double{total});
        EXPECT_NEAR(trimmed.high, 0.61F, 0.02F);
        EXPECT_NEAR(trimmed.low, total < 2.0F ? 0.39F : 0.05F, 0.05F);
    }
}

TEST(Ranges, SurviveStorage) {
    std::vector<std::uint8_t> texel(HEAD_BYTES);
    for (const Range range : {Range{0.0F, 1.0F}, storable({0.123F, 0.124F}), storable({-0.05F, 1.05F})}) {
        const TexelHead head = write_head(range, 1e9F, texel);
        EXPECT_EQ(head.range.low, range.low);
        EXPECT_EQ(head.range.high, range.high);
        EXPECT_EQ(head.total, 65504.0F); // opaque, and finite
    }
}

TEST(Ranges, OfNothingIsTheWhole) {
    const Profile clear{{0.2F, 0.6F}, {0.0F, 0.0F}, 0.0F};
    for (const RangeKind kind : {RangeKind::MINMAX, RangeKind::MOMENTS, RangeKind::BOTH, RangeKind::TRIMMED}) {
        const Range range = depth_range(clear.absorbers(), kind, 3.0F);
        EXPECT_EQ(range.low, 0.0F);
        EXPECT_EQ(range.high, 1.0F);
    }
}

} // namespace
} // namespace sfumato
