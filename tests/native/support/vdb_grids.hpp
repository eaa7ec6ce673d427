// SPDX-License-Identifier: GPL-3.0-or-later
// Grids with every way in which OpenVDB stores a node, and files of them.
#pragma once

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

namespace sfumato::vdb_testing {

// A folder for a test program's files, which goes with it.
class Folder {
public:
    explicit Folder(const std::string &name)
        : folder(std::filesystem::temp_directory_path() / (name + "_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(folder);
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(folder, ignored);
    }
    [[nodiscard]] std::string path(const std::string &name = "file.vdb") const { return (folder / name).string(); }

private:
    std::filesystem::path folder;
};

constexpr std::uint32_t NO_COMPRESSION = openvdb::io::COMPRESS_NONE, ZIP = openvdb::io::COMPRESS_ZIP,
                        BLOSC = openvdb::io::COMPRESS_BLOSC, ACTIVE = openvdb::io::COMPRESS_ACTIVE_MASK;
constexpr std::uint32_t COMPRESSIONS[] = {NO_COMPRESSION, ZIP, BLOSC, ACTIVE, ZIP | ACTIVE, BLOSC | ACTIVE};

inline void write(const std::string &path, const openvdb::GridPtrVec &grids, std::uint32_t compression = BLOSC | ACTIVE,
                  bool statistics = true) {
    openvdb::io::File file(path);
    file.setCompression(compression);
    file.setGridStatsMetadataEnabled(statistics);
    file.write(grids);
}

// As to a pipe: nothing in the file tells where a grid begins.
inline void write_streamed(const std::string &path, const openvdb::GridPtrVec &grids,
                           std::uint32_t compression = BLOSC | ACTIVE) {
    std::ofstream stream(path, std::ios::binary);
    openvdb::io::Stream file(stream);
    file.setCompression(compression);
    file.write(grids);
}

inline std::string bytes_of(const std::string &path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::string &path, const std::string &bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

// Leaves on both sides of 0, so under eight nodes of the root; one for each way in which inactive voxels are stored.
// Tiles at each level: of 8^3, 128^3 and 4096^3 voxels.
template <typename Grid>
typename Grid::Ptr varied_grid(typename Grid::ValueType background, bool tiles = true) {
    using Value = typename Grid::ValueType;
    const auto grid = Grid::create(background);
    auto &tree = grid->tree();
    const auto value = [](int i) { return static_cast<Value>(0.3 + 1.7 * (i % 13)); };
    const auto leaf = [&](const openvdb::Coord &first, const std::vector<Value> &off, int step) {
        for (int i = 0; i < 512; ++i) {
            const openvdb::Coord at = first + openvdb::Coord(i / 64, i / 8 % 8, i % 8);
            if (step > 0 && i % step == 0) {
                tree.setValueOn(at, value(i));
            } else {
                tree.setValueOff(at, off[static_cast<std::size_t>(i) % off.size()]);
            }
        }
    };
    const Value negative = openvdb::math::negative(background), one = value(3), two = value(5), three = value(8);
    leaf({0, 0, 0}, {background}, 7);
    leaf({8, 0, 0}, {negative}, 5);
    leaf({16, 0, 0}, {one}, 3);
    leaf({24, 0, 0}, {background, negative}, 11);
    leaf({0, 8, 0}, {one, background, background}, 13);
    leaf({8, 8, 0}, {one, two}, 4);
    leaf({16, 8, 0}, {one, two, three}, 9);
    leaf({24, 8, 8}, {background}, 1);
    leaf({32, 0, 0}, {two}, 0);
    leaf({-8, -8, -8}, {one, background}, 6);
    leaf({-8, 0, 0}, {background}, 2);
    if (tiles) {
        tree.addTile(1, {40, 0, 0}, one, true);
        tree.addTile(1, {0, 16, 0}, two, false);
        tree.addTile(1, {0, 0, 16}, background, true);
        tree.addTile(2, {0, -128, 0}, three, false);
        tree.addTile(3, {-4096, -4096, 0}, two, false);
        tree.addTile(1, {400, 400, 400}, one, false); // outside the box
    }
    grid->setName("density");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    return grid;
}

} // namespace sfumato::vdb_testing
