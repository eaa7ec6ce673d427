// SPDX-License-Identifier: GPL-3.0-or-later
// A particle becomes the rectangle of texels that it covers, and the coefficients that its middle adds: eqs 5-6 of
// Jansen and Bavoil (2010). Its other texels get a share of the same, so all trigonometry is done here.
//
// Attributes: puff, the centre in the space of the light map and the radius in metres; shape, a corner of the rectangle
// in [-1, 1]^2 and the particle's opacity. `metre` is a metre's share of the map along its axes.
//
// The paper's particles are flat. Here, where `extent` is 1 and not 0, one is spread over a slab along the light that
// varies as it does; what of the slab lies outside the map's depths is cut off.

void main()
{
  vec2 axes = puff.w * metre.xy * texels;
  // Sampled at the centres of texels, a narrower puff might be met or missed. Widened, it keeps its total.
  vec2 widened = max(axes, LEAST_RADIUS);
  vec2 corner = clamp(puff.xy + shape.xy * widened / texels, 0.0f, 1.0f);
  gl_Position = vec4(2.0f * corner - 1.0f, 0.0f, 1.0f);

  float reach = extent * PUFF_SLAB * puff.w * metre.z;
  float near_z = clamp(puff.z - reach, 0.0f, 1.0f);
  float far_z = clamp(puff.z + reach, 0.0f, 1.0f);
  float width = far_z - near_z;
  float z = 0.5f * (near_z + far_z);
  float tau = optical_depth_of(shape.z) * (axes.x / widened.x) * (axes.y / widened.y);
  tau *= pick(reach > 0.0f, width / max(2.0f * reach, 1e-30f), 1.0f);
  footprint = vec4(puff.xy * texels, widened);

  Harmonic first = harmonic(1.0f, z);
  Harmonic h = harmonic(float(FIRST), z);
#define WEIGH(layer, target, weight) \
  weight.x = project_cosine(tau, h, factor_of(2 * layer, width)); \
  weight.y = project_sine(tau, h, factor_of(2 * layer, width)); \
  h = next_harmonic(h, first); \
  weight.z = project_cosine(tau, h, factor_of(2 * layer + 1, width)); \
  weight.w = project_sine(tau, h, factor_of(2 * layer + 1, width)); \
  h = next_harmonic(h, first);
  EACH_LAYER(WEIGH)
}
