// SPDX-License-Identifier: GPL-3.0-or-later
// The fragment that is drawn here; what is nothing is discarded.
//
// A sprite is a puff (puff.glsl). Among triangles it is cut into slices, each of which stands in its own middle: a triangle
// that passes through it meets them one by one.
//
// Variants:
//   SOLIDS  texture `solids` has the distance along the view of what is opaque, which cuts what stands in it
//   LIT     what falls on sprites is looked up in a light map

struct Fragment {
  float z;
  float tau;
  float alpha;
  vec3 colour;
};

Fragment fragment_here()
{
  bool sprite = slice.x > 0.0f;
  float inside = sprite ? 1.0f - dot(spot.xy, spot.xy) : 1.0f;
  if (inside <= 0.0f) {
    discard;
  }
  float chord = slice.x * sqrt(inside); // half of it
  float distance_here = spot.z + 0.5f * (slice.y + slice.z) * chord;
  float end = slice.z;
#ifdef SOLIDS
  float solid = texelFetch(solids, ivec2(gl_FragCoord.xy), 0).x;
  if (sprite) {
    end = clamp((solid - spot.z) / max(chord, 1e-20f), slice.y, slice.z);
  }
  else if (solid <= distance_here) {
    discard;
  }
#endif
  Fragment here;
  here.tau = matter.w;
  if (sprite) {
    here.tau *= puff_column(inside) * (puff_before(end) - puff_before(slice.y));
  }
  if (here.tau <= 0.0f) {
    discard;
  }
  here.z = fragment_depth((distance_here - view.depths.x) * view.depths.y);
  here.alpha = 1.0f - transmittance_of(here.tau);
  here.colour = matter.xyz;
#ifdef LIT
  here.colour *= light_in_map();
#endif
  return here;
}
