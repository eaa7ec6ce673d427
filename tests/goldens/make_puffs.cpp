// SPDX-License-Identifier: GPL-3.0-or-later
// make_puffs FILE.vdb: the density of 300 soft puffs of two sizes in a ball of 90 cm, each 1 - (r / radius)^2, where
// tests/blender/background/puffs.py has them as particles.
#include <cmath>
#include <exception>
#include <iostream>
#include <vector>

#include <openvdb/openvdb.h>

namespace {

constexpr int PUFFS = 300;
constexpr double CELL = 0.02; // metres
constexpr double BALL = 0.7;  // that the middles are in

struct Puff {
    openvdb::Vec3d middle;
    double radius;
};

// Of Roberts's sequence, which fills a cube evenly, what is in the ball.
std::vector<Puff> puffs() {
    const openvdb::Vec3d steps(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);
    std::vector<Puff> out;
    for (int i = 0; out.size() < PUFFS; ++i) {
        openvdb::Vec3d place;
        for (int axis = 0; axis < 3; ++axis) {
            const double along = (i + 0.5) * steps[axis];
            place[axis] = 2.0 * (along - std::floor(along)) - 1.0;
        }
        if (place.length() < 1.0) {
            out.push_back({BALL * place, out.size() % 2 == 0 ? 0.12 : 0.2});
        }
    }
    return out;
}

openvdb::FloatGrid::Ptr density() {
    const auto grid = openvdb::FloatGrid::create();
    auto cells = grid->getAccessor();
    for (const Puff &puff : puffs()) {
        openvdb::Coord low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = static_cast<int>(std::floor((puff.middle[axis] - puff.radius) / CELL));
            high[axis] = static_cast<int>(std::ceil((puff.middle[axis] + puff.radius) / CELL));
        }
        for (openvdb::Coord at = low; at.z() <= high.z(); ++at.z()) {
            for (at.y() = low.y(); at.y() <= high.y(); ++at.y()) {
                for (at.x() = low.x(); at.x() <= high.x(); ++at.x()) {
                    const double far = (openvdb::Vec3d(at.x(), at.y(), at.z()) * CELL - puff.middle).length();
                    if (far < puff.radius) {
                        const double more = 1.0 - (far / puff.radius) * (far / puff.radius);
                        cells.setValue(at, cells.getValue(at) + static_cast<float>(more));
                    }
                }
            }
        }
    }
    grid->setName("density");
    grid->setSaveFloatAsHalf(true);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(CELL));
    return grid;
}

} // namespace

int main(int count, char **arguments) {
    if (count != 2) {
        std::cerr << "usage: make_puffs FILE.vdb\n";
        return 2;
    }
    try {
        openvdb::initialize();
        openvdb::io::File(arguments[1]).write({density()});
    } catch (const std::exception &error) {
        std::cerr << arguments[1] << ": " << error.what() << '\n';
        return 1;
    }
    return 0;
}
