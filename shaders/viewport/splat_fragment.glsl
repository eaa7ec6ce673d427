// SPDX-License-Identifier: GPL-3.0-or-later
// What a particle adds to the coefficients of one texel; blending sums it up.
//
// Across the light a particle has the profile of a puff (puff.glsl). The paper leaves this to a texture.

void main()
{
  vec2 q = (gl_FragCoord.xy - footprint.xy) / footprint.zw;
  float inside = 1.0f - dot(q, q);
  if (inside <= 0.0f) {
    discard;
  }
  float column = puff_column(inside);
#define ADD(layer, target, weight) target = column * weight;
  EACH_LAYER(ADD)
}
