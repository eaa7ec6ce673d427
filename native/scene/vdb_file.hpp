// SPDX-License-Identifier: GPL-3.0-or-later
// What a .vdb file tells of its grids before their voxels.
#pragma once

#include "scene/vdb_source.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

// A box of voxels, both corners inside; empty where a coordinate of `low` is above that of `high`.
struct VoxelBox {
    glm::ivec3 low{INT32_MAX};
    glm::ivec3 high{INT32_MIN};

    [[nodiscard]] bool empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
};

enum class VdbScalar { NONE, FLOAT, DOUBLE, INT32, INT64, BOOL };

// How the numbers of a grid are stored.
struct VdbNumbers {
    std::string name;                   // float, vec3s, ...
    VdbScalar scalar = VdbScalar::NONE; // none where it is not known, or not read
    int channels = 1;                   // of a value, three where it is a vector
    int channel = 0;                    // the one that is read
    int bytes = 0;                      // of a value, 0 where it is not known
    int bytes_in_nodes = 0;             // less where a grid is saved as half floats
    std::uint32_t compression = 0;      // bits of VdbCompression
};

enum VdbCompression : std::uint32_t { VDB_ZIP = 1, VDB_ACTIVE_ONLY = 2, VDB_BLOSC = 4 };

struct VdbGrid {
    std::string name;                // as it is asked for and listed: the second grid of a name is "name[1]"
    std::string base;                // without the number
    std::string parent;              // whose voxels it shares, or none
    std::string type;                // of its tree
    std::int64_t begin = 0, end = 0; // of its part of the file
    VdbNumbers numbers;

    // What only its part of the file tells; see read_head.
    bool level_set = false;
    std::optional<VoxelBox> active; // voxels, as far as the file says
    std::string map;                // its kind
    glm::dmat4 index_to_object{1.0};
    std::int64_t tree = 0; // where it begins
};

class VdbFile {
public:
    // Throws std::runtime_error: no such file, no OpenVDB file, a version that is not known, a file cut short.
    explicit VdbFile(const std::string &path);

    // The first grid of the name, or the one whose number is named too. Throws where there is none, and lists those
    // that there are.
    [[nodiscard]] const VdbGrid &find(const std::string &name) const;
    // The one that holds its voxels: itself, or its parent.
    [[nodiscard]] const VdbGrid &holder(const VdbGrid &grid) const;
    // Its metadata and its map.
    void read_head(VdbGrid &grid);
    // All of its tree in memory, the source at its start.
    VdbSource &hold_tree(const VdbGrid &grid);

private:
    VdbGrid descriptor();
    void read_streamed(int count);

    VdbSource source;
    bool offsets = true;
    std::vector<VdbGrid> grids;
};

} // namespace sfumato
