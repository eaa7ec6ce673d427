// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <glm/common.hpp>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

namespace sfumato {
namespace {

constexpr std::int64_t MOST_CELLS = std::int64_t{1} << 30; // 4 GiB of floats

template <typename Number>
Number number(std::istream &stream) {
    Number value{};
    if (!stream.read(reinterpret_cast<char *>(&value), sizeof value)) {
        throw std::runtime_error("its header is cut short");
    }
    return value;
}

void skip(std::istream &stream, std::int64_t bytes, std::int64_t size) {
    if (bytes > size - stream.tellg()) {
        throw std::runtime_error("its header is cut short");
    }
    stream.seekg(bytes, std::ios::cur);
}

// The library reads on behind a file's end, for minutes or for ever. Each grid's descriptor says where the grid ends,
// so the header is walked through once: version, metadata, and for each grid its descriptor, up to the next one.
void require_whole(std::istream &stream, std::int64_t size) {
    const auto skip_text = [&] { skip(stream, number<std::uint32_t>(stream), size); };
    const auto version = number<std::uint32_t>(stream);
    if (version < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION) {
        return; // before 2013, when descriptors were different
    }
    skip(stream, 2 * sizeof(std::uint32_t), size); // the library's own version
    const bool offsets = number<char>(stream) != 0;
    skip(stream, 36, size); // a name of its own, in hexadecimal digits
    for (auto left = number<std::uint32_t>(stream); left > 0; --left) {
        skip_text(); // name
        skip_text(); // type
        skip_text(); // value
    }
    const auto grids = number<std::int32_t>(stream);
    for (std::int32_t grid = 0; offsets && grid < grids; ++grid) {
        skip_text(); // name
        skip_text(); // type
        skip_text(); // of which it is an instance
        number<std::int64_t>(stream);
        number<std::int64_t>(stream);
        const auto end = number<std::int64_t>(stream);
        if (end > size || end < stream.tellg()) {
            throw std::runtime_error("it is cut short, " + std::to_string(size) + " bytes of at least " +
                                     std::to_string(end));
        }
        stream.seekg(end);
    }
}

// What the library would say of these in words of its own, or not at all.
void require_vdb(const std::string &path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::runtime_error("there is no such file");
    }
    if (std::filesystem::is_directory(status)) {
        throw std::runtime_error("it is a directory");
    }
    std::ifstream stream(path, std::ios::binary);
    if (!stream) {
        throw std::runtime_error("it cannot be opened");
    }
    if (std::filesystem::file_size(path) == 0) {
        throw std::runtime_error("it is empty");
    }
    if (std::int64_t magic = 0;
        !stream.read(reinterpret_cast<char *>(&magic), sizeof magic) || magic != openvdb::OPENVDB_MAGIC) {
        throw std::runtime_error("it is no OpenVDB file");
    }
    require_whole(stream, static_cast<std::int64_t>(std::filesystem::file_size(path)));
}

// The grid, before any of its voxels are read, whose header tells its type and its box.
openvdb::GridBase::Ptr header_of(openvdb::io::File &file, const std::string &name) {
    if (!file.hasGrid(name)) {
        std::string all;
        for (auto at = file.beginName(); at != file.endName(); ++at) {
            all += (all.empty() ? "'" : ", '") + at.gridName() + "'";
        }
        throw std::runtime_error("it has no grid '" + name + "', but " + (all.empty() ? "none at all" : all));
    }
    openvdb::GridBase::Ptr grid = file.readGridMetadata(name);
    const std::string type = grid->valueType();
    if (!grid->isType<openvdb::FloatGrid>()) {
        throw std::runtime_error("its grid '" + name + "' holds " + type + ", not floats");
    }
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
        throw std::runtime_error("its grid '" + name + "' is a level set, a distance to a surface and no density");
    }
    if (!grid->transform().isLinear()) {
        throw std::runtime_error("its grid '" + name + "' has a " + grid->transform().mapType() +
                                 ", but only linear ones can be read");
    }
    return grid;
}

// In 64 bits: the extents of a box from one end of the index space to the other overflow 32.
void require_room(const openvdb::CoordBBox &box, const std::string &name) {
    std::array<std::int64_t, 3> size{};
    double cells = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        size[axis] = std::int64_t{box.max()[axis]} - box.min()[axis] + 1;
        cells *= static_cast<double>(size[axis]);
    }
    if (cells > static_cast<double>(MOST_CELLS)) {
        throw std::runtime_error("its grid '" + name + "' spans " + std::to_string(size[0]) + " x " +
                                 std::to_string(size[1]) + " x " + std::to_string(size[2]) +
                                 " cells; at most 2^30 cells can be read");
    }
}

// use(the open file, the grid before any of its voxels are read).
template <typename Use>
auto with_file(const std::string &path, const std::string &name, const Use &use) {
    require_vdb(path);
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false); // everything now: a truncated file must fail here, not in the middle of a frame
    return use(file, header_of(file, name));
}

openvdb::FloatGrid::Ptr voxels_of(openvdb::io::File &file, const std::string &name) {
    auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
    if (!grid) {
        throw std::runtime_error("its grid '" + name + "' does not hold floats");
    }
    return grid;
}

VolumeHeader placed(const openvdb::CoordBBox &box, const openvdb::GridBase &grid, const std::string &name) {
    VolumeHeader header;
    if (box.empty()) {
        return header;
    }
    require_room(box, name);
    const openvdb::Coord size = box.dim();
    header.resolution = {size.x(), size.y(), size.z()};
    const openvdb::math::Mat4d index_to_object = grid.transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row) { // OpenVDB multiplies row vectors: its rows are GLM's columns
        for (int column = 0; column < 4; ++column) {
            header.grid_to_object[row][column] = index_to_object(row, column);
        }
    }
    // OpenVDB's samples are at whole numbers, ours in the middle of cells.
    const glm::dvec4 first(box.min().x() - 0.5, box.min().y() - 0.5, box.min().z() - 0.5, 1.0);
    header.grid_to_object[3] = header.grid_to_object * first;
    return header;
}

VolumeFile dense(const openvdb::FloatGrid &grid, const openvdb::CoordBBox &box, const std::string &name) {
    VolumeFile volume{placed(box, grid, name), {}};
    if (box.empty()) {
        return volume;
    }
    volume.density.resize(static_cast<std::size_t>(box.volume()));
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> cells(box, volume.density.data());
    openvdb::tools::copyToDense(grid, cells);
    const auto wrong =
        std::find_if(volume.density.begin(), volume.density.end(), [](float value) { return !std::isfinite(value); });
    if (wrong != volume.density.end()) {
        const openvdb::Coord at = cells.offsetToCoord(static_cast<std::size_t>(wrong - volume.density.begin()));
        throw std::runtime_error("its grid '" + name + "' holds " + std::to_string(*wrong) + " at voxel " +
                                 at.asVec3i().str());
    }
    return volume;
}

openvdb::CoordBBox box_of(openvdb::io::File &file, const openvdb::GridBase &header, const std::string &name) {
    const auto corner = [&](const char *which) { return header.getMetadata<openvdb::Vec3IMetadata>(which); };
    const auto low = corner(openvdb::GridBase::META_FILE_BBOX_MIN),
               high = corner(openvdb::GridBase::META_FILE_BBOX_MAX);
    if (low && high) {
        return {openvdb::Coord(low->value()), openvdb::Coord(high->value())};
    }
    return voxels_of(file, name)->evalActiveVoxelBoundingBox();
}

// The part inside a box of what lies at `place`, counted from the box's first voxel.
CellBlock block_of(const float *values, const glm::vec<3, std::ptrdiff_t> &strides, const openvdb::CoordBBox &place,
                   const openvdb::CoordBBox &box) {
    openvdb::CoordBBox inside = place;
    inside.intersect(box);
    if (inside.empty()) {
        return {};
    }
    const openvdb::Coord size = inside.dim(), first = inside.min() - box.min(), cut = inside.min() - place.min();
    return {values + cut.x() * strides.x + cut.y() * strides.y + cut.z() * strides.z,
            {first.x(), first.y(), first.z()},
            {size.x(), size.y(), size.z()},
            strides};
}

void require_densities(const CellBlock &block, const openvdb::Coord &origin, const std::string &name) {
    const bool constant = block.strides == glm::vec<3, std::ptrdiff_t>(0);
    const glm::ivec3 size = constant ? glm::min(block.size, 1) : block.size;
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                const float value = block.values[x * block.strides.x + y * block.strides.y + z * block.strides.z];
                if (value >= 0.0F && value <= 1e30F) {
                    continue;
                }
                const glm::ivec3 at = block.first + glm::ivec3(x, y, z);
                throw std::runtime_error("its grid '" + name + "' holds " + std::to_string(value) + " at voxel " +
                                         (origin + openvdb::Coord(at.x, at.y, at.z)).asVec3i().str() +
                                         (std::isfinite(value) ? ", but a density is in [0, 1e30]" : ""));
            }
        }
    }
}

VolumeBlocks blocks(const std::shared_ptr<const openvdb::FloatGrid> &grid, const std::string &name) {
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    VolumeBlocks volume{placed(box, *grid, name), {}, grid};
    const openvdb::FloatTree &tree = grid->tree();
    const auto add = [&](const CellBlock &block) {
        if (block.size.x > 0) {
            require_densities(block, box.min(), name);
            volume.blocks.push_back(block);
        }
    };
    if (grid->background() != 0.0F) { // then nothing is sparse
        const auto all = std::make_shared<const VolumeFile>(dense(*grid, box, name));
        const glm::ivec3 n = all->resolution;
        add({all->density.data(), glm::ivec3(0), n, {1, n.x, std::ptrdiff_t{n.x} * n.y}});
        volume.owner = all;
        return volume;
    }
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        constexpr std::ptrdiff_t EDGE = openvdb::FloatTree::LeafNodeType::DIM; // z runs fastest
        add(block_of(leaf->buffer().data(), {EDGE * EDGE, EDGE, 1}, leaf->getNodeBoundingBox(), box));
    }
    // Tiles, active or not: each is one number.
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (*tile != 0.0F) {
            add(block_of(&*tile, {0, 0, 0}, tile.getBoundingBox(), box));
        }
    }
    return volume;
}

// use() with what it throws told as the file's.
template <typename Use>
auto read(const std::string &path, const std::string &name, const Use &use) {
    try {
        return with_file(path, name, use);
    } catch (const std::exception &error) {
        throw std::runtime_error("'" + path + "' cannot be read: " + error.what());
    }
}

} // namespace

VolumeFile read_volume(const std::string &path, const std::string &grid) {
    return read(path, grid, [&](openvdb::io::File &file, const openvdb::GridBase::Ptr &) {
        const auto voxels = voxels_of(file, grid);
        return dense(*voxels, voxels->evalActiveVoxelBoundingBox(), grid);
    });
}

VolumeHeader read_volume_header(const std::string &path, const std::string &grid) {
    return read(path, grid, [&](openvdb::io::File &file, const openvdb::GridBase::Ptr &header) {
        return placed(box_of(file, *header, grid), *header, grid);
    });
}

VolumeBlocks read_volume_blocks(const std::string &path, const std::string &grid) {
    return read(path, grid, [&](openvdb::io::File &file, const openvdb::GridBase::Ptr &) {
        return blocks(voxels_of(file, grid), grid);
    });
}

} // namespace sfumato
