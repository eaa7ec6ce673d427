// SPDX-License-Identifier: GPL-3.0-or-later
// What a particle adds to the coefficients of one texel: eqs 5-6 of Jansen and Bavoil (2010), which blending sums.
//
// A particle is a puff whose density falls off as 1 - (r / R)^2. Through it, at the share q of R from its centre, runs a
// column of (1 - q^2)^(3/2) times the one through the middle. The paper leaves the profile to a texture.
// With THICK the column is spread over the puff's depth, as a slab with the same variance: half as wide as the chord
// times sqrt(3/5), which is SLAB. Without, it is flat, as in the paper. What lies outside the map's depths is cut off.

void main()
{
  vec2 q = (gl_FragCoord.xy - footprint.xy) / footprint.zw;
  float inside = 1.0f - dot(q, q);
  if (inside <= 0.0f) {
    discard;
  }
  float chord = sqrt(inside);
  float tau = column.z * inside * chord;
  float z = column.x;
#ifdef THICK
  float reach = max(column.y * chord, 1e-6f);
  float near_z = clamp(z - reach, 0.0f, 1.0f);
  float far_z = clamp(z + reach, 0.0f, 1.0f);
  float width = far_z - near_z;
  tau *= width / (2.0f * reach);
  z = 0.5f * (near_z + far_z);
#endif
  Harmonic first = harmonic(1.0f, z);
  Harmonic h = first_of_pass(z);
  vec4 layers[LAYERS];
  for (int j = 0; j < LAYERS; ++j) {
    vec4 pair[2];
    for (int i = 0; i < 2; ++i) {
      float k = float(FIRST + 2 * j + i);
#ifdef THICK
      float thickness = pick(k > 0.0f, slab_factor(k, width), 1.0f);
#else
      float thickness = 1.0f;
#endif
      pair[i] = vec4(project_cosine(tau, h, thickness), project_sine(tau, h, thickness), 0.0f, 0.0f);
      pair[i] *= pick(k > float(HARMONICS), 0.0f, 1.0f);
      h = next_harmonic(h, first);
    }
    layers[j] = vec4(pair[0].xy, pair[1].xy);
  }
  write_layers(layers);
}
