// SPDX-License-Identifier: GPL-3.0-or-later
// Light leaving a diffuse surface.

// Lambert (1760): the radiance per unit irradiance of a surface facing the light. `cosine` is the cosine between the
// shading normal, turned towards the eye, and the direction towards the light.
float diffuse_reflection(float albedo, float cosine)
{
  return albedo * 0.318309886183790672f * max(cosine, 0.0f);
}
