// SPDX-License-Identifier: GPL-3.0-or-later
// What takes light on its way, as light maps see it: a grid, particles, or whatever else has a column density along a
// light ray.
#pragma once

#include "scene/kept.hpp"
#include "scene/visibility.hpp"
#include "text/dispatch.hpp"

#include <array>
#include <functional>
#include <optional>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sfumato {

struct CroppedMedium; // media/medium.hpp
struct LightMap;      // maps/light_map.hpp
class Surfaces;       // solids/surfaces.hpp

struct Body {
    // A box of cells around it, as fine as its shadow.
    glm::dmat4 cells_to_world{1.0};
    glm::dvec3 cells{0.0};
    double cell_size = 0.0;     // the shortest edge, metres
    glm::vec3 extinction{0.0F}; // per unit of column density
    float anisotropy = 0.0F;    // of its phase function
    Visibility visibility;
    bool takes_light = true; // else it only glows, and no light is asked about it
    bool scatters = true;    // else no light is asked what it is worth in it: hair
    bool clear = false;      // of its light rays only solids are known: the world's air
    bool followed = false;   // the camera's rays are followed across its maps: air and fog
    // What its columns are made of; and a plan's map of them. Both may be called on any thread, at any later time.
    std::function<void(Key &)> identify;
    std::function<LightMap(LightMap plan, const InstructionSet &with)> project;

    [[nodiscard]] bool grey() const { return extinction.x == extinction.y && extinction.y == extinction.z; }
    [[nodiscard]] std::array<glm::dvec3, 8> corners() const;
};

Body body_of(const CroppedMedium &medium);

// What throws shadows in the world's air, as a body whose light maps know solids alone, and have so many texels along
// its longer side; none where there is neither a solid nor a body.
std::optional<Body> air_body(const Surfaces &surfaces, std::span<const Body> bodies, int texels);

// A sphere around a body.
struct Ball {
    glm::dvec3 middle{0.0};
    double radius = 0.0;
};
Ball ball_of(const Body &body);

} // namespace sfumato
