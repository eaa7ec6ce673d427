// SPDX-License-Identifier: GPL-3.0-or-later
// Step 3 of Song (2021): what a fragment shows, by its pixel's series; in alpha the weight. `sigma` is the exponent p.

float averaged(vec2 pair, Harmonic h, float k)
{
  return integral_harmonic(pair.x, pair.y, h, k) * sigma_factor(k, float(HARMONICS + 1), sigma);
}

void main()
{
  Fragment here = fragment_here();
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  Harmonic first = harmonic(1.0f, here.z);
  Harmonic h = harmonic(0.0f, here.z);
  float a0 = texelFetch(layer0, pixel, 0).x;
  float tau = integral_constant(a0, here.z);
#define READ(layer, target, weight) \
  { \
    vec4 pairs = texelFetch(target, pixel, 0); \
    if (layer > 0) { \
      tau += averaged(pairs.xy, h, float(2 * layer)); \
    } \
    h = next_harmonic(h, first); \
    if (2 * layer + 1 <= HARMONICS) { \
      tau += averaged(pairs.zw, h, float(2 * layer + 1)); \
    } \
    h = next_harmonic(h, first); \
  }
  EACH_LAYER(READ)
  float seen = seen_of(here.alpha, clamp_optical_depth(tau, a0));
  sums = vec4(seen * here.colour, seen);
}
