// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of light, apart from the rest of the scene for those who need no more: the kernels.
#pragma once

#include <cstdint>

namespace sfumato {

enum class LightKind : std::uint8_t {
    SUN,       // far away; strength: irradiance on a surface that faces it, W/m^2
    SPHERE,    // a point with a radius, and a spot when its cone is narrower than everything; radiant intensity, W/sr
    RECTANGLE, // one-sided, shines along `direction`; radiance, W/(m^2 sr), where it is brightest
    ELLIPSE,   // the same, inscribed in the rectangle
    POLYGON    // a part of a mesh that glows: shines from both its sides; radiance
};

} // namespace sfumato
