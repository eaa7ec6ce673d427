// SPDX-License-Identifier: GPL-3.0-or-later
// The optical depth of the nearest layers, and the series of the tail, by blending. Textures layer0 ... layer3, nearest and
// furthest have depths; where there is none, NO_DEPTH.

void main()
{
  Fragment here = fragment_here();
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 depths = vec4(texelFetch(layer0, pixel, 0).x, texelFetch(layer1, pixel, 0).x, texelFetch(layer2, pixel, 0).x,
                     texelFetch(layer3, pixel, 0).x);
  layers = vec4(0.0f);
  tail = vec4(0.0f);
  for (int layer = 0; layer < 4; ++layer) {
    if (depths[layer] < NO_DEPTH && here.z <= layer_end(depths[layer])) {
      layers[layer] = here.tau;
      return;
    }
  }
  float last = depths.w;
  DepthRange range = stored_tail_range(
      tail_range(texelFetch(nearest, pixel, 0).x, texelFetch(furthest, pixel, 0).x, last), last);
  Harmonic h = harmonic(1.0f, relative_depth(range, here.z));
  tail = vec4(here.tau, project_cosine(here.tau, h, 1.0f), project_sine(here.tau, h, 1.0f), 0.0f);
}
