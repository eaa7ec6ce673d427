// SPDX-License-Identifier: GPL-3.0-or-later
// needs: complex polygon poles ellipse
// Elliptical and spherical lights cut by horizons: the arcs of the outline (ellipse.glsl) in front of one plane or two,
// and the chords that close them.

// Heights over a plane, level + x cos(psi) + y sin(psi), and where the outline comes up through it and goes down again.
struct OutlineCut {
  float level;
  float x;
  float y;
  float visible; // 0: nothing, 1: a part, 2: all
  float entry_cos;
  float entry_sin;
  float exit_cos;
  float exit_sin;
  OutlineArc arc;
};

OutlineCut outline_cut(vec3 u, vec3 v, vec3 centre, vec3 n)
{
  OutlineCut cut;
  cut.level = dot(centre, n);
  cut.x = dot(u, n);
  cut.y = dot(v, n);
  float reach = sqrt(cut.x * cut.x + cut.y * cut.y);
  cut.visible = pick(cut.level >= reach, 2.0f, pick(cut.level > -reach, 1.0f, 0.0f));
  float inverse = 1.0f / max(reach, 1e-30f);
  cut.arc.cos_h = clamp(-cut.level * inverse, -1.0f, 1.0f);
  cut.arc.sin_h = sqrt(max((1.0f - cut.arc.cos_h) * (1.0f + cut.arc.cos_h), 0.0f));
  cut.arc.middle_cos = pick(reach > 1e-30f, cut.x * inverse, 1.0f);
  cut.arc.middle_sin = pick(reach > 1e-30f, cut.y * inverse, 0.0f);
  cut.entry_cos = cut.arc.middle_cos * cut.arc.cos_h + cut.arc.middle_sin * cut.arc.sin_h;
  cut.entry_sin = cut.arc.middle_sin * cut.arc.cos_h - cut.arc.middle_cos * cut.arc.sin_h;
  cut.exit_cos = cut.arc.middle_cos * cut.arc.cos_h - cut.arc.middle_sin * cut.arc.sin_h;
  cut.exit_sin = cut.arc.middle_sin * cut.arc.cos_h + cut.arc.middle_cos * cut.arc.sin_h;
  OutlineArc whole = whole_outline();
  cut.arc.middle_cos = pick(cut.visible > 1.5f, whole.middle_cos, cut.arc.middle_cos);
  cut.arc.middle_sin = pick(cut.visible > 1.5f, whole.middle_sin, cut.arc.middle_sin);
  cut.arc.cos_h = pick(cut.visible > 1.5f, whole.cos_h, cut.arc.cos_h);
  cut.arc.sin_h = pick(cut.visible > 1.5f, whole.sin_h, cut.arc.sin_h);
  return cut;
}

// The edge in the plane from where the outline leaves its half space to where it returns; no length where it does not.
Edge outline_gap(OutlineCut cut, vec3 u, vec3 v, vec3 centre, vec3 n)
{
  float part = pick(abs(cut.visible - 1.0f) < 0.5f, 1.0f, 0.0f);
  Gap gap;
  gap.exit = (centre + u * cut.exit_cos + v * cut.exit_sin) * part;
  gap.entry = (centre + u * cut.entry_cos + v * cut.entry_sin) * part;
  return gap_edge(gap, n);
}

float height_at(OutlineCut cut, float cosine, float sine)
{
  return cut.level + cut.x * cosine + cut.y * sine;
}

// A number that grows with the angle from direction a to direction b, from 0 to 4.
float turn_between(float a_cos, float a_sin, float b_cos, float b_sin)
{
  float cosine = a_cos * b_cos + a_sin * b_sin;
  float sine = a_cos * b_sin - a_sin * b_cos;
  return pick(sine < 0.0f, 3.0f + cosine, 1.0f - cosine);
}

OutlineArc arc_between(float a_cos, float a_sin, float b_cos, float b_sin)
{
  float x = b_cos - a_cos;
  float y = b_sin - a_sin;
  float chord = sqrt(x * x + y * y);
  float sine = a_cos * b_sin - a_sin * b_cos;
  OutlineArc arc;
  arc.sin_h = min(0.5f * chord, 1.0f);
  arc.cos_h = pick(sine < 0.0f, -1.0f, 1.0f) * 0.5f * sqrt(squared(a_cos + b_cos) + squared(a_sin + b_sin));
  arc.middle_cos = pick(chord > 1e-12f, y / max(chord, 1e-12f), a_cos);
  arc.middle_sin = pick(chord > 1e-12f, -x / max(chord, 1e-12f), a_sin);
  return arc;
}

// The arc that begins where the outline comes up through plane a, if that is in front of plane b, up to where it goes
// down through either. `begins` is 0 or 1.
struct BegunArc {
  OutlineArc arc;
  float begins;
};

BegunArc begun_arc(OutlineCut a, OutlineCut b)
{
  float to_a = turn_between(a.entry_cos, a.entry_sin, a.exit_cos, a.exit_sin);
  float to_b = turn_between(a.entry_cos, a.entry_sin, b.exit_cos, b.exit_sin);
  float first = pick(b.visible > 1.5f, 1.0f, pick(to_a < to_b, 1.0f, 0.0f));
  BegunArc begun;
  begun.arc = arc_between(a.entry_cos, a.entry_sin, pick(first > 0.5f, a.exit_cos, b.exit_cos),
                          pick(first > 0.5f, a.exit_sin, b.exit_sin));
  float within = pick(b.visible > 1.5f, 1.0f, pick(height_at(b, a.entry_cos, a.entry_sin) >= 0.0f, 1.0f, 0.0f));
  begun.begins = within * pick(abs(a.visible - 1.0f) < 0.5f, 1.0f, 0.0f) * pick(b.visible > 0.5f, 1.0f, 0.0f);
  return begun;
}

struct Outline {
  vec3 centre;
  vec3 u;
  vec3 v;
};

// The same outline with u the longer half axis, whose entry of S is a divisor, and clockwise seen from the origin.
Outline outline_of(vec3 centre, vec3 u, vec3 v)
{
  float longer = pick(dot(u, u) < dot(v, v), 1.0f, 0.0f);
  Outline outline;
  outline.centre = centre;
  outline.u = pick(longer > 0.5f, v, u);
  outline.v = pick(longer > 0.5f, u, v);
  outline.v = outline.v * pick(dot(centre, cross(outline.u, outline.v)) < 0.0f, -1.0f, 1.0f);
  return outline;
}

// Black for ellipses without an extent, or of coordinates that are no numbers.
float if_ellipse(vec3 centre, vec3 u, vec3 v, vec3 n, float value)
{
  float u2 = dot(u, u);
  float v2 = dot(v, v);
  return if_finite(dot(centre, centre) + u2 + v2 + dot(n, n), pick(min(u2, v2) > 0.0f, value, 0.0f));
}

// Irradiance / pi on a surface with the unit normal n from an ellipse of radiance 1 with perpendicular half axes u and
// v. Exact, horizon-cut ones included: Lambert's cosine is the pole B = 1, and lambda is real.
float diffuse_ellipse(vec3 n, vec3 centre, vec3 u, vec3 v)
{
  Outline o = outline_of(centre, u, v);
  Complex one = complex(1.0f, 0.0f);
  EllipseCone cone = ellipse_cone(o.u, o.v, centre, n);
  Factors factors = factors_of(cone, one, complex(negative_root(cone, 1.0f), 0.0f));
  OutlineCut cut = outline_cut(o.u, o.v, centre, n);
  Edge gap = outline_gap(cut, o.u, o.v, centre, n);
  float sum = ellipse_pole_along(factors, cut.arc, one) + safe_angle(gap.area, dot(gap.from, gap.to));
  float seen = pick(cut.visible > 0.5f, clamp(sum / (2.0f * PI_EXACT), 0.0f, 1.0f), 0.0f);
  return if_ellipse(centre, u, v, n, seen);
}

// L = N/(2 pi) int (u.r)^n du over an ellipse for n >= 9, cut to the half space of r and to that of n.
float ellipse_lobe(vec3 r, float exponent, vec3 n, vec3 centre, vec3 u, vec3 v)
{
  Outline o = outline_of(centre, u, v);
  Poles poles = two_poles(exponent);
  EllipseCone cone = ellipse_cone(o.u, o.v, centre, r);
  Factors first = factors_of(cone, poles.b1, followed_root(cone, poles.b1));
  Factors second = factors_of(cone, poles.b2, followed_root(cone, poles.b2));
  OutlineCut front = outline_cut(o.u, o.v, centre, r);
  OutlineCut over = outline_cut(o.u, o.v, centre, n);
  // Two planes that are one cut once.
  vec3 apart = n - r;
  float same = pick(dot(apart, apart) < 1e-10f, 1.0f, 0.0f);
  over.visible = pick(same > 0.5f, 2.0f, over.visible);

  // The outline in front of both planes is whole, or up to two arcs. Where both planes cut it at one point, only one
  // arc begins there.
  BegunArc a = begun_arc(front, over);
  BegunArc b = begun_arc(over, front);
  float close = squared(front.entry_cos - over.entry_cos) + squared(front.entry_sin - over.entry_sin);
  float both = a.begins * b.begins * pick(close < 1e-8f, 1.0f, 0.0f);
  b.begins = b.begins * (1.0f - both);
  float whole = pick(front.visible > 1.5f, pick(over.visible > 1.5f, 1.0f, 0.0f), 0.0f);
  OutlineArc all = whole_outline();
  a.arc.middle_cos = pick(whole > 0.5f, all.middle_cos, a.arc.middle_cos);
  a.arc.middle_sin = pick(whole > 0.5f, all.middle_sin, a.arc.middle_sin);
  a.arc.cos_h = pick(whole > 0.5f, all.cos_h, a.arc.cos_h);
  a.arc.sin_h = pick(whole > 0.5f, all.sin_h, a.arc.sin_h);
  a.begins = max(a.begins, whole);
  float sum = a.begins * (ellipse_pole_along(first, a.arc, poles.w1) + ellipse_pole_along(second, a.arc, poles.w2)) +
              b.begins * (ellipse_pole_along(first, b.arc, poles.w1) + ellipse_pole_along(second, b.arc, poles.w2));

  // The chords: in r's plane all poles add up to the angle; in the horizon it is an edge like any other.
  Edge behind = outline_gap(front, o.u, o.v, centre, r);
  behind = clip_edge(behind, pick(same > 0.5f, 1.0f, dot(behind.from, n)), pick(same > 0.5f, 1.0f, dot(behind.to, n)));
  Edge below = outline_gap(over, o.u, o.v, centre, n);
  sum = sum + safe_angle(behind.area, dot(behind.from, behind.to)) +
        poles_along(arc_of(below, r, dot(below.from, r), dot(below.to, r)), poles);
  float seen = min(front.visible, over.visible);
  float share = pick(seen > 0.5f, clamp(sum / (2.0f * PI_EXACT), 0.0f, 1.0f), 0.0f);
  return if_finite(dot(r, r) + exponent, if_ellipse(centre, u, v, n, share));
}

// A sphere is seen as the circle on its tangent cone. The origin lies outside it.
Outline sphere_outline(vec3 centre, float radius)
{
  vec3 towards = unit_or_zero(centre);
  float sine = min(radius / sqrt(max(dot(centre, centre), 1e-36f)), 0.99999f);
  vec3 aside = pick(abs(towards.x) < 0.5f, vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f));
  vec3 across = unit_or_zero(cross(towards, aside));
  Outline outline;
  outline.centre = towards * sqrt((1.0f - sine) * (1.0f + sine));
  outline.u = across * sine;
  outline.v = cross(towards, across) * sine;
  return outline;
}
