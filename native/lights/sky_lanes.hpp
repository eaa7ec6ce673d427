// SPDX-License-Identifier: GPL-3.0-or-later
// Looking up pictures of skies.
#pragma once

#include "lights/sky.hpp"
#include "text/lanes.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sfumato::SFUMATO_ISA {
namespace {

// Points that share the unit disk evenly, on a spiral (Vogel, "A better way to construct the sunflower head", 1979).
constexpr int FACETS = 32;
struct Spiral {
    std::array<float, FACETS> x{}, y{};
};
inline const Spiral &spiral() {
    static const Spiral points = [] {
        Spiral out;
        for (int k = 0; k < FACETS; ++k) {
            const double radius = std::sqrt((k + 0.5) / FACETS), angle = 2.0 * std::numbers::pi * std::numbers::phi * k;
            out.x[static_cast<std::size_t>(k)] = static_cast<float>(radius * std::cos(angle));
            out.y[static_cast<std::size_t>(k)] = static_cast<float>(radius * std::sin(angle));
        }
        return out;
    }();
    return points;
}

struct SkyPlace {
    Real column, row; // of texels, from the upper left corner of the first
};

inline SkyPlace sky_place(const SkyImageView &image, const vec3 &towards) {
    const Real around = 0.5F - Isa::atan(towards.y, towards.x) * 0.159154943F;
    const Real down = Isa::atan(sqrt(towards.x * towards.x + towards.y * towards.y), towards.z) * 0.318309886F;
    return {around * static_cast<float>(image.width), down * static_cast<float>(image.height)};
}

inline vec3 sky_texel(const SkyImageView &image, Real column, Real row) {
    const Index at = (truncate(row) * Index(image.width) + truncate(column)) * Index(3);
    return {gather(image.rgb, at), gather(image.rgb + 1, at), gather(image.rgb + 2, at)};
}

// That of the texel in a direction.
inline vec3 nearest_in(const SkyImageView &image, const vec3 &towards) {
    const SkyPlace place = sky_place(image, towards);
    return sky_texel(image, clamp(place.column, 0.0F, static_cast<float>(image.width) - 0.5F),
                     clamp(place.row, 0.0F, static_cast<float>(image.height) - 0.5F));
}

// Bilinear between four; beyond a pole lies the other half of its row.
inline vec3 radiance_in(const SkyImageView &image, const vec3 &towards) {
    const SkyPlace place = sky_place(image, towards);
    const float width = static_cast<float>(image.width), last = static_cast<float>(image.height - 1);
    const Real x = place.column - 0.5F, y = place.row - 0.5F;
    const Real left = floor(x), top = floor(y);
    const auto texel = [&](Real column, Real row) {
        const Mask beyond = (row < 0.0F) | (row > last);
        const Real turned = column + pick(beyond, static_cast<float>(image.width / 2), 0.0F);
        const Real within = turned - width * floor(turned * (1.0F / width));
        return sky_texel(image, min(within, width - 1.0F), clamp(row, 0.0F, last));
    };
    const auto between = [&](Real row) {
        const vec3 a = texel(left, row), b = texel(left + 1.0F, row);
        return a + (b - a) * (x - left);
    };
    const vec3 upper = between(top), lower = between(top + 1.0F);
    return upper + (lower - upper) * (y - top);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
