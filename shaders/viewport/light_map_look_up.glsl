// SPDX-License-Identifier: GPL-3.0-or-later
// What a light map lets through to where a sprite is: eq 3 of Jansen and Bavoil (2010). Texture `light_map` has the layers
// that addon/gpu/light_maps.py makes; MAP_LAYERS of them.

float light_in_map()
{
  float d = clamp(in_map.z, 0.0f, 1.0f);
  Harmonic first = harmonic(1.0f, d);
  Harmonic h = first;
  vec4 pairs = texture(light_map, vec3(in_map.xy, 0.0f));
  float a0 = pairs.x;
  float tau = integral_constant(a0, d) + integral_harmonic(pairs.z, pairs.w, h, 1.0f);
  for (int layer = 1; layer < MAP_LAYERS; ++layer) {
    pairs = texture(light_map, vec3(in_map.xy, float(layer)));
    h = next_harmonic(h, first);
    tau += integral_harmonic(pairs.x, pairs.y, h, float(2 * layer));
    h = next_harmonic(h, first);
    tau += integral_harmonic(pairs.z, pairs.w, h, float(2 * layer + 1));
  }
  return transmittance_of(clamp_optical_depth(tau, a0));
}
