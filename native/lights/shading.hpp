// SPDX-License-Identifier: GPL-3.0-or-later
// Between the two lane files that share it: surfaces in the light of one light, as many as there are lanes.
#pragma once

#include "lights/light.hpp"
#include "text/dispatch.hpp"

namespace sfumato {

struct ShadingPacket {
    alignas(64) float point[3][MAX_LANES];
    alignas(64) float normal[3][MAX_LANES];  // shading normal, towards the eye
    alignas(64) float tangent[3][MAX_LANES]; // the direction of alpha_x
    alignas(64) float bitangent[3][MAX_LANES];
    alignas(64) float direction[3][MAX_LANES]; // of the view ray
    alignas(64) float alpha_x[MAX_LANES], alpha_y[MAX_LANES], apart[MAX_LANES], index[MAX_LANES];
    bool beckmann = false; // the facets of all lanes

    // For look(): from where, besides `point`, and the place in [0, 1]^2 of a sample on the light. It has what the
    // sample is to diffuse surfaces, and leaves what it is to the gloss.
    alignas(64) float from[3][MAX_LANES];
    alignas(64) float light_u[MAX_LANES], light_v[MAX_LANES];
    alignas(64) float towards[3][MAX_LANES], reach[MAX_LANES], irradiance[MAX_LANES];
    alignas(64) float worth[MAX_LANES]; // what the gloss makes of it, by any number that is one for a lane and light
    alignas(64) float moved[MAX_LANES]; // 1 where gloss looks elsewhere

    // For a light of strength 1: what a white diffuse surface sends to the eye; and what a layer of gloss does, for a
    // reflectance of 1 and for Fresnel's share of it.
    alignas(64) float diffuse[MAX_LANES], plain[MAX_LANES], fresnel[MAX_LANES];
};

namespace SFUMATO_ISA {
void shade_diffuse(const LightView &light, ShadingPacket &packet);
void shade_gloss(const LightView &light, ShadingPacket &packet);
// Moves a sample to where on the light the gloss looks, if that is but a part of the light.
void look(const LightView &light, ShadingPacket &packet);
} // namespace SFUMATO_ISA

} // namespace sfumato
