// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/vdb_file.hpp"

#include "scene/vdb_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <glm/matrix.hpp>

namespace sfumato {
namespace {

constexpr std::int64_t MAGIC = 0x56444220;        // "VDB ", backwards
constexpr std::uint32_t OLDEST = 222;             // since then a node says how its inactive values are stored
constexpr std::uint32_t NEWEST = 225;             // like 224 but for a type of grid
constexpr std::int64_t UUID = 36;                 // hexadecimal digits
constexpr char NUMBER_FOLLOWS = '\x1e';           // behind a name that more than one grid has
constexpr std::string_view HALVED = "_HalfFloat"; // behind the type of a tree

struct Stored {
    std::string_view name;
    VdbScalar scalar;
    int channels;
    int bytes, bytes_as_half;
};

constexpr std::array STORED{
    Stored{"float", VdbScalar::FLOAT, 1, 4, 2},   Stored{"double", VdbScalar::DOUBLE, 1, 8, 2},
    Stored{"int32", VdbScalar::INT32, 1, 4, 4},   Stored{"int64", VdbScalar::INT64, 1, 8, 8},
    Stored{"bool", VdbScalar::BOOL, 1, 1, 1},     Stored{"vec3s", VdbScalar::FLOAT, 3, 12, 6},
    Stored{"vec3d", VdbScalar::DOUBLE, 3, 24, 6}, Stored{"vec3i", VdbScalar::INT32, 3, 12, 12},
};

// Of a tree like Tree_float_5_4_3. Of one that is not known, the name is all that can be said.
VdbNumbers numbers_of(const std::string &type, bool halved) {
    constexpr std::string_view front = "Tree_", back = "_5_4_3";
    VdbNumbers numbers;
    numbers.name = type;
    if (!type.starts_with(front) || !type.ends_with(back) || type.size() < front.size() + back.size()) {
        return numbers;
    }
    numbers.name = type.substr(front.size(), type.size() - front.size() - back.size());
    for (const Stored &stored : STORED) {
        if (stored.name == numbers.name) {
            numbers.bytes = stored.bytes;
            numbers.bytes_in_nodes = halved ? stored.bytes_as_half : stored.bytes;
            numbers.scalar = stored.scalar;
            numbers.channels = stored.channels;
        }
    }
    return numbers;
}

// "density" and a 1 behind the sign as "density[1]".
std::string shown(const std::string &name) {
    const auto sign = name.find(NUMBER_FOLLOWS);
    return sign == std::string::npos ? name : name.substr(0, sign) + "[" + name.substr(sign + 1) + "]";
}

void skip_metadata(VdbSource &source) {
    for (auto left = source.number<std::uint32_t>(); left > 0; --left) {
        source.skip(source.number<std::uint32_t>()); // name
        source.skip(source.number<std::uint32_t>()); // type
        source.skip(source.number<std::uint32_t>()); // value
    }
}

glm::dvec3 vector_of(VdbSource &source) {
    const auto x = source.number<double>(), y = source.number<double>(), z = source.number<double>();
    return {x, y, z};
}

// To the object from voxels, or nothing where the map is not linear. Vectors are rows in the file, so its rows are
// GLM's columns.
std::optional<glm::dmat4> matrix_of(VdbSource &source, const std::string &map) {
    constexpr std::int64_t derived = std::int64_t{4} * 3 * sizeof(double); // voxel size, inverses: from the scale
    glm::dmat4 matrix(1.0);
    const auto read_scale = [&] {
        const glm::dvec3 scale = vector_of(source);
        source.skip(derived);
        for (int axis = 0; axis < 3; ++axis) {
            matrix[axis][axis] = scale[axis];
        }
    };
    if (map == "ScaleMap" || map == "UniformScaleMap") {
        read_scale();
    } else if (map == "ScaleTranslateMap" || map == "UniformScaleTranslateMap") {
        matrix[3] = glm::dvec4(vector_of(source), 1.0);
        read_scale();
    } else if (map == "TranslationMap") {
        matrix[3] = glm::dvec4(vector_of(source), 1.0);
    } else if (map == "AffineMap" || map == "UnitaryMap") {
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                matrix[row][column] = source.number<double>();
            }
        }
    } else {
        return std::nullopt;
    }
    return matrix;
}

// Whether there is one voxel in a place, and a place for each.
bool places_voxels(const glm::dmat4 &matrix) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(matrix[column][row]) || (row == 3 && matrix[column][row] != (column == 3 ? 1.0 : 0.0))) {
                return false;
            }
        }
    }
    return glm::determinant(glm::dmat3(matrix)) != 0.0;
}

} // namespace

VdbFile::VdbFile(const std::string &path) : source(path) {
    if (source.size() < std::int64_t{sizeof MAGIC} || source.number<std::int64_t>() != MAGIC) {
        throw std::runtime_error("it is no OpenVDB file");
    }
    const auto version = source.number<std::uint32_t>();
    if (version < OLDEST || version > NEWEST) {
        throw std::runtime_error("its format has version " + std::to_string(version) + ", but only " +
                                 std::to_string(OLDEST) + " to " + std::to_string(NEWEST) + " are known");
    }
    source.skip(2 * sizeof(std::uint32_t)); // of the library that wrote it
    offsets = source.number<char>() != 0;
    source.skip(UUID);
    skip_metadata(source);
    const auto count = source.number<std::int32_t>();
    if (!offsets) {
        read_streamed(count);
        return;
    }
    for (std::int32_t grid = 0; grid < count; ++grid) {
        grids.push_back(descriptor());
        const std::int64_t end = grids.back().end;
        if (end > source.size() || end < source.position()) {
            throw std::runtime_error("it is cut short, " + std::to_string(source.size()) + " bytes of at least " +
                                     std::to_string(end));
        }
        source.seek(end);
    }
}

VdbGrid VdbFile::descriptor() {
    VdbGrid grid;
    const std::string name = source.text();
    grid.name = shown(name);
    grid.base = name.substr(0, name.find(NUMBER_FOLLOWS));
    grid.type = source.text();
    const bool halved = grid.type.ends_with(HALVED);
    if (halved) {
        grid.type.resize(grid.type.size() - HALVED.size());
    }
    grid.numbers = numbers_of(grid.type, halved);
    grid.parent = shown(source.text());
    grid.begin = source.number<std::int64_t>();
    source.number<std::int64_t>(); // where the leaves begin, which is where the rest of the tree ends
    grid.end = source.number<std::int64_t>();
    return grid;
}

// One after the other, each to its end: nothing else tells where the next begins.
void VdbFile::read_streamed(int count) {
    source.hold(source.size());
    for (int left = count; left > 0; --left) {
        VdbGrid grid = descriptor();
        grid.begin = source.position();
        read_head(grid);
        if (left > 1 && grid.parent.empty()) {
            if (grid.tree == 0 || grid.numbers.bytes == 0) {
                throw std::runtime_error("its grid '" + grid.name + "' holds " + grid.numbers.name + " in a " +
                                         grid.map + ", behind which nothing is found in a file that was streamed");
            }
            skip_vdb_tree(source, grid.numbers);
        }
        grid.end = left > 1 ? source.position() : source.size();
        grids.push_back(std::move(grid));
    }
}

const VdbGrid &VdbFile::find(const std::string &name) const {
    auto found = std::find_if(grids.begin(), grids.end(), [&](const VdbGrid &grid) { return grid.base == name; });
    if (found == grids.end()) {
        found = std::find_if(grids.begin(), grids.end(), [&](const VdbGrid &grid) { return grid.name == name; });
    }
    if (found == grids.end()) {
        std::string all;
        for (const VdbGrid &grid : grids) {
            all += (all.empty() ? "'" : ", '") + grid.name + "'";
        }
        throw std::runtime_error("it has no grid '" + name + "', but " + (all.empty() ? "none at all" : all));
    }
    return *found;
}

const VdbGrid &VdbFile::holder(const VdbGrid &grid) const {
    if (grid.parent.empty()) {
        return grid;
    }
    for (const VdbGrid &parent : grids) {
        if (parent.name == grid.parent && parent.type == grid.type && parent.parent.empty()) {
            return parent;
        }
    }
    throw std::runtime_error("its grid '" + grid.name + "' shares the voxels of a grid '" + grid.parent +
                             "', which is not there, or is none of its kind");
}

void VdbFile::read_head(VdbGrid &grid) {
    source.name_part("grid '" + grid.name + "'");
    source.seek(grid.begin);
    grid.numbers.compression = source.number<std::uint32_t>();
    if ((grid.numbers.compression & ~(VDB_ZIP | VDB_ACTIVE_ONLY | VDB_BLOSC)) != 0) {
        throw std::runtime_error("its grid '" + grid.name + "' is compressed in a way that is not known, " +
                                 std::to_string(grid.numbers.compression));
    }
    std::optional<glm::ivec3> low, high;
    for (auto left = source.number<std::uint32_t>(); left > 0; --left) {
        const std::string name = source.text(), type = source.text();
        const std::int64_t bytes = source.number<std::uint32_t>();
        if (name == "class" && type == "string" && bytes < 64) {
            const auto *text = reinterpret_cast<const char *>(source.take(bytes));
            grid.level_set = std::string_view(text, static_cast<std::size_t>(bytes)) == "level set";
        } else if ((name == "file_bbox_min" || name == "file_bbox_max") && type == "vec3i" && bytes == 12) {
            const auto x = source.number<std::int32_t>(), y = source.number<std::int32_t>(),
                       z = source.number<std::int32_t>();
            (name == "file_bbox_min" ? low : high) = {x, y, z};
        } else {
            source.skip(bytes);
        }
    }
    if (low && high) {
        grid.active = VoxelBox{*low, *high};
    }
    grid.map = source.text();
    const auto matrix = matrix_of(source, grid.map);
    if (matrix) {
        if (!places_voxels(*matrix)) {
            throw std::runtime_error("its grid '" + grid.name + "' has a map that gives its voxels no place");
        }
        grid.index_to_object = *matrix;
        grid.tree = source.position();
    }
}

VdbSource &VdbFile::hold_tree(const VdbGrid &grid) {
    source.name_part("grid '" + grid.name + "'");
    source.seek(grid.tree);
    source.hold(grid.end);
    return source;
}

} // namespace sfumato
