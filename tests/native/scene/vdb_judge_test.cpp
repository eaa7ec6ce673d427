// SPDX-License-Identifier: GPL-3.0-or-later
// What is read of .vdb files, bit for bit against OpenVDB, which wrote them.
#include "scene/volume_file.hpp"
#include "support/vdb_grids.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>

namespace sfumato {
namespace {

using namespace vdb_testing;

bool same_bits(const std::vector<float> &a, const std::vector<float> &b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// Voxel by voxel, by the library's own accessor.
template <typename Grid>
VolumeFile judged(const openvdb::GridBase &base) {
    const auto &grid = dynamic_cast<const Grid &>(base);
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    VolumeFile volume;
    if (box.empty()) {
        return volume;
    }
    volume.resolution = {box.dim().x(), box.dim().y(), box.dim().z()};
    const auto matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            volume.grid_to_object[row][column] = matrix(row, column);
        }
    }
    const auto first = box.min().asVec3d() - openvdb::Vec3d(0.5);
    volume.grid_to_object[3] = volume.grid_to_object * glm::dvec4(first.x(), first.y(), first.z(), 1.0);
    auto cells = grid.getConstAccessor();
    for (int z = box.min().z(); z <= box.max().z(); ++z) {
        for (int y = box.min().y(); y <= box.max().y(); ++y) {
            for (int x = box.min().x(); x <= box.max().x(); ++x) {
                volume.density.push_back(static_cast<float>(cells.getValue({x, y, z})));
            }
        }
    }
    return volume;
}

VolumeFile judged(const std::string &path, const std::string &name) {
    openvdb::io::File file(path);
    file.open(false);
    const auto grid = file.readGrid(name);
    const std::string type = grid->valueType();
    return type == "float"    ? judged<openvdb::FloatGrid>(*grid)
           : type == "double" ? judged<openvdb::DoubleGrid>(*grid)
           : type == "int32"  ? judged<openvdb::Int32Grid>(*grid)
           : type == "int64"  ? judged<openvdb::Int64Grid>(*grid)
                              : judged<openvdb::BoolGrid>(*grid);
}

std::vector<float> filled(const VolumeBlocks &volume) {
    const glm::ivec3 n = volume.resolution;
    std::vector<float> cells(static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) *
                             static_cast<std::size_t>(n.z));
    for (const CellBlock &block : volume.blocks) {
        for (int z = 0; z < block.size.z; ++z) {
            for (int y = 0; y < block.size.y; ++y) {
                for (int x = 0; x < block.size.x; ++x) {
                    const glm::ivec3 at = block.first + glm::ivec3(x, y, z);
                    auto &cell = cells.at(static_cast<std::size_t>(at.x + n.x * (at.y + n.y * at.z)));
                    EXPECT_EQ(cell, 0.0F); // no cell is in two blocks
                    cell = block.values[x * block.strides.x + y * block.strides.y + z * block.strides.z];
                }
            }
        }
    }
    return cells;
}

std::string refusal(const std::string &path, const std::string &name = "density") {
    std::string said;
    for (int reader = 0; reader < 3; ++reader) {
        try {
            reader == 0   ? void(read_volume(path, name))
            : reader == 1 ? void(read_volume_header(path, name))
                          : void(read_volume_blocks(path, name));
            return "nothing was refused";
        } catch (const std::runtime_error &error) {
            const std::string start = "'" + path + "' cannot be read: ";
            EXPECT_EQ(std::string(error.what()).find(start), 0U);
            EXPECT_TRUE(said.empty() || said == error.what()) << said << "; " << error.what();
            said = error.what();
        }
    }
    return said.substr(path.size() + std::string("'' cannot be read: ").size());
}

class Judged : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    // The blocks hold what the dense array holds.
    void expect_the_same(const std::string &path, const std::string &name = "density") {
        const VolumeFile expected = judged(path, name), found = read_volume(path, name);
        const VolumeHeader header = read_volume_header(path, name);
        for (const VolumeHeader &one : {static_cast<const VolumeHeader &>(found), header}) {
            EXPECT_EQ(one.resolution, expected.resolution);
            EXPECT_EQ(one.grid_to_object, expected.grid_to_object);
        }
        ASSERT_TRUE(same_bits(found.density, expected.density));
        voxels += found.density.size();
        const VolumeBlocks blocks = read_volume_blocks(path, name);
        EXPECT_EQ(blocks.resolution, expected.resolution);
        EXPECT_EQ(blocks.grid_to_object, expected.grid_to_object);
        EXPECT_TRUE(same_bits(filled(blocks), expected.density));
    }

    template <typename Grid>
    void expect_all_the_same(const std::vector<typename Grid::ValueType> &backgrounds) {
        for (const auto background : backgrounds) {
            for (const bool half : {false, true}) {
                const auto grid = varied_grid<Grid>(background);
                grid->setSaveFloatAsHalf(half);
                for (const std::uint32_t compression : COMPRESSIONS) {
                    SCOPED_TRACE(std::to_string(background) + (half ? " as half, " : ", ") +
                                 openvdb::io::compressionToString(compression));
                    write(folder.path(), {grid}, compression);
                    expect_the_same(folder.path());
                }
            }
        }
    }

    Folder folder{"vdb_judge_test"};
    std::size_t voxels = 0;
};

TEST_F(Judged, FloatsAreReadBitForBit) {
    expect_all_the_same<openvdb::FloatGrid>({0.0F, 0.25F, -2.0F, 1e-7F});
    EXPECT_GT(voxels, 1000000U);
}

TEST_F(Judged, OtherScalarsAreReadBitForBit) {
    expect_all_the_same<openvdb::DoubleGrid>({0.0, 0.1});
    expect_all_the_same<openvdb::Int32Grid>({0, 3});
    expect_all_the_same<openvdb::Int64Grid>({0, -2});
    expect_all_the_same<openvdb::BoolGrid>({false, true});
}

// Half floats that are denormal, the largest, and below 0.
TEST_F(Judged, EveryHalfIsRead) {
    const auto grid = openvdb::FloatGrid::create();
    grid->setName("density");
    for (unsigned bits = 0; bits < 0x10000; ++bits) {
        openvdb::math::half half;
        half.setBits(static_cast<unsigned short>(bits));
        if (std::isfinite(static_cast<float>(half))) {
            grid->tree().setValueOn({int(bits % 64), int(bits / 64 % 32), int(bits / 2048)}, half);
        }
    }
    grid->setSaveFloatAsHalf(true);
    write(folder.path(), {grid});
    expect_the_same(folder.path());
    EXPECT_EQ(voxels, 65536U);
}

TEST_F(Judged, MapsPlaceVoxelsWhereTheyAre) {
    using namespace openvdb::math;
    Mat4d turned = rotation<Mat4d>(Vec3d(1.0, 2.0, 3.0).unit(), 0.7), sheared = turned;
    sheared.postScale(Vec3d(0.5, 2.0, 0.1));
    sheared.postTranslate(Vec3d(3.0, -2.0, 1.5));
    const Vec3d uneven(0.1, 0.7, -3.0), even(0.3), there(5.5, -1.0 / 3.0, 1e6);
    for (const MapBase::Ptr &map : std::vector<MapBase::Ptr>{
             std::make_shared<ScaleMap>(uneven), std::make_shared<UniformScaleMap>(0.3),
             std::make_shared<TranslationMap>(there), std::make_shared<ScaleTranslateMap>(uneven, there),
             std::make_shared<UniformScaleTranslateMap>(0.3, there), std::make_shared<UnitaryMap>(turned),
             std::make_shared<AffineMap>(sheared)}) {
        SCOPED_TRACE(map->type());
        const auto grid = varied_grid<openvdb::FloatGrid>(0.0F);
        grid->setTransform(std::make_shared<Transform>(map));
        write(folder.path(), {grid});
        expect_the_same(folder.path());
    }
}

TEST_F(Judged, BoxesAreFoundWithoutStatistics) {
    const auto grid = varied_grid<openvdb::FloatGrid>(0.0F);
    write(folder.path(), {grid}, BLOSC | ACTIVE, false);
    expect_the_same(folder.path());
    for (int i = 0; i < 3; ++i) { // single voxels at each end of a leaf
        for (const int at : {-1, 0, 7, 8, 4095}) {
            const auto one = openvdb::FloatGrid::create();
            one->setName("density");
            openvdb::Coord voxel(3, 3, 3);
            voxel[i] = at;
            one->tree().setValueOn(voxel, 2.0F);
            one->tree().setValueOn({4, 2, 5}, 3.0F);
            write(folder.path(), {one}, NO_COMPRESSION, false);
            expect_the_same(folder.path());
        }
    }
    const auto nothing = openvdb::FloatGrid::create(0.5F);
    nothing->setName("density");
    nothing->tree().setValueOff({0, 0, 0}, 2.0F);
    write(folder.path(), {nothing}, BLOSC, false);
    expect_the_same(folder.path());
    EXPECT_TRUE(read_volume_blocks(folder.path(), "density").blocks.empty());
}

TEST_F(Judged, InstancesShareVoxels) {
    const auto first = varied_grid<openvdb::FloatGrid>(0.0F);
    first->setName("first");
    const auto second = openvdb::gridPtrCast<openvdb::FloatGrid>(first->copyGrid());
    second->setName("density");
    second->setTransform(openvdb::math::Transform::createLinearTransform(3.0));
    for (const bool streamed : {false, true}) {
        streamed ? write_streamed(folder.path(), {first, second}) : write(folder.path(), {first, second});
        const std::size_t both = bytes_of(folder.path()).size();
        write(folder.path("one.vdb"), {first});
        EXPECT_LT(both, bytes_of(folder.path("one.vdb")).size() + 1000); // the tree is there once
        expect_the_same(folder.path(), "first");
        expect_the_same(folder.path(), "density");
    }
    std::string bytes = bytes_of(folder.path());
    bytes.replace(bytes.rfind("first"), 5, "third");
    write_bytes(folder.path(), bytes);
    EXPECT_EQ(refusal(folder.path()).find("its grid 'density' shares the voxels of a grid 'third', which is not there"),
              0U);
}

TEST_F(Judged, OneOfManyGridsIsChosenByName) {
    const auto named = [](const std::string &name, float value) {
        const auto grid = openvdb::FloatGrid::create();
        grid->setName(name);
        grid->tree().setValueOn({1, 2, 3}, value);
        return grid;
    };
    const openvdb::GridPtrVec grids{named("heat", 1.0F),    named("density", 2.0F), named("density", 3.0F),
                                    named("", 4.0F),        named("density", 5.0F), named("", 6.0F),
                                    named("fuel[1]", 7.0F), named("dens", 8.0F)};
    for (const bool streamed : {false, true}) {
        streamed ? write_streamed(folder.path(), grids) : write(folder.path(), grids);
        for (const char *name : {"heat", "density[0]", "density[1]", "density[2]", "[0]", "[1]", "dens"}) {
            SCOPED_TRACE(name);
            expect_the_same(folder.path(), name);
        }
        for (const char *name : {"density", ""}) { // the first of them; OpenVDB finds none where files were streamed
            SCOPED_TRACE(name);
            const auto first = judged(folder.path(), std::string(name) + "[0]");
            EXPECT_EQ(read_volume(folder.path(), name).density, first.density);
            if (!streamed) {
                expect_the_same(folder.path(), name);
            }
        }
        EXPECT_EQ(refusal(folder.path(), "density[3]"),
                  "it has no grid 'density[3]', but 'heat', 'density[0]', 'density[1]', '[0]', 'density[2]', '[1]', "
                  "'fuel[1]', 'dens'");
    }
}

// Python takes no other text than UTF-8.
TEST_F(Judged, NamesAreSaidAsFarAsTheyAreText) {
    const auto grid = openvdb::FloatGrid::create();
    const std::string whole = "Дым \xe7\x83\x9f \xf0\x9f\x92\xa8";
    grid->setName(whole);
    write(folder.path(), {grid});
    expect_the_same(folder.path(), whole);
    EXPECT_EQ(refusal(folder.path()), "it has no grid 'density', but '" + whole + "'");
    // A letter of Latin-1, a continuation alone, a cut one, an overlong 0, a surrogate, one above all, two controls.
    grid->setName("\xe4 \x80 \xd0 \xc0\x80 \xed\xa0\x80 \xf4\x90\x80\x80 \xff \n\x7f");
    write(folder.path(), {grid});
    EXPECT_EQ(refusal(folder.path()), "it has no grid 'density', but '? ? ? \?\? \?\?\? \?\?\?\? ? \?\?'");
}

TEST_F(Judged, StreamedFilesAreReadThrough) {
    const auto vectors = openvdb::Vec3SGrid::create(openvdb::Vec3s(1, 2, 3));
    vectors->setName("velocity");
    vectors->tree().setValueOn({1, 2, 3}, openvdb::Vec3s(4, 5, 6));
    vectors->tree().setValueOff({1, 2, 4}, openvdb::Vec3s(7, 8, 9));
    const auto doubles = openvdb::Vec3DGrid::create();
    doubles->setName("vorticity");
    doubles->tree().setValueOn({-1, 2, 3}, openvdb::Vec3d(4, 5, 6));
    doubles->setSaveFloatAsHalf(true);
    const auto cells = openvdb::Vec3IGrid::create();
    cells->setName("cells");
    cells->tree().setValueOn({-1, 2, 3}, openvdb::Vec3i(4, 5, 6));
    const auto flags = varied_grid<openvdb::BoolGrid>(true);
    flags->setName("flags");
    const auto smoke = varied_grid<openvdb::FloatGrid>(0.25F);
    const auto last = varied_grid<openvdb::FloatGrid>(0.0F);
    last->setName("last");
    for (const std::uint32_t compression : COMPRESSIONS) {
        write_streamed(folder.path(), {vectors, doubles, cells, flags, smoke, last}, compression);
        for (const char *name : {"flags", "density", "last"}) {
            expect_the_same(folder.path(), name);
        }
        EXPECT_EQ(refusal(folder.path(), "velocity"), "its grid 'velocity' holds vec3s, not floats");
    }
    const auto mask = openvdb::MaskGrid::create();
    mask->setName("mask");
    write_streamed(folder.path(), {mask, smoke});
    EXPECT_EQ(refusal(folder.path()).find("its grid 'mask' holds mask"), 0U);
    write_streamed(folder.path(), {smoke, mask});
    expect_the_same(folder.path());
}

// The layout of these grids is that of 222 in all of them; 225 has a type of grid more.
// Each channel of a vector, however it is stored; scalars are one channel.
template <typename Grid>
void expect_colours(const Folder &folder, const std::vector<std::uint32_t> &compressions) {
    using Vector = typename Grid::ValueType;
    using Number = typename Vector::value_type;
    const auto grid = Grid::create(Vector(Number(1), Number(2), Number(3)));
    grid->setName("tint");
    for (int i = 0; i < 600; ++i) {
        const openvdb::Coord at(i % 11 - 3, i % 7, i % 23);
        const Vector value(Number(i % 13), Number(i % 5), Number(i % 3));
        i % 4 == 0 ? grid->tree().setValueOff(at, value) : grid->tree().setValueOn(at, value);
    }
    grid->tree().addTile(1, {16, 0, 0}, Vector(Number(7), Number(8), Number(9)), true);
    for (const bool half : {false, true}) {
        grid->setSaveFloatAsHalf(half);
        for (const std::uint32_t compression : compressions) {
            SCOPED_TRACE(grid->valueType() + (half ? " as half, " : ", ") +
                         openvdb::io::compressionToString(compression));
            write(folder.path(), {grid}, compression);
            const std::vector<VolumeFile> channels = read_volume_colours(folder.path(), "tint");
            ASSERT_EQ(channels.size(), 3U);
            const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
            std::size_t at = 0;
            for (int z = box.min().z(); z <= box.max().z(); ++z) {
                for (int y = box.min().y(); y <= box.max().y(); ++y) {
                    for (int x = box.min().x(); x <= box.max().x(); ++x, ++at) {
                        const Vector expected = grid->tree().getValue({x, y, z});
                        for (std::size_t c = 0; c < 3; ++c) {
                            ASSERT_EQ(channels[c].density.at(at), static_cast<float>(expected[static_cast<int>(c)]));
                        }
                    }
                }
            }
            EXPECT_EQ(at, channels[0].density.size());
        }
    }
}

TEST_F(Judged, ColoursAreReadChannelByChannel) {
    const std::vector<std::uint32_t> all(std::begin(COMPRESSIONS), std::end(COMPRESSIONS));
    expect_colours<openvdb::Vec3SGrid>(folder, all);
    expect_colours<openvdb::Vec3DGrid>(folder, {NO_COMPRESSION, BLOSC | ACTIVE});
    expect_colours<openvdb::Vec3IGrid>(folder, {NO_COMPRESSION, BLOSC | ACTIVE});
    const auto grey = varied_grid<openvdb::FloatGrid>(0.25F);
    write(folder.path(), {grey});
    const std::vector<VolumeFile> channels = read_volume_colours(folder.path(), "density");
    ASSERT_EQ(channels.size(), 1U);
    EXPECT_TRUE(same_bits(channels[0].density, judged(folder.path(), "density").density));
}

TEST_F(Judged, VersionsFrom222To225AreRead) {
    write(folder.path(), {varied_grid<openvdb::FloatGrid>(0.25F)});
    std::string bytes = bytes_of(folder.path());
    for (const char version : {'\xde', '\xdf', '\xe0', '\xe1'}) {
        bytes[8] = version;
        write_bytes(folder.path(), bytes);
        expect_the_same(folder.path());
    }
    for (const char version : {'\xdd', '\xe2'}) {
        bytes[8] = version;
        write_bytes(folder.path(), bytes);
        EXPECT_EQ(refusal(folder.path()), "its format has version " + std::to_string(std::uint8_t(version)) +
                                              ", but only 222 to 225 are known");
    }
}

TEST_F(Judged, SamplesAreReadBitForBit) {
    const std::filesystem::path samples = SAMPLES;
    int files = 0;
    for (const auto &folder_of : {samples / "frames", samples / "plume_cache" / "data"}) {
        for (const auto &file : std::filesystem::directory_iterator(folder_of)) {
            if (file.path().extension() == ".vdb") {
                SCOPED_TRACE(file.path().string());
                expect_the_same(file.path().string());
                ++files;
            }
        }
    }
    EXPECT_GT(files, 10);
}

} // namespace
} // namespace sfumato
