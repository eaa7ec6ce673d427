// SPDX-License-Identifier: GPL-3.0-or-later
// Which stages run, and what a tile of samples goes through.
#include "frame/frame.hpp"
#include "frame/stages.hpp"
#include "support/pictures.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

std::vector<std::string> names(const Frame &frame) {
    std::vector<std::string> out;
    for (const StageClock::Row &row : frame.stages()) {
        EXPECT_GT(row.seconds, 0.0) << row.name;
        out.emplace_back(row.name);
    }
    return out;
}

TEST(Stages, OnlyThoseRunThatTheSceneNeeds) {
    const std::vector<std::string> pixels = {"surfaces", "march", "composite"};
    Scene scene = smoke_over_floor();
    const Frame whole(scene, {});
    EXPECT_EQ(names(whole), (std::vector<std::string>{"solids", "smoke", "lights", "light maps", "light volumes"}));
    (void)whole.surfaces(camera, 4, 4, Layer::RADIANCE, 1, {});
    EXPECT_EQ(names(whole).size(), 7U) << "the surfaces alone need no march";
    (void)whole.render(camera, 4, 4, 1, {});
    EXPECT_EQ(names(whole).size(), 8U);

    Scene unlit = scene;
    unlit.lights.clear();
    const Frame dark(unlit, {});
    EXPECT_EQ(names(dark), (std::vector<std::string>{"solids", "smoke"}));

    scene.media.clear();
    const Frame clear(scene, {});
    (void)clear.render(camera, 4, 4, 1, {});
    EXPECT_EQ(names(clear), (std::vector<std::string>{"solids", "lights", "surfaces", "composite"}));
}

// Of any number of samples, whether it fills packets and tiles or not.
TEST(Tracer, FollowsEachSampleOnceAndKeepsItsPlace) {
    const FrameView empty{}; // every ray reaches the background
    StageClock clock;
    for (const InstructionSet &with : instruction_sets()) {
        const Tracer tracer{with, empty, Layer::RADIANCE, clock};
        const auto lanes = static_cast<std::size_t>(with.lanes);
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, lanes, 16 * lanes - 1, 33 * lanes + 1}) {
            std::vector<int> filled(count), taken(count);
            const auto fill = [&](Packet &packet, std::size_t lane, std::size_t number) {
                ASSERT_LT(number, count);
                ASSERT_EQ(packet.shadows.size(), 3U);
                ++filled[number];
                packet.u[lane] = packet.v[lane] = packet.light_u[lane] = packet.light_v[lane] = 0.5F;
            };
            const auto take = [&](const Layers &layers, std::size_t lane, std::size_t number) {
                EXPECT_EQ(layers.hit[lane], 0.0F);
                ++taken[number];
            };
            tracer.trace(count, fill, take, 3);
            for (std::size_t i = 0; i < count; ++i) {
                EXPECT_EQ(taken[i], 1);
                EXPECT_TRUE(filled[i] == 1 || i + 1 == count) << "lanes to spare follow the last";
            }
        }
    }
}

} // namespace
} // namespace sfumato
