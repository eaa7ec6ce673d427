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

// The share of diffuse light that is left where a normal is bent, so that it ends softly where the smooth surface turns
// away from the light: Chiang, Li and Burley, "Taming the shadow terminator", 2019. Cosines of the light to the bent and to
// the smooth normal, and between these.
float bent_share(float to_bent, float to_smooth, float between)
{
  float g = clamp(to_smooth / max(to_bent * between, 1e-6f), 0.0f, 1.0f);
  return g * (1.0f + g * (1.0f - g));
}

// Of a matt surface of V-shaped grooves, over Lambert's: Oren and Nayar, "Generalization of Lambert's reflectance model",
// 1994, in the form of Fujii, "A tiny improvement of Oren-Nayar reflectance model", 2012, whose albedo
// Portsmouth, Kutz and Hill ("EON: a practical energy-preserving rough diffuse BRDF", 2025) have in closed form. All
// below are for a roughness in [0, 1].
float grooves(float to_light, float to_eye, float between, float roughness)
{
  float light = clamp(to_light, 0.0f, 1.0f), eye = clamp(to_eye, 0.0f, 1.0f), aside = between - light * eye;
  float less = 0.287793409f * roughness; // (1/2 - 2/(3 pi)) of it
  float kept = pick(aside > 0.0f, aside / max(max(light, eye), 1e-6f), aside);
  return (1.0f + roughness * kept) / (1.0f + less);
}

// The share of light from all sides that one reflection by white grooves sends towards a direction, by its cosine: EON,
// eq 31, within 1e-3.
float grooves_albedo(float cosine, float roughness)
{
  float miss = 1.0f - clamp(cosine, 0.0f, 1.0f);
  float g = miss * (0.0571085289f + miss * (0.491881867f + miss * (-0.332181442f + miss * 0.0714429953f)));
  return (1.0f + roughness * g) / (1.0f + 0.287793409f * roughness);
}

// Its mean over all directions, weighted by their cosines.
float grooves_mean(float roughness)
{
  return (1.0f + 0.0724882124f * roughness) / (1.0f + 0.287793409f * roughness); // 2/3 - 28/(15 pi)
}

// What grooves send on after more than one reflection, over the first one's colour: to be multiplied by
// what both directions' albedos lack to 1. `albedo` is what each further reflection leaves.
float grooves_again(float albedo, float roughness)
{
  float mean = grooves_mean(roughness), lost = 1.0f - mean;
  return albedo * mean / (max(lost, 1e-6f) * (1.0f - albedo * lost));
}
