// SPDX-License-Identifier: GPL-3.0-or-later
// A light, apart from the rest of the scene for those who need no more: the kernels.
#pragma once

#include "scene/sky_image.hpp"
#include "scene/visibility.hpp"

#include <array>
#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>

namespace sfumato {

enum class LightKind : std::uint8_t {
    SUN,       // far away; strength: irradiance on a surface that faces it, W/m^2
    SPHERE,    // a point with a radius, and a spot when its cone is narrower than everything; radiant intensity, W/sr
    RECTANGLE, // one-sided, shines along `direction`; radiance, W/(m^2 sr), where it is brightest
    ELLIPSE,   // the same, inscribed in the rectangle
    POLYGON,   // a part of a mesh that glows: shines from both its sides; radiance
    SKY        // all around; strength: 4 pi times the mean radiance, W/m^2
};

// A light as Cycles models it: uniform over its extent, but for a sky. What `strength` means depends on the kind.
struct Light {
    using Kind = LightKind;
    Kind kind = Kind::SUN;
    glm::vec3 strength{1.0F};
    glm::vec3 direction{0.0F, 0.0F, -1.0F}; // the way the light travels, unit length; of a sphere, its cone's axis
    glm::vec3 position{0.0F};               // of the centre; neither a sun's, a polygon's nor a sky's
    glm::vec3 across{0.5F, 0.0F, 0.0F};     // half axes of rectangles and ellipses, at right angles to each other and
    glm::vec3 up{0.0F, 0.5F, 0.0F};         // to the direction; of an oval cone, see there
    float angle = 0.0F;                     // of a sun: angular diameter, radians
    float radius = 0.0F;                    // of a sphere
    float cone = 6.2831853F; // of a sphere: the whole angle of its cone, radians; from 2 pi on it is none
    float blend = 0.0F;      // of a sphere: the share of the cone's 1 - cos(angle) over which it fades in
    // Of a sphere: whether its cone is wider or narrower by way of across and up, in inverse proportion to their
    // lengths.
    bool oval = false;
    // Two habits of older renderers, so that a preview means what they will show: a sphere looks as large as a disk
    // that faces the eye, and a spot dims by the cosine to its axis, too.
    bool facing_disk = false;
    bool spot_cosine = false;
    bool part = false;                  // of a sphere: of a fire, whose other parts blur what it throws
    float spread = 3.1415927F;          // of rectangles and ellipses: the whole angle that they shine into, radians
    std::array<glm::vec3, 4> corners{}; // of a polygon: flat, convex, in turn; of a triangle the last one twice
    int octant = -1;                    // of a sky: an eighth of it, between the planes of the axes; -1 for all of it
    float gain = 1.0F;                  // of a sky's image: by what its radiance is multiplied
    std::shared_ptr<const SkyImage> image; // of a sky, what it looks like; or none: the same from all sides
    Reach reach;
};

} // namespace sfumato
