// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke from .vdb files, as OpenVDB 3 to 13 write them.
#pragma once

#include "scene/cell_block.hpp"

#include <memory>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct VolumeHeader {
    glm::ivec3 resolution{0};       // of the box around the active voxels, zero where there are none
    glm::dmat4 grid_to_object{1.0}; // from cells, as in scene.hpp, to the file's own space
};

struct VolumeFile : VolumeHeader {
    std::vector<float> density; // x runs fastest
};

// What of a grid is stored, as it is stored: blocks of voxels, and what they point into.
struct VolumeBlocks : VolumeHeader {
    std::vector<CellBlock> blocks; // no cell is in two of them; where none is, the density is 0
    std::shared_ptr<const void> owner;
};

// Reads one grid of scalars. Throws std::runtime_error, which names the file and the cause: a file that is missing,
// truncated, damaged or no OpenVDB file, a grid that is not there or holds no scalars, a box too large for memory.
VolumeFile read_volume(const std::string &path, const std::string &grid);

// Of the same grid, and refused likewise, without a look at its voxels where the file tells their box by itself.
VolumeHeader read_volume_header(const std::string &path, const std::string &grid);

// The three channels of a grid of vectors, or the one that a grid of scalars has. Throws as read_volume does.
std::vector<VolumeFile> read_volume_colours(const std::string &path, const std::string &grid);

// The same grid without an array of its box. Voxels above 1e30 are refused too.
VolumeBlocks read_volume_blocks(const std::string &path, const std::string &grid);

} // namespace sfumato
