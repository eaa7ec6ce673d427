// SPDX-License-Identifier: GPL-3.0-or-later
// Light reflected by microfacets, as integrals over half vectors: the outline of a light, and what it encloses.
//
// A light fills a region of directions i; the microfacets that mirror it into the eye fill a region of half vectors
// h = i + view. Walter, Marschner, Li and Torrance, "Microfacet Models for Refraction through Rough Surfaces", 2007,
// eqs 13-14: di = 4 (v.h) dh. So the light that they reflect, before masking and Fresnel, is
//   (1/n.v) int D(h) (v.h) dh.
// Trowbridge and Reitz's D (GGX) is constant on the sphere of p = S h, S = diag(1/alpha_x, 1/alpha_y, 1): there
// D(h) h dh = (1/pi) S^-1 p dp, which Stokes turns into an integral along the outline (Lambert 1760, for w = S^-1 view):
//   int D (v.h) dh = (1/pi) oint 1/2 w.(p x p') / |p|^2.
//
// What is ours. On any circle of directions, great (the edge of a polygon, the horizon) or small (the rim of a sphere),
// i = (1 - s^2, 2 s) / (1 + s^2) in the circle's own axes, s being the tangent of half the angle. So p is a quadratic
// in s, p x p' a quadratic too and |p|^2 a quartic with no real root: the integral is elementary, and exact however
// small alpha is. No edge is split, nothing is tabulated.
//
// In single precision an edge's place is known to 6e-8, and a lobe is alpha wide: 999 of 1000 isotropic lights are
// good to 5e-6 for alpha >= 0.01 and n.v >= 0.03, all to 3e-5. Of brushed metal whose alphas are more than tenfold apart,
// the smaller below 0.1, 98 of 100 are, 999 of 1000 to 1e-4, and the worst of 40 000 is off by 4e-3.

#define TINY 1e-30f

vec3 unit(vec3 v)
{
  float k = inversesqrt(max(dot(v, v), TINY));
  return v * k;
}

vec3 times(vec3 a, vec3 b)
{
  return vec3(a.x * b.x, a.y * b.y, a.z * b.z);
}

// The angle of (x, y), y >= 0, from the x axis: 0 to pi. A polynomial through Chebyshev's points, 1e-8.
float angle_of(float x, float y)
{
  float wide = abs(x);
  float low = min(wide, y), high = max(max(wide, y), TINY);
  float t = low * reciprocal(high);
  float q = t * t;
  float a = 0.00276628f * q - 0.01573125f;
  a = a * q + 0.04213762f;
  a = a * q - 0.07456855f;
  a = a * q + 0.10618371f;
  a = a * q - 0.14197798f;
  a = a * q + 0.19991872f;
  a = a * q - 0.33333037f;
  a = a * q + 0.99999998f;
  a = a * t;
  a = pick(y > wide, 1.57079632679489662f - a, a);
  return pick(x < 0.0f, 3.14159265358979324f - a, a);
}

// cos(2/3 acos u), u in [0, 1]: a third of an angle from the cosine of half of it. A polynomial, 3e-8.
float third_of_angle(float u)
{
  float c = 0.00112764f * u - 0.00608935f;
  c = c * u + 0.01604728f;
  c = c * u - 0.0302354f;
  c = c * u + 0.05284141f;
  c = c * u - 0.11103851f;
  c = c * u + 0.57734692f;
  return c * u + 0.50000003f;
}

// Part of the outline, p0 + p1 s + p2 s^2, from s = low to s = high, by way of infinity where low > high.
struct HalfArc {
  vec3 p0;
  vec3 p1;
  vec3 p2;
  float low;
  float high;
};

#define FAR_END 1e6f

// The tangent of half the angle whose cosine and sine are given.
float half_tangent(float cosine, float sine)
{
  float safe = pick(abs(sine) > 1e-12f, sine, 1e-12f);
  float tangent = pick(cosine > 0.0f, sine, 1.0f - cosine) * reciprocal(pick(cosine > 0.0f, 1.0f + cosine, safe));
  return clamp(tangent, -FAR_END, FAR_END);
}

vec3 mirrored(vec3 view)
{
  return vec3(-view.x, -view.y, view.z);
}

// The great arc from direction a to direction b, less than half a turn, first about its middle, then about where it is
// nearest to the mirrored view or, at grazing angles and on brushed metal, whose lobe is long and lies askew, one step of
// Newton's further towards the lobe's axis. There all else is small, so that no peak is lost to rounding.
HalfArc great_arc(vec3 view, vec3 stretch, vec3 a, vec3 b)
{
  float two = 2.0f;
  vec3 sum = a + b, chord = b - a, mirror = mirrored(view);
  float sum2 = dot(sum, sum), chord2 = dot(chord, chord);
  float by_sum = inversesqrt(max(sum2, TINY)), by_chord = inversesqrt(max(chord2, TINY));
  vec3 axis = sum * by_sum, side = chord * by_chord;
  float end = chord2 * by_chord * reciprocal(2.0f + sum2 * by_sum);
  float x = dot(mirror, axis), y = dot(mirror, side);
  // On the far side of the circle: beyond either end, or, of an arc from whose pole one looks, its middle.
  float nearest = y * reciprocal(max(x + sqrt(x * x + y * y), 1e-3f * abs(y) + 1e-12f));
  nearest = clamp(nearest, -end, end);
  vec3 p0 = times(stretch, view + axis), p1 = times(stretch, side * two), p2 = times(stretch, view - axis);
  vec3 bend = p2 * nearest, p = p0 + (p1 + bend) * nearest, slope = p1 + bend + bend;
  float px = slope.x * p.z - p.x * slope.z, py = slope.y * p.z - p.y * slope.z;
  float step = -(p.x * px + p.y * py) * p.z * reciprocal(max(px * px + py * py, TINY));
  float at = clamp(nearest + step, -end, end), twice = 2.0f * at, rest = 1.0f - at * at;
  // Turned about the circle's axis; a common factor of p, 1 + at^2, means nothing.
  HalfArc arc;
  arc.p0 = p0 + (p1 + p2 * at) * at;
  arc.p1 = p1 * rest + (p2 - p0) * twice;
  arc.p2 = p2 - (p1 - p0 * at) * at;
  // At most half a turn: neither end passes infinity.
  arc.low = -(end + at) * reciprocal(max(1.0f - at * end, 1e-6f));
  arc.high = (end - at) * reciprocal(max(1.0f + at * end, 1e-6f));
  return arc;
}

// An arc of the circle centre + x cos t + y sin t of directions, by the cosines and sines of its ends.
HalfArc small_arc(vec3 view, vec3 stretch, vec3 centre, vec3 x, vec3 y, float cos_a, float sin_a, float cos_b,
                  float sin_b)
{
  vec3 mirror = mirrored(view);
  float c = dot(mirror, x), s = dot(mirror, y);
  float length2 = c * c + s * s, k = inversesqrt(max(length2, TINY));
  c = pick(length2 < 1e-20f, 1.0f, c * k);
  s = pick(length2 < 1e-20f, 0.0f, s * k);
  vec3 axis = x * c + y * s, side = y * c - x * s, middle = view + centre;
  HalfArc arc;
  float two = 2.0f;
  arc.p0 = times(stretch, middle + axis);
  arc.p1 = times(stretch, side * two);
  arc.p2 = times(stretch, middle - axis);
  arc.low = half_tangent(cos_a * c + sin_a * s, sin_a * c - cos_a * s);
  arc.high = half_tangent(cos_b * c + sin_b * s, sin_b * c - cos_b * s);
  return arc;
}

// |p|^2 scale = ((s - m1)^2 + w1^2) ((s - m2)^2 + w2^2): where the outline passes the lobe's axis, and how wide a peak
// of the integrand is there. Each peak turns through its angle on the way along the arc.
struct Peaks {
  float scale;
  float m1;
  float w1;
  float m2;
  float w2;
  float angle1;
  float angle2;
  float log_ratio;
};

float turned(float m, float w, float low, float high)
{
  float sine = w * (high - low), cosine = w * w + (low - m) * (high - m);
  float turn = angle_of(cosine, abs(sine));
  return pick(sine < 0.0f, 3.14159265358979324f - turn, turn);
}

float from_root(float s, float m, float w)
{
  return (s - m) * (s - m) + w * w;
}

// Ferrari's resolvent. Of its three roots, all real, the largest is the sum of the squared moduli of the quartic's two
// pairs; the smaller modulus follows from their product, which is a0, without cancellation.
//
// Brushed metal's lobe is a ridge, all but a function of one slope: |p|^2 is nearly the square of a quadratic, the
// peaks are nearly one, and so are the two larger roots: half of the digits are lost. But about the peaks' middle the
// roots are (m1 - m2)^2, -(w1 - w2)^2 and -(w1 + w2)^2, and their sum and products known from what
// (s^2 + a3/2 s + gamma)^2 leaves of the quartic, slope s + (a0 - gamma^2): the small two follow from
// x = ((w1 - w2)^2 - (m1 - m2)^2) / wide2 where x = even / (1 - x) + odd / (1 - x)^2, by its series.
#define ONE_RIDGE 0.03f

// There the cosine of three times the angle that tells the roots apart is near -1.
#define RIDGE_COSINE (-0.99f)

float ridge_sum(float a0, float a1, float a2, float a3, float sum)
{
  float half_a3 = 0.5f * a3, gamma = 0.5f * (a2 - half_a3 * half_a3), slope = a1 - a3 * gamma;
  float wide2 = max(4.0f * gamma - half_a3 * half_a3, TINY), by_wide2 = reciprocal(wide2);
  float even = (slope * a3 - 4.0f * (a0 - gamma * gamma)) * by_wide2 * by_wide2;
  float part = slope * by_wide2, odd = part * part * by_wide2;
  float x = even + odd;
  x = even + odd + x * (even + 2.0f * odd);
  x = even + odd + x * (even + 2.0f * odd + x * (even + 3.0f * odd));
  float apart2 = x * x + 4.0f * odd * (1.0f + x + x * x);
  return pick(apart2 < ONE_RIDGE * ONE_RIDGE, 0.5f * (half_a3 * half_a3 + wide2 * (1.0f - x + sqrt(apart2))), sum);
}

Peaks peaks_of(HalfArc arc)
{
  Peaks peaks;
  // p2 vanishes where the arc passes through the view itself: one peak goes to infinity. Not further than this.
  float c4 = max(max(dot(arc.p2, arc.p2), 1e-6f * dot(arc.p1, arc.p1)), 1e-12f);
  float k = reciprocal(c4);
  float a0 = dot(arc.p0, arc.p0) * k, a1 = 2.0f * dot(arc.p0, arc.p1) * k, a3 = 2.0f * dot(arc.p1, arc.p2) * k;
  float a2 = (dot(arc.p1, arc.p1) + 2.0f * dot(arc.p0, arc.p2)) * k;
  float b = a1 * a3 - 4.0f * a0;
  float c = 4.0f * a2 * a0 - a3 * a3 * a0 - a1 * a1;
  float q = max(a2 * a2 - 3.0f * b, TINY) * 0.111111111111111111f;
  float by_root_q = inversesqrt(q), root_q = q * by_root_q;
  float r = (2.0f * a2 * a2 * a2 - 9.0f * a2 * b - 27.0f * c) * 0.0185185185185185185f;
  float cosine = clamp(r * by_root_q * by_root_q * by_root_q, -1.0f, 1.0f);
  float sum = a2 * 0.333333333333333333f + 2.0f * root_q * third_of_angle(sqrt(0.5f + 0.5f * cosine));
  if (any_lane(cosine < RIDGE_COSINE)) {
    sum = ridge_sum(a0, a1, a2, a3, sum);
  }
  float apart_c = sqrt(max(sum * sum - 4.0f * a0, 0.0f));
  float apart_b = sqrt(max(a3 * a3 - 4.0f * (a2 - sum), 0.0f));
  float c2 = max(0.5f * (sum + apart_c), TINY);
  float c1 = a0 * reciprocal(c2);
  // The linear terms by whichever difference is the safer divisor.
  float by_c = (a1 - a3 * c1) * reciprocal(max(apart_c, TINY));
  float by_b = 0.5f * (a3 + pick(a1 < 0.5f * a3 * sum, -apart_b, apart_b));
  float b1 = pick(apart_c * apart_c > apart_b * apart_b * abs(sum), by_c, by_b);
  float b2 = a3 - b1;
  peaks.scale = k;
  peaks.m1 = -0.5f * b1;
  peaks.m2 = -0.5f * b2;
  peaks.w1 = sqrt(max(c1 - peaks.m1 * peaks.m1, 1e-9f * c1 + 1e-18f));
  peaks.w2 = sqrt(max(c2 - peaks.m2 * peaks.m2, 1e-9f * c2 + 1e-18f));
  return peaks;
}

Peaks with_angles(HalfArc arc, Peaks peaks)
{
  peaks.angle1 = turned(peaks.m1, peaks.w1, arc.low, arc.high);
  peaks.angle2 = turned(peaks.m2, peaks.w2, arc.low, arc.high);
  return peaks;
}

// The integrals along the arc of 1, s and s^2 over |p|^2, by partial fractions. The residues at two peaks that coincide
// would be infinite and opposite; a relative distance of SEPARATION costs its square, and saves the rounding.
struct Powers {
  float zero;
  float one;
  float two;
};

#define SEPARATION 0.002f

Powers powers_of(HalfArc arc, Peaks peaks)
{
  float m1 = peaks.m1, m2 = peaks.m2;
  float gap = (m1 - m2) * (m1 - m2) + (peaks.w1 - peaks.w2) * (peaks.w1 - peaks.w2);
  float wide = peaks.w1 + peaks.w2;
  float shift = pick(gap < SEPARATION * SEPARATION * wide * wide, 0.5f * SEPARATION * wide, 0.0f);
  float w1 = peaks.w1 + shift, w2 = max(peaks.w2 - shift, TINY);
  float d = m1 - m2, sums = (w1 - w2) * (w1 + w2);
  // (z1 - z2) (z1 - conj z2), and its like at z2.
  float q_re1 = d * d - sums, q_im1 = 2.0f * d * w1, q_re2 = d * d + sums, q_im2 = -2.0f * d * w2;
  float k = peaks.scale * reciprocal(max(w1 * w2 * (q_re1 * q_re1 + q_im1 * q_im1), TINY)); // |q1| = |q2|
  float ratio = from_root(arc.high, m1, w1) * from_root(arc.low, m2, w2);
  ratio = ratio * reciprocal(max(from_root(arc.low, m1, w1) * from_root(arc.high, m2, w2), TINY));
  // The logarithm of both peaks has opposite factors: the integrand falls as 1/s^2.
  float by_log = 0.5f * log(max(ratio, TINY)) * k * w2, angle1 = peaks.angle1 * k * w2, angle2 = peaks.angle2 * k * w1;
  // What the real part of a numerator at each peak is to be taken by, and the imaginary one.
  float re1 = q_re1 * angle1 - q_im1 * by_log, im1 = (q_im1 * angle1 + q_re1 * by_log) * w1;
  float re2 = q_re2 * angle2, im2 = q_im2 * angle2 * w2;
  Powers powers;
  powers.zero = re1 + re2;
  powers.one = re1 * m1 + im1 + (re2 * m2 + im2);
  powers.two = re1 * (m1 * m1 - w1 * w1) + re2 * (m2 * m2 - w2 * w2) + 2.0f * (im1 * m1 + im2 * m2);
  return powers;
}

// p x p' = c0 + c1 s + c2 s^2.
struct Turning {
  vec3 c0;
  vec3 c1;
  vec3 c2;
};

Turning turning_of(HalfArc arc)
{
  Turning turning;
  turning.c0 = cross(arc.p0, arc.p1);
  turning.c1 = cross(arc.p0, arc.p2 + arc.p2);
  turning.c2 = cross(arc.p1, arc.p2);
  return turning;
}

// A point of the outline, p normalised, and its share of the integral of p x p' / |p|^2.
struct ArcNode {
  vec3 point;
  vec3 turn;
};

// The nodes at a given share of both peaks' angles, at most a half, from either end. There the two integrands 1/|s - z|^2
// are flat, and (s - z1)(s - z2) has a known phase: s is the root of a quadratic.
struct ArcNodes {
  ArcNode a;
  ArcNode b;
};

// The node whose phase is that of the arc's end s, turned.
ArcNode node_after(HalfArc arc, Turning turning, Peaks peaks, float end, float cosine, float sine, float weight)
{
  float m1 = peaks.m1, m2 = peaks.m2, w1 = peaks.w1, w2 = peaks.w2;
  float x = (end - m1) * (end - m2) - w1 * w2, y = -w1 * (end - m2) - w2 * (end - m1);
  float ex = x * cosine - y * sine, ey = y * cosine + x * sine;
  // Of both roots s the one where the phase is this rather than the opposite one: it grows with s from none to a turn, so
  // up to half a turn, where ey > 0, the lesser root, and beyond the greater. By the divisor that does not cancel.
  float qb = ey * (m1 + m2) - ex * (w1 + w2), qc = ex * (m1 * w2 + m2 * w1) - ey * (m1 * m2 - w1 * w2);
  float discriminant = sqrt(max(qb * qb + 4.0f * ey * qc, 0.0f)), size = abs(qb) + discriminant;
  float n = pick(qb < 0.0f, -size, -2.0f * qc), d = pick(qb < 0.0f, 2.0f * ey, size);
  float s = clamp(n * reciprocal(pick(abs(d) > TINY, d, TINY)), -FAR_END, FAR_END);
  float from1 = from_root(s, m1, w1), from2 = from_root(s, m2, w2);
  vec3 p = arc.p0 + (arc.p1 + arc.p2 * s) * s;
  // |p|^2 scale = from1 from2.
  float amount = weight * peaks.scale * reciprocal(max(w1 * from2 + w2 * from1, TINY));
  ArcNode node;
  node.point = unit(p);
  node.turn = (turning.c0 + (turning.c1 + turning.c2 * s) * s) * amount;
  return node;
}

ArcNodes nodes_at(HalfArc arc, Turning turning, Peaks peaks, float share, float weight)
{
  float total = peaks.angle1 + peaks.angle2, turn = 0.5f * total * share, x = turn * turn;
  // Taylor's series, for angles up to a quarter of a turn: 3e-5. Where a node lies need not be exact.
  float s = -0.000198412698412698413f + x * 2.75573192239858907e-6f;
  s = -0.166666666666666667f + x * (0.00833333333333333333f + x * s);
  float c = -0.00138888888888888889f + x * 2.48015873015873016e-5f;
  c = -0.5f + x * (0.0416666666666666667f + x * c);
  float half_sine = turn * (1.0f + x * s), half_cosine = 1.0f + x * c;
  float cosine = 1.0f - 2.0f * half_sine * half_sine, sine = 2.0f * half_sine * half_cosine;
  ArcNodes nodes;
  nodes.a = node_after(arc, turning, peaks, arc.low, cosine, sine, total * weight);
  nodes.b = node_after(arc, turning, peaks, arc.high, cosine, -sine, total * weight);
  return nodes;
}
