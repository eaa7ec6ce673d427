// SPDX-License-Identifier: GPL-3.0-or-later
// needs: complex polygon
// Cosine powers over polygons as a sum of poles.
//
// With N = n + 1 and the lobe's axis r, L = N/(2 pi) M^n = N/(2 pi) int (u.r)^n du over a polygon in front of r's plane
// is 1/(2 pi) times the integral of 1 - (1 + rho^2)^(-N/2) over the azimuth about r along the boundary, where
// rho = tan(theta). Lecocq et al., "Analytic Approximations for Real-Time Area Light Shading", 2017, fit that integrand
// edge by edge. It is the same radial function for all edges, so we fit it once,
//     (1 + rho^2)^(-N/2) = sum Re[w / (1 + rho^2/B)],   sum Re w = 1,
// and every pole B integrates in closed form along every edge.

// An edge in front of r's plane: s = m.r with the edge's normal m; and of its ends p0, p1, of any length, the cosines
// a = p.r, the product `across` of what they have across r, and `area` = |p0 x p1|.
struct Arc {
  float s;
  float a0;
  float a1;
  float across;
  float area;
};

// r of any length: the rounding of a unit vector would turn narrow lobes. So s comes from what the ends have across r,
// which is exact near the lobe, rather than from the rounded normal.
Arc arc_of(Edge edge, vec3 r, float height_from, float height_to)
{
  Edge front = clip_edge(edge, height_from, height_to);
  float inverse2 = 1.0f / dot(r, r);
  float inverse = sqrt(inverse2);
  float from_height = max(height_from, 0.0f);
  float to_height = max(height_to, 0.0f);
  vec3 from = front.from - r * (from_height * inverse2);
  vec3 to = front.to - r * (to_height * inverse2);
  Arc arc;
  arc.a0 = from_height * inverse;
  arc.a1 = to_height * inverse;
  arc.across = dot(from, to);
  vec3 nearest = pick(dot(from, from) < dot(to, to), from, to);
  arc.s = clamp(dot(r, cross(nearest, to - from)) * inverse / max(front.area, 1e-30f), -1.0f, 1.0f);
  arc.area = front.area;
  return arc;
}

// int (x dy - y dx)/(rho^2 + B) along the arc, times w: (s/sigma) A, with sigma^2 = s^2 + B (1 - s^2) and
// tan(A) = Q/P, Q = sigma area, P = across + B a0 a1. The real part of A lies in [0, pi]. Written with the products
// across r rather than with the angles along the edge, which have no origin on an edge in r's plane.
float pole_along(Arc arc, Complex b, Complex w)
{
  float c2 = max(1.0f - arc.s * arc.s, 0.0f);
  Complex sigma = complex_sqrt(complex(arc.s * arc.s + b.re * c2, b.im * c2));
  Complex p = complex(arc.across + b.re * arc.a0 * arc.a1, b.im * arc.a0 * arc.a1);
  Complex angle = complex_atan(complex_scale(arc.area, sigma), p);
  angle.re = angle.re + pick(angle.re < 0.0f, PI_EXACT, 0.0f);
  Complex wa = complex_mul(w, angle);
  return arc.s * (wa.re * sigma.re + wa.im * sigma.im) / max(complex_norm(sigma), 1e-30f);
}

struct Poles {
  Complex b1;
  Complex b2;
  Complex w1;
  Complex w2;
};

float poles_along(Arc arc, Poles poles)
{
  return pole_along(arc, poles.b1, poles.w1) + pole_along(arc, poles.b2, poles.w2);
}

// Our fit of two poles, B = 2p/N, for every u = 1/N <= 0.1 (n >= 9); u = 0 is the Gaussian limit. The best two poles
// for the greatest error leave 1.0e-4 at u = 0, 2.7e-5 at .05 and 3e-6 at .1. These polynomials, by least squares with
// Lawson's weights, leave 1.3e-4, 4e-5 and 2e-5; what a light makes of it is about half.
Poles two_poles(float exponent)
{
  float u = 1.0f / (exponent + 1.0f);
  Poles poles;
  poles.b1.re = 2.0f * u * (1.5346741f + u * (8.1164861f + u * (48.711274f + u * (-529.82671f + u * (-21.191878f + u * 6304.1399f)))));
  poles.b1.im = 2.0f * u * (1.1780214f + u * (-0.12292215f + u * (0.17599221f + u * (-405.78169f + u * (1721.9813f + u * 542.62839f)))));
  poles.b2.re = 2.0f * u * (-0.38746166f + u * (22.924719f + u * (86.795551f + u * (458.6027f + u * (-333.70052f + u * -33844.515f)))));
  poles.b2.im = 2.0f * u * (3.6233248f + u * (13.026627f + u * (-8.7822607f + u * (-271.05505f + u * (-12128.052f + u * 51116.731f)))));
  poles.w1.re = 1.2340956f + u * (2.6272733f + u * (8.9864226f + u * (-109.53281f + u * (-1659.1265f + u * 2459.4991f))));
  poles.w1.im = 1.4780011f + u * (10.916041f + u * (169.32519f + u * (-211.21721f + u * (4324.9316f + u * -9619.3108f))));
  poles.w2.re = 1.0f - poles.w1.re;
  poles.w2.im = 0.072393972f + u * (-1.2698789f + u * (-38.384491f + u * (-90.476662f + u * (-129.45197f + u * 4351.9687f))));
  return poles;
}
