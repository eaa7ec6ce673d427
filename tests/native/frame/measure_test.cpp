// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/measure.hpp"
#include "frame/measured_pixels.hpp"
#include "support/pictures.hpp"

#include <cmath>

namespace sfumato {
namespace {

Measured measured(const Scene &scene, const std::vector<float> &picture, const InstructionSet &with = instruction_set(),
                  std::uint64_t seed = 3) {
    return Frame(scene, {}, with).measure(camera, WIDTH, HEIGHT, picture, {}, 192, seed);
}

TEST(Measure, IsTheSameOnAllInstructionSets) {
    const Scene scene = smoke_over_floor_and_block();
    const std::vector<float> picture = render(scene, {7, 1.0, 0.5}, 16);
    const Measured expected = measured(scene, picture);
    for (const InstructionSet &with : instruction_sets()) {
        const Measured found = measured(scene, picture, with);
        EXPECT_NEAR(found.reported, expected.reported, 1e-5) << with.name;
        EXPECT_NEAR(found.high, expected.high, 1e-5) << with.name;
        EXPECT_EQ(found.pixels, expected.pixels);
    }
}

TEST(Measure, LooksAtSamplesOfItsSeedAlone) {
    const Scene scene = smoke_over_floor_and_block();
    const std::vector<float> picture = render(scene, {7, 1.0, 0.5}, 16);
    EXPECT_EQ(measured(scene, picture).reported, measured(scene, picture).reported);
    EXPECT_NE(measured(scene, picture, instruction_set(), 4).reported, measured(scene, picture).reported);
}

// Each class by its pixels: the sum of all is the picture.
TEST(Measure, ChoosesPixelsOfEveryClass) {
    std::vector<float> picture(std::size_t{4} * 64 * 48, 0.5F);
    for (std::size_t i = 4 * 64 * 24; i < picture.size(); ++i) {
        picture[i] = 2.0F; // an edge
    }
    std::size_t all = 0, chosen = 0, at_edges = 0, edges = 0;
    for (const PixelClass &own : measured_pixels(picture, 64, 48, 100, 1)) {
        all += own.count;
        chosen += own.chosen.size();
        at_edges += own.edges ? own.chosen.size() : 0;
        edges += own.edges ? own.count : 0;
        for (const std::size_t pixel : own.chosen) {
            EXPECT_LT(pixel, std::size_t{64} * 48);
            EXPECT_EQ(own.edges, pixel / 64 == 23 || pixel / 64 == 24);
        }
    }
    EXPECT_EQ(all, std::size_t{64} * 48);
    EXPECT_EQ(edges, std::size_t{2} * 64);
    EXPECT_GE(chosen, 100U);
    EXPECT_LE(chosen, 140U);
    EXPECT_GT(at_edges, 20U); // of a twenty-fourth of the picture
}

// A class of its own is not away from its mean: the interval is narrow, and holds what is known.
TEST(Measure, FindsAKnownError) {
    Scene scene = smoke_over_floor();
    scene.media.clear();
    scene.meshes.clear();
    std::vector<float> picture = render(scene);
    for (std::size_t i = 0; i < picture.size(); ++i) {
        picture[i] *= i % 4 == 0 ? 1.1F : 1.0F; // red
    }
    const glm::dvec3 sky(scene.background);
    const double expected = 0.1 * sky.x / std::sqrt(3.0) / ((1.1 * sky.x + sky.y + sky.z) / 3.0);
    const Measured found = measured(scene, picture);
    EXPECT_NEAR(found.reported, expected, 1e-5);
    EXPECT_LE(found.low, expected + 1e-6);
    EXPECT_GE(found.high, expected - 1e-6);
}

// With all its pixels it is the difference that the judge finds.
TEST(Measure, AgreesWithTheJudge) {
    // Without edges of solids, which the judge looks at through pixels' centres alone.
    const Scene scene = smoke_over_floor();
    const Camera above = reference::testing::camera_at({0.5F, -1.0F, 4.5F}, {0.0F, 0.0F, 0.0F}, 16.0F / 9.0F);
    const std::vector<glm::dvec4> expected = exact(scene, above);
    const FrameSettings coarse{3, 0.25, 0.3};
    const std::vector<float> picture = render(scene, coarse, 1, above);
    double squares = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        if (i % 4 < 3) {
            squares += std::pow(double{picture[i]} - expected[i / 4][int(i % 4)], 2);
            sum += expected[i / 4][int(i % 4)];
        }
    }
    const double count = 3.0 * WIDTH * HEIGHT, truth = std::sqrt(squares / count) / (sum / count);
    // A filter that is hardly wider than nothing: what is seen through centres.
    const Filter centre{Filter::Shape::BLACKMAN_HARRIS, 0.02F};
    const Measured found = Frame(scene, coarse).measure(above, WIDTH, HEIGHT, picture, centre, WIDTH * HEIGHT, 1);
    EXPECT_NEAR(found.reported / truth, 1.0, 0.1);
    EXPECT_LE(found.low, truth);
    EXPECT_GE(found.high, truth);
}

} // namespace
} // namespace sfumato
