// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/tint.hpp"

#include <cmath>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace sfumato {
namespace {

glm::dvec3 colour_of(const ColourCells &colours, const glm::ivec3 &cell) {
    if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(cell, colours.resolution))) {
        return glm::dvec3(0.0);
    }
    const auto row = static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(colours.resolution.y) +
                     static_cast<std::size_t>(cell.y);
    const std::size_t at = (row * static_cast<std::size_t>(colours.resolution.x) + static_cast<std::size_t>(cell.x)) *
                           static_cast<std::size_t>(colours.stride);
    return {colours.channels[0][at], colours.channels[1][at], colours.channels[2][at]};
}

// Trilinear: where the cells of both grids coincide, that is the one cell's own.
glm::dvec3 colour_at(const ColourCells &colours, const glm::dvec3 &place) {
    // A turned or scaled grid's matrix is rounded: what is meant to be one cell must not be a mixture of two.
    const glm::dvec3 position = glm::round((place - 0.5) * 4096.0) / 4096.0;
    const glm::dvec3 lower = glm::floor(position), above = position - lower;
    glm::dvec3 sum(0.0);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
        const glm::dvec3 shares = glm::mix(1.0 - above, above, side);
        const double share = shares.x * shares.y * shares.z;
        if (share > 0.0) {
            sum += share * colour_of(colours, glm::ivec3(lower + side));
        }
    }
    return glm::max(sum, 0.0);
}

} // namespace

void tint(Grid &grid, const ColourCells &colours, const glm::dmat4 &to_colours) {
    grid.tint.assign(3 * grid.density.size(), 0.0F);
    oneapi::tbb::parallel_for(0, grid.boxes(), [&](int number) {
        const Grid::Box box = grid.box(number);
        auto at = static_cast<std::size_t>(box.begin);
        for (int z = 0; z < box.size.z; ++z) {
            for (int y = 0; y < box.size.y; ++y) {
                for (int x = 0; x < box.size.x; ++x, ++at) {
                    const float density = grid.density[at];
                    if (density > 0.0F) {
                        const glm::dvec3 middle = glm::dvec3(grid.first + box.first + glm::ivec3(x, y, z)) + 0.5;
                        const glm::dvec3 colour = colour_at(colours, to_colours * glm::dvec4(middle, 1.0));
                        for (int c = 0; c < 3; ++c) {
                            grid.tint[3 * at + static_cast<std::size_t>(c)] = static_cast<float>(density * colour[c]);
                        }
                    }
                }
            }
        }
    });
}

glm::vec3 brightest(const Grid *grid) {
    if (grid == nullptr || grid->tint.empty()) {
        return glm::vec3(1.0F);
    }
    glm::vec3 most(0.0F);
    for (std::size_t at = 0; at < grid->density.size(); ++at) {
        if (grid->density[at] > 0.0F) {
            const float *const rgb = grid->tint.data() + 3 * at;
            most = glm::max(most, glm::vec3(rgb[0], rgb[1], rgb[2]) / grid->density[at]);
        }
    }
    return most;
}

} // namespace sfumato
