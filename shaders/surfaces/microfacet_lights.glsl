// SPDX-License-Identifier: GPL-3.0-or-later
// needs: half_vector microfacet
// Area lights reflected by microfacets: quadrilaterals, spheres, ellipses; what is below the horizon gives nothing.
// Each light is its outline in arcs (half_vector.glsl), closed along the horizon where that cuts it.

// ---- The horizon ----

// The part above the horizon of the edge between two directions, and where it crosses on the way down (leave) or up (enter).
struct LitEdge {
  vec3 a;
  vec3 b;
  vec3 leave;
  vec3 enter;
};

LitEdge lit_edge(vec3 a, vec3 b)
{
  float rise = b.z - a.z, zero = 0.0f;
  float t = clamp(-a.z * reciprocal(pick(abs(rise) > TINY, rise, TINY)), 0.0f, 1.0f);
  vec3 crossing = unit(vec3(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), zero));
  vec3 none = vec3(zero, zero, zero), zenith = vec3(zero, zero, 1.0f);
  LitEdge edge;
  edge.a = pick(a.z < 0.0f, pick(b.z < 0.0f, zenith, crossing), a);
  edge.b = pick(b.z < 0.0f, pick(a.z < 0.0f, zenith, crossing), b);
  edge.leave = pick(a.z < 0.0f, none, pick(b.z < 0.0f, crossing, none));
  edge.enter = pick(a.z < 0.0f, pick(b.z < 0.0f, none, crossing), none);
  return edge;
}

LitEdge whole_edge(vec3 a, vec3 b)
{
  float zero = 0.0f;
  LitEdge edge;
  edge.a = a;
  edge.b = b;
  edge.leave = vec3(zero, zero, zero);
  edge.enter = edge.leave;
  return edge;
}

RimArc lit_arc(Microfacets m, LitEdge edge)
{
  return great_circle_arc(m, edge.a, edge.b);
}

// Along the horizon, closing a clipped outline; no length where nothing was clipped.
LitEdge horizon_edge(vec3 leave, vec3 enter)
{
  float both = dot(leave, leave) * dot(enter, enter), zero = 0.0f;
  vec3 zenith = vec3(zero, zero, 1.0f);
  return whole_edge(pick(both > 0.25f, leave, zenith), pick(both > 0.25f, enter, zenith));
}

RimArc horizon_arc(Microfacets m, vec3 leave, vec3 enter)
{
  return lit_arc(m, horizon_edge(leave, enter));
}

// ---- Lights ----

Reflection microfacet_quad(Microfacets m, vec3 a, vec3 b, vec3 c, vec3 d)
{
  vec3 ua = unit(a), ub = unit(b), uc = unit(c), ud = unit(d);
  LitEdge edges[5];
  edges[0] = whole_edge(ua, ub);
  edges[1] = whole_edge(ub, uc);
  edges[2] = whole_edge(uc, ud);
  edges[3] = whole_edge(ud, ua);
  edges[4] = edges[0];
  // Most lights are above every horizon in sight.
  bool cut = any_lane(min(min(ua.z, ub.z), min(uc.z, ud.z)) < 0.0f);
  if (cut) {
    vec3 leave = edges[0].leave, enter = leave;
    for (int k = 0; k < 4; ++k) {
      edges[k] = lit_edge(edges[k].a, edges[k].b);
      leave = leave + edges[k].leave;
      enter = enter + edges[k].enter;
    }
    edges[4] = horizon_edge(leave, enter);
  }
  // Step by step rather than edge by edge: each step waits for the one before, but not for the other edges'. Bounds that
  // vary would keep GPUs from unrolling, and arrays from registers.
  HalfArc halves[5];
  Peaks peaks[5];
  Turning turnings[5];
  RimArc arcs[5];
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      halves[k] = great_arc(m.view, m.stretch, edges[k].a, edges[k].b);
    }
  }
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      peaks[k] = peaks_of(halves[k]);
    }
  }
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      peaks[k] = with_angles(halves[k], peaks[k]);
    }
  }
  float flux = 0.0f, zero = 0.0f;
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      turnings[k] = turning_of(halves[k]);
      arcs[k].flux = arc_flux(m, halves[k], turnings[k], peaks[k], no_level());
      flux = flux + arcs[k].flux;
    }
  }
  vec3 middle = vec3(zero, zero, zero);
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      ArcNodes nodes = nodes_at(halves[k], turnings[k], peaks[k], OPEN_NODE, 0.5f);
      arcs[k].a = nodes.a;
      arcs[k].b = nodes.b;
      middle = middle + lobe_turns(m, arcs[k]);
    }
  }
  Mean mean = mean_about(m, middle, flux);
  for (int k = 0; k < 5; ++k) {
    if (k < 4 || cut) {
      mean = with_arc(mean, m, arcs[k]);
    }
  }
  return reflected(m, dot(a, a) + dot(b, b) + dot(c, c) + dot(d, d), mean, flux);
}

// The middle of a round light about a direction; size2: the square of its half width, in radians or so. Along a small
// circle the turns are large and their sum small: there the light's own middle, not below the horizon.
#define SMALL_ROUND 0.3f

vec3 round_middle(Microfacets m, vec3 direction, float size2, vec3 turned, float flux)
{
  vec3 own = times(m.stretch, m.view + vec3(direction.x, direction.y, max(direction.z, 0.0f)));
  float thin = SMALL_ROUND * min(m.rough.x, m.rough.y), sense = pick(flux < 0.0f, -1.0f, 1.0f);
  return pick(size2 < thin * thin * dot(own, own), own * sense, turned);
}

// The rim of a sphere is a small circle of directions. Its top divides what is above the horizon into two arcs alike.
// The point must be outside the sphere.
Reflection microfacet_sphere(Microfacets m, vec3 centre, float radius)
{
  float zero = 0.0f, one = 1.0f;
  float sine = clamp(radius / sqrt(max(dot(centre, centre), TINY)), 1e-6f, 0.99999f);
  float cosine = sqrt(1.0f - sine * sine);
  vec3 axis = unit(centre);
  float level = sqrt(axis.x * axis.x + axis.y * axis.y); // 1 - z^2 is rounding alone where the light is overhead
  vec3 uphill = unit(vec3(-axis.x * axis.z, -axis.y * axis.z, level * level));
  vec3 x = pick(level < 1e-4f, vec3(one, zero, zero), uphill);
  vec3 y = cross(axis, x);
  x = x * sine;
  y = y * sine;
  vec3 middle = axis * cosine;
  float rise = max(level, 1e-4f) * sine;
  float cos_end = clamp(-middle.z / rise, -1.0f, 1.0f);
  float sin_end = sqrt(max(1.0f - cos_end * cos_end, 0.0f));
  vec3 leave = middle + x * cos_end + y * sin_end, enter = middle + x * cos_end - y * sin_end;
  float cut = pick(abs(cos_end) < 0.9999999f, 1.0f, 0.0f);
  RimArc arcs[3];
  arcs[0] = small_circle_arc(m, small_arc(m.view, m.stretch, middle, x, y, one, zero, cos_end, sin_end), CLOSED_NODE);
  arcs[1] = small_circle_arc(m, small_arc(m.view, m.stretch, middle, x, y, cos_end, -sin_end, one, zero), CLOSED_NODE);
  float flux = arcs[0].flux + arcs[1].flux;
  vec3 turned = lobe_turns(m, arcs[0]) + lobe_turns(m, arcs[1]);
  bool is_cut = any_lane(cut > 0.5f);
  if (is_cut) {
    arcs[2] = horizon_arc(m, leave * cut, enter * cut);
    flux = flux + arcs[2].flux;
    turned = turned + lobe_turns(m, arcs[2]);
  }
  // Below the horizon the outline has no length, and whatever came of that counts for nothing.
  flux = pick(cos_end < 0.9999995f, pick(radius > 0.0f, flux, 0.0f), 0.0f);
  Mean mean = mean_about(m, round_middle(m, axis, sine * sine, turned, flux), flux);
  mean = with_arc(with_arc(mean, m, arcs[0]), m, arcs[1]);
  if (is_cut) {
    mean = with_arc(mean, m, arcs[2]);
  }
  return reflected(m, dot(centre, centre) + radius * radius, mean, flux);
}

// The circle of directions through both ends of a piece of rim, by the direction in its middle and the chords to it and
// from it. On an ellipse the middle of the parameter is aside of the middle of the arc, and the circle through all three
// would enclose too much. But between chord and rim lies as much as on the circle that the ellipse is squeezed from, if
// squeezed alike: so the circle is as high over the middle of the chord as that direction is over its foot. Relative to
// 4/3 of half the chord times its height, a segment of a circle is (1 + 4/5 (height / half chord)^2)^(1/4) or so, also
// at tips where it is most of the circle: that is taken off. `flat_share` is that of a circle's piece, its fourth power.
RimArc arc_over(Microfacets m, vec3 middle, vec3 chord_in, vec3 chord_out, float flat_share)
{
  float half_of = 0.5f, small = 1e-6f;
  vec3 chord = chord_in + chord_out, rise = (chord_in - chord_out) * half_of;
  float half_chord2 = 0.25f * max(dot(chord, chord), TINY), aside = 0.25f * dot(rise, chord) / half_chord2;
  vec3 base = middle - rise, up = rise - chord * aside;
  float up2 = dot(up, up), flat_part = sqrt(sqrt(flat_share * half_chord2 / (half_chord2 + 0.8f * up2)));
  // |base + up flat_part|^2 - 1, and what makes it a direction.
  float more = flat_part * (half_chord2 * (1.0f - 4.0f * aside * aside) - up2 * (1.0f - flat_part)) - half_chord2;
  float size = sqrt(max(1.0f + more, small)), inverse = 1.0f / size;
  up = up * (flat_part * inverse) - base * (more * inverse / (1.0f + size));
  up2 = max(dot(up, up), small * small * half_chord2);
  float height = sqrt(up2), half_chord = sqrt(half_chord2), both = half_chord2 + up2, radius = half_of * both / height;
  vec3 x = up * (radius / height), y = chord * (half_of * radius / half_chord);
  float cosine = (half_chord2 - up2) / both, sine = 2.0f * half_chord * height / both;
  return small_circle_arc(m, small_arc(m.view, m.stretch, base + up - x, x, y, cosine, -sine, cosine, sine), OPEN_NODE);
}

// A point of the rim, and from there to the next: the chord between both directions, without cancellation.
struct RimStep {
  vec3 to;
  vec3 chord; // between the unit vectors
};

RimStep rim_step(vec3 from, vec3 along)
{
  RimStep rim;
  rim.to = from + along;
  float a = sqrt(max(dot(from, from), TINY)), b = sqrt(max(dot(rim.to, rim.to), TINY)), inverse = 1.0f / b;
  float longer = dot(along, from + rim.to) / ((a + b) * a);
  rim.chord = (along - from * longer) * inverse;
  return rim;
}

// An ellipse, centre + u x + v y for x^2 + y^2 <= 1. Equal steps along its rim are few directions where it is far and
// many where it is near; so it is taken for another ellipse in the same cone of directions, whose centre is on the cone's
// own axis. With the light's x, y, 1 as axes and 1 for the time of relativity that is a boost: it maps the unit circle to
// itself.
struct Cone {
  vec3 centre;
  vec3 u;
  vec3 v;
};

#define BOOST_MAX 0.999f

Cone centred_cone(vec3 centre, vec3 u, vec3 v)
{
  float uu = dot(u, u), vv = dot(v, v), cc = dot(centre, centre), uv = dot(u, v), uc = dot(u, centre);
  float vc = dot(v, centre), k = 1.0f / max(uu + vv + cc, TINY);
  uu = uu * k;
  vv = vv * k;
  cc = cc * k;
  uv = uv * k;
  uc = uc * k;
  vc = vc * k;
  // The Gram matrix of u, v, centre and the form x^2 + y^2 - 1 have one common axis inside the circle. Its -lambda = mu is
  // the largest root of mu^3 - squares mu^2 + areas mu - volume2, real like the others.
  float area2 = uu * vv - uv * uv, squares = cc - uu - vv, areas = area2 - (vv * cc - vc * vc) - (uu * cc - uc * uc);
  float volume2 = cc * area2 - uc * (uc * vv - uv * vc) + vc * (uc * uv - uu * vc);
  float q = max(squares * squares - 3.0f * areas, TINY) * 0.111111111111111111f, by_root_q = inversesqrt(q);
  float r = (2.0f * squares * squares * squares - 9.0f * squares * areas + 27.0f * volume2) * 0.0185185185185185185f;
  float cosine = clamp(r * by_root_q * by_root_q * by_root_q, -1.0f, 1.0f);
  float root = squares * 0.333333333333333333f + 2.0f * q * by_root_q * third_of_angle(sqrt(0.5f + 0.5f * cosine));
  // Where the axis pierces the light. Any point within the ellipse would do: this one need not be exact.
  float a = uu + max(root, 1e-6f), d = vv + max(root, 1e-6f), by = 1.0f / max(a * d - uv * uv, TINY);
  float x = (uv * vc - d * uc) * by, y = (uv * uc - a * vc) * by;
  float off = sqrt(x * x + y * y), by_off = 1.0f / max(off, TINY);
  x = pick(off > 1e-6f, x * by_off, 1.0f);
  y = pick(off > 1e-6f, y * by_off, 0.0f);
  off = min(off, BOOST_MAX);
  float gamma = inversesqrt(1.0f - off * off);
  vec3 radial = u * x + v * y;
  Cone cone;
  cone.centre = (centre + radial * off) * gamma;
  cone.u = (radial + centre * off) * gamma;
  cone.v = v * x - u * y;
  return cone;
}

// The rim in ELLIPSE_ARCS circles of directions.
#define ELLIPSE_ARCS 8

Reflection microfacet_ellipse(Microfacets m, vec3 centre, vec3 u, vec3 v)
{
  Cone cone = centred_cone(centre, u, v);
  // Conjugate half axes, the first to the highest point: z is cone.centre.z + rise cos t.
  float rise = sqrt(max(cone.u.z * cone.u.z + cone.v.z * cone.v.z, TINY)), k = 1.0f / rise;
  float cu = pick(rise < 1e-12f, 1.0f, cone.u.z * k), su = pick(rise < 1e-12f, 0.0f, cone.v.z * k);
  vec3 x = cone.u * cu + cone.v * su, y = cone.v * cu - cone.u * su;
  float cos_end = clamp(-cone.centre.z / max(rise, 1e-12f), -1.0f, 1.0f);
  float sin_end = sqrt(max(1.0f - cos_end * cos_end, 0.0f));
  // A sixteenth of the way curved, by halving the angle three times.
  float s = sqrt(0.5f - 0.5f * cos_end), c = sqrt(0.5f + 0.5f * cos_end);
  for (int halving = 0; halving < 2; ++halving) {
    c = sqrt(0.5f + 0.5f * c);
    s = 0.5f * s / c;
  }
  // From t to t + 2 d the rim goes 2 sin d along (-x sin(t + d) + y cos(t + d)). Here d is half of the step above.
  float cos_d = sqrt(0.5f + 0.5f * c), sin_d = 0.5f * s / cos_d, twice = 2.0f * sin_d;
  float cos_t = cos_end * cos_d - sin_end * -sin_d, sin_t = -sin_end * cos_d + cos_end * sin_d, next = 0.0f;
  float half_tan = s / (1.0f + c), flat_share = 1.0f + 0.8f * half_tan * half_tan;
  RimStep here, half_way;
  here.to = cone.centre + x * cos_end - y * sin_end;
  vec3 enter = unit(here.to);
  RimArc arcs[ELLIPSE_ARCS + 1];
  float flux = 0.0f;
  vec3 middle = enter * flux;
  for (int n = 0; n < ELLIPSE_ARCS; ++n) {
    half_way = rim_step(here.to, (y * cos_t - x * sin_t) * twice);
    next = cos_t * c - sin_t * s;
    sin_t = sin_t * c + cos_t * s;
    cos_t = next;
    here = rim_step(half_way.to, (y * cos_t - x * sin_t) * twice);
    next = cos_t * c - sin_t * s;
    sin_t = sin_t * c + cos_t * s;
    cos_t = next;
    arcs[n] = arc_over(m, unit(half_way.to), half_way.chord, here.chord, flat_share);
    flux = flux + arcs[n].flux;
    middle = middle + lobe_turns(m, arcs[n]);
  }
  vec3 leave = unit(here.to);
  float cut = pick(abs(cos_end) < 0.9999999f, 1.0f, 0.0f);
  bool is_cut = any_lane(cut > 0.5f);
  if (is_cut) {
    arcs[ELLIPSE_ARCS] = horizon_arc(m, leave * cut, enter * cut);
    flux = flux + arcs[ELLIPSE_ARCS].flux;
    middle = middle + lobe_turns(m, arcs[ELLIPSE_ARCS]);
  }
  flux = pick(cos_end < 0.9999995f, flux, 0.0f);
  float u2 = dot(u, u), v2 = dot(v, v), c2 = dot(centre, centre);
  Mean mean = mean_about(m, round_middle(m, unit(cone.centre), (u2 + v2) / max(c2, TINY), middle, flux), flux);
  for (int n = 0; n < ELLIPSE_ARCS; ++n) {
    mean = with_arc(mean, m, arcs[n]);
  }
  if (is_cut) {
    mean = with_arc(mean, m, arcs[ELLIPSE_ARCS]);
  }
  flux = pick(min(u2, v2) > 0.0f, flux, 0.0f);
  return reflected(m, c2 + u2 + v2, mean, flux);
}

// ---- GGX by its parameters ----

Reflection ggx_quad(vec3 view, float alpha_x, float alpha_y, vec3 a, vec3 b, vec3 c, vec3 d)
{
  return microfacet_quad(microfacets(BRDF_GGX, view, alpha_x, alpha_y), a, b, c, d);
}

Reflection ggx_sphere(vec3 view, float alpha_x, float alpha_y, vec3 centre, float radius)
{
  return microfacet_sphere(microfacets(BRDF_GGX, view, alpha_x, alpha_y), centre, radius);
}

Reflection ggx_ellipse(vec3 view, float alpha_x, float alpha_y, vec3 centre, vec3 u, vec3 v)
{
  return microfacet_ellipse(microfacets(BRDF_GGX, view, alpha_x, alpha_y), centre, u, v);
}
