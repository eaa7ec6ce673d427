// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures at a glance, against those of which every pixel is traced.
#include "support/pictures.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr int ACROSS = 160, UP = 90;
constexpr float STRENGTH = 0.8F;

// Root mean square difference, over the mean.
double apart(const std::vector<float> &a, const std::vector<float> &b) {
    EXPECT_EQ(a.size(), b.size());
    double sum = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += std::pow(double{a[i]} - double{b[i]}, 2);
        mean += double{b[i]};
    }
    return std::sqrt(sum * static_cast<double>(a.size())) / mean;
}

TEST(Glance, OfNothingIsTheBackgroundWhateverTheSize) {
    Scene scene;
    scene.background = {0.25F, 0.5F, 1.0F};
    const Frame frame(scene, {});
    for (const auto &[width, height] : std::vector<std::pair<int, int>>{{1, 1}, {1, 7}, {6, 1}, {33, 18}}) {
        for (const int spacing : {1, 2, 3, 4, 64}) {
            const std::vector<float> picture = frame.glance(camera, width, height, PICTURE, spacing);
            ASSERT_EQ(picture.size(), static_cast<std::size_t>(4 * width * height));
            for (std::size_t i = 0; i < picture.size(); i += 4) {
                EXPECT_NEAR(picture[i], 0.25F, 1e-6F) << width << " x " << height << ", spacing " << spacing;
                EXPECT_NEAR(picture[i + 2], 1.0F, 1e-6F);
                EXPECT_EQ(picture[i + 3], 0.0F);
            }
        }
    }
}

TEST(Glance, IsCloseToAPictureOfWhichEveryPixelIsTraced) {
    const Frame frame(smoke_over_floor_and_block(), finest);
    const std::vector<float> fine = frame.render(camera, ACROSS, UP, 32, {}).value();
    const double once = apart(frame.render(camera, ACROSS, UP, 1, {}).value(), fine);
    for (const int spacing : {1, 2, 3, 4}) {
        const double glanced = apart(frame.glance(camera, ACROSS, UP, PICTURE, spacing), fine);
        EXPECT_LT(glanced, once) << "at edges it is softer than one sample a pixel, spacing " << spacing;
    }
}

// What is traced is exact: the distances of a plane bend so little that hardly any is.
TEST(Glance, InterpolatesDistances) {
    const Frame frame(smoke_over_floor(), finest);
    const std::vector<float> full = frame.surfaces(camera, ACROSS, UP, Layer::RADIANCE, 1, {}).value();
    const std::vector<float> few = frame.glance(camera, ACROSS, UP, Layer::RADIANCE, 4);
    std::size_t same = 0;
    for (std::size_t i = 3; i < full.size(); i += 4) {
        EXPECT_NEAR(few[i], full[i], 0.01F * full[i]);
        same += few[i] == full[i] ? 1 : 0;
    }
    EXPECT_GT(same, full.size() / 4 / 20);
    EXPECT_LT(same, full.size() / 4 / 2);
}

// Lit by the sun alone, a surface loses the share of its light that shadows take; over that lies the smoke.
TEST(Glance, OfAnOverlayIsThePictureTakenApart) {
    Scene scene = smoke_over_floor();
    const Frame frame(scene, finest);
    const std::vector<float> picture = frame.glance(camera, ACROSS, UP, PICTURE, 1);
    const std::vector<float> both =
        frame.glance(camera, ACROSS, UP, LayerSet(Layer::ALL_SHADOWS).with(Layer::SMOKE), 1, STRENGTH);
    ASSERT_EQ(both.size(), 2 * picture.size());
    const auto is_sky = [&](int x, int y) {
        return both[picture.size() + 4 * static_cast<std::size_t>(y * ACROSS + x) + 3] == 0.0F;
    };
    std::size_t sky = 0;
    for (int y = 1; y < UP - 1; ++y) {
        for (int x = 1; x < ACROSS - 1; ++x) {
            // Edges are softened each in its own image.
            if (!is_sky(x, y) || !is_sky(x - 1, y) || !is_sky(x + 1, y) || !is_sky(x, y - 1) || !is_sky(x, y + 1)) {
                continue;
            }
            ++sky;
            const std::size_t i = 4 * static_cast<std::size_t>(y * ACROSS + x), behind = picture.size() + i;
            for (std::size_t c = 0; c < 3; ++c) {
                const float through = both[behind + c] * scene.background[static_cast<int>(c)];
                EXPECT_NEAR(both[i + c] + through, picture[i + c], 1e-5F);
            }
        }
    }
    EXPECT_GT(sky, picture.size() / 80);
    EXPECT_LT(sky, picture.size() / 5);
}

} // namespace
} // namespace sfumato
