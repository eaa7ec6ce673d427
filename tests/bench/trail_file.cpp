// SPDX-License-Identifier: GPL-3.0-or-later
// trail_file FILE.vdb: a trail of smoke along the diagonal of a box of 320^3 cells of a centimetre, 1 % of them filled.
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>

#include <openvdb/openvdb.h>

namespace {

constexpr int CELLS = 320;
constexpr double RADIUS = 13.8; // cells
constexpr double CELL = 0.01;   // metres

// Densest on the diagonal, and 0 at RADIUS from it.
float density(double x, double y, double z) {
    const double along = (x + y + z) / 3.0;
    const double distance =
        std::sqrt((x - along) * (x - along) + (y - along) * (y - along) + (z - along) * (z - along));
    return static_cast<float>(std::max(1.0 - distance / RADIUS, 0.0));
}

openvdb::FloatGrid::Ptr trail() {
    const auto grid = openvdb::FloatGrid::create();
    auto cells = grid->getAccessor();
    for (int z = 0; z < CELLS; ++z) {
        for (int y = 0; y < CELLS; ++y) {
            for (int x = 0; x < CELLS; ++x) {
                if (const float value = density(x, y, z); value > 0.0F) {
                    cells.setValue({x, y, z}, value);
                }
            }
        }
    }
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(CELL));
    return grid;
}

} // namespace

int main(int count, char **arguments) {
    if (count != 2) {
        std::cerr << "usage: trail_file FILE.vdb\n";
        return 2;
    }
    try {
        openvdb::initialize();
        openvdb::io::File(arguments[1]).write({trail()});
    } catch (const std::exception &error) {
        std::cerr << arguments[1] << ": " << error.what() << '\n';
        return 1;
    }
    return 0;
}
