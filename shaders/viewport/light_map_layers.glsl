// SPDX-License-Identifier: GPL-3.0-or-later
// Harmonics as the layers of a light map: layer j holds a_2j, b_2j, a_2j+1, b_2j+1. For k = 0 the series' own formulas
// give a_0 and b_0 = 0, so that no harmonic is a special case.
//
// A pass writes as many layers as there are colour targets; addon/gpu/light_maps.py defines
//   FIRST          its first harmonic, an even number
//   LAYERS         its number of layers
//   HARMONICS      the map's last harmonic: beyond it a layer holds zeros
//   EACH_LAYER(f)  f(0, layer0, weight0) f(1, layer1, weight1) ..., for the layers of the pass

// slab_factor() of a harmonic of the pass; zero for one that the map has not.
float factor_of(int number, float width)
{
  float k = float(FIRST + number);
  return pick(k > float(HARMONICS), 0.0f, pick(k > 0.0f, slab_factor(k, width), 1.0f));
}
