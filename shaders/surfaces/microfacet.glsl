// SPDX-License-Identifier: GPL-3.0-or-later
// needs: complex polygon poles half_vector
// Rough metal and varnish: microfacets, and how a light's outline gives what they reflect of it. No tables.
//
// Directions are in the frame of the shading point: z the normal, x the tangent, the point at the origin; `view` is the
// unit vector towards the eye, on the side of the normal. All lights have radiance 1.
//
// D: Trowbridge and Reitz (1975, GGX); Beckmann (1963); Blinn (1977) with exponent 2/alpha^2 - 2. Masking: Smith's,
// height-correlated (Heitz, "Understanding the Masking-Shadowing Function", 2014, eq 99) as in EEVEE and in the tables
// of Heitz et al. (2016), or, as Cycles 3.4 has it, the product of two G1 (`apart`). Lambda of Beckmann, and with it that of Blinn, is the
// rational fit of Walter et al. (2007). Fresnel's reflectance rises from F0, straight on, to 1 along one curve for all colours:
// F0 + (1 - F0) fresnel_share. So two integrals serve every colour.

#define BRDF_GGX 0
#define BRDF_BECKMANN 1
#define BRDF_BLINN_PHONG 2

// int f_{F=1} cos dw, and the same weighted by fresnel_share of v.h: F0 (plain - fresnel) + fresnel is reflected.
struct Reflection {
  float plain;
  float fresnel;
};

#define ALPHA_MIN 0.01f
#define VIEW_MIN 1e-3f

// A lobe without tails is traced with the peaks of a GGX lobe that is this much wider.
#define GUIDE 1.22474487139158905f

struct Microfacets {
  int brdf; // one for all lanes
  vec3 view;
  vec3 rough;   // (alpha_x, alpha_y, 1)
  vec3 squash;  // from the sphere of p to half vectors: rough, or wider
  vec3 stretch; // and back
  vec3 weight;  // squash * view
  float view_reach;
  float apart; // 0, or 1 for masking and shadowing that know nothing of each other
  float index; // of refraction, as fresnel_share has it
  float size2;  // of what it was made of, for if_finite
  Poles poles; // of the lobe, where it is not GGX; on the sphere of p
};

// d.z / G1(d), which stays finite where d grazes the surface.
float reach(int brdf, vec3 rough, vec3 d)
{
  vec3 r = times(rough, d);
  if (brdf == BRDF_GGX) {
    return 0.5f * (d.z + sqrt(dot(r, r)));
  }
  float across = sqrt(r.x * r.x + r.y * r.y), a = d.z * reciprocal(max(across, TINY));
  float masked = across * (1.0f + a * (2.276f + 2.577f * a)) * reciprocal(3.535f + 2.181f * a);
  return pick(a < 1.6f, masked, d.z);
}

// alpha below 0.01 is taken for 0.01 (a mirror within 0.6 degrees), above 1 for 1; a view from below or along the
// surface for one that is 0.06 degrees above it. Blinn: alpha_x alone, at most 0.447 (exponent 8, where the poles end).
Microfacets microfacets(int brdf, vec3 view, float alpha_x, float alpha_y)
{
  Microfacets m;
  m.brdf = brdf;
  m.view = unit(vec3(view.x, view.y, max(view.z, VIEW_MIN)));
  float one = 1.0f, wider = one, exponent = 1e6f;
  float ax = clamp(alpha_x, ALPHA_MIN, 1.0f), ay = clamp(alpha_y, ALPHA_MIN, 1.0f);
  if (brdf == BRDF_BLINN_PHONG) {
    ax = min(ax, 0.447213f);
    ay = ax;
    exponent = 2.0f / (ax * ax) - 1.0f;
  }
  if (brdf != BRDF_GGX) {
    wider = GUIDE;
  }
  m.rough = vec3(ax, ay, one);
  m.squash = vec3(ax * wider, ay * wider, one);
  m.stretch = vec3(one / m.squash.x, one / m.squash.y, one);
  m.weight = times(m.squash, m.view);
  m.view_reach = reach(brdf, m.rough, m.view);
  m.apart = 0.0f;
  m.index = 0.0f;
  m.size2 = dot(view, view) + alpha_x * alpha_x + alpha_y * alpha_y;
  // B of two_poles is a square of a tangent of theta.
  m.poles = two_poles(exponent);
  float to_p = 0.5f * (exponent + 1.0f) / (wider * wider);
  m.poles.b1 = complex_scale(to_p, m.poles.b1);
  m.poles.b2 = complex_scale(to_p, m.poles.b2);
  return m;
}

// The density of normals h, unit vectors.
float normal_density(Microfacets m, vec3 h)
{
  float one = 1.0f, z2 = max(h.z * h.z, 1e-12f);
  vec3 p = vec3(h.x / m.rough.x, h.y / m.rough.y, one);
  float slope2 = (p.x * p.x + p.y * p.y) / z2, k = 0.318309886183790672f / (m.rough.x * m.rough.y);
  if (m.brdf == BRDF_GGX) {
    return k / (z2 * z2 * (1.0f + slope2) * (1.0f + slope2));
  }
  if (m.brdf == BRDF_BECKMANN) {
    return k * exp(-slope2) / (z2 * z2);
  }
  return k * exp((1.0f / (m.rough.x * m.rough.x) - 1.0f) * log(z2));
}

// How far Fresnel's reflectance has risen from straight on, 0, to grazing, 1. Where `index` is 1 or more: of a dielectric
// of that index of refraction, unpolarised (Fresnel 1823; in the form of Walter et al. 2007, eq 22, their g - c taken
// as (index^2 - 1) / (g + c), which does not cancel at an index near 1, and over one denominator). Where index is 0:
// (1 - cosine)^5 (Schlick 1994). Where it is DIP_BEFORE_EDGE: no rise but the dip before it of metals that do not rise all
// the way (Kutz, Hasan and Edmondson, "Novel aspects of the Adobe Standard Material", 2021), cosine (1 - cosine)^6, over
// what it is at its deepest, where the cosine is 1/7.
#define DIP_BEFORE_EDGE (-1.0f)

float fresnel_share(float cosine, float index)
{
  float c = clamp(cosine, 0.0f, 1.0f), miss = 1.0f - c, miss2 = miss * miss, share = miss2 * miss2 * miss;
  if (any_lane(index > 0.5f)) {
    float n = max(index, 1.0f), steep = (n - 1.0f) * (n + 1.0f), g = sqrt(steep + c * c), sum = g + c;
    float over = sum * (c * sum - 1.0f), under = c * steep + sum, whole = sum * sum * under;
    float reflectance = 0.5f * steep * steep * (under * under + over * over) * reciprocal(max(whole * whole, TINY));
    // What depends on the index alone is the same at every node.
    float straight_on = (n - 1.0f) / (n + 1.0f), rise = (n + 1.0f) * (n + 1.0f) / (4.0f * n);
    share = pick(index > 0.5f, clamp((reflectance - straight_on * straight_on) * rise, 0.0f, 1.0f), share);
  }
  if (any_lane(index < -0.5f)) {
    share = pick(index < -0.5f, 17.6513846f * c * miss * share, share); // 7 (7/6)^6
  }
  return share;
}

// F and G2 / n.v, for F = 1 and for fresnel_share, of the half vector h of any length; `towards` is v.h.
Reflection masking_at(Microfacets m, vec3 h, float towards)
{
  float inverse = inversesqrt(max(dot(h, h), TINY));
  float along = towards * inverse;
  float two = 2.0f * along * inverse;
  vec3 i = h * two - m.view;
  i.z = max(i.z, 0.0f);
  // 1 / G2 = 1 + Lambda(v) + Lambda(i), or (1 + Lambda(v)) (1 + Lambda(i)), times n.v and n.i.
  float shadowed = reach(m.brdf, m.rough, i);
  float both = m.apart * (m.view_reach - m.view.z) * (shadowed - i.z);
  Reflection g;
  g.plain = i.z * reciprocal(max(m.view_reach * i.z + m.view.z * (shadowed - i.z) + both, TINY));
  g.fresnel = g.plain * fresnel_share(along, m.index);
  return g;
}

// Light that leaves facets after further reflections between them, for each unit that the first one lost, of which all
// could leave (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017): by the means of Fresnel's
// reflectance and of what is reflected for F = 1.
float sent_again(float reflectance, float plain)
{
  return reflectance * plain / (1.0f - reflectance * (1.0f - plain));
}

// By what the light of a layer is to be multiplied for that, where `once` is reflected for F = 1.
float gain_of_again(float again, float once)
{
  return 1.0f + again * (1.0f - once) / max(once, TINY);
}

// What a layer reflects of light from all sides, towards the eye: of what one reflection would send were nothing lost,
// all that leaves; `f0` straight on, rising by `fresnel` to `edge`.
float reflected_by_layer(float f0, float edge, float once, float fresnel, float leaves)
{
  return (f0 + (1.0f - f0) * edge * fresnel / max(once, TINY)) * leaves;
}

// The same where the half vector is squash * p.
Reflection masking(Microfacets m, vec3 p)
{
  vec3 h = times(m.squash, p);
  return masking_at(m, h, dot(m.view, h));
}

// The half vector, of any length, of a facet of GGX's that the eye sees, as often as it is seen (Dupuy and Benyoub,
// "Sampling visible GGX normals with spherical caps", 2023), for a point of the unit disk, area to area. Of light from all
// sides the mean of view_reach times masking_at() is reflected.
vec3 seen_facet(Microfacets m, float x, float y)
{
  vec3 seen = unit(times(m.rough, m.view));
  float share = x * x + y * y;
  float z = (1.0f - share) * (1.0f + seen.z) - seen.z;
  float aside = sqrt(max(1.0f - z * z, 0.0f)) * inversesqrt(max(share, TINY));
  return times(m.rough, vec3(x * aside + seen.x, y * aside + seen.y, z + seen.z));
}

// The BRDF times n.i, for F = 1: what a light that fills little of the sky is worth.
Reflection microfacet_reflection(Microfacets m, vec3 i)
{
  vec3 h = unit(m.view + i);
  Reflection f = masking(m, times(m.stretch, h));
  float lobe = 0.25f * normal_density(m, h) * pick(i.z > 0.0f, 1.0f, 0.0f);
  f.plain = f.plain * lobe;
  f.fresnel = f.fresnel * lobe;
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

// What a node's p x p' / |p|^2 is to be scaled by, axis by axis, for a lobe that is a sum of poles: each pole is a GGX
// lobe of complex alpha^2 = b, and D h dh = (1/pi) S^-2 (h x h') / |S h|^2 holds for it. `point` is normalised.
vec3 lobe_scale(Microfacets m, vec3 point)
{
  float level_part = 1.0f, up = 1.0f;
  if (m.brdf != BRDF_GGX) {
    float across2 = point.x * point.x + point.y * point.y, up2 = point.z * point.z;
    Complex d1 = complex(across2 + m.poles.b1.re * up2, m.poles.b1.im * up2);
    Complex d2 = complex(across2 + m.poles.b2.re * up2, m.poles.b2.im * up2);
    Complex k1 = complex_div(m.poles.w1, d1), k2 = complex_div(m.poles.w2, d2);
    level_part = complex_mul(m.poles.b1, k1).re + complex_mul(m.poles.b2, k2).re;
    up = k1.re + k2.re;
  }
  return vec3(level_part, level_part, up);
}

// Along a small circle p x p' / |p|^2 is large and its sum small. So: what it would be if the lobe and 1 / |p|^2 were
// those of the circle's middle, which is exact, and from nodes what is left. Without a circle all is left.
struct Level {
  vec3 lobe; // times 1 / |p|^2, at the middle
  vec3 axis; // of the circle, on the sphere of p
  float height;
  float flux; // of the lobe at the middle
};

Level no_level()
{
  Level level;
  float zero = 0.0f;
  level.lobe = vec3(zero, zero, zero);
  level.axis = vec3(zero, zero, 1.0f);
  level.height = zero;
  level.flux = zero;
  return level;
}

Level level_of(Microfacets m, HalfArc arc)
{
  float half_of = 0.5f;
  vec3 middle = (arc.p0 + arc.p2) * half_of, x = (arc.p0 - arc.p2) * half_of, y = arc.p1 * half_of;
  float n = 1.0f / max(dot(middle, middle), TINY);
  Level level;
  level.lobe = lobe_scale(m, unit(middle)) * n;
  level.axis = cross(x, y);
  level.height = dot(middle, level.axis);
  // int p x p' dt with s = tan(t/2).
  float k_low = 1.0f / (1.0f + arc.low * arc.low), k_high = 1.0f / (1.0f + arc.high * arc.high);
  float cosines = 2.0f * (k_high - k_low), sines = 2.0f * (arc.high * k_high - arc.low * k_low);
  float angle = 2.0f * turned(0.0f, 1.0f, arc.low, arc.high);
  vec3 around = level.axis * angle + cross(middle, y * sines + x * cosines);
  level.flux = 0.5f * dot(m.weight, times(level.lobe, around));
  return level;
}

float node_flux(Microfacets m, Level level, ArcNode node)
{
  float along = dot(node.point, level.axis);
  float size = level.height / pick(abs(along) > TINY, along, TINY); // |p| on the circle
  return 0.5f * dot(m.weight, times(node.turn, lobe_scale(m, node.point) - level.lobe * (size * size)));
}

// GGX: exact. Else by Gauss's two nodes on each of LOBE_PANELS equal shares of the arc's phase.
#define LOBE_PANELS 3
#define LOBE_PANEL 0.333333333333333333f

float lobe_flux(Microfacets m, HalfArc half_arc, Turning turning, Peaks peaks, Level level)
{
  float flux = level.flux, panel = LOBE_PANEL, place = OPEN_NODE;
  for (int k = 0; k < LOBE_PANELS; ++k) {
    ArcNodes nodes = nodes_at(half_arc, turning, peaks, place * panel, 0.5f * panel);
    flux = flux + node_flux(m, level, nodes.a) + node_flux(m, level, nodes.b);
    // From the end: the other node of this panel, then the first of the next.
    place = pick(place < 0.5f, 1.0f - OPEN_NODE, 1.0f + OPEN_NODE);
  }
  return flux;
}

float arc_flux(Microfacets m, HalfArc half_arc, Turning turning, Peaks peaks, Level level)
{
  if (m.brdf != BRDF_GGX) {
    return lobe_flux(m, half_arc, turning, peaks, level);
  }
  Powers powers = powers_of(half_arc, peaks);
  float g0 = dot(m.weight, turning.c0), g1 = dot(m.weight, turning.c1), g2 = dot(m.weight, turning.c2);
  return 0.5f * (g0 * powers.zero + g1 * powers.one + g2 * powers.two);
}

RimArc rim_arc(Microfacets m, HalfArc half_arc, Peaks peaks, float first_node, Level level)
{
  RimArc arc;
  Turning turning = turning_of(half_arc);
  ArcNodes nodes = nodes_at(half_arc, turning, peaks, first_node, 0.5f);
  arc.a = nodes.a;
  arc.b = nodes.b;
  arc.flux = arc_flux(m, half_arc, turning, peaks, level);
  return arc;
}

vec3 turns(RimArc arc)
{
  return arc.a.turn + arc.b.turn;
}

// Towards the middle of what the outline encloses, weighted with the lobe.
vec3 lobe_turns(Microfacets m, RimArc arc)
{
  vec3 sum = turns(arc);
  if (m.brdf != BRDF_GGX) {
    sum = times(arc.a.turn, lobe_scale(m, arc.a.point)) + times(arc.b.turn, lobe_scale(m, arc.b.point));
  }
  return sum;
}

// The lobe over the guide at p, times a constant, as a logarithm.
float log_lobe(Microfacets m, vec3 p)
{
  float z2 = max(p.z * p.z, 1e-6f), slope2 = GUIDE * GUIDE * (p.x * p.x + p.y * p.y) / z2, log_density = -slope2;
  if (m.brdf == BRDF_BLINN_PHONG) {
    float a2 = m.rough.x * m.rough.x;
    log_density = (-1.0f / a2 - 1.0f) * log(1.0f + a2 * slope2);
  }
  return max(log_density - 2.0f * log(z2), -60.0f);
}

RimArc great_circle_arc(Microfacets m, vec3 a, vec3 b)
{
  HalfArc half_arc = great_arc(m.view, m.stretch, a, b);
  return rim_arc(m, half_arc, with_angles(half_arc, peaks_of(half_arc)), OPEN_NODE, no_level());
}

// A small circle that is small beside the lobe has its peaks at +-i, both: there the nodes' own sum is the better one.
#define NEARLY_ONE_PEAK 0.03f

RimArc small_circle_arc(Microfacets m, HalfArc half_arc, float first_node)
{
  Peaks peaks = with_angles(half_arc, peaks_of(half_arc));
  Level level = level_of(m, half_arc);
  RimArc arc = rim_arc(m, half_arc, peaks, first_node, level);
  if (m.brdf == BRDF_GGX) {
    float wide = NEARLY_ONE_PEAK * (peaks.w1 + peaks.w2), d = peaks.m1 - peaks.m2, e = peaks.w1 - peaks.w2;
    float by_nodes = level.flux + node_flux(m, level, arc.a) + node_flux(m, level, arc.b);
    arc.flux = pick(d * d + e * e < wide * wide, by_nodes, arc.flux);
  }
  return arc;
}

// Masking and Fresnel vary slowly over the region. Their mean: a fan of triangles from the region's middle to the nodes
// of its outline, each by two nodes along the ray: the apex, and FAN_NODE of the way. Three quarters would be Radau's
// rule, exact for quadratics; but masking falls faster than these towards the horizon, and so it is a little further
// out, as is best for rectangles of all kinds. A triangle turned inside out lies where the region does not, and its
// masking is that of elsewhere: it counts FAN_OUTSIDE as much.
#define FAN_NODE 0.77f
#define FAN_WEIGHT (2.0f / (3.0f * FAN_NODE))
#define FAN_OUTSIDE 0.5f

struct Mean {
  vec3 apex;
  vec3 facing; // the apex, negative where the outline runs clockwise
  Reflection at_apex;
  float apex_weight;
  float apex_lobe;
  float solid_angle;
  float weight; // and the others: of the nodes alone, without the apex
  float plain;
  float fresnel;
  float most; // masking at any node: the mean is no higher
};

// About the middle of an outline, whose sense is that of its flux.
Mean mean_about(Microfacets m, vec3 middle, float flux)
{
  Mean mean;
  float sense = pick(flux < 0.0f, -1.0f, 1.0f);
  // Inside by construction, but for rounding: a half vector below the horizon mirrors nothing.
  mean.apex = unit(vec3(middle.x * sense, middle.y * sense, max(middle.z * sense, 1e-6f)));
  mean.facing = mean.apex * sense;
  mean.at_apex = masking(m, mean.apex);
  mean.apex_weight = (1.0f - FAN_WEIGHT) * dot(m.weight, mean.apex);
  mean.apex_lobe = 0.0f;
  if (m.brdf != BRDF_GGX) {
    mean.apex_lobe = log_lobe(m, mean.apex);
  }
  mean.solid_angle = 0.0f;
  mean.weight = 0.0f;
  mean.plain = 0.0f;
  mean.fresnel = 0.0f;
  mean.most = mean.at_apex.plain;
  return mean;
}

Mean with_node(Mean mean, Microfacets m, ArcNode node)
{
  float near_part = 1.0f - FAN_NODE, far_part = FAN_NODE, cosine = dot(mean.apex, node.point);
  vec3 p = mean.apex * near_part + node.point * far_part, h = times(m.squash, p);
  float inverse = inversesqrt(near_part * near_part + far_part * far_part + 2.0f * near_part * far_part * cosine);
  float towards = dot(m.view, h);
  Reflection g = masking_at(m, h, towards);
  float solid_angle = dot(mean.facing, node.turn) * reciprocal(max(1.0f + cosine, 1e-3f));
  solid_angle = max(solid_angle, solid_angle * FAN_OUTSIDE);
  float at_node = FAN_WEIGHT * inverse * solid_angle * towards;
  if (m.brdf != BRDF_GGX) {
    at_node = at_node * exp(min(log_lobe(m, p * inverse) - mean.apex_lobe, 20.0f));
  }
  mean.solid_angle = mean.solid_angle + solid_angle;
  mean.weight = mean.weight + at_node;
  mean.plain = mean.plain + at_node * g.plain;
  mean.fresnel = mean.fresnel + at_node * g.fresnel;
  mean.most = max(mean.most, g.plain);
  return mean;
}

Mean with_arc(Mean mean, Microfacets m, RimArc arc)
{
  return with_node(with_node(mean, m, arc.a), m, arc.b);
}

// Of a light whose numbers have the sum of squares `size2`.
Reflection reflected(Microfacets m, float size2, Mean mean, float flux)
{
  float at_apex = mean.solid_angle * mean.apex_weight, weight = mean.weight + at_apex;
  // Negative where a tiny light's flux is all rounding.
  float k = pick(weight < 0.0f, -1.0f, 1.0f) * reciprocal(max(abs(weight), TINY));
  float amount = 0.318309886183790672f * abs(flux);
  float plain = min(max((mean.plain + at_apex * mean.at_apex.plain) * k, 0.0f), mean.most);
  float fresnel = min(max((mean.fresnel + at_apex * mean.at_apex.fresnel) * k, 0.0f), plain);
  Reflection light;
  // Energy: a surface lit by radiance 1 from everywhere sends no more.
  light.plain = if_finite(m.size2 + size2, pick(amount > 0.0f, min(amount * plain, 1.0f), 0.0f));
  light.fresnel = min(if_finite(m.size2 + size2, pick(amount > 0.0f, amount * fresnel, 0.0f)), light.plain);
  return light;
}
