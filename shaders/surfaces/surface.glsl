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

// Of fibres that stand out of a surface, over Lambert's, likewise: what is white only at a grazing reflection (Burley 2012,
// section 5.4, as Cycles has it: times pi).
float sheen(float between)
{
  float half_between = sqrt(clamp(0.5f + 0.5f * between, 0.0f, 1.0f)), miss = 1.0f - half_between, miss2 = miss * miss;
  return 3.14159265f * miss2 * miss2 * miss;
}

// Ashikhmin, Premoze and Shirley, "A microfacet-based BRDF generator", 2000, with an inverse Gaussian of normals and the
// masking of Cook and Torrance (1982).
float velvet(float to_light, float to_eye, float between, float roughness)
{
  float light = max(to_light, 1e-4f), eye = max(to_eye, 1e-4f), wide = max(roughness, 0.01f);
  float along = sqrt(max(0.5f + 0.5f * between, 1e-6f)); // of the half vector and either
  float up = clamp(0.5f * (light + eye) / along, 0.0f, 1.0f), across2 = max(1.0f - up * up, 1e-5f);
  float inverse = 1.0f / (wide * wide);
  float normals = exp(-up * up / across2 * inverse) * inverse / (across2 * across2);
  float masked = min(1.0f, 2.0f * up / along * min(light, eye));
  return 0.25f * normals * masked / (eye * light);
}

// A volume of fibres: Zeltner, Burley and Chiang, "Practical multiple-scattering sheen using linearly transformed cosines",
// 2022: Lambert's lobe (Heitz et al. 2016) stretched and sheared in the plane of the eye and the normal, by what polynomials
// of the cosine to the eye and the roughness, from 0.15 on, make of what Cycles 5.0.1 shows: on the mean within .2 % of
// white, 2.4 % of itself at a roughness of one half. For all that is sent to be 1; addon/export/shading/relief.py has how much that is.
float fibres(float to_light, float to_eye, float between, float roughness)
{
  float c = clamp(to_eye, 0.0f, 1.0f), r = clamp(roughness, 0.15f, 1.0f), light = max(to_light, 0.0f);
  float a0 = 0.050197f + r * (-0.1116f + r * (0.64118f + r * (0.97653f + r * -0.82618f)));
  float a1 = -1.8302f + r * (21.08f + r * (-52.392f + r * (55.297f + r * -21.492f)));
  float a2 = 5.118f + r * (-63.102f + r * (178.06f + r * (-204.15f + r * 82.762f)));
  float a3 = -3.6343f + r * (59.621f + r * (-183.83f + r * (222.15f + r * -93.062f)));
  float a4 = 0.78444f + r * (-18.842f + r * (62.601f + r * (-79.232f + r * 34.235f)));
  float a = a0 + c * (a1 + c * (a2 + c * (a3 + c * a4)));
  float b0 = 0.25352f + r * (-3.0163f + r * (6.83f + r * (-6.3934f + r * 2.3283f)));
  float b1 = -1.8319f + r * (33.279f + r * (-106.09f + r * (122.67f + r * -48.082f)));
  float b2 = -0.90266f + r * (-64.561f + r * (265.82f + r * (-343.96f + r * 143.83f)));
  float b3 = 7.333f + r * (37.647f + r * (-240.55f + r * (350.15f + r * -154.89f)));
  float b4 = -4.9293f + r * (-3.199f + r * (74.173f + r * (-123.05f + r * 57.138f)));
  float b = b0 + c * (b1 + c * (b2 + c * (b3 + c * b4)));
  float wide = max(a, 1e-3f);
  float along = (between - light * c) * inversesqrt(max(1.0f - c * c, 1e-8f));
  float across2 = max(1.0f - light * light - along * along, 0.0f), sheared = wide * along + b * light;
  float length2 = max(sheared * sheared + wide * wide * across2 + light * light, 1e-12f);
  return wide * wide / (length2 * length2);
}
