// SPDX-License-Identifier: GPL-3.0-or-later
// Harmonics as the layers of a light map: layer j holds a_2j, b_2j, a_2j+1, b_2j+1. For k = 0 the series' own formulas
// give a_0 and b_0 = 0, so that no harmonic is a special case.
//
// A pass writes as many layers as there are colour targets; viewport_light_map.py defines
//   FIRST      its first harmonic, an even number
//   LAYERS     its number of layers
//   HARMONICS  the map's last harmonic: beyond it a layer holds zeros

Harmonic first_of_pass(float z)
{
#if FIRST == 0
  Harmonic h;
  h.cosine = 1.0f;
  h.sine = 0.0f;
  return h;
#else
  return harmonic(float(FIRST), z);
#endif
}

void write_layers(vec4 layers[LAYERS])
{
  layer0 = layers[0];
#if LAYERS > 1
  layer1 = layers[1];
#endif
#if LAYERS > 2
  layer2 = layers[2];
#endif
#if LAYERS > 3
  layer3 = layers[3];
#endif
#if LAYERS > 4
  layer4 = layers[4];
#endif
#if LAYERS > 5
  layer5 = layers[5];
#endif
}
