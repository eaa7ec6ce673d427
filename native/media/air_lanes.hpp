// SPDX-License-Identifier: GPL-3.0-or-later
// The world's air on straight ways, in all lanes: of what is at its ground so much, metres.
#pragma once

#include "lights/lights_lanes.hpp"
#include "media/air.hpp"
#include "text/lanes.hpp"
#include "text/media_text.hpp"

#include <algorithm>
#include <limits>

namespace sfumato::SFUMATO_ISA {
namespace {

// (1 - exp(-x)) / x, the mean of what is left over a stretch of optical depth x; for negative x, too.
inline Real mean_left(Real x) {
    const Real series = 1.0F - x * (0.5F - x * (1.0F / 6.0F - x * (1.0F / 24.0F)));
    return pick(abs(x) < 0.03F, series, (1.0F - exp(-x)) / pick(abs(x) < 0.03F, 1.0F, x));
}

inline Real density_of(const AirView &air, Real z) {
    constexpr float MOST = 60.0F; // the exponent of what is far below the ground
    return air.per_height > 0.0F ? exp(min((air.ground - z) * air.per_height, MOST)) : Real(1.0F);
}

inline Real amount_on(const AirView &air, const vec3 &from, const vec3 &direction, Real length) {
    if (air.per_height == 0.0F) {
        return length;
    }
    const Real rise = clamp(direction.z * length * air.per_height, -60.0F, 1e30F);
    return density_of(air, from.z) * length * mean_left(rise);
}

// Between a place and one of a light's samples. The irradiance of suns is that which arrives: even air dims none.
inline Real amount_to(const AirView &air, const LightView &light, const glm::vec3 &sample, const vec3 &place) {
    constexpr float ENDLESS = 1e30F;
    if (!light.parallel()) {
        const vec3 way = broadcast(sample) - place;
        const Real length = sqrt(max(dot(way, way), 1e-30F));
        return amount_on(air, place, way * (1.0F / length), length);
    }
    if (air.per_height == 0.0F) {
        return 0.0F;
    }
    return sample.z > 0.0F ? density_of(air, place.z) * (1.0F / (air.per_height * sample.z)) : Real(ENDLESS);
}

// Adds the optical depth of that in each colour.
inline void add_air(const AirView &air, const LightView &light, const glm::vec3 &sample, const vec3 &place, int colours,
                    Real *depth) {
    if (light.parallel() && air.per_height == 0.0F) {
        return;
    }
    const Real amount = amount_to(air, light, sample, place);
    for (int c = 0; c < colours; ++c) {
        depth[c] = depth[c] + min(amount * air.extinction[c], 1e4F);
    }
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
