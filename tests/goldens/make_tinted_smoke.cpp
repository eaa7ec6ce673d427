// SPDX-License-Identifier: GPL-3.0-or-later
// make_tinted_smoke FILE.vdb: a ball of smoke with two grids to colour it by: `tint`, of vectors, and `grey`, of floats
// in a larger box.
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>

#include <openvdb/openvdb.h>

namespace {

constexpr int CELLS = 16;
constexpr double CELL = 2.0 / CELLS; // metres

template <typename Grid, typename Value>
typename Grid::Ptr filled(const char *name, int first, int last, const Value &value) {
    const auto grid = Grid::create();
    auto cells = grid->getAccessor();
    for (int z = first; z < last; ++z) {
        for (int y = first; y < last; ++y) {
            for (int x = first; x < last; ++x) {
                cells.setValue({x, y, z}, value(openvdb::Vec3d(x, y, z) * CELL));
            }
        }
    }
    grid->setName(name);
    grid->setSaveFloatAsHalf(true);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(CELL));
    return grid;
}

openvdb::GridPtrVec grids() {
    const auto density = [](const openvdb::Vec3d &place) {
        return static_cast<float>(std::max(1.0 - (place - openvdb::Vec3d(1.0)).length(), 0.0));
    };
    const auto tint = [](const openvdb::Vec3d &place) {
        return openvdb::Vec3s(openvdb::Vec3d(0.5 * place.x(), 1.0 - 0.5 * place.x(), 0.5 * place.z()));
    };
    const auto grey = [](const openvdb::Vec3d &place) { return static_cast<float>(0.2 + 0.3 * place.z()); };
    return {filled<openvdb::FloatGrid>("density", 0, CELLS, density),
            filled<openvdb::Vec3SGrid>("tint", 0, CELLS, tint),
            filled<openvdb::FloatGrid>("grey", -2, CELLS + 2, grey)};
}

} // namespace

int main(int count, char **arguments) {
    if (count != 2) {
        std::cerr << "usage: make_tinted_smoke FILE.vdb\n";
        return 2;
    }
    try {
        openvdb::initialize();
        openvdb::io::File(arguments[1]).write(grids());
    } catch (const std::exception &error) {
        std::cerr << arguments[1] << ": " << error.what() << '\n';
        return 1;
    }
    return 0;
}
