// SPDX-License-Identifier: GPL-3.0-or-later
// Phase functions, normalised to one over the sphere.

// Henyey and Greenstein, "Diffuse radiation in the galaxy", 1941. cos_theta is the cosine between the directions in
// which the light travels before and after it scatters: g > 0 sends it on.
float henyey_greenstein(float cos_theta, float g)
{
  float base = 1.0f + g * g - 2.0f * g * cos_theta;
  return 0.0795774715459476679f * (1.0f - g * g) / (base * sqrt(base));
}
