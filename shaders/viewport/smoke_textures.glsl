// SPDX-License-Identifier: GPL-3.0-or-later
// The textures of medium NUMBER; addon/gpu/smoke.py puts the number in, once for each medium, since samplers have no index.
//   density_NUMBER    one channel; or where any medium is TINTED, the density times the colour in which it scatters, and
//                     the density; where any medium is EMITTING, what glows behind it along z, last in the texel
//   light_NUMBER      one light's volume behind the other along z: optical depth towards the light (one colour, or three),
//                     and the share of its falloff that arrives past solids and the edges of its cone
//   clearance_NUMBER  for each brick: negative where smoke may be met, else how many cells are empty around it

#ifndef LAST_OF
#  ifdef TINTED
#    define LAST_OF(v) (v).w
#  else
#    define LAST_OF(v) (v).x
#  endif
// Where a place in [0, 1]^3 lies in one of several volumes behind each other along z. Half a cell from the ends, where no
// smoke is, one must not blend into the next.
vec3 in_stack(vec3 place, float which, float volumes, float cells)
{
  return vec3(place.xy, (clamp(place.z * cells, 0.5f, cells - 0.5f) / cells + which) / volumes);
}
#endif

float clearance_of_brick_NUMBER(ivec3 brick)
{
  return texelFetch(clearance_NUMBER, clamp(brick, ivec3(0), textureSize(clearance_NUMBER, 0) - 1), 0).x;
}

#ifdef EMITTING
vec4 cell_of_NUMBER(vec3 place, float which)
{
  float cells = 0.5f * float(textureSize(density_NUMBER, 0).z);
  return textureLod(density_NUMBER, in_stack(place, which, 2.0f, cells), 0.0f);
}

float glow_at_NUMBER(vec3 place)
{
  return LAST_OF(cell_of_NUMBER(place, 1.0f));
}
#else
vec4 cell_of_NUMBER(vec3 place, float which)
{
  return textureLod(density_NUMBER, place, 0.0f);
}
#endif

float density_at_NUMBER(vec3 place)
{
  return LAST_OF(cell_of_NUMBER(place, 0.0f));
}

#ifdef TINTED
vec3 tint_at_NUMBER(vec3 place)
{
  vec4 texel = cell_of_NUMBER(place, 0.0f);
  return texel.xyz / max(texel.w, 1e-30f);
}
#endif

vec4 light_in_volume_NUMBER(vec3 place, float light, float lights, float cells)
{
  return textureLod(light_NUMBER, in_stack(place, light, lights, cells), 0.0f);
}
