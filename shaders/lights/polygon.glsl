// SPDX-License-Identifier: GPL-3.0-or-later
// Convex polygonal lights seen from the shading point, which is the origin: edges, clipping, and Lambert's irradiance.
//
// An edge is the arc of the great circle through two vertices, which need no particular length. Integrals of polynomials
// over a polygon are sums over its edges (Arvo, "Applications of Irradiance Tensors", 1995), so that clipping needs no
// new list of vertices: each edge is cut to the half space on its own, and one more edge, in the clipping plane, leads
// from where the polygon leaves it to where it returns. A convex polygon does both at most once.

// Exact to float32 in one lane, and to float64 where `float` is double.
#define PI_EXACT (float(3.14159274101257f) - 8.74227765734758e-8f)

struct Edge {
  vec3 normal; // of its plane, to the inside for a polygon that is clockwise seen from the origin; 0 for no edge
  vec3 from;
  vec3 to;
  float area; // |from x to|, which is |from| |to| sin(angle)
};

vec3 unit_or_zero(vec3 v)
{
  return v * (1.0f / sqrt(max(dot(v, v), 1e-36f)));
}

// a x b from the difference, which is exact for short edges: their product alone would cancel.
Edge edge_between(vec3 a, vec3 b)
{
  vec3 across = cross(a, b - a);
  float area = sqrt(dot(across, across));
  Edge edge;
  edge.normal = across * (1.0f / max(area, 1e-18f));
  edge.from = a;
  edge.to = b;
  edge.area = area;
  return edge;
}

// What numbers of the sum of squares `size2` give; black if any of them was NaN or infinite. A GPU's min and max may turn
// NaN into their other argument: at the end of a formula it would be white.
float if_finite(float size2, float value)
{
  return pick(size2 < 1e37f, value, 0.0f);
}

// atan(y, x) in (-pi, pi], and 0 for the undefined angle of (0, 0).
float safe_angle(float y, float x)
{
  return atan(y, pick(abs(x) + abs(y) > 0.0f, x, 1.0f));
}

// Where an edge with these heights over a plane crosses it, and the part of an edge in front of the plane.
float crossing_share(float height_from, float height_to)
{
  return abs(height_from) / max(abs(height_from) + abs(height_to), 1e-30f);
}

Edge clip_edge(Edge edge, float height_from, float height_to)
{
  float share = crossing_share(height_from, height_to);
  vec3 crossing = edge.from + (edge.to - edge.from) * share;
  Edge clipped;
  clipped.normal = edge.normal;
  clipped.from = pick(height_from < 0.0f, crossing, edge.from);
  clipped.to = pick(height_to < 0.0f, crossing, edge.to);
  clipped.area = edge.area * (pick(height_to < 0.0f, share, 1.0f) - pick(height_from < 0.0f, share, 0.0f));
  return clipped;
}

// Where a polygon leaves the half space in front of a plane, and where it returns: zero until it has.
struct Gap {
  vec3 exit;
  vec3 entry;
};

Gap no_gap()
{
  Gap gap;
  gap.exit = vec3(0.0f, 0.0f, 0.0f);
  gap.entry = vec3(0.0f, 0.0f, 0.0f);
  return gap;
}

Gap gap_after(Gap gap, Edge edge, float height_from, float height_to)
{
  vec3 crossing = edge.from + (edge.to - edge.from) * crossing_share(height_from, height_to);
  float leaves = pick(height_from < 0.0f, 0.0f, pick(height_to < 0.0f, 1.0f, 0.0f));
  float returns = pick(height_from < 0.0f, pick(height_to < 0.0f, 0.0f, 1.0f), 0.0f);
  gap.exit = gap.exit + crossing * leaves;
  gap.entry = gap.entry + crossing * returns;
  return gap;
}

// The angle from exit to entry about the plane's normal n.
float gap_angle(Gap gap, vec3 n)
{
  return safe_angle(dot(n, cross(gap.exit, gap.entry)), dot(gap.exit, gap.entry));
}

// The edge that closes the gap: it lies in the plane, so that its normal is n, or -n for a polygon wound the other way.
Edge gap_edge(Gap gap, vec3 n)
{
  float area = dot(n, cross(gap.exit, gap.entry));
  Edge edge;
  edge.normal = n * pick(area < 0.0f, -1.0f, 1.0f);
  edge.from = gap.exit;
  edge.to = gap.entry;
  edge.area = abs(area);
  return edge;
}

// ---- Lambert ----
// irradiance = n . f with f = 1/2 sum_edges angle (from x to)/|from x to|, for radiance 1 (Lambert 1760).

float lambert_edge(Edge edge, vec3 n)
{
  return dot(edge.normal, n) * safe_angle(edge.area, dot(edge.from, edge.to));
}

float clipped_lambert_edge(Edge edge, vec3 n, float height_from, float height_to)
{
  return lambert_edge(clip_edge(edge, height_from, height_to), n);
}

// From the sum over the clipped edges and the gap in the horizon: positive for polygons that are clockwise seen from the
// origin, irradiance / pi.
float lambert_of(float sum, Gap gap, vec3 n)
{
  return (sum + gap_angle(gap, n)) / (2.0f * PI_EXACT);
}

// Irradiance / pi on a surface with the unit normal n, from a quadrilateral of radiance 1 with corners a, b, c, d, all
// seen from the shading point. Either winding gives the same; what is below the horizon gives nothing.
float diffuse_quad(vec3 n, vec3 a, vec3 b, vec3 c, vec3 d)
{
  float ha = dot(a, n);
  float hb = dot(b, n);
  float hc = dot(c, n);
  float hd = dot(d, n);
  Edge ab = edge_between(a, b);
  Edge bc = edge_between(b, c);
  Edge cd = edge_between(c, d);
  Edge da = edge_between(d, a);
  float sum = clipped_lambert_edge(ab, n, ha, hb) + clipped_lambert_edge(bc, n, hb, hc) +
              clipped_lambert_edge(cd, n, hc, hd) + clipped_lambert_edge(da, n, hd, ha);
  Gap gap = gap_after(gap_after(no_gap(), ab, ha, hb), bc, hb, hc);
  gap = gap_after(gap_after(gap, cd, hc, hd), da, hd, ha);
  float above = max(max(ha, hb), max(hc, hd));
  float size2 = dot(a, a) + dot(b, b) + dot(c, c) + dot(d, d) + dot(n, n);
  return if_finite(size2, pick(above > 0.0f, min(abs(lambert_of(sum, gap, n)), 1.0f), 0.0f));
}

// Irradiance / pi from a sphere of radiance 1. Above the horizon it is cos(angle) sin^2(sigma), where sigma is the half
// angle of the sphere; one that the horizon cuts follows Snyder, "Area Light Sources for Real-Time Graphics", 1996.
float diffuse_sphere(vec3 n, vec3 centre, float radius)
{
  float distance2 = dot(centre, centre);
  float cosine = clamp(dot(n, centre) / sqrt(max(distance2, 1e-36f)), -1.0f, 1.0f);
  float sine2 = max(1.0f - cosine * cosine, 0.0f);
  float sin2 = min(radius * radius / max(distance2, 1e-36f), 1.0f); // of sigma
  float whole = sin2 * cosine;

  // The azimuth at which the horizon cuts the cone has cosine y; z is a tangent.
  float safe_sin2 = max(sin2, 1e-30f);
  float x = sqrt(max(1.0f - sin2, 0.0f) / safe_sin2);
  float y = clamp(-x * cosine / sqrt(max(sine2, 1e-12f)), -1.0f, 1.0f);
  float root = sqrt(max(1.0f - y * y, 0.0f));
  float height = sqrt(sine2) * root;
  // atan(z) - z cos^2(sigma) with z = height / x, regrouped as (atan(z) - z) + z sin^2(sigma) for small lights, whose z
  // is small.
  float z = height / max(x, 1e-6f);
  float z2 = z * z;
  float series = -z * z2 * (1.0f / 3.0f - z2 * (1.0f / 5.0f - z2 * (1.0f / 7.0f - z2 * (1.0f / 9.0f))));
  float tail = pick(z < 0.1f, series + z * sin2, atan(height, x) - height * x * sin2);
  float cut = (sin2 * cosine * atan(root, y) + tail) / PI_EXACT;

  float part = pick(cosine * abs(cosine) < -sin2, 0.0f, pick(cosine * abs(cosine) > sin2, whole, cut));
  float size2 = distance2 + radius * radius + dot(n, n);
  return if_finite(size2, pick(distance2 > radius * radius, clamp(part, 0.0f, 1.0f), 1.0f));
}
