// SPDX-License-Identifier: GPL-3.0-or-later
// The textures of medium NUMBER; addon/gpu/smoke.py puts the number in, once for each medium, since samplers have no index.
//   density_NUMBER    one channel; or where any medium is TINTED, the density times the colour in which it scatters, and
//                     the density
//   light_NUMBER      one light's volume behind the other along z: optical depth towards the light (one colour, or three),
//                     and the share of its falloff that arrives past solids and the edges of its cone
//   clearance_NUMBER  for each brick: negative where smoke may be met, else how many cells are empty around it

float clearance_of_brick_NUMBER(ivec3 brick)
{
  return texelFetch(clearance_NUMBER, clamp(brick, ivec3(0), textureSize(clearance_NUMBER, 0) - 1), 0).x;
}

#ifdef TINTED
float density_at_NUMBER(vec3 place)
{
  return textureLod(density_NUMBER, place, 0.0f).w;
}

vec3 tint_at_NUMBER(vec3 place)
{
  vec4 texel = textureLod(density_NUMBER, place, 0.0f);
  return texel.xyz / max(texel.w, 1e-30f);
}
#else
float density_at_NUMBER(vec3 place)
{
  return textureLod(density_NUMBER, place, 0.0f).x;
}
#endif

// `place` is in [0, 1]^3; half a cell from the ends, where no smoke is, one light's volume must not blend into the next.
vec4 light_in_volume_NUMBER(vec3 place, float light, float lights, float cells)
{
  float z = (clamp(place.z * cells, 0.5f, cells - 0.5f) / cells + light) / lights;
  return textureLod(light_NUMBER, vec3(place.xy, z), 0.0f);
}
