// SPDX-License-Identifier: GPL-3.0-or-later
// needs: camera march medium preintegration ramp
// The march of march.glsl where a medium's density is a transfer function of its grid. Each ray takes steps of its own:
// none is longer than that of march(), and in a medium that splits() none crosses a plane through the centres of cells,
// between which trilinear smoke is a cubic along a ray. Other media are met in the middle of each step.
//
// A medium answers besides: classified(m), whether it has a transfer function; splits(m), both for all rays alike; and
// light_along(m, place, world, light), what arrives of a light at a place that need not be a cell.

// How far ahead of where a step ended it begins to look, in cells: so that it is behind the plane that it ended at.
#define BEHIND_PLANE 1e-3f

// From x on to the next multiple of `spacing`.
float to_plane(float x, float along, float spacing)
{
  float place = x / spacing;
  float above = place - floor(place);
  float way = pick(along > 0.0f, 1.0f - above, pick(above > 0.0f, above, 1.0f));
  return way * spacing / max(abs(along), 1e-20f);
}

float to_planes(vec3 p, vec3 along, float spacing)
{
  return min(min(to_plane(p.x, along.x, spacing), to_plane(p.y, along.y, spacing)), to_plane(p.z, along.z, spacing));
}

// What rounding leaves of nothing is nothing.
float positive(float depth)
{
  return max(depth, 0.0f);
}
vec3 positive(vec3 depth)
{
  return vec3(positive(depth.x), positive(depth.y), positive(depth.z));
}

float fastest(vec3 along)
{
  return max(max(abs(along.x), abs(along.y)), abs(along.z));
}

// What all lights send to the eye by a unit of scattering at t.
vec3 lit_by_all(int m, Crossing crossing, Ray ray, float t)
{
  Place place = place_at(m, crossing.origin + crossing.direction * t);
  vec3 world = ray.origin + ray.direction * t;
  // Neither a step nor smoke before the eye dims it: scattered_by_step() of nothing.
  vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  for (int light = 0; light < light_count(); ++light) {
    Arriving arriving = light_along(m, place, world, light);
    sum = sum + light_strength(light) * (incoming_at(m, light, arriving.share, world, ray.direction) *
                                         scattered_by_step(1.0f, Colour(0.0f), Colour(0.0f), arriving.depth));
  }
  return sum;
}

Cubic cubic_between(int m, Crossing crossing, float t, float metres, float front, float back)
{
  Cubic cubic;
  if (splits(m)) {
    float third = metres * (1.0f / 3.0f);
    cubic = cubic_through(front, density_at(m, place_at(m, crossing.origin + crossing.direction * (t + third))),
                          density_at(m, place_at(m, crossing.origin + crossing.direction * (t + 2.0f * third))), back);
  } else {
    cubic.c0 = front;
    cubic.c1 = back - front;
    cubic.c2 = 0.0f;
    cubic.c3 = 0.0f;
  }
  return cubic;
}

Lit lit_between(int m, Crossing crossing, Ray ray, float t, float metres)
{
  Lit lit;
  lit.front = lit_by_all(m, crossing, ray, t);
  lit.middle = lit_by_all(m, crossing, ray, t + 0.5f * metres);
  lit.back = lit_by_all(m, crossing, ray, t + metres);
  return lit;
}

// The part of a stretch's lights from u on, `share` of it long.
Lit part_of_lit(Lit lit, float u, float share)
{
  Lit part;
  part.front = lit_at(lit, u);
  part.middle = lit_at(lit, u + 0.5f * share);
  part.back = lit_at(lit, u + share);
  return part;
}

// A step on which s is a cubic: cut where that turns, and where it meets a stop. Light may change within a part no less
// than s does: where steps are split, it is asked for in each.
Sent sent_by_step(int m, Crossing crossing, Ray ray, Cubic cubic, float t, float metres, Colour beside)
{
  Turns turns = turns_of(cubic);
  Sent sent;
  sent.radiance = vec3(0.0f, 0.0f, 0.0f);
  sent.depth = Colour(0.0f);
  Colour before = Colour(0.0f); // the depth with what is beside
  Lit whole;
  if (!splits(m)) {
    whole = lit_between(m, crossing, ray, t, metres);
  }
  float number = part_of(m, cubic_at(cubic, 0.0f));
  float u = 0.0f;
  for (int k = 0; k < 4096 && any_lane(u < 1.0f); ++k) {
    Part part = part_at(m, number);
    float end = pick(u < turns.first, turns.first, pick(u < turns.second, turns.second, 1.0f));
    float there = cubic_at(cubic, end);
    bool above = there > part.place.y;
    bool below = there < part.place.x;
    if (any_lane(above || below)) {
      float met = cubic_crossing(cubic, u, end, pick(above, part.place.y, part.place.x));
      end = pick(above || below, clamp(met, u, end), end);
    }
    float share = end - u;
    Colour next = before + beside * share;
    if (any_lane(part.density.z > 0.0f && share > 0.0f && metres > 0.0f)) {
      Lit lit;
      if (splits(m)) {
        lit = lit_between(m, crossing, ray, t + metres * u, metres * share);
      } else {
        lit = part_of_lit(whole, u, share);
      }
      Stretch amounts = amounts_of(part, cubic, u, share, metres, scattering_of(m), lit);
      sent.radiance = sent.radiance + dimmed(sent_through(amounts, extinction_of(m), beside * share), before);
      Colour depth = extinction_of(m) * max(depth_of(amounts), 0.0f);
      sent.depth = sent.depth + depth;
      next = next + depth;
    }
    before = next;
    number = number + pick(above, 1.0f, pick(below, -1.0f, 0.0f));
    u = end;
  }
  return sent;
}

// Nothing is asked of lights where all of a step's values are in parts that hold nothing.
Sent sent_by_classified(int m, Crossing crossing, Ray ray, Cubic cubic, float t, float metres, Colour beside)
{
  Sent sent;
  sent.radiance = vec3(0.0f, 0.0f, 0.0f);
  sent.depth = Colour(0.0f);
  Turns turns = turns_of(cubic);
  float s0 = cubic_at(cubic, 0.0f);
  float s1 = cubic_at(cubic, turns.first);
  float s2 = cubic_at(cubic, turns.second);
  float s3 = cubic_at(cubic, 1.0f);
  float low = min(min(s0, s1), min(s2, s3));
  float high = max(max(s0, s1), max(s2, s3));
  if (any_lane(metres > 0.0f && holds_any(m, low, high))) {
    sent = sent_by_step(m, crossing, ray, cubic, t, metres, beside);
  }
  return sent;
}

Smoke march_ramped(Ray ray, float reach)
{
  Crossing crossings[MEDIA];
  float held[MEDIA];    // what the grid held where the last step ended,
  float held_at[MEDIA]; // there
  float near_t = 1e30f;
  float far_t = 0.0f;
  float longest = 1e30f; // step, metres
  for (int m = 0; m < media_count(); ++m) {
    crossings[m] = crossing_of(m, ray, reach);
    held[m] = 0.0f;
    held_at[m] = -1.0f;
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
  near_t = min(near_t, far_t);
  float dt = stretch / max(march_steps(stretch, longest), 1.0f);
  float t = near_t;
  bool marching = t < far_t;
  while (any_lane(marching)) {
    float end = far_t; // of the step, or of a leap
    float meets[MEDIA]; // 1, or 0
    bool met_any = t < -1.0f;
    for (int m = 0; m < media_count(); ++m) {
      Crossing crossing = crossings[m];
      float speed = fastest(crossing.direction);
      float behind = t + max(BEHIND_PLANE / max(speed, 1e-20f), t * 4e-7f);
      bool before = t < crossing.inside.near_t;
      bool inside = marching && t >= crossing.inside.near_t && t < crossing.inside.far_t;
      float limit = pick(before && crossing.inside.near_t < crossing.inside.far_t, crossing.inside.near_t, 1e30f);
      meets[m] = 0.0f;
      if (any_lane(inside)) {
        vec3 cell = crossing.origin + crossing.direction * behind;
        float clear = clearance_at(m, cell);
        bool met = inside && clear < 0.0f;
        meets[m] = pick(met, 1.0f, 0.0f);
        met_any = met_any || met;
        // Smoke may begin as far behind the end of this brick as there is none from anywhere in it.
        float leap = behind + to_planes(cell, crossing.direction, 4.0f) + clear / max(speed, 1e-20f);
        float plane = 1e30f;
        if (classified(m) && splits(m)) {
          plane = behind + to_planes(cell - vec3(0.5f, 0.5f, 0.5f), crossing.direction, 1.0f);
        }
        limit = pick(inside, min(pick(met, plane, leap), crossing.inside.far_t), limit);
      }
      end = min(end, max(limit, behind));
    }
    // Far from the eye a step may be less than what changes t.
    end = pick(met_any, min(end, t + max(dt, t * 4e-7f)), end);
    end = pick(marching, min(end, far_t), t);
    if (any_lane(met_any)) {
      float metres = pick(met_any, end - t, 0.0f);
      float middle = t + 0.5f * metres;
      float amounts[MEDIA];
      float fronts[MEDIA];
      Place places[MEDIA];
      Colour tau = Colour(0.0f);
      for (int m = 0; m < media_count(); ++m) {
        amounts[m] = 0.0f;
        fronts[m] = 0.0f;
        if (any_lane(meets[m] > 0.0f)) {
          Crossing crossing = crossings[m];
          if (classified(m)) {
            fronts[m] = held[m];
            if (any_lane(meets[m] > 0.0f && held_at[m] != t)) {
              fronts[m] = density_at(m, place_at(m, crossing.origin + crossing.direction * t));
            }
            held[m] = density_at(m, place_at(m, crossing.origin + crossing.direction * end));
            held_at[m] = end;
            if (media_count() > 1) {
              amounts[m] = meets[m] * metres * mean_density(m, fronts[m], held[m]);
            }
          } else {
            places[m] = place_at(m, crossing.origin + crossing.direction * middle);
            amounts[m] = meets[m] * metres * density_at(m, places[m]);
          }
          tau = tau + extinction_of(m) * amounts[m];
        }
      }
      vec3 radiance = vec3(0.0f, 0.0f, 0.0f);
      Colour depth = Colour(0.0f);
      vec3 world = ray.origin + ray.direction * middle;
      for (int m = 0; m < media_count(); ++m) {
        if (any_lane(meets[m] > 0.0f)) {
          if (classified(m)) {
            Cubic cubic = cubic_between(m, crossings[m], t, metres, fronts[m], held[m]);
            Colour beside = positive(tau - extinction_of(m) * amounts[m]);
            Sent sent = sent_by_classified(m, crossings[m], ray, cubic, t, meets[m] * metres, beside);
            radiance = radiance + dimmed(sent.radiance, smoke.depth);
            depth = depth + sent.depth;
          } else {
            radiance = radiance + scattered_by_medium(m, places[m], amounts[m], tau, smoke.depth, world, ray.direction);
            depth = depth + extinction_of(m) * amounts[m];
          }
          if (emits(m)) {
            radiance = radiance + emitted_by_medium(m, crossings[m], middle, meets[m] * metres, tau, smoke.depth);
          }
        }
      }
      smoke.radiance = smoke.radiance + radiance;
      smoke.depth = smoke.depth + depth;
      leave_knot(end, end - t, smoke.radiance, smoke.depth);
    }
    t = end;
    marching = t < far_t && least(smoke.depth) < OPAQUE_DEPTH;
  }
  return smoke;
}
