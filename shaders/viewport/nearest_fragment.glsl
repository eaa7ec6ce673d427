// SPDX-License-Identifier: GPL-3.0-or-later
// What a fragment shows, by what is kept of its pixel: of the layers, or of the tail; and in alpha the weight of each.

void main()
{
  Fragment here = fragment_here();
  Kept pixel = kept_here();
  of_layers = vec4(0.0f);
  of_tail = vec4(0.0f);
  float before = 1.0f;
  for (int layer = 0; layer < 4; ++layer) {
    if (pixel.level[layer] > 0.0f && here.z <= layer_end(pixel.depth[layer])) {
      float seen = seen_in_layer(here.alpha, pixel.level[layer], before);
      of_layers = vec4(seen * here.colour, seen);
      return;
    }
    before *= 1.0f - stored_opacity(pixel.level[layer]);
  }
  uint codes = texelFetch(series, ivec2(gl_FragCoord.xy), 0).x;
  DepthRange levels;
  levels.low = float((codes >> 16u) & 255u);
  levels.high = float(codes >> 24u);
  float d = relative_depth(stored_tail_range(levels, pixel.depth.w), here.z);
  TailDepth depth = tail_depth_step(tail_depth_start(pixel.tail, d), pixel.tail,
                                    eight_bit_ratio(float(codes & 255u)), eight_bit_ratio(float((codes >> 8u) & 255u)),
                                    harmonic(1.0f, d), 1.0f);
  float weight = seen_in_tail(here.alpha, depth, pixel.tail);
  of_tail = vec4(weight * here.colour, weight);
}
