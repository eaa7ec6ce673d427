// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as Blender writes them: whole ones, and what a killed task leaves.
#include "scene/picture_file.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace sfumato {
namespace {

constexpr int EDGE = 64;

class Pictures : public testing::Test {
protected:
    void SetUp() override {
        folder = std::filesystem::temp_directory_path() / ("picture_file_test_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    [[nodiscard]] std::string path(const std::string &name) const { return (folder / name).string(); }

    // Noise, so that no format makes it short, in `parts` parts.
    [[nodiscard]] std::string write(const std::string &name, OIIO::ImageSpec spec, int parts = 1) const {
        std::mt19937 generator(1);
        std::vector<float> pixels(std::size_t(EDGE) * EDGE * std::size_t(spec.nchannels));
        for (float &value : pixels) {
            value = float(generator() % 1000) / 1000.0F;
        }
        const auto out = OIIO::ImageOutput::create(path(name));
        EXPECT_TRUE(out) << OIIO::geterror();
        std::vector<OIIO::ImageSpec> specs;
        for (int part = 0; part < parts; ++part) {
            spec["oiio:subimagename"] = "part " + std::to_string(part);
            specs.push_back(spec);
        }
        EXPECT_TRUE(parts == 1 ? out->open(path(name), spec) : out->open(path(name), parts, specs.data()));
        for (int part = 0; part < parts; ++part) {
            if (part > 0) {
                EXPECT_TRUE(out->open(path(name), specs[std::size_t(part)], OIIO::ImageOutput::AppendSubimage));
            }
            EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << out->geterror();
        }
        EXPECT_TRUE(out->close());
        return path(name);
    }

    // The first `share` of a file, under another name.
    [[nodiscard]] std::string cut(const std::string &file, double share) const {
        const std::string out = path("cut" + std::filesystem::path(file).extension().string());
        std::filesystem::copy_file(file, out, std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(out, std::uintmax_t(share * double(std::filesystem::file_size(file))));
        return out;
    }

    // g++ 12 warns at "'" + text (GCC bug 105651).
    static std::string start_of_reason(const std::string &file) {
        return std::string("'").append(file).append("' cannot be read whole: ");
    }

    // Whole it can be read, and no part of it.
    void judge(const std::string &file, double longest = 0.99) const {
        SCOPED_TRACE(file);
        EXPECT_EQ(unreadable(file), std::nullopt);
        for (const double share : {0.001, 0.01, 0.1, 0.5, longest}) {
            const std::string part = cut(file, share);
            const auto why = unreadable(part);
            ASSERT_TRUE(why) << share;
            EXPECT_TRUE(why->starts_with(start_of_reason(part))) << *why;
            EXPECT_EQ(why->find('\n'), std::string::npos) << *why;
        }
    }

    std::filesystem::path folder;
};

OIIO::ImageSpec spec(OIIO::TypeDesc::BASETYPE type, int channels = 4) {
    return {EDGE, EDGE, channels, OIIO::TypeDesc(type)};
}

TEST_F(Pictures, OfEachKindOfExr) {
    for (const std::string codec : {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        for (const auto type : {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT}) {
            auto kind = spec(type);
            kind["compression"] = codec;
            judge(write(codec + ".exr", kind));
        }
    }
    auto tiled = spec(OIIO::TypeDesc::HALF);
    tiled.tile_width = tiled.tile_height = 16;
    judge(write("tiled.exr", tiled));
    judge(write("parts.exr", spec(OIIO::TypeDesc::HALF), 3));
}

TEST_F(Pictures, OfPngTiffJpegAndHdr) {
    judge(write("bytes.png", spec(OIIO::TypeDesc::UINT8)));
    judge(write("words.png", spec(OIIO::TypeDesc::UINT16, 3)));
    for (const std::string codec : {"none", "zip", "lzw", "packbits"}) { // deflate is Blender's own
        auto kind = spec(OIIO::TypeDesc::UINT16);
        kind["compression"] = codec;
        judge(write("codec_" + codec + ".tif", kind));
    }
    judge(write("picture.jpg", spec(OIIO::TypeDesc::UINT8, 3)));
    judge(write("picture.hdr", spec(OIIO::TypeDesc::FLOAT, 3)));
}

TEST_F(Pictures, OfWebpTargaBmpIrisAndDpx) {
    judge(write("picture.webp", spec(OIIO::TypeDesc::UINT8)));
    judge(write("picture.tga", spec(OIIO::TypeDesc::UINT8)), 0.9); // ends with half a kilobyte about the picture
    judge(write("picture.bmp", spec(OIIO::TypeDesc::UINT8, 3)));
    judge(write("picture.rgb", spec(OIIO::TypeDesc::UINT8, 3)));
    judge(write("picture.dpx", spec(OIIO::TypeDesc::UINT16, 3)));
}

// A frame is larger than a band of rows, and need not be a multiple of it.
TEST_F(Pictures, OfMoreThanOneBand) {
    OIIO::ImageSpec large(4096, 1031, 4, OIIO::TypeDesc::FLOAT);
    large["compression"] = "none";
    const auto out = OIIO::ImageOutput::create("exr");
    const std::string file = path("large.exr");
    ASSERT_TRUE(out->open(file, large));
    ASSERT_TRUE(
        out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(std::size_t(4096) * 1031 * 4, 0.25F).data()));
    ASSERT_TRUE(out->close());
    EXPECT_EQ(unreadable(file), std::nullopt);
    EXPECT_TRUE(unreadable(cut(file, 0.999)));
}

TEST_F(Pictures, WhatIsNoneIsNamed) {
    const auto says = [&](const std::string &name, const std::string &why) {
        const std::string file = path(name), said = unreadable(file).value_or("nothing");
        EXPECT_TRUE(said.starts_with(start_of_reason(file) + why)) << said;
    };
    says("none.exr", "there is no such file");
    says("", "it is a directory");
    std::ofstream(path("empty.png")).flush();
    says("empty.png", "it is empty");
    for (const std::string name : {"text.png", "text.exr", "text.jpg", "text.tif", "text.EXR"}) {
        std::ofstream(path(name)) << "Smoke simulates air, and air simulates nothing.";
        says(name, "");
    }
}

// A movie, say. Nothing is known of it, so it is no broken frame.
TEST_F(Pictures, OtherFilesAreLeftAlone) {
    std::ofstream(path("words.txt")) << "Air simulates nothing.";
    EXPECT_EQ(unreadable(path("words.txt")), std::nullopt);
}

} // namespace
} // namespace sfumato
