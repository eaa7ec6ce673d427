// SPDX-License-Identifier: GPL-3.0-or-later
// Step 2 of Song (2021): what a fragment adds to the layers of its pixel's series (light_map_layers.glsl), by blending.

void main()
{
  Fragment here = fragment_here();
  Harmonic first = harmonic(1.0f, here.z);
  Harmonic h = harmonic(float(FIRST), here.z);
#define ADD(layer, target, weight) \
  target.x = project_cosine(here.tau, h, factor_of(2 * layer, 0.0f)); \
  target.y = project_sine(here.tau, h, factor_of(2 * layer, 0.0f)); \
  h = next_harmonic(h, first); \
  target.z = project_cosine(here.tau, h, factor_of(2 * layer + 1, 0.0f)); \
  target.w = project_sine(here.tau, h, factor_of(2 * layer + 1, 0.0f)); \
  h = next_harmonic(h, first);
  EACH_LAYER(ADD)
}
