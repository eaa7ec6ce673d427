// SPDX-License-Identifier: GPL-3.0-or-later
// What is kept of a pixel, 22 bytes: in `kept0` ... `kept3`, for each layer its depth in 24 bits and the level of its
// opacity in 8, or 0 where there is none; in `series`, two levels of the tail's harmonic, and two of its range; in `total`,
// the level of the optical depth of all fragments.

uint layer_code(float depth, float tau)
{
  if (depth == NO_DEPTH) {
    return 0u;
  }
  return (uint(depth * FRAGMENT_DEPTHS) << 8u) | uint(opacity_level(1.0f - transmittance_of(tau)));
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 depths = vec4(texelFetch(layer0, pixel, 0).x, texelFetch(layer1, pixel, 0).x, texelFetch(layer2, pixel, 0).x,
                     texelFetch(layer3, pixel, 0).x);
  vec4 taus = texelFetch(layers, pixel, 0);
  vec4 sums = texelFetch(tail, pixel, 0);
  kept0 = layer_code(depths.x, taus.x);
  kept1 = layer_code(depths.y, taus.y);
  kept2 = layer_code(depths.z, taus.z);
  kept3 = layer_code(depths.w, taus.w);
  series = 0u;
  if (sums.x > 0.0f) {
    DepthRange levels = tail_range(texelFetch(nearest, pixel, 0).x, texelFetch(furthest, pixel, 0).x, depths.w);
    series = uint(tail_level(sums.y, 2.0f * sums.x)) | (uint(tail_level(sums.z, 2.0f * sums.x)) << 8u) |
             (uint(levels.low) << 16u) | (uint(levels.high) << 24u);
  }
  total = uint(total_level(dot(taus, vec4(1.0f)) + sums.x));
}
