// SPDX-License-Identifier: GPL-3.0-or-later
#include "volume_file.hpp"

#include <cstdint>
#include <stdexcept>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

namespace sfumato {
namespace {

constexpr std::int64_t MOST_CELLS = std::int64_t{1} << 30; // 4 GiB of floats

VolumeFile read(const std::string &path, const std::string &name) {
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false); // everything now: a truncated file must fail here, not in the middle of a frame
    if (!file.hasGrid(name)) {
        throw std::runtime_error("it has no grid '" + name + "'");
    }
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
    if (!grid) {
        throw std::runtime_error("its grid '" + name + "' does not hold floats");
    }
    VolumeFile volume;
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    if (box.empty()) {
        return volume;
    }
    const openvdb::Coord size = box.dim();
    if (static_cast<std::int64_t>(box.volume()) > MOST_CELLS) {
        throw std::runtime_error("its grid '" + name + "' spans " + std::to_string(size.x()) + " x " +
                                 std::to_string(size.y()) + " x " + std::to_string(size.z()) +
                                 " cells; at most 2^30 cells can be read");
    }
    volume.resolution = {size.x(), size.y(), size.z()};
    volume.density.resize(static_cast<std::size_t>(box.volume()));
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(box, volume.density.data());
    openvdb::tools::copyToDense(*grid, dense);

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
