// SPDX-License-Identifier: GPL-3.0-or-later
// The smoke pass: for each pixel, march the lit volume up to the first surface and darken that surface by the light map.
//
// Textures (viewport.py makes them):
//   surfaces    radiance without smoke, or with OVERLAY the cosine of the sun's angle,
//               in red where solids leave the sun visible; alpha: distance along the ray
//   lit_volume  density, column density towards the sun, share of the sun that solids keep back (0 where not stored)
//   clearance   for each brick of the volume: negative where smoke may be met, else how many cells are empty around it
//   light_map   layer j holds a_2j, b_2j, a_2j+1, b_2j+1, where b_0 = 0
//
// Variants:
//   COLOURS     1 where all colours have the same extinction, so that one march serves them, else 3
//   OVERLAY     the surfaces are Blender's own picture: it is multiplied by `transmittance`, whose alpha tells
//               surfaces (1) from background (0), and `radiance` is added

vec3 spread(float value[COLOURS])
{
#if COLOURS == 1
  return vec3(value[0]);
#else
  return vec3(value[0], value[1], value[2]);
#endif
}

vec3 transform(vec4 row_x, vec4 row_y, vec4 row_z, vec4 place)
{
  return vec3(dot(row_x, place), dot(row_y, place), dot(row_z, place));
}

// Column density of smoke between the sun and a point in the space of the light map.
float column_density(vec3 place)
{
  float margin = min(min(place.x, 1.0f - place.x), min(place.y, 1.0f - place.y));
  if (min(margin, place.z) <= 0.0f) {
    return 0.0f;
  }
  vec4 texel = textureLod(light_map, vec3(place.x, place.y, 0.0f), 0.0f);
  float a0 = texel.x;
  // Behind all smoke, where a floor mostly is, the constant term is the whole answer.
  if (place.z >= 1.0f || a0 <= 0.0f) {
    return 0.5f * max(a0, 0.0f);
  }
  Harmonic first = harmonic(1.0f, place.z);
  Harmonic h = first;
  float harmonics = view.screen.z;
  float column = integral_constant(a0, place.z);
  for (float k = 1.0f; k <= harmonics; k += 2.0f) {
    column += integral_harmonic(texel.z, texel.w, h, k);
    h = next_harmonic(h, first);
    if (k < harmonics) {
      texel = textureLod(light_map, vec3(place.x, place.y, 0.5f * (k + 1.0f)), 0.0f);
      column += integral_harmonic(texel.x, texel.y, h, k + 1.0f);
      h = next_harmonic(h, first);
    }
  }
  return clamp_optical_depth(column, a0);
}

void main()
{
  vec2 uv = gl_FragCoord.xy / view.screen.xy;
  Ray ray = camera_ray(view.near0.xyz, view.near_u.xyz, view.near_v.xyz, view.far0.xyz, view.far_u.xyz, view.far_v.xyz,
                       uv.x, uv.y);
  vec4 surface = texelFetch(surfaces, ivec2(gl_FragCoord.xy), 0);
  float reach = surface.w;
  bool hit = reach < ray.reach * 0.999999f;

  March march[COLOURS];
  for (int c = 0; c < COLOURS; ++c) {
    march[c].optical_depth = 0.0f;
    march[c].scattered = 0.0f;
  }

  vec3 origin = transform(view.grid_x, view.grid_y, view.grid_z, vec4(ray.origin, 1.0f));
  vec3 direction = transform(view.grid_x, view.grid_y, view.grid_z, vec4(ray.direction, 0.0f));
  Interval interval;
  interval.near_t = 0.0f;
  interval.far_t = reach;
  interval = clip_to_box(interval, origin, direction, view.grid.xyz);
  float stretch = interval.far_t - interval.near_t;
  if (stretch > 0.0f) {
    float steps = march_steps(stretch, view.source.w);
    float dt = stretch / steps;
    float speed = max(max(abs(direction.x), abs(direction.y)), abs(direction.z)) * dt; // cells a step
    ivec3 last_brick = textureSize(clearance, 0) - 1;
    float k = 0.0f;
    float clearest = 0.0f;
    while (k < steps && clearest < OPAQUE_DEPTH) {
      vec3 place = origin + direction * (interval.near_t + (k + 0.5f) * dt);
      ivec3 brick = clamp(ivec3(place * view.grid.w), ivec3(0), last_brick);
      float clear = texelFetch(clearance, brick, 0).x;
      k += 1.0f;
      if (clear >= 0.0f) {
        k += floor(clear / speed);
        continue;
      }
      vec4 lit = textureLod(lit_volume, place / view.grid.xyz, 0.0f);
      clearest = OPAQUE_DEPTH;
      for (int c = 0; c < COLOURS; ++c) {
        march[c] = march_step(march[c], view.extinction[c] * lit.x * dt, view.extinction[c] * lit.y, lit.z);
        clearest = min(clearest, march[c].optical_depth);
      }
    }
  }

  float column = 0.0f;
#ifdef OVERLAY
  bool shadowed = surface.x > 0.0f;
#else
  bool shadowed = hit;
#endif
  if (shadowed) {
    vec3 point = ray.origin + ray.direction * reach;
    column = column_density(transform(view.map_x, view.map_y, view.map_z, vec4(point, 1.0f)));
  }

  float to_eye[COLOURS];
  float to_sun[COLOURS];
  float scattered[COLOURS];
  for (int c = 0; c < COLOURS; ++c) {
    to_eye[c] = transmittance_of(march[c].optical_depth);
    to_sun[c] = transmittance_of(view.extinction[c] * column);
    scattered[c] = march[c].scattered;
  }
  float phase = henyey_greenstein(dot(view.sun.xyz, -ray.direction), view.extinction.w);
  vec3 smoke = view.source.xyz * phase * spread(scattered);
#ifdef OVERLAY
  // Light that Blender's picture shows, and light that ought to be there: T_opaque T_map of the sun at its cosine.
  float shown = pick(view.screen.w > 0.5f, surface.x, surface.y);
  vec3 missing = shown - surface.x * spread(to_sun);
  transmittance = vec4(spread(to_eye) * (1.0f - view.sun.w * missing), pick(hit, 1.0f, 0.0f));
  radiance = vec4(smoke, 0.0f);
#else
  float alpha = 1.0f - dot(spread(to_eye), vec3(1.0f / 3.0f));
  radiance = vec4(smoke + spread(to_eye) * surface.xyz * spread(to_sun), pick(hit, 1.0f, alpha));
#endif
}
