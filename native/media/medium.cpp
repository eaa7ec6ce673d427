// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/medium.hpp"

#include "scene/scene.hpp"

#include <algorithm>
#include <limits>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

namespace sfumato {

float CroppedMedium::strongest() const {
    return std::max({extinction.x, extinction.y, extinction.z});
}

ClearanceView CroppedMedium::clearances() const {
    ClearanceView view = grid->clearances();
    view.cells = ramp ? ramp->clearance.data() : view.cells;
    return view;
}

float emptiness(const glm::uvec3 &resolution, const glm::mat4 &grid_to_world, const glm::vec3 &extinction) {
    const float strongest = std::max({extinction.x, extinction.y, extinction.z});
    if (!(strongest > 0.0F)) {
        return std::numeric_limits<float>::infinity();
    }
    const double diagonal =
        glm::length(glm::dvec3(glm::dmat4(grid_to_world) * glm::dvec4(glm::dvec3(resolution), 0.0)));
    return static_cast<float>(1e-4 / (strongest * diagonal));
}

CroppedMedium crop(const Medium &medium) {
    CroppedMedium out;
    out.extinction = medium.scattering + medium.absorption;
    out.scattering = medium.scattering;
    out.anisotropy = medium.anisotropy;
    out.visibility = medium.visibility;
    float threshold = emptiness(medium.resolution, medium.grid_to_world, out.extinction);
    bool clear = threshold == std::numeric_limits<float>::infinity();
    if (medium.transfer) { // whose stops may be anywhere
        threshold = 0.0F;
        clear = clear && !medium.radiated;
    }
    if (clear && medium.emission.empty()) {
        return out;
    }
    out.grid = medium.grid ? medium.grid
                           : crop(medium.density, glm::ivec3(medium.resolution), threshold, Layout::BEST, medium.glow);
    if (!out.grid) {
        return out;
    }
    if (!out.grid->glow.empty()) {
        out.emission = medium.emission;
    } else if (clear) {
        out.grid = nullptr;
        return out;
    }
    const glm::dmat4 to_world(medium.grid_to_world);
    out.grid_to_world = glm::translate(to_world, glm::dvec3(out.grid->first));
    out.cell_size = std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis) {
        out.cell_size = std::min(out.cell_size, glm::length(glm::dvec3(to_world[axis])));
    }
    return out;
}

void classify(CroppedMedium &cropped, const Medium &medium, std::span<const glm::vec2> ranges) {
    if (medium.transfer) {
        cropped.ramp = std::make_shared<const MediumRamp>(
            ramp_of(*medium.transfer, medium.radiated.get(), ranges, cropped.grid->bricks));
    }
}

} // namespace sfumato
