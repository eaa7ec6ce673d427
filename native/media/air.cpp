// SPDX-License-Identifier: GPL-3.0-or-later
#include "media/air.hpp"

#include "scene/scene.hpp"

namespace sfumato {

AirView view_of(const Air &air) {
    AirView view;
    view.rayleigh = air.rayleigh * air.shaft_tint;
    view.mie = air.mie * air.shaft_tint;
    view.extinction = air.rayleigh + air.mie + air.absorption;
    view.emission = air.emission;
    view.anisotropy = air.anisotropy;
    view.cornette_shanks = air.cornette_shanks;
    view.per_height = air.scale_height > 0.0F ? 1.0F / air.scale_height : 0.0F;
    view.ground = air.ground;
    view.lit_by = air.visibility.lit_by;
    return view;
}

bool is_grey(const AirView &air) {
    return air.extinction.x == air.extinction.y && air.extinction.y == air.extinction.z;
}

} // namespace sfumato
