// SPDX-License-Identifier: GPL-3.0-or-later
// The lanes of every instruction set against the same text, one lane wide, and against the table of bases.
#include "rays/curve.hpp"
#include "rays/ray_kernels.hpp"
#include "support/ray_profiles.hpp"

#include <array>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr int RAYS = 37, RECEIVERS = 5; // no multiple of any number of lanes

class EverySet : public testing::Test {
protected:
    void SetUp() override {
        for (unsigned seed = 0; seed < RAYS; ++seed) {
            rays.push_back(cloud(seed));
            ranges.push_back(depth_range(rays.back().absorbers(), RangeKind::MINMAX, 3.0F));
        }
        for (int i = 0; i < RAYS * RECEIVERS; ++i) {
            depth.push_back(float(i * 53 % (RAYS * RECEIVERS)) / float(RAYS * RECEIVERS - 1));
        }
    }
    [[nodiscard]] std::vector<float> coefficients(const Series &series) const {
        std::vector<float> c(RAYS * series.count, 0.0F);
        for (std::size_t r = 0; r < RAYS; ++r) {
            project(series, rays[r].absorbers(), ranges[r], std::span(c).subspan(r * series.count, series.count));
        }
        return c;
    }
    // By Basis::integral, in single lanes.
    [[nodiscard]] std::vector<float> expected(const Series &series, std::span<const float> all) const {
        std::vector<float> out, g(series.count);
        for (std::size_t i = 0; i < depth.size(); ++i) {
            const std::size_t r = i / RECEIVERS;
            const std::span<const float> c = all.subspan(r * series.count, series.count);
            const float d = (depth[i] - ranges[r].low) / (ranges[r].high - ranges[r].low);
            series.basis().integral(std::clamp(d, 0.0F, 1.0F), g, series.tables);
            double tau = 0.0;
            for (std::size_t k = 0; k < g.size(); ++k) {
                tau += double{c[k]} * double{g[k]};
            }
            out.push_back(float(std::exp(-std::clamp(tau, 0.0, double{total_of(series, c)}))));
        }
        return out;
    }

    std::vector<Profile> rays;
    std::vector<Range> ranges;
    std::vector<float> depth;
};

TEST_F(EverySet, SumsHarmonics) {
    std::vector<float> z, tau;
    for (int i = 0; i < 301; ++i) {
        z.push_back(float(i) / 300.0F);
        tau.push_back(0.01F * float(i % 7));
    }
    for (const InstructionSet &set : instruction_sets()) {
        for (const bool half : {false, true}) {
            std::array<float, 19> sums{};
            ray_kernels(set).harmonic_sums(
                {z.data(), tau.data(), z.size(), 0.25F, 0.75F, half, half ? 18U : 9U, sums.data()});
            for (std::size_t j = 0; j < sums.size(); ++j) {
                const std::size_t k = half ? j : (j + 1) / 2;
                double wanted = 0.0;
                for (std::size_t i = 0; i < z.size(); ++i) {
                    const double x = std::clamp((double{z[i]} - 0.25) / 0.5, 0.0, 1.0);
                    const double angle = std::numbers::pi * double(half ? k : 2 * k) * x;
                    wanted += double{tau[i]} * (half || j == 0 || j % 2 == 1 ? std::cos(angle) : std::sin(angle));
                }
                EXPECT_NEAR(sums[j], wanted, 5e-5) << set.name << ", sum " << j << (half ? " of halves" : "");
            }
        }
    }
}

TEST_F(EverySet, LooksUpSeries) {
    std::vector<float> pairs;
    for (const Range &range : ranges) {
        pairs.insert(pairs.end(), {range.low, range.high});
    }
    for (const Series &series : {Series{FOURIER, 7, {}}, Series{FOURIER, 31, {}}, Series{COSINE, 15, {}}}) {
        const std::vector<float> c = coefficients(series), wanted = expected(series, c);
        for (const InstructionSet &set : instruction_sets()) {
            std::vector<float> found(depth.size() + 1, -1.0F);
            ray_kernels(set).look_up_series({c.data(), pairs.data(), static_cast<int>(series.count),
                                             series.name == COSINE, depth.data(), found.data(), RECEIVERS,
                                             RAYS * RECEIVERS});
            EXPECT_EQ(found.back(), -1.0F) << set.name;
            for (std::size_t i = 0; i < depth.size(); ++i) {
                EXPECT_NEAR(found[i], wanted[i], 1e-5) << set.name << ", " << series.count << " at " << depth[i];
            }
        }
    }
}

TEST_F(EverySet, LooksUpCosinesInEightBits) {
    const Series series{COSINE, 15, {}};
    std::vector<float> c = coefficients(series);
    std::vector<std::int32_t> texels(RAYS * RAY_WORDS);
    std::array<std::uint8_t, 20> texel{};
    for (std::size_t r = 0; r < RAYS; ++r) {
        const auto of_ray = std::span(c).subspan(r * 15, 15);
        pack(series, of_ray, ranges[r], texel);
        unpack(series, texel, of_ray);
        std::memcpy(texels.data() + r * RAY_WORDS, texel.data(), texel.size());
    }
    const std::vector<float> wanted = expected(series, c);
    for (const InstructionSet &set : instruction_sets()) {
        std::vector<float> found(depth.size());
        ray_kernels(set).look_up_texels(
            {texels.data(), false, depth.data(), found.data(), RECEIVERS, RAYS * RECEIVERS});
        for (std::size_t i = 0; i < depth.size(); ++i) {
            EXPECT_NEAR(found[i], wanted[i], 1e-5) << set.name << " at " << depth[i];
        }
    }
}

// The exact polygon of the bytes, knot by knot, in double.
double on_curve(std::span<const std::uint8_t> texel, double z) {
    const TexelHead head = read_head(texel);
    const double total = std::exp(-double{head.total});
    const double d = (z - double{head.range.low}) / std::max(double{head.range.high - head.range.low}, 1e-7);
    double depth_left = 1.0, share_left = 1.0;
    if (z < double{head.range.low} || z >= double{head.range.high}) {
        return z < double{head.range.low} ? 1.0 : total;
    }
    for (std::size_t k = 0; k <= CURVE_KNOTS; ++k) {
        const double next = k == CURVE_KNOTS ? 0.0 : depth_left * (1.0 - texel[HEAD_BYTES + k] / 255.0);
        const double less = k == CURVE_KNOTS ? 0.0 : share_left * (1.0 - texel[HEAD_BYTES + CURVE_KNOTS + k] / 255.0);
        if (1.0 - d >= next) {
            const double part = (1.0 - d - next) / std::max(depth_left - next, 1e-12);
            return total + (1.0 - total) * (less + (share_left - less) * std::clamp(part, 0.0, 1.0));
        }
        depth_left = next;
        share_left = less;
    }
    return total;
}

TEST_F(EverySet, LooksUpCurves) {
    std::vector<std::int32_t> texels(RAYS * RAY_WORDS);
    std::vector<double> wanted;
    std::array<std::uint8_t, CURVE_BYTES> texel{};
    for (std::size_t r = 0; r < RAYS; ++r) {
        rays[r].tau.resize(r); // from nothing on
        rays[r].depth.resize(r);
        fit_curve(exact_curve(rays[r].absorbers()), texel);
        std::memcpy(texels.data() + r * RAY_WORDS, texel.data(), texel.size());
        for (std::size_t i = 0; i < RECEIVERS; ++i) {
            wanted.push_back(on_curve(texel, double{depth[r * RECEIVERS + i]}));
        }
    }
    for (const InstructionSet &set : instruction_sets()) {
        std::vector<float> found(depth.size());
        ray_kernels(set).look_up_texels({texels.data(), true, depth.data(), found.data(), RECEIVERS, RAYS * RECEIVERS});
        for (std::size_t i = 0; i < depth.size(); ++i) {
            EXPECT_NEAR(found[i], wanted[i], 2e-5) << set.name << ", ray " << i / RECEIVERS << " at " << depth[i];
        }
    }
}

} // namespace
} // namespace sfumato
