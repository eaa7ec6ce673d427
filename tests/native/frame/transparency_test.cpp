// SPDX-License-Identifier: GPL-3.0-or-later
// Transparent fragments without sorting, whatever they are.
#include "frame/transparency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr std::array<float, 10> OPACITIES{0.0F, 1e-30F, 1e-9F, 1e-7F, 1e-4F, 0.3F, 0.9F, 0.9999F, 0.99999994F, 1.0F};
constexpr std::array<float, 8> DEPTHS{0.0F, 1e-30F, 1e-8F, 0.5F, 0.50000006F, 0.999F, 0.99999994F, 1.0F};

// One pixel after another, from nothing to fourteen fragments; every second value is one of those above.
class Pixels {
public:
    PixelFragments next() {
        const std::size_t count = generator() % (generator() % 4 == 0 ? 15U : 4U);
        for (std::size_t i = 0; i < count; ++i) {
            alphas[i] = value(OPACITIES);
            depths[i] = value(DEPTHS);
            colours[i] = {uniform(), uniform(), 1.0F};
        }
        return {std::span(depths).first(count), std::span(alphas).first(count), std::span(colours).first(count)};
    }

private:
    float uniform() { return static_cast<float>(generator() >> 8U) / 16777216.0F; }
    template <std::size_t N>
    float value(const std::array<float, N> &chosen) {
        return generator() % 2 == 0 ? chosen[generator() % N] : uniform();
    }
    std::minstd_rand engine{7};
    unsigned generator() { return (static_cast<unsigned>(engine()) << 9U) ^ static_cast<unsigned>(engine()); }
    std::array<float, 15> alphas{}, depths{};
    std::array<glm::vec3, 15> colours{};
};

// Finite, no more opaque than 1, and no brighter than the brightest fragment.
::testing::AssertionResult is_sound(const glm::vec4 &made) {
    const float brightest = std::max({made.x, made.y, made.z});
    const float least = std::min({made.x, made.y, made.z, made.w});
    if (std::isfinite(made.x + made.y + made.z + made.w) && least >= 0.0F && made.w <= 1.0F &&
        brightest <= made.w * 1.0001F + 1e-6F) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << made.x << " " << made.y << " " << made.z << " " << made.w;
}

TEST(Transparency, IsSoundInTenMillionPixels) {
    Pixels pixels;
    for (int pixel = 0; pixel < 10'000'000; ++pixel) {
        const glm::vec4 made = composite_nearest(pixels.next(), 4, 1);
        ASSERT_TRUE(is_sound(made)) << "pixel " << pixel;
    }
}

TEST(Transparency, IsSoundByAnyMethod) {
    Pixels pixels;
    for (int pixel = 0; pixel < 300'000; ++pixel) {
        const PixelFragments fragments = pixels.next();
        ASSERT_TRUE(is_sound(composite_nearest(fragments, 0, 3))) << "series alone, pixel " << pixel;
        ASSERT_TRUE(is_sound(composite_nearest(fragments, 8, 0))) << "eight nearest, pixel " << pixel;
        ASSERT_TRUE(is_sound(composite_fourier(fragments, 4, 1.0F))) << "as published, pixel " << pixel;
        ASSERT_TRUE(is_sound(composite_weighted(fragments))) << "weighted, pixel " << pixel;
    }
}

// A blue fragment shines through others as they let it through, and opaque ones hide it.
TEST(Transparency, HidesWhatIsBehindSomethingOpaque) {
    constexpr float quarter = 128.0F * 128.0F / 65025.0F; // an opacity that is stored exactly
    const std::array<float, 3> depth{0.2F, 0.6F, 0.4F};
    const std::array<glm::vec3, 3> colour{glm::vec3{1, 0, 0}, glm::vec3{0, 0, 1}, glm::vec3{0, 1, 0}};
    const std::array<float, 3> clear{quarter, 1.0F, quarter}, opaque{quarter, 1.0F, 1.0F};
    EXPECT_NEAR(composite_nearest({depth, clear, colour}, 4, 1).z, (1.0F - quarter) * (1.0F - quarter), 2e-5F);
    const glm::vec4 hidden = composite_nearest({depth, opaque, colour}, 4, 1);
    EXPECT_NEAR(hidden.z, 0.0F, 2e-5F);
    EXPECT_NEAR(hidden.y, 1.0F - quarter, 2e-5F);
}

} // namespace
} // namespace sfumato
