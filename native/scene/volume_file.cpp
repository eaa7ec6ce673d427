// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

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

VolumeFile read(const std::string &path, const std::string &name) {
    require_vdb(path);
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false); // everything now: a truncated file must fail here, not in the middle of a frame
    header_of(file, name);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
    if (!grid) {
        throw std::runtime_error("its grid '" + name + "' does not hold floats");
    }
    VolumeFile volume;
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    if (box.empty()) {
        return volume;
    }
    require_room(box, name);
    const openvdb::Coord size = box.dim();
    volume.resolution = {size.x(), size.y(), size.z()};
    volume.density.resize(static_cast<std::size_t>(box.volume()));
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(box, volume.density.data());
    openvdb::tools::copyToDense(*grid, dense);
    const auto wrong =
        std::find_if(volume.density.begin(), volume.density.end(), [](float value) { return !std::isfinite(value); });
    if (wrong != volume.density.end()) {
        const openvdb::Coord at = dense.offsetToCoord(static_cast<std::size_t>(wrong - volume.density.begin()));
        throw std::runtime_error("its grid '" + name + "' holds " + std::to_string(*wrong) + " at voxel " +
                                 at.asVec3i().str());
    }

    const openvdb::math::Mat4d index_to_object = grid->transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row) { // OpenVDB multiplies row vectors: its rows are GLM's columns
        for (int column = 0; column < 4; ++column) {
            volume.grid_to_object[row][column] = index_to_object(row, column);
        }
    }
    // OpenVDB's samples are at whole numbers, ours in the middle of cells.
    const glm::dvec4 first(box.min().x() - 0.5, box.min().y() - 0.5, box.min().z() - 0.5, 1.0);
    volume.grid_to_object[3] = volume.grid_to_object * first;
    return volume;
}

} // namespace

VolumeFile read_volume(const std::string &path, const std::string &grid) {
    try {
        return read(path, grid);
    } catch (const std::exception &error) {
        throw std::runtime_error("'" + path + "' cannot be read: " + error.what());
    }
}

} // namespace sfumato
