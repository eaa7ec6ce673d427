// SPDX-License-Identifier: GPL-3.0-or-later
// Light leaving a diffuse surface that is not Lambert's.

// What a rough or a smooth surface sends more or less of than one of Lambert's (1760) does, towards its rim: Burley,
// "Physically Based Shading at Disney", 2012, section 5.3. Cosines of the light and of the eye to the normal, and of the
// angle between both. A negative roughness: nothing.
float diffuse_rim(float to_light, float to_eye, float between, float roughness)
{
  float miss_light = 1.0f - clamp(to_light, 0.0f, 1.0f), miss_eye = 1.0f - clamp(to_eye, 0.0f, 1.0f);
  float light2 = miss_light * miss_light, eye2 = miss_eye * miss_eye;
  float fresnel_light = light2 * light2 * miss_light, fresnel_eye = eye2 * eye2 * miss_eye;
  // F_D90 - 1, where the square of the cosine to the half vector is (1 + between) / 2.
  float edge = roughness * (1.0f + between) - 0.5f;
  float rim = (1.0f + edge * fresnel_light) * (1.0f + edge * fresnel_eye);
  return pick(roughness < 0.0f, 1.0f, rim);
}
