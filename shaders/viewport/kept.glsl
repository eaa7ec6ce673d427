// SPDX-License-Identifier: GPL-3.0-or-later
// What keep_fragment.glsl kept of this pixel: textures `kept0` ... `kept3`, `series` and `total`.

struct Kept {
  vec4 depth;
  vec4 level;
  float all;    // optical depth
  float passed; // transmittance of all layers
  float tail;   // optical depth of the tail
};

Kept kept_here()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uvec4 codes = uvec4(texelFetch(kept0, pixel, 0).x, texelFetch(kept1, pixel, 0).x, texelFetch(kept2, pixel, 0).x,
                      texelFetch(kept3, pixel, 0).x);
  Kept here;
  here.depth = vec4(codes >> 8u) / FRAGMENT_DEPTHS;
  here.level = vec4(codes & 255u);
  here.all = stored_total(float(texelFetch(total, pixel, 0).x));
  here.passed = 1.0f;
  float layers = 0.0f;
  for (int layer = 0; layer < 4; ++layer) {
    float alpha = stored_opacity(here.level[layer]);
    here.passed *= 1.0f - alpha;
    layers += optical_depth_of(alpha);
  }
  here.tail = tail_total(here.all, layers);
  return here;
}
