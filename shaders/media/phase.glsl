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

// The same of light that comes from all of a cap of the sphere alike, by the length of its mean direction, and the cosine
// to that: 1 is one direction. Its first four Legendre moments; with those of the cap, eight caps that make up the sphere
// send as much into each direction, as they must.
float henyey_greenstein_of_cap(float cos_theta, float g, float concentration)
{
  float rim = 2.0f * concentration - 1.0f; // the cosine of the cap's half angle, from the cap's mean, (1 + rim) / 2
  float once = 3.0f * g * concentration * cos_theta;
  float twice = 2.5f * g * g * concentration * rim * (3.0f * cos_theta * cos_theta - 1.0f);
  float thrice = 0.875f * g * g * g * concentration * (5.0f * rim * rim - 1.0f) *
                cos_theta * (5.0f * cos_theta * cos_theta - 3.0f);
  float series = 0.0795774715459476679f * max(1.0f + once + twice + thrice, 0.0f);
  return pick(concentration < 1.0f, series, henyey_greenstein(cos_theta, g));
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
