// SPDX-License-Identifier: GPL-3.0-or-later
// needs: camera light medium phase
// The smoke before the first surface on a view ray, marched through all media at once: single scattering, medium.glsl.
//
// Whoever marches defines, before this text:
//   Colour              one number where all smoke is grey, so that one march serves all colours; else vec3
//   MEDIA               at least media_count(), of bodies of smoke; light_count(), of lights
//   Place               a place between cells, found once for all that is read there
//   leave_knot(t, step, radiance, depth)   what may be kept of the smoke up to the end of a step, t
//   note_step(k, world)   what a step that meets smoke may have to know besides: its number, and its middle
//   Arriving            of one light in a cell: the optical depth towards it, and the share of its falloff that gets past
//                       solids and the edges of its cone (Colour depth, float share)
// and what a medium answers:
//   where it is         to_grid(m, point), along_grid(m, direction), grid_size(m), clearance_at(m, cell)
//   what a step meets   place_at(m, cell), density_at(m, place), longest_step(m) in cells, extinction_of(m)
//   what that scatters  scattering_at(m, place), anisotropy_of(m), light_at(m, place, light)
//   what it emits       emits(m), the same for all rays; glow_at(m, place), in [0, 1], for which emission_row(m, row)
//                       stands, of rows up to last_row(m)
// and a light: is_parallel(light), light_concentration, light_direction, light_position, light_size2, light_strength.

// What lies behind this optical depth adds less than 1e-5 of its radiance: there a march stops.
#define OPAQUE_DEPTH 12.0f

// A ray in the grid of one medium.
struct Crossing {
  vec3 origin;
  vec3 direction;
  Interval inside;
};

struct Smoke {
  vec3 radiance;
  Colour depth; // optical, towards the eye
};

// Of the least opaque colour.
float least(float depth)
{
  return depth;
}
float least(vec3 depth)
{
  return min(min(depth.x, depth.y), depth.z);
}

Crossing crossing_of(int m, Ray ray, float reach)
{
  Crossing crossing;
  crossing.origin = to_grid(m, ray.origin);
  crossing.direction = along_grid(m, ray.direction);
  Interval whole;
  whole.near_t = 0.0f;
  whole.far_t = reach;
  crossing.inside = clip_to_box(whole, crossing.origin, crossing.direction, grid_size(m));
  return crossing;
}

// What a unit of scattering would send to the eye of a light, were there no smoke; `share` is of its falloff.
float incoming_at(int m, int light, float share, vec3 world, vec3 direction)
{
  float incoming = share;
  vec3 travel = light_direction(light);
  if (!is_parallel(light)) {
    vec3 from_light = world - light_position(light);
    float distance2 = dot(from_light, from_light);
    incoming = incoming * falloff(distance2, light_size2(light));
    travel = from_light * inversesqrt(max(distance2, 1e-20f));
  }
  return incoming *
         henyey_greenstein_of_cap(-dot(travel, direction), anisotropy_of(m), light_concentration(light));
}

// What one step through a medium sends to the eye from all lights. `amount` is density times length, tau the optical
// depth of the step in all media.
vec3 scattered_by_medium(int m, Place place, float amount, Colour tau, Colour tau_eye, vec3 world, vec3 direction)
{
  vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  for (int light = 0; light < light_count(); ++light) {
    Arriving arriving = light_at(m, place, light);
    float incoming = incoming_at(m, light, arriving.share, world, direction);
    sum = sum + light_strength(light) * (scattered_by_step(amount, tau, tau_eye, arriving.depth) * incoming);
  }
  return sum * scattering_at(m, place); // grey smoke may still scatter in colours
}

// Per metre, whatever the density.
vec3 emission_at(int m, Place place)
{
  float row = glow_at(m, place) * last_row(m);
  float below = max(min(floor(row), last_row(m) - 1.0f), 0.0f);
  vec3 low = emission_row(m, below);
  return low + (emission_row(m, below + 1.0f) - low) * (row - below);
}

// What a step around t sends to the eye by itself: as light that is scattered, which has crossed nothing. Fire has edges
// of a cell, and goes with the fourth power of what is in the grid: its mean over each half of the step, which may have a
// cell's middle between them, is taken by Gauss and Legendre's rule of two points.
vec3 emitted_by_medium(int m, Crossing crossing, float t, float metres, Colour tau, Colour tau_eye)
{
  vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  for (int point = 0; point < 4; ++point) {
    float half_step = point < 2 ? -0.25f : 0.25f; // its middle
    float away = half_step + (point == 0 || point == 2 ? -0.14433757f : 0.14433757f);
    sum = sum + emission_at(m, place_at(m, crossing.origin + crossing.direction * (t + away * metres)));
  }
  return sum * scattered_by_step(0.25f * metres, tau, tau_eye, Colour(0.0f));
}

Smoke march(Ray ray, float reach)
{
  Crossing crossings[MEDIA];
  float near_t = 1e30f;
  float far_t = 0.0f;
  float longest = 1e30f; // step, metres
  for (int m = 0; m < media_count(); ++m) {
    crossings[m] = crossing_of(m, ray, reach);
    vec3 along = crossings[m].direction;
    Interval inside = crossings[m].inside;
    bool met = inside.near_t < inside.far_t;
    near_t = pick(met, min(near_t, inside.near_t), near_t);
    far_t = pick(met, max(far_t, inside.far_t), far_t);
    longest = pick(met, min(longest, longest_step(m) * inversesqrt(dot(along, along))), longest);
  }
  Smoke smoke;
  smoke.radiance = vec3(0.0f, 0.0f, 0.0f);
  smoke.depth = Colour(0.0f);
  float stretch = max(far_t - near_t, 0.0f);
  near_t = min(near_t, far_t); // so that a lane that meets nothing is at no endless distance
  float steps = pick(stretch > 0.0f, march_steps(stretch, longest), 0.0f);
  float dt = stretch / max(steps, 1.0f);
  float k = 0.0f;
  bool marching = k < steps;
  while (any_lane(marching)) {
    float t = near_t + (k + 0.5f) * dt;
    Place places[MEDIA];
    float amounts[MEDIA];
    float glowing[MEDIA]; // metres
    Colour tau = Colour(0.0f);
    float leap = 1e6f; // steps that surely meet nothing
    bool met_any = k < 0.0f;
    for (int m = 0; m < media_count(); ++m) {
      Crossing crossing = crossings[m];
      amounts[m] = 0.0f;
      glowing[m] = 0.0f;
      bool before = marching && t < crossing.inside.near_t;
      bool inside = marching && t >= crossing.inside.near_t && t <= crossing.inside.far_t;
      float ahead = pick(before, (crossing.inside.near_t - t) / max(dt, 1e-30f) - 1.0f, 1e6f);
      if (any_lane(inside)) {
        vec3 cell = crossing.origin + crossing.direction * t;
        float clear = clearance_at(m, cell);
        bool met = inside && clear < 0.0f;
        if (any_lane(met)) {
          met_any = met_any || met;
          places[m] = place_at(m, cell);
          amounts[m] = pick(inside, density_at(m, places[m]) * dt, 0.0f);
          tau = tau + extinction_of(m) * amounts[m];
          if (emits(m)) {
            glowing[m] = pick(inside, dt, 0.0f);
          }
        }
        vec3 along = crossing.direction;
        float speed = max(max(abs(along.x), abs(along.y)), abs(along.z)) * dt; // cells a step
        ahead = pick(inside, clear / max(speed, 1e-6f), ahead);
      }
      leap = min(leap, ahead);
    }
    if (any_lane(met_any)) {
      vec3 world = ray.origin + ray.direction * t;
      note_step(k, world);
      for (int m = 0; m < media_count(); ++m) {
        if (any_lane(amounts[m] > 0.0f)) {
          smoke.radiance = smoke.radiance + scattered_by_medium(m, places[m], amounts[m], tau, smoke.depth, world, ray.direction);
        }
        if (emits(m)) {
          if (any_lane(glowing[m] > 0.0f)) {
            smoke.radiance = smoke.radiance + emitted_by_medium(m, crossings[m], t, glowing[m], tau, smoke.depth);
          }
        }
      }
      smoke.depth = smoke.depth + tau;
      leave_knot(t + 0.5f * dt, dt, smoke.radiance, smoke.depth);
      leap = 0.0f;
    }
    k = k + 1.0f + floor(lowest_lane(max(leap, 0.0f)));
    marching = k < steps && least(smoke.depth) < OPAQUE_DEPTH;
  }
  return smoke;
}
