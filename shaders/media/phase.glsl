// SPDX-License-Identifier: GPL-3.0-or-later
// Phase functions, normalised to one over the sphere. cos_theta is the cosine between the directions in which the light
// travels before and after it scatters. Where a peak of less than a degree must keep its digits, the angle is given by
// the squares of half its sine and cosine, each with digits of its own.

// Henyey and Greenstein, "Diffuse radiation in the galaxy", 1941: g > 0 sends the light on.
float henyey_greenstein(float cos_theta, float g)
{
  float base = 1.0f + g * g - 2.0f * g * cos_theta;
  return 0.0795774715459476679f * (1.0f - g * g) / (base * sqrt(base));
}

float henyey_greenstein(float half_sine2, float half_cosine2, float g)
{
  float base = (1.0f - g) * (1.0f - g) * half_cosine2 + (1.0f + g) * (1.0f + g) * half_sine2;
  return 0.0795774715459476679f * (1.0f - g) * (1.0f + g) / (base * sqrt(base));
}

// Of molecules.
float rayleigh(float cos_theta)
{
  return 0.0596831036594607509f * (1.0f + cos_theta * cos_theta);
}

// Cornette and Shanks, "Physically reasonable analytic expression for the single-scattering phase function", 1992: it
// becomes Rayleigh's where g = 0.
float cornette_shanks(float half_sine2, float half_cosine2, float g)
{
  float cos_theta = half_cosine2 - half_sine2;
  return henyey_greenstein(half_sine2, half_cosine2, g) * 1.5f * (1.0f + cos_theta * cos_theta) / (2.0f + g * g);
}
