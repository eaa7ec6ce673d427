// SPDX-License-Identifier: GPL-3.0-or-later
// needs: complex polygon
// Elliptical lights, and spherical ones by their circular outline: cosine powers (poles.glsl) and Lambert's irradiance.
//
// Along the outline p = u cos(psi) + v sin(psi) + centre one pole B integrates
//     r.(p x p') / (|p|^2 + (B-1)(p.r)^2) = nu.e / (e.S e),   e = (cos(psi), sin(psi), 1),
// with a complex symmetric S. Since e.J e = 0 for J = diag(1, 1, -1), S may be replaced by S - lambda J, and for
// det(S - lambda J) = 0 the denominator falls into two factors, (l1.e)(l2.e). The root lambda that is negative for real
// B > 0 puts both zeros of l1.e inside the unit circle of exp(i psi) and both of l2.e outside. Then, with l1 x l2
// along k and nu = c1 l1 + c2 l2 + c3 J k, any arc has the integral
//     c1 int 1/(l2.e) + c2 int 1/(l1.e) + c3 [log(l1.e) - log(l2.e)] / (l2_y - l1_y),
// and the whole outline 4 pi i c3 / (l2_y - l1_y). Our derivation; no sampling, no iteration but for lambda's.

struct EllipseCone {
  vec3 nu;
  vec3 along; // r.u, r.v, r.centre
  float uu;   // the products of u, v, centre across r: S = these + B along along^T
  float vv;
  float cc;
  float uv;
  float uc;
  float vc;
  float square0; // det(S - lambda J) = lambda^3 + square lambda^2 + linear lambda + constant, each of the form a + B b
  float square1;
  float linear0;
  float linear1;
  float constant1;
};

float squared(float x)
{
  return x * x;
}

EllipseCone ellipse_cone(vec3 u, vec3 v, vec3 centre, vec3 r)
{
  vec3 uv = cross(u, v);
  vec3 cv = cross(centre, v);
  vec3 uc = cross(u, centre);
  EllipseCone cone;
  cone.nu = vec3(dot(r, cv), dot(r, uc), dot(r, uv));
  cone.along = vec3(dot(r, u), dot(r, v), dot(r, centre));
  vec3 wu = u - r * cone.along.x;
  vec3 wv = v - r * cone.along.y;
  vec3 wc = centre - r * cone.along.z;
  cone.uu = dot(wu, wu);
  cone.vv = dot(wv, wv);
  cone.cc = dot(wc, wc);
  cone.uv = dot(wu, wv);
  cone.uc = dot(wu, wc);
  cone.vc = dot(wv, wc);
  vec3 uv_across = uv - r * cone.nu.z;
  vec3 cv_across = cv - r * cone.nu.x;
  vec3 uc_across = uc - r * cone.nu.y;
  cone.square0 = cone.cc - cone.uu - cone.vv;
  cone.square1 = squared(cone.along.z) - squared(cone.along.x) - squared(cone.along.y);
  cone.linear0 = squared(cone.nu.z) - squared(cone.nu.x) - squared(cone.nu.y);
  cone.linear1 = dot(uv_across, uv_across) - dot(cv_across, cv_across) - dot(uc_across, uc_across);
  cone.constant1 = squared(dot(centre, uv));
  return cone;
}

// The negative root for real b > 0, when all three are real: Laguerre's method from its lower bound, the entry S_zz.
float negative_root(EllipseCone cone, float b)
{
  float c2 = cone.square0 + b * cone.square1;
  float c1 = cone.linear0 + b * cone.linear1;
  float c0 = b * cone.constant1;
  float x = -(cone.cc + b * squared(cone.along.z));
  for (int step = 0; step < 5; ++step) {
    float f = ((x + c2) * x + c1) * x + c0;
    float slope = (3.0f * x + 2.0f * c2) * x + c1;
    float bend = 6.0f * x + 2.0f * c2;
    float root = sqrt(max(4.0f * slope * slope - 6.0f * f * bend, 0.0f));
    x = min(x - 3.0f * f / max(slope + root, 1e-30f), 0.0f);
  }
  return x;
}

// For complex b it is followed from |b|: no other root can meet it, since no zero crosses the unit circle.
Complex followed_root(EllipseCone cone, Complex b)
{
  float size = sqrt(complex_norm(b));
  Complex lambda = complex(negative_root(cone, size), 0.0f);
  Complex turn = complex_sqrt(complex_sqrt(complex_sqrt(complex_scale(1.0f / size, b))));
  Complex now = complex(size, 0.0f);
  for (int step = 0; step < 8; ++step) {
    now = complex_mul(now, turn);
    Complex c2 = complex(cone.square0 + cone.square1 * now.re, cone.square1 * now.im);
    Complex c1 = complex(cone.linear0 + cone.linear1 * now.re, cone.linear1 * now.im);
    Complex c0 = complex_scale(cone.constant1, now);
    for (int newton = 0; newton < 3; ++newton) {
      Complex f1 = complex_add(complex_mul(complex_add(lambda, c2), lambda), c1);
      Complex f = complex_add(complex_mul(f1, lambda), c0);
      Complex twice = complex_add(complex_scale(2.0f, lambda), c2);
      Complex slope = complex_add(complex_mul(twice, lambda), f1);
      lambda = complex_sub(lambda, complex_div(f, slope));
    }
  }
  return lambda;
}

// One factor l.e = cos(psi) + y sin(psi) + z.
struct Factor {
  Complex y;
  Complex z;
};

struct Factors {
  Factor inner;
  Factor outer;
  Complex scale; // 1/(S_xx - lambda): the denominator is (inner)(outer)/scale
  Complex c1;
  Complex c2;
  Complex c3;
};

Complex entry_of(float across, float b_times, Complex b)
{
  return complex(across + b_times * b.re, b_times * b.im);
}

Factors factors_of(EllipseCone cone, Complex b, Complex lambda)
{
  vec3 g = cone.along;
  Complex one = complex(1.0f, 0.0f);
  Complex xx = complex_sub(entry_of(cone.uu, g.x * g.x, b), lambda);
  Complex yy = complex_sub(entry_of(cone.vv, g.y * g.y, b), lambda);
  Complex inverse = complex_div(one, xx);
  Complex xy = complex_mul(entry_of(cone.uv, g.x * g.y, b), inverse); // all over xx from here on
  Complex xz = complex_mul(entry_of(cone.uc, g.x * g.z, b), inverse);
  Complex yz = complex_mul(entry_of(cone.vc, g.y * g.z, b), inverse);
  // (1 - b)/(1 + b) for the product b of two zeros inside the circle has a positive real part: so does this root.
  Complex minor = complex_sub(complex_mul(yy, inverse), complex_mul(xy, xy));
  Complex root = complex_sqrt(minor);
  Complex i_root = complex(-root.im, root.re);

  // (S - lambda J) k = 0, k = (x, y, 1).
  Complex y = complex_div(complex_sub(complex_mul(xz, xy), yz), minor);
  Complex x = complex_scale(-1.0f, complex_add(xz, complex_mul(xy, y)));

  Complex lift = complex_mul(i_root, y);
  Factors factors;
  factors.inner.y = complex_add(xy, i_root);
  factors.inner.z = complex_sub(xz, lift);
  factors.outer.y = complex_sub(xy, i_root);
  factors.outer.z = complex_add(xz, lift);
  factors.scale = inverse;

  Complex length = complex_sub(complex_add(complex_mul(x, x), complex_mul(y, y)), one);
  Complex nu_k = complex_add(complex_add(complex_scale(cone.nu.x, x), complex_scale(cone.nu.y, y)),
                             complex(cone.nu.z, 0.0f));
  factors.c3 = complex_div(nu_k, length);
  Complex rest_x = complex_sub(complex(cone.nu.x, 0.0f), complex_mul(factors.c3, x));
  Complex rest_y = complex_sub(complex(cone.nu.y, 0.0f), complex_mul(factors.c3, y));
  factors.c1 = complex_div(complex_sub(rest_y, complex_mul(factors.outer.y, rest_x)), complex_scale(2.0f, i_root));
  factors.c2 = complex_sub(rest_x, factors.c1);
  return factors;
}

// Part of the outline: psi from `middle` - h to `middle` + h.
struct OutlineArc {
  float middle_cos;
  float middle_sin;
  float cos_h;
  float sin_h;
};

OutlineArc whole_outline()
{
  OutlineArc arc;
  arc.middle_cos = 1.0f;
  arc.middle_sin = 0.0f;
  arc.cos_h = -1.0f;
  arc.sin_h = 0.0f;
  return arc;
}

// Of one of the two zeros t of a factor, as a function of t = tan((psi - middle)/2): the change of log(t - zero) over
// the arc, whose imaginary part has the sign of the zero's, `side`.
Complex zero_along(Complex leading, Complex rest, float side, float sine, float cosine)
{
  Complex up = complex_scale(sine, leading);
  Complex mid = complex_scale(cosine, rest);
  Complex to = complex_add(mid, up);
  Complex from = complex_sub(mid, up);
  float angle = side * atan(to.im * from.re - to.re * from.im, to.re * from.re + to.im * from.im);
  float wrapped = angle + pick(angle < -0.5f * PI_EXACT, 2.0f * PI_EXACT, 0.0f);
  return complex(0.5f * log(max(complex_norm(to), 1e-37f) / max(complex_norm(from), 1e-37f)), side * wrapped);
}

struct FactorArc {
  Complex logarithm; // change of log(l.e)
  Complex inverse;   // int 1/(l.e)
};

FactorArc factor_along(Factor factor, float side, OutlineArc arc)
{
  Complex a = complex_add(complex(arc.middle_cos, 0.0f), complex_scale(arc.middle_sin, factor.y));
  Complex b = complex_sub(complex_scale(arc.middle_cos, factor.y), complex(arc.middle_sin, 0.0f));
  Complex c = factor.z;
  Complex d2 = complex_sub(complex_mul(complex_sub(c, a), complex_add(c, a)), complex_mul(b, b));
  // At a double zero the difference of two logarithms becomes a derivative; so it does just beside it.
  d2.re = d2.re + pick(complex_norm(d2) < 1e-20f, 1e-10f, 0.0f);
  Complex d = complex_sqrt(d2);
  Complex id = complex(-d.im, d.re);
  float half_cos = sqrt(max(0.5f + 0.5f * arc.cos_h, 0.0f));
  float half_sin = sqrt(max(0.5f - 0.5f * arc.cos_h, 0.0f));
  half_sin = pick(arc.cos_h > 0.0f, 0.5f * arc.sin_h / max(half_cos, 0.5f), half_sin);
  half_cos = pick(arc.cos_h > 0.0f, half_cos, 0.5f * arc.sin_h / max(half_sin, 0.5f));
  Complex leading = complex_sub(c, a);
  FactorArc out_arc;
  out_arc.logarithm = complex_add(zero_along(leading, complex_sub(b, id), side, half_sin, half_cos),
                                  zero_along(leading, complex_add(b, id), side, half_sin, half_cos));
  Complex angle = complex_atan(complex_scale(arc.sin_h, d), complex_add(a, complex_scale(arc.cos_h, c)));
  out_arc.inverse = complex_scale(2.0f, complex_div(angle, d));
  return out_arc;
}

// The pole's integral over the arc, times w.
float ellipse_pole_along(Factors factors, OutlineArc arc, Complex w)
{
  FactorArc inner = factor_along(factors.inner, 1.0f, arc);
  FactorArc outer = factor_along(factors.outer, -1.0f, arc);
  Complex turned = complex_div(complex_sub(inner.logarithm, outer.logarithm),
                               complex_sub(factors.outer.y, factors.inner.y));
  Complex sum = complex_add(complex_mul(factors.c3, turned),
                            complex_add(complex_mul(factors.c1, outer.inverse), complex_mul(factors.c2, inner.inverse)));
  return complex_mul(w, complex_mul(factors.scale, sum)).re;
}
