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
    bool beckmann = false;                   // the facets of all lanes
    alignas(64) float towards[3][MAX_LANES]; // for weigh_gloss()

    // For a light of strength 1: what a white diffuse surface sends to the eye; and what a layer of gloss does, for a
    // reflectance of 1 and for Fresnel's share of it.
    alignas(64) float diffuse[MAX_LANES], plain[MAX_LANES], fresnel[MAX_LANES];
};

namespace SFUMATO_ISA {
void shade_diffuse(const LightView &light, ShadingPacket &packet);
void shade_gloss(const LightView &light, ShadingPacket &packet);
// The BRDF of the gloss times the cosine, for a reflectance of 1 and the direction `towards`, into `plain`.
void weigh_gloss(ShadingPacket &packet);
} // namespace SFUMATO_ISA

} // namespace sfumato
