// SPDX-License-Identifier: GPL-3.0-or-later
// The fragment that is drawn here; what is nothing is discarded.
//
// A sprite is a puff (puff.glsl). Among triangles it is cut into slices, each of which stands in its own middle: a triangle
// that passes through it meets them one by one. Hair covers the share of a pixel's surroundings that it does in the
// pictures of the processor (native/frame/strands_lanes.cpp).
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

// Of what a pixel sees within STRIP_REACH pixels.
float cover_of_strip()
{
  vec2 edges = clamp(0.5f + (spot.x + vec2(-spot.y, spot.y)) * (0.5f / STRIP_REACH), 0.0f, 1.0f);
  return filter_share(edges.y) - filter_share(edges.x);
}

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
  here.tau = slice.w;
  if (sprite) {
    here.tau *= puff_column(inside) * (puff_before(end) - puff_before(slice.y));
  }
  else if (spot.y > 0.0f) {
    here.tau = optical_depth_of((1.0f - transmittance_of(here.tau)) * cover_of_strip());
  }
  if (here.tau <= 0.0f) {
    discard;
  }
  here.z = fragment_depth((distance_here - view.depths.x) * view.depths.y);
  here.alpha = 1.0f - transmittance_of(here.tau);
  here.colour = sent;
#ifdef LIT
  here.colour *= light_in_map();
#endif
  return here;
}
