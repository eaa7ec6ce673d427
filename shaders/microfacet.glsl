// SPDX-License-Identifier: GPL-3.0-or-later
// Area lights reflected by rough metal and varnish: GGX without tables.
//
// Directions are in the frame of the shading point: z the normal, x the tangent, the point at the origin; `view` is the
// unit vector towards the eye, on the side of the normal. All lights have radiance 1.
//
// D: Trowbridge and Reitz (1975), anisotropic. Masking and shadowing: Smith's, height-correlated (Heitz, "Understanding
// the Masking-Shadowing Function", 2014, eq 99), as in EEVEE, in the tables of Heitz et al. (2016) and in Cycles since
// 3.6; Cycles 3.4 multiplies two G1 instead. Fresnel: Schlick (1994), split so that one integral serves every colour.

// int f_{F=1} cos dw, and the same weighted by (1 - v.h)^5: F0 (plain - schlick) + schlick is reflected.
struct Reflection {
  float plain;
  float schlick;
};

#define ALPHA_MIN 0.01f
#define VIEW_MIN 1e-3f

struct Microfacets {
  vec3 view;
  vec3 squash;  // (alpha_x, alpha_y, 1): from the sphere of p to half vectors
  vec3 stretch; // and back
  vec3 weight;  // squash * view
  float spread; // its length
};

// alpha below 0.01 is taken for 0.01 (a mirror within 0.6 degrees), above 1 for 1; a view from below or along the
// surface for one that is 0.06 degrees above it.
Microfacets microfacets(vec3 view, float alpha_x, float alpha_y)
{
  Microfacets m;
  m.view = unit(vec3(view.x, view.y, max(view.z, VIEW_MIN)));
  float ax = clamp(alpha_x, ALPHA_MIN, 1.0f), ay = clamp(alpha_y, ALPHA_MIN, 1.0f), one = 1.0f;
  m.squash = vec3(ax, ay, one);
  m.stretch = vec3(one / ax, one / ay, one);
  m.weight = times(m.squash, m.view);
  m.spread = sqrt(dot(m.weight, m.weight));
  return m;
}

float ggx_density(Microfacets m, vec3 h)
{
  vec3 p = times(m.stretch, h);
  float q = dot(p, p);
  return 0.318309886183790672f * m.stretch.x * m.stretch.y / max(q * q, TINY);
}

// G2 / n.v for the half vector squash * p. With |squash d| = |d.z| (1 + 2 Lambda(d)) there is nothing to divide by
// where view or light graze the surface.
Reflection masking(Microfacets m, vec3 p)
{
  vec3 h = times(m.squash, p);
  float n = 1.0f / max(dot(h, h), TINY);
  float along = dot(m.view, h);
  float two = 2.0f * along * n;
  vec3 i = h * two - m.view;
  vec3 j = times(m.squash, i);
  float up = max(i.z, 0.0f);
  float miss = clamp(1.0f - along * sqrt(n), 0.0f, 1.0f);
  Reflection g;
  g.plain = 2.0f * up / max(m.spread * up + sqrt(dot(j, j)) * m.view.z, TINY);
  g.schlick = g.plain * miss * miss * miss * miss * miss;
  return g;
}

// The BRDF times n.i, for F = 1: what a light that fills little of the sky is worth.
Reflection ggx_reflection(Microfacets m, vec3 i)
{
  vec3 h = unit(m.view + i);
  Reflection f = masking(m, times(m.stretch, h));
  float lobe = 0.25f * ggx_density(m, h) * pick(i.z > 0.0f, 1.0f, 0.0f);
  f.plain = f.plain * lobe;
  f.schlick = f.schlick * lobe;
  return f;
}

// What an arc of the outline encloses, and two nodes that stand for it.
struct RimArc {
  float flux;
  ArcNode a;
  ArcNode b;
};

// Gauss's two nodes for arcs with ends; the middles of both halves for those that close, where equal steps are best.
#define OPEN_NODE 0.211324865405187118f
#define CLOSED_NODE 0.25f

RimArc rim_arc(Microfacets m, HalfArc half_arc, Peaks peaks, float first_node)
{
  RimArc arc;
  float g0 = 0.5f * dot(m.weight, cross(half_arc.p0, half_arc.p1)), g1 = dot(m.weight, cross(half_arc.p0, half_arc.p2));
  float g2 = 0.5f * dot(m.weight, cross(half_arc.p1, half_arc.p2));
  arc.flux = rational_integral(half_arc, peaks, g0, g1, g2);
  arc.a = node_at(half_arc, peaks, first_node, 0.5f);
  arc.b = node_at(half_arc, peaks, 1.0f - first_node, 0.5f);
  return arc;
}

vec3 turns(RimArc arc)
{
  return arc.a.turn + arc.b.turn;
}

RimArc great_circle_arc(Microfacets m, vec3 a, vec3 b)
{
  HalfArc half_arc = great_arc(m.view, m.stretch, a, b);
  return rim_arc(m, half_arc, peaks_of(half_arc), OPEN_NODE);
}

// A small circle that is small beside the lobe has its peaks at +-i, both: there, and there alone, the nodes' own sum
// is the better one.
#define NEARLY_ONE_PEAK 0.1f

RimArc small_circle_arc(Microfacets m, HalfArc half_arc, float first_node)
{
  Peaks peaks = peaks_of(half_arc);
  RimArc arc = rim_arc(m, half_arc, peaks, first_node);
  float wide = NEARLY_ONE_PEAK * (peaks.w1 + peaks.w2), d = peaks.m1 - peaks.m2, e = peaks.w1 - peaks.w2;
  arc.flux = pick(d * d + e * e < wide * wide, 0.5f * dot(m.weight, turns(arc)), arc.flux);
  return arc;
}

// Masking and Fresnel vary slowly over the region. Their mean: a fan of triangles from the region's middle to the nodes
// of its outline, each by Radau's rule (nodes at the apex and at three quarters, exact for quadratics along the ray).
struct Mean {
  vec3 apex;
  Reflection at_apex;
  float apex_weight;
  float weight;
  float plain;
  float schlick;
  float most; // masking at any node: the mean is no higher
};

Mean mean_about(Microfacets m, vec3 middle)
{
  Mean mean;
  // Inside by construction, but for rounding: a half vector below the horizon mirrors nothing.
  mean.apex = unit(vec3(middle.x, middle.y, max(middle.z, 1e-6f)));
  mean.at_apex = masking(m, mean.apex);
  mean.apex_weight = 0.111111111111111111f * dot(m.weight, mean.apex);
  mean.weight = 0.0f;
  mean.plain = 0.0f;
  mean.schlick = 0.0f;
  mean.most = mean.at_apex.plain;
  return mean;
}

Mean with_node(Mean mean, Microfacets m, ArcNode node)
{
  float near_part = 0.25f, far_part = 0.75f;
  vec3 p = unit(mean.apex * near_part + node.point * far_part);
  Reflection g = masking(m, p);
  float solid_angle = dot(mean.apex, node.turn) / max(1.0f + dot(mean.apex, node.point), 1e-3f);
  float at_apex = solid_angle * mean.apex_weight;
  float at_node = 0.888888888888888889f * solid_angle * dot(m.weight, p);
  mean.weight = mean.weight + at_apex + at_node;
  mean.plain = mean.plain + at_apex * mean.at_apex.plain + at_node * g.plain;
  mean.schlick = mean.schlick + at_apex * mean.at_apex.schlick + at_node * g.schlick;
  mean.most = max(mean.most, g.plain);
  return mean;
}

Mean with_arc(Mean mean, Microfacets m, RimArc arc)
{
  return with_node(with_node(mean, m, arc.a), m, arc.b);
}

// Either winding: the outline's sense is that of its flux.
Reflection reflected(Mean mean, float flux)
{
  float k = pick(mean.weight < 0.0f, -1.0f, 1.0f) / max(abs(mean.weight), TINY);
  float amount = 0.318309886183790672f * abs(flux);
  float plain = clamp(mean.plain * k, 0.0f, mean.most);
  Reflection light;
  light.schlick = amount * clamp(mean.schlick * k, 0.0f, plain);
  light.plain = amount * plain;
  return light;
}

vec3 facing(vec3 middle, float flux)
{
  float sense = pick(flux < 0.0f, -1.0f, 1.0f);
  return middle * sense;
}
