// SPDX-License-Identifier: GPL-3.0-or-later
// .vdb files: what is read, and how files that cannot be are refused.
#include "media/grid.hpp"
#include "scene/volume_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

namespace sfumato {
namespace {

class Files : public testing::Test {
protected:
    void SetUp() override {
        openvdb::initialize();
        folder = std::filesystem::temp_directory_path() / ("volume_file_test_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    [[nodiscard]] std::string path(const std::string &name = "file.vdb") const { return (folder / name).string(); }
    [[nodiscard]] std::string write(const openvdb::GridPtrVec &grids) const {
        openvdb::io::File(path()).write(grids);
        return path();
    }
    [[nodiscard]] std::string write_bytes(const std::string &bytes) const {
        std::ofstream(path(), std::ios::binary) << bytes;
        return path();
    }
    static openvdb::FloatGrid::Ptr grid(const std::string &name = "density") {
        const auto out = openvdb::FloatGrid::create();
        out->setName(name);
        return out;
    }
    // A ball of noise, which takes several leaves.
    static openvdb::FloatGrid::Ptr ball() {
        const auto out = grid();
        std::mt19937 generator(1);
        for (int z = -10; z <= 10; ++z) {
            for (int y = -10; y <= 10; ++y) {
                for (int x = -10; x <= 10; ++x) {
                    if (x * x + y * y + z * z <= 100) {
                        out->tree().setValue({x, y, z}, 1.0F + float(generator() % 1000) / 1000.0F);
                    }
                }
            }
        }
        return out;
    }
    static std::string refusal(const std::string &path, const std::string &name = "density") {
        const std::string said = refusal_by(read_volume, path, name);
        EXPECT_EQ(refusal_by(read_volume_blocks, path, name), said);
        return said;
    }
    template <typename Read>
    static std::string refusal_by(const Read &read, const std::string &path, const std::string &name = "density") {
        try {
            read(path, name);
        } catch (const std::runtime_error &error) {
            EXPECT_NE(std::string(error.what()).find("'" + path + "' cannot be read: "), std::string::npos);
            return std::string(error.what()).substr(path.size() + std::string("'' cannot be read: ").size());
        }
        return "nothing was refused";
    }
    // That the blocks of a file hold what its dense array holds, and its header says where.
    static void expect_the_same(const std::string &file, bool in_bricks) {
        const VolumeFile dense = read_volume(file, "density");
        const VolumeBlocks blocks = read_volume_blocks(file, "density");
        const VolumeHeader header = read_volume_header(file, "density");
        for (const VolumeHeader &other : {static_cast<const VolumeHeader &>(blocks), header}) {
            EXPECT_EQ(other.resolution, dense.resolution);
            EXPECT_EQ(other.grid_to_object, dense.grid_to_object);
        }
        for (const float threshold : {0.0F, 0.3F}) {
            const auto expected = crop(dense.density, dense.resolution, threshold, Layout::DENSE);
            const auto found = crop(blocks.blocks, threshold);
            ASSERT_TRUE(expected && found);
            EXPECT_EQ(found->stored.empty(), !in_bricks);
            EXPECT_EQ(found->first, expected->first);
            EXPECT_EQ(found->resolution, expected->resolution);
            EXPECT_EQ(found->clearance, expected->clearance);
            EXPECT_NEAR(found->amount, expected->amount, 1e-6 * expected->amount);
            std::vector<float> cells(expected->density.size());
            copy_cells(*found, found->density, 1, cells);
            EXPECT_EQ(cells, expected->density);
        }
    }

    std::filesystem::path folder;
};

TEST_F(Files, AreReadWhereTheirVoxelsAre) {
    const auto some = grid();
    some->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    some->tree().setValue({3, -4, 5}, 1.0F);
    some->tree().setValue({4, -2, 5}, 2.0F);
    const VolumeFile volume = read_volume(write({some}), "density");
    EXPECT_EQ(volume.resolution, glm::ivec3(2, 3, 1));
    EXPECT_EQ(volume.density, (std::vector<float>{1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 2.0F}));
    const glm::dvec4 centre = volume.grid_to_object * glm::dvec4(0.5, 0.5, 0.5, 1.0);
    EXPECT_EQ(centre, glm::dvec4(1.5, -2.0, 2.5, 1.0));
    EXPECT_EQ(read_volume(write({grid()}), "density").resolution, glm::ivec3(0)); // no smoke yet
}

TEST_F(Files, AreReadInBlocksAsTheyAreReadDensely) {
    expect_the_same(write({ball()}), false);
    const auto trail = grid(); // far from the origin, below it, and half a leaf off
    trail->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    std::mt19937 generator(2);
    for (int i = 0; i < 150; ++i) {
        trail->tree().setValue({i - 3, 2 * i - 101, 7 - i}, 0.1F + float(generator() % 1000) / 1000.0F);
    }
    expect_the_same(write({trail}), true);
    trail->setSaveFloatAsHalf(true);
    expect_the_same(write({trail}), true);
    const auto stored_nowhere = trail->deepCopy(); // voxels that are off keep their values
    stored_nowhere->tree().setValueOff({20, -60, -20}, 0.7F);
    stored_nowhere->tree().setValueOff({-20, -120, 30}, 0.7F); // outside the box
    expect_the_same(write({stored_nowhere}), true);
    const auto tiles = trail->deepCopy(); // of 8^3, and of 128^3, which the box cuts
    tiles->tree().addTile(1, {40, -40, -40}, 0.5F, true);
    tiles->tree().addTile(1, {80, -40, -40}, 0.6F, false);
    expect_the_same(write({tiles}), true);
    tiles->tree().addTile(2, {0, 0, -128}, 0.4F, false);
    expect_the_same(write({tiles}), true);
    const auto foggy = openvdb::FloatGrid::create(0.5F); // all that is stored nowhere is smoke too
    foggy->setName("density");
    foggy->tree().setValue({0, 0, 0}, 1.0F);
    foggy->tree().setValue({9000, 3, 3}, 0.0F);
    expect_the_same(write({foggy}), false);
}

TEST_F(Files, WithoutSmokeHaveNoBlocks) {
    const std::string file = write({grid()});
    EXPECT_EQ(read_volume_header(file, "density").resolution, glm::ivec3(0));
    EXPECT_EQ(read_volume_blocks(file, "density").resolution, glm::ivec3(0));
    EXPECT_TRUE(read_volume_blocks(file, "density").blocks.empty());
}

TEST_F(Files, WithDensitiesThatCannotBeAreRefused) {
    const auto some = grid();
    some->tree().setValue({3, -4, 5}, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(refusal_by(read_volume_blocks, write({some})), "its grid 'density' holds -inf at voxel [3, -4, 5]");
    const auto tile = grid();
    tile->tree().addTile(1, {8, 16, 24}, 2e30F, true);
    EXPECT_NE(refusal_by(read_volume_blocks, write({tile})).find("at voxel [8, 16, 24], but a density is at most 1e30"),
              std::string::npos);
}

TEST_F(Files, ThatAreNoneAreNamed) {
    EXPECT_EQ(refusal(path("missing.vdb")), "there is no such file");
    EXPECT_EQ(refusal(folder.string()), "it is a directory");
    EXPECT_EQ(refusal(write_bytes("")), "it is empty");
    EXPECT_EQ(refusal(write_bytes("VDB")), "it is no OpenVDB file");
    EXPECT_EQ(refusal(write_bytes("Smoke simulates air.\n")), "it is no OpenVDB file");
    EXPECT_EQ(refusal(write_bytes(std::string(4096, '\xff'))), "it is no OpenVDB file");
}

TEST_F(Files, SayWhichGridsThereAre) {
    EXPECT_EQ(refusal(write({grid("flame"), grid("heat")})), "it has no grid 'density', but 'flame', 'heat'");
    EXPECT_EQ(refusal(write({grid("flame")}), ""), "it has no grid '', but 'flame'");
    EXPECT_EQ(refusal(write({})), "it has no grid 'density', but none at all");
}

TEST_F(Files, OfOtherTypesAreRefused) {
    const auto named = [](const openvdb::GridBase::Ptr &other) {
        other->setName("density");
        return other;
    };
    EXPECT_EQ(refusal(write({named(openvdb::Vec3SGrid::create())})), "its grid 'density' holds vec3s, not floats");
    EXPECT_EQ(refusal(write({named(openvdb::MaskGrid::create())})), "its grid 'density' holds mask, not floats");
    EXPECT_EQ(refusal(write({named(openvdb::Vec3IGrid::create())})), "its grid 'density' holds vec3i, not floats");
    const auto level_set = grid();
    level_set->setGridClass(openvdb::GRID_LEVEL_SET);
    EXPECT_EQ(refusal(write({level_set})), "its grid 'density' is a level set, a distance to a surface and no density");
    const auto frustum = grid();
    frustum->setTransform(openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {10, 10, 10}}, 0.5, 1.0, 0.1));
    EXPECT_EQ(refusal(write({frustum})),
              "its grid 'density' has a NonlinearFrustumMap, but only linear ones can be read");
}

TEST_F(Files, OfTooManyCellsAreRefusedBeforeMemoryIsAskedFor) {
    const auto wide = grid();
    wide->tree().setValue({0, 0, 0}, 1.0F);
    wide->tree().setValue({2047, 1023, 1023}, 1.0F);
    EXPECT_EQ(refusal(write({wide})),
              "its grid 'density' spans 2048 x 1024 x 1024 cells; at most 2^30 cells can be read");
    const auto widest = grid();
    widest->tree().setValue({-2000000000, 0, 0}, 1.0F);
    widest->tree().setValue({2000000000, 0, 7}, 1.0F);
    EXPECT_EQ(refusal(write({widest})),
              "its grid 'density' spans 4000000001 x 1 x 8 cells; at most 2^30 cells can be read");
    const auto tile = grid();
    tile->tree().addTile(2, {0, 0, 0}, 1.0F, true);
    tile->tree().addTile(2, {65536, 0, 0}, 1.0F, true);
    EXPECT_NE(refusal(write({tile})).find("cells; at most 2^30"), std::string::npos);
}

TEST_F(Files, WithVoxelsThatAreNoNumbersAreRefused) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const auto some = grid();
        some->tree().setValue({3, -4, 5}, 1.0F);
        some->tree().setValue({4, -4, 6}, bad);
        EXPECT_EQ(refusal(write({some})), "its grid 'density' holds " + std::to_string(bad) + " at voxel [4, -4, 6]");
    }
}

std::string bytes_of(const std::string &path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Wherever it ends: in the header, in the description of a grid, in the middle of the tree.
TEST_F(Files, CutShortAreRefused) {
    const std::string whole = bytes_of(write({ball()}));
    ASSERT_GT(whole.size(), 2000U);
    ASSERT_EQ(read_volume(path(), "density").resolution, glm::ivec3(21));
    for (std::size_t size = 0; size < whole.size(); size += size < 400 ? 3 : 1999) {
        const std::string said = refusal(write_bytes(whole.substr(0, size)));
        EXPECT_TRUE(said.find("cut short") != std::string::npos || size < 8) << size << ": " << said;
    }
    EXPECT_EQ(refusal(write_bytes(whole.substr(0, 20))), "its header is cut short");
    const auto shorter = std::to_string(whole.size() - 1), all = std::to_string(whole.size());
    EXPECT_EQ(refusal(write_bytes(whole.substr(0, whole.size() - 1))),
              "it is cut short, " + shorter + " bytes of at least " + all);
}

// Refusals by the hundred take no memory with them. Resident pages, from the kernel.
TEST_F(Files, LeakNothing) {
    const auto pages = [] {
        std::ifstream stream("/proc/self/statm");
        long total = 0, resident = 0;
        stream >> total >> resident;
        return resident;
    };
    const auto bad = ball();
    bad->tree().setValue({0, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    const std::string file = write({bad});
    const auto again = [&] { EXPECT_NE(refusal(file), "nothing was refused"); };
    for (int i = 0; i < 20; ++i) {
        again();
    }
    const long before = pages();
    for (int i = 0; i < 200; ++i) { // 21^3 floats each: 7 MB, were they kept
        again();
    }
    EXPECT_LT(pages() - before, 500); // 2 MB
}

} // namespace
} // namespace sfumato
