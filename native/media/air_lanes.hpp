// SPDX-License-Identifier: GPL-3.0-or-later
// The world's air on straight ways, in all lanes: of what is at its ground so much, metres.
#pragma once

#include "lights/lights_lanes.hpp"
#include "media/air.hpp"
#include "text/air_text.hpp"
#include "text/lanes.hpp"

namespace sfumato::SFUMATO_ISA {
namespace {

using AirText = text::AirText<Real, Isa>;

// Of a place and of a way, in scale heights.
inline Real height_of(const AirView &air, const vec3 &place) {
    return (place.z - air.ground) * air.per_height;
}

inline Real column_on(const AirView &air, const vec3 &from, const vec3 &direction, Real length) {
    return air.even() ? length : AirText().air_column(height_of(air, from), direction.z * air.per_height, length);
}

// Between a place and one of a light's samples.
inline Real column_to(const AirView &air, const LightView &light, const glm::vec3 &sample, const vec3 &place) {
    if (light.parallel()) {
        return air.even() ? Real(0.0F)
                          : AirText().air_column_above(height_of(air, place), Real(sample.z * air.per_height));
    }
    const vec3 way = broadcast(sample) - place;
    const Real length = sqrt(max(dot(way, way), 1e-30F));
    // Of a ball, what is seen is its surface.
    const Real until = is_ball(light) ? max(AirText().way_to_sphere(length, light.radius), 0.0F) : length;
    return column_on(air, place, way * (1.0F / length), until);
}

// Adds the optical depth of that in each colour.
inline void add_air(const AirView &air, const LightView &light, const glm::vec3 &sample, const vec3 &place, int colours,
                    Real *depth) {
    if (light.parallel() && air.even()) {
        return;
    }
    const Real column = column_to(air, light, sample, place);
    for (int c = 0; c < colours; ++c) {
        depth[c] = depth[c] + min(column * air.extinction[c], 1e4F);
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
