// SPDX-License-Identifier: GPL-3.0-or-later
// What a layer of gloss does besides reflecting once: what it leaves to all that lies below it, and what comes of light
// that its facets send to each other.
#pragma once

#include "scene/scene.hpp"

#include <array>

namespace sfumato {

constexpr int CURVE_POINTS = 16;

struct GlossCurves {
    // At cosines to the eye from 0 to 1, in equal steps: the share of what is below that is left; and what the layer's
    // light is to be multiplied by, in each colour: its share of the surface, and more for what its facets lose.
    std::array<float, CURVE_POINTS> left{};
    std::array<std::array<float, CURVE_POINTS>, 3> gain{};
};

GlossCurves gloss_curves(const Gloss &gloss);

// What the curves are made of, where a layer's roughness or colour varies: of light from all sides what is reflected
// for F = 1, and weighted by Fresnel's share, by roughness and by the cosine to the eye, both in equal steps.
struct GlossTable {
    static constexpr int ROUGHNESSES = 16;
    static constexpr float FIRST_ROUGHNESS = 0.1F, LAST_ROUGHNESS = 1.0F;

    std::array<float, ROUGHNESSES * CURVE_POINTS> plain{}, fresnel{}; // by roughness, then by cosine
    std::array<float, ROUGHNESSES> mean{};                            // of plain, over all cosines
    float rise = 0.0F, dip = 0.0F; // the means of Fresnel's share at the edge, and of the dip before it
    float edge = 0.0F;
    bool lossless = false, leaves_rest = false, leaves_all = false;
};

// Of a layer whose index is about that of this one; nothing is read of its colours, roughness and share.
GlossTable gloss_table(const Gloss &gloss);

} // namespace sfumato
