// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vdb_tree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>

#include <glm/common.hpp>

namespace sfumato {
namespace {

constexpr int LEAF = 3, LOWER = 4, UPPER = 5; // edges of nodes, in children, as powers of 2
constexpr int ROOT_EDGE = 1 << (LEAF + LOWER + UPPER);
// A box of 2^30 cells has half as many; what a file says in a few bits must not become gigabytes.
constexpr std::size_t MOST_TILES = std::size_t{1} << 22;

// Reads from the root downwards, as it is stored: the shape of the whole tree, then the voxels of all leaves.
class Reader {
public:
    Reader(VdbSource &from, const VdbNumbers &those, bool keeping)
        : source(from), numbers(those), keeps(keeping), unpacker(those) {}

    VdbTree read() {
        source.skip(sizeof(std::int32_t)); // of buffers, which always was 1
        read_root();
        for (VdbLeaf &leaf : tree.leaves) {
            const VdbMask active = leaf.values.active;
            source.skip(active.places() / 8); // once more
            leaf.values = numbers.scalar == VdbScalar::BOOL ? find_bools(source, active)
                                                            : find_values(source, numbers, active, tree.background);
        }
        return std::move(tree);
    }

private:
    void read_root();
    glm::ivec3 read_place();
    template <int LOG2>
    void read_node(const glm::ivec3 &first);
    void read_leaf(const glm::ivec3 &first);
    template <int LOG2>
    void keep_tiles(const VdbMask &children, const VdbValues &values, const glm::ivec3 &first);
    void keep_tile(const VdbTile &tile);
    void include(const glm::ivec3 &low, const glm::ivec3 &high) {
        tree.box = {glm::min(tree.box.low, low), glm::max(tree.box.high, high)};
    }

    VdbSource &source;
    const VdbNumbers &numbers;
    bool keeps;
    VdbUnpacker unpacker;
    std::vector<float> node_values;
    VdbTree tree;
};

// Of a child of the root.
glm::ivec3 Reader::read_place() {
    const auto x = source.number<std::int32_t>(), y = source.number<std::int32_t>(), z = source.number<std::int32_t>();
    if (x % ROOT_EDGE != 0 || y % ROOT_EDGE != 0 || z % ROOT_EDGE != 0) {
        throw std::runtime_error("a node of it is at voxel [" + std::to_string(x) + ", " + std::to_string(y) + ", " +
                                 std::to_string(z) + "], where there can be none");
    }
    return {x, y, z};
}

void Reader::read_root() {
    using Place = std::array<int, 3>;
    const auto place_of = [](const glm::ivec3 &first) { return Place{first.x, first.y, first.z}; };
    tree.background = read_value(source, numbers);
    const auto tiles = source.number<std::uint32_t>(), nodes = source.number<std::uint32_t>();
    std::vector<Place> places;
    for (std::uint32_t i = 0; i < tiles; ++i) {
        const glm::ivec3 first = read_place();
        places.push_back(place_of(first));
        const float value = read_value(source, numbers);
        if (source.number<std::uint8_t>() != 0) {
            include(first, first + (ROOT_EDGE - 1));
        }
        keep_tile({first, ROOT_EDGE, value});
    }
    for (std::uint32_t i = 0; i < nodes; ++i) {
        const glm::ivec3 first = read_place();
        if (i > 0 && place_of(first) <= places.back()) { // the order in which the leaves' voxels follow
            throw std::runtime_error("its nodes are not in order");
        }
        places.push_back(place_of(first));
        read_node<UPPER>(first);
    }
    std::sort(places.begin(), places.end());
    if (std::adjacent_find(places.begin(), places.end()) != places.end()) {
        throw std::runtime_error("two nodes of it are in one place");
    }
}

// Where the child at a place of a node is.
template <int LOG2>
glm::ivec3 child_of(const glm::ivec3 &first, int place, int child_edge) {
    constexpr int mask = (1 << LOG2) - 1;
    return first + child_edge * glm::ivec3(place >> (2 * LOG2), (place >> LOG2) & mask, place & mask);
}

template <int LOG2>
constexpr int CHILD_EDGE = LOG2 == UPPER ? 1 << (LEAF + LOWER) : 1 << LEAF;

template <int LOG2>
void Reader::read_node(const glm::ivec3 &first) {
    constexpr int places = 1 << (3 * LOG2);
    const VdbMask children(source, places), active(source, places);
    const VdbValues values = find_values(source, numbers, active, tree.background);
    if (keeps) {
        keep_tiles<LOG2>(children, values, first);
    }
    children.for_each([&](int place) {
        const glm::ivec3 child = child_of<LOG2>(first, place, CHILD_EDGE<LOG2>);
        if constexpr (LOG2 == UPPER) {
            read_node<LOWER>(child);
        } else {
            read_leaf(child);
        }
    });
}

void Reader::keep_tile(const VdbTile &tile) {
    if (!keeps || std::bit_cast<std::uint32_t>(tile.value) == std::bit_cast<std::uint32_t>(tree.background)) {
        return;
    }
    if (tree.tiles.size() == MOST_TILES) {
        throw std::runtime_error("it has more than " + std::to_string(MOST_TILES) + " tiles");
    }
    tree.tiles.push_back(tile);
}

template <int LOG2>
void Reader::keep_tiles(const VdbMask &children, const VdbValues &values, const glm::ivec3 &first) {
    constexpr int places = 1 << (3 * LOG2), edge = CHILD_EDGE<LOG2>;
    values.active.for_each([&](int place) {
        if (!children.on(place)) {
            const glm::ivec3 low = child_of<LOG2>(first, place, edge);
            include(low, low + (edge - 1));
        }
    });
    node_values.resize(places);
    unpacker.unpack(values, node_values);
    for (int place = 0; place < places; ++place) {
        if (!children.on(place)) {
            keep_tile({child_of<LOG2>(first, place, edge), edge, node_values[static_cast<std::size_t>(place)]});
        }
    }
}

void Reader::read_leaf(const glm::ivec3 &first) {
    const VdbMask active(source, VdbLeaf::VOXELS);
    tree.leaves.push_back({first, {}});
    tree.leaves.back().values.active = active;
    std::uint64_t any = 0; // of y and z
    int low_x = VdbLeaf::EDGE, high_x = -1;
    for (int x = 0; x < VdbLeaf::EDGE; ++x) {
        if (active.word(x) != 0) {
            any |= active.word(x);
            low_x = std::min(low_x, x);
            high_x = x;
        }
    }
    if (any == 0) {
        return;
    }
    unsigned of_z = 0;
    for (int y = 0; y < VdbLeaf::EDGE; ++y) {
        of_z |= static_cast<unsigned>((any >> (8 * y)) & 0xffU);
    }
    include(first + glm::ivec3(low_x, std::countr_zero(any) / 8, std::countr_zero(of_z)),
            first + glm::ivec3(high_x, 7 - std::countl_zero(any) / 8, std::bit_width(of_z) - 1));
}

} // namespace

VdbTree read_vdb_tree(VdbSource &source, const VdbNumbers &numbers) {
    VdbTree tree = Reader(source, numbers, true).read();
    const auto outside = [&](const glm::ivec3 &first, int edge) {
        for (int axis = 0; axis < 3; ++axis) {
            if (first[axis] > tree.box.high[axis] || first[axis] + (edge - 1) < tree.box.low[axis]) {
                return true;
            }
        }
        return false;
    };
    std::erase_if(tree.tiles, [&](const VdbTile &tile) { return outside(tile.first, tile.edge); });
    std::erase_if(tree.leaves, [&](const VdbLeaf &leaf) { return outside(leaf.first, VdbLeaf::EDGE); });
    return tree;
}

void skip_vdb_tree(VdbSource &source, const VdbNumbers &numbers) {
    Reader(source, numbers, false).read();
}

} // namespace sfumato
