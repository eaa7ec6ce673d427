// SPDX-License-Identifier: GPL-3.0-or-later
// What a particle adds to the coefficients of one texel; blending sums it up.
//
// Across the light a particle has the profile of a puff whose density falls off as 1 - (r / R)^2: through it, at the
// share q of R from its centre, runs (1 - q^2)^(3/2) of the column through the middle. The paper leaves this to a
// texture.

void main()
{
  vec2 q = (gl_FragCoord.xy - footprint.xy) / footprint.zw;
  float inside = 1.0f - dot(q, q);
  if (inside <= 0.0f) {
    discard;
  }
  float column = inside * sqrt(inside);
#define ADD(layer, target, weight) target = column * weight;
  EACH_LAYER(ADD)
}
