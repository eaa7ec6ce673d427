// SPDX-License-Identifier: GPL-3.0-or-later
// The tree of a grid of a .vdb file: a root, nodes of 32^3 nodes of 16^3 leaves of 8^3 voxels, and tiles, which are
// single values in place of a node or leaf.
#pragma once

#include "scene/vdb_values.hpp"

#include <vector>

#include <glm/vec3.hpp>

namespace sfumato {

struct VdbTile {
    glm::ivec3 first;
    int edge;
    float value;
};

struct VdbLeaf {
    static constexpr int EDGE = 8;
    static constexpr std::size_t VOXELS = 512; // z runs fastest

    glm::ivec3 first;
    VdbValues values;
};

// What of a tree is in the box of its active voxels. Where there is no leaf and no tile, it has its background.
struct VdbTree {
    float background = 0.0F;
    VoxelBox box;
    std::vector<VdbTile> tiles; // no two of them and the leaves overlap
    std::vector<VdbLeaf> leaves;
};

// From where the source is. Its values are in what the source holds, which must outlive it. Throws std::runtime_error.
VdbTree read_vdb_tree(VdbSource &source, const VdbNumbers &numbers);
// The source is behind it then.
void skip_vdb_tree(VdbSource &source, const VdbNumbers &numbers);

} // namespace sfumato
