// SPDX-License-Identifier: GPL-3.0-or-later
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

Arc arc_of(Edge edge, vec3 r, float height_from, float height_to)
{
  Edge front = clip_edge(edge, height_from, height_to);
  Arc arc;
  arc.s = dot(front.normal, r);
  arc.a0 = max(height_from, 0.0f);
  arc.a1 = max(height_to, 0.0f);
  arc.across = dot(front.from - r * arc.a0, front.to - r * arc.a1);
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

// Our fit of two poles, B = 2p/N, to within 1.0e-4 for every u = 1/N <= 0.1 (n >= 9); u = 0 is the Gaussian limit. Least
// squares with Lawson's weights towards the least maximum, rho^2 N/2 from 0 to 4.5e6, and polynomials of degree 5.
Poles two_poles(float exponent)
{
  float u = 1.0f / (exponent + 1.0f);
  Poles poles;
  poles.b1.re = 2.0f * u * (1.5420265f + u * (7.8973299f + u * (21.399981f + u * (-1034.4705f + u * (11175.055f + u * -39367.335f)))));
  poles.b1.im = 2.0f * u * (1.1751342f + u * (0.11309296f + u * (-19.357813f + u * (-108.80751f + u * (109.77942f + u * 2078.6727f)))));
  poles.b2.re = 2.0f * u * (-0.36668569f + u * (20.067264f + u * (118.60601f + u * (-416.67195f + u * (5993.1893f + u * -61281.035f)))));
  poles.b2.im = 2.0f * u * (3.6045084f + u * (14.580092f + u * (-42.757471f + u * (-862.9196f + u * (-1028.7943f + u * 7148.6525f)))));
  poles.w1.re = 1.2378406f + u * (2.2403279f + u * (4.7730779f + u * (-213.38752f + u * (1092.6453f + u * 3595.3765f))));
  poles.w1.im = 1.4787057f + u * (11.887058f + u * (93.435197f + u * (-1048.8124f + u * (10499.107f + u * -6175.8479f))));
  poles.w2.re = 1.0f - poles.w1.re;
  poles.w2.im = 0.076331625f + u * (-1.7184077f + u * (-20.091837f + u * (-18.797731f + u * (1200.5634f + u * -9489.2146f))));
  return poles;
}
