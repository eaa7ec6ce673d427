// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_file.hpp"

#include "scene/any_file.hpp"
#include "scene/vdb_tree.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <new>
#include <span>
#include <stdexcept>

#include <glm/common.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace sfumato {
namespace {

constexpr std::int64_t MOST_CELLS = std::int64_t{1} << 30; // 4 GiB of floats
constexpr std::ptrdiff_t EDGE = VdbLeaf::EDGE;

using Leaf = std::span<float, VdbLeaf::VOXELS>;

std::string text_of(const glm::ivec3 &voxel) {
    return std::to_string(voxel.x).insert(0, 1, '[') + ", " + std::to_string(voxel.y) + ", " + std::to_string(voxel.z) +
           "]";
}

// In 64 bits: the extents of a box from one end of the index space to the other overflow 32.
std::array<std::int64_t, 3> extents(const VoxelBox &box) {
    std::array<std::int64_t, 3> size{};
    for (int axis = 0; axis < 3; ++axis) {
        size[static_cast<std::size_t>(axis)] = std::int64_t{box.high[axis]} - box.low[axis] + 1;
    }
    return size;
}

[[noreturn]] void refuse_box(const VoxelBox &box, const std::string &name, const std::string &why) {
    const auto size = extents(box);
    throw std::runtime_error("its grid '" + name + "' spans " + std::to_string(size[0]) + " x " +
                             std::to_string(size[1]) + " x " + std::to_string(size[2]) + " cells; " + why);
}

VolumeHeader placed(const VoxelBox &box, const VdbGrid &grid) {
    VolumeHeader header;
    if (box.empty()) {
        return header;
    }
    const auto size = extents(box);
    if (static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) >
        static_cast<double>(MOST_CELLS)) {
        refuse_box(box, grid.name, "at most 2^30 cells can be read");
    }
    header.resolution = {size[0], size[1], size[2]};
    header.grid_to_object = grid.index_to_object;
    // OpenVDB's samples are at whole numbers, ours in the middle of cells.
    header.grid_to_object[3] = header.grid_to_object * glm::dvec4(glm::dvec3(box.low) - 0.5, 1.0);
    return header;
}

// A grid of a file, before any of its voxels are read.
struct Chosen {
    VdbFile file;
    VdbGrid grid;

    Chosen(const std::string &path, const std::string &name, bool colours) : file(path), grid(file.find(name)) {
        const auto refuse = [&](const std::string &why) { throw std::runtime_error("its grid '" + name + "' " + why); };
        if (grid.numbers.scalar == VdbScalar::NONE || (grid.numbers.channels > 1 && !colours)) {
            refuse("holds " + grid.numbers.name + ", not floats");
        }
        file.read_head(grid);
        if (grid.level_set) {
            refuse("is a level set, a distance to a surface and no density");
        }
        if (grid.tree == 0) {
            refuse("has a " + grid.map + ", but only linear ones can be read");
        }
        grid.name = name;
    }

    // Of the tree, whose voxels stay in the file's bytes.
    VdbTree tree() {
        VdbGrid holder = file.holder(grid);
        file.read_head(holder);
        if (holder.tree == 0) {
            throw std::runtime_error("its grid '" + holder.name + "' has a " + holder.map);
        }
        const int channel = grid.numbers.channel;
        grid.numbers = holder.numbers;
        grid.numbers.channel = channel;
        return read_vdb_tree(file.hold_tree(holder), grid.numbers);
    }
};

// use(number of the leaf, its voxels), of many at once.
template <typename Target, typename Use>
void for_each_leaf(const VdbTree &tree, const VdbNumbers &numbers, const Target &target, const Use &use) {
    constexpr std::size_t grain = 16;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.leaves.size(), grain), [&](const auto &range) {
        VdbUnpacker unpacker(numbers);
        std::array<float, VdbLeaf::VOXELS> here;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Leaf voxels = target(i, here);
            unpacker.unpack(tree.leaves[i].values, voxels);
            use(i, voxels);
        }
    });
}

// A box that a leaf or tile has in common with the grid's, counted from the latter's first voxel.
struct Common {
    glm::ivec3 first, size;
};

Common common(const glm::ivec3 &first, int edge, const VoxelBox &box) {
    const glm::ivec3 low = glm::max(first, box.low), high = glm::min(first + (edge - 1), box.high);
    return {low - box.low, high - low + 1};
}

bool all_finite(std::span<const float> values) {
    float sum = 0.0F; // stays 0 unless a value is no number
    for (const float value : values) {
        sum += 0.0F * value;
    }
    return sum == 0.0F;
}

// set(index of the first of a row of cells, how many, z and y of the row in the common box).
template <typename Set>
void for_each_row(const Common &part, const glm::ivec3 &resolution, const Set &set) {
    for (int z = 0; z < part.size.z; ++z) {
        for (int y = 0; y < part.size.y; ++y) {
            const auto row = static_cast<std::size_t>(part.first.z + z) * static_cast<std::size_t>(resolution.y) +
                             static_cast<std::size_t>(part.first.y + y);
            set(row * static_cast<std::size_t>(resolution.x) + static_cast<std::size_t>(part.first.x), y, z);
        }
    }
}

VolumeFile dense(const VdbTree &tree, const VdbGrid &grid) {
    VolumeFile volume{placed(tree.box, grid), {}};
    const glm::ivec3 n = volume.resolution;
    const std::size_t cells =
        static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z);
    try {
        volume.density.assign(cells, tree.background);
    } catch (const std::bad_alloc &) {
        refuse_box(tree.box, grid.name, "there is no memory for them");
    }
    std::atomic<bool> finite = std::isfinite(tree.background);
    for (const VdbTile &tile : tree.tiles) {
        const Common part = common(tile.first, tile.edge, tree.box);
        for_each_row(part, n, [&](std::size_t at, int, int) {
            std::fill_n(volume.density.begin() + static_cast<std::ptrdiff_t>(at), part.size.x, tile.value);
        });
        finite = finite && std::isfinite(tile.value);
    }
    for_each_leaf(
        tree, grid.numbers, [](std::size_t, auto &here) { return Leaf(here); },
        [&](std::size_t i, Leaf voxels) {
            const glm::ivec3 first = tree.leaves[i].first;
            const Common part = common(first, VdbLeaf::EDGE, tree.box);
            const glm::ivec3 cut = part.first + tree.box.low - first;
            for_each_row(part, n, [&](std::size_t at, int y, int z) {
                const float *from = &voxels[0] + (cut.x * EDGE + cut.y + y) * EDGE + cut.z + z;
                for (int x = 0; x < part.size.x; ++x) {
                    volume.density[at + static_cast<std::size_t>(x)] = from[x * EDGE * EDGE];
                }
            });
            if (!all_finite(voxels)) {
                finite = false;
            }
        });
    if (finite) {
        return volume;
    }
    const auto wrong =
        std::find_if(volume.density.begin(), volume.density.end(), [](float value) { return !std::isfinite(value); });
    if (wrong != volume.density.end()) {
        const auto at = static_cast<std::int64_t>(wrong - volume.density.begin());
        const glm::ivec3 cell(at % n.x, at / n.x % n.y, at / n.x / n.y);
        throw std::runtime_error("its grid '" + grid.name + "' holds " + std::to_string(*wrong) + " at voxel " +
                                 text_of(tree.box.low + cell));
    }
    return volume;
}

void require_densities(const CellBlock &block, const glm::ivec3 &origin, const std::string &name) {
    const bool constant = block.strides == glm::vec<3, std::ptrdiff_t>(0);
    const glm::ivec3 size = constant ? glm::min(block.size, 1) : block.size;
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                const float value = block.values[x * block.strides.x + y * block.strides.y + z * block.strides.z];
                if (std::isfinite(value) && value <= 1e30F) {
                    continue;
                }
                throw std::runtime_error("its grid '" + name + "' holds " + std::to_string(value) + " at voxel " +
                                         text_of(origin + block.first + glm::ivec3(x, y, z)) +
                                         (std::isfinite(value) ? ", but a density is at most 1e30" : ""));
            }
        }
    }
}

// The numbers that blocks point into.
struct Stored {
    std::vector<VdbTile> tiles;
    std::unique_ptr<float[]> voxels; // of all leaves
};

VolumeBlocks blocks(VdbTree tree, const VdbGrid &grid) {
    VolumeBlocks volume{placed(tree.box, grid), {}, {}};
    const auto add = [&](const float *values, const Common &part, const glm::vec<3, std::ptrdiff_t> &strides) {
        volume.blocks.push_back({values, part.first, part.size, strides});
        require_densities(volume.blocks.back(), tree.box.low, grid.name);
    };
    if (tree.background != 0.0F) { // then nothing is sparse
        const auto all = std::make_shared<const VolumeFile>(dense(tree, grid));
        const glm::ivec3 n = all->resolution;
        if (n.x > 0) {
            add(all->density.data(), {glm::ivec3(0), n}, {1, n.x, std::ptrdiff_t{n.x} * n.y});
        }
        volume.owner = all;
        return volume;
    }
    const std::size_t leaves = tree.leaves.size();
    const auto stored = std::make_shared<Stored>();
    stored->voxels = std::make_unique_for_overwrite<float[]>(leaves * VdbLeaf::VOXELS);
    const auto voxels_of = [&](std::size_t i) { return stored->voxels.get() + i * VdbLeaf::VOXELS; };
    for_each_leaf(
        tree, grid.numbers, [&](std::size_t i, auto &) { return Leaf(voxels_of(i), VdbLeaf::VOXELS); },
        [](std::size_t, Leaf) {});
    volume.blocks.reserve(leaves + tree.tiles.size());
    for (std::size_t i = 0; i < leaves; ++i) {
        const glm::ivec3 first = tree.leaves[i].first;
        const Common part = common(first, VdbLeaf::EDGE, tree.box);
        const glm::ivec3 cut = part.first + tree.box.low - first;
        add(voxels_of(i) + (cut.x * EDGE + cut.y) * EDGE + cut.z, part, {EDGE * EDGE, EDGE, 1});
    }
    stored->tiles = std::move(tree.tiles);
    for (const VdbTile &tile : stored->tiles) {
        if (tile.value != 0.0F) {
            add(&tile.value, common(tile.first, tile.edge, tree.box), {0, 0, 0});
        }
    }
    volume.owner = stored;
    return volume;
}

// use(the grid) with what it throws told as the file's.
template <typename Use>
auto read(const std::string &path, const std::string &name, const Use &use, bool colours = false) {
    try {
        Chosen chosen(path, name, colours);
        return use(chosen);
    } catch (const std::bad_alloc &) {
        throw std::runtime_error("'" + path + "' cannot be read: there is no memory for it");
    } catch (const std::exception &error) {
        throw std::runtime_error("'" + path + "' cannot be read: " + legible(error.what()));
    }
}

} // namespace

VolumeFile read_volume(const std::string &path, const std::string &grid) {
    return read(path, grid, [](Chosen &chosen) {
        const VdbTree tree = chosen.tree();
        return dense(tree, chosen.grid);
    });
}

std::vector<VolumeFile> read_volume_colours(const std::string &path, const std::string &grid) {
    const auto channels = [](Chosen &chosen) {
        std::vector<VolumeFile> out;
        for (int &channel = chosen.grid.numbers.channel; channel < chosen.grid.numbers.channels; ++channel) {
            const VdbTree tree = chosen.tree();
            out.push_back(dense(tree, chosen.grid));
        }
        return out;
    };
    return read(path, grid, channels, true);
}

VolumeHeader read_volume_header(const std::string &path, const std::string &grid) {
    return read(path, grid, [](Chosen &chosen) {
        const auto box = chosen.grid.active ? *chosen.grid.active : chosen.tree().box;
        return placed(box, chosen.grid);
    });
}

VolumeBlocks read_volume_blocks(const std::string &path, const std::string &grid) {
    return read(path, grid, [](Chosen &chosen) { return blocks(chosen.tree(), chosen.grid); });
}

} // namespace sfumato
