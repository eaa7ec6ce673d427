// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke from .vdb files. The only file that knows OpenVDB.
#pragma once

#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct VolumeFile {
    glm::ivec3 resolution{0};       // of the box around the active voxels, zero where there are none
    std::vector<float> density;     // x runs fastest
    glm::dmat4 grid_to_object{1.0}; // from cells, as in scene.hpp, to the file's own space
};

// Reads one grid of scalars. Throws std::runtime_error, which names the file and the cause: a file that is missing,
// truncated or no OpenVDB file, a grid that is not there or holds no floats, a box too large for memory.
VolumeFile read_volume(const std::string &path, const std::string &grid);

} // namespace sfumato
