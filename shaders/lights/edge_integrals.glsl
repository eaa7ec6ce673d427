// SPDX-License-Identifier: GPL-3.0-or-later
// needs: polygon
// Cosine powers over polygons by integrals along each edge: exactly for whole exponents (Arvo 1995), and by the peaks of
// Lecocq et al., "Analytic Approximations for Real-Time Area Light Shading", 2017, section 6.
//
// N M^n = sum_edges s int (1 - z^N)/(1 - z^2) d(phi), z = c cos(phi), for any real n, N = n + 1. The paper's eq 2 has two
// cases; its odd n is this form, and its even n (z^N - z instead of z^N - 1) needs the solid angle too.

// An edge in front of r's plane: s = m.r with the edge's normal m, c^2 = 1 - s^2; for both unit ends a = c cos(phi) and
// y = c sin(phi); and the angle between them.
struct UnitArc {
  float s;
  float c2;
  float a0;
  float y0;
  float a1;
  float y1;
  float angle;
};

UnitArc unit_arc_of(Edge edge, vec3 r, float height_from, float height_to)
{
  Edge front = clip_edge(edge, height_from, height_to);
  vec3 from = unit_or_zero(front.from);
  vec3 to = unit_or_zero(front.to);
  vec3 g = cross(front.normal, r);
  UnitArc arc;
  arc.s = dot(front.normal, r);
  arc.c2 = dot(g, g);
  arc.a0 = max(dot(from, r), 0.0f);
  arc.a1 = max(dot(to, r), 0.0f);
  arc.y0 = dot(from, g);
  arc.y1 = dot(to, g);
  arc.angle = safe_angle(front.area, dot(front.from, front.to));
  return arc;
}

// ---- Whole exponents ----
// J_k = int z^k d(phi): k J_k = [a^(k-1) y] + (k-1) c^2 J_(k-2), J_0 = the angle, J_1 = [y].

struct Moments {
  float last;     // J_k
  float previous; // J_(k-1)
  float power0;   // a0^k
  float power1;
};

Moments first_moments(UnitArc arc) // k = 1
{
  Moments moments;
  moments.last = arc.y1 - arc.y0;
  moments.previous = arc.angle;
  moments.power0 = arc.a0;
  moments.power1 = arc.a1;
  return moments;
}

Moments next_moments(Moments moments, UnitArc arc, float k)
{
  Moments next;
  next.last = (moments.power1 * arc.y1 - moments.power0 * arc.y0 + (k - 1.0f) * arc.c2 * moments.previous) / k;
  next.previous = moments.last;
  next.power0 = moments.power0 * arc.a0;
  next.power1 = moments.power1 * arc.a1;
  return next;
}

// The solid angle of the triangle from r to the arc: what N M^n of an even n has beside its odd J_k (van Oosterom and
// Strackee, "The Solid Angle of a Plane Triangle", 1983).
float triangle_on(UnitArc arc)
{
  return 2.0f * safe_angle(arc.s * sin(arc.angle), 1.0f + arc.a0 + arc.a1 + cos(arc.angle));
}

// N M^n along one edge, whole n >= 0: s times J_k over k = n - 1, n - 3, ..., and the triangle for even n.
float arvo_along(UnitArc arc, int exponent)
{
  bool even = exponent - 2 * (exponent / 2) == 0;
  Moments moments = first_moments(arc);
  float sum = even ? (exponent > 0 ? moments.last : float(0.0f)) : moments.previous;
  float order = 1.0f;
  for (int k = 2; k < exponent; ++k) {
    order = order + 1.0f;
    moments = next_moments(moments, arc, order);
    if ((k - 2 * (k / 2) == 0) != even) {
      sum = sum + moments.last;
    }
  }
  return arc.s * sum + (even ? triangle_on(arc) : float(0.0f));
}

// Real exponents in [1, 9): z^N by Lagrange's polynomial in N through z, z^2, ..., z^12, each of which is exact along an
// edge. The error of z^N is below 1e-5 for N > 4.5 and 2e-4 at N = 2.25, near the horizon of the lobe only.
#define LOW_ORDERS 12

float lagrange_weight(float order, float node)
{
  float weight = 1.0f;
  float other = 0.0f;
  for (int k = 1; k <= LOW_ORDERS; ++k) {
    other = other + 1.0f;
    float distance = node - other;
    float itself = pick(abs(distance) < 0.5f, 1.0f, 0.0f);
    weight = weight * pick(itself > 0.5f, 1.0f, (order - other) / (distance + itself));
  }
  return weight;
}

// J_k counts in z^N for all N = k + 2, k + 4, ...: weights[k] is their sum, and weights[LOW_ORDERS - 1] that of odd N.
struct LowOrders {
  float weights[LOW_ORDERS];
};

LowOrders low_orders(float exponent)
{
  LowOrders orders;
  float even = 0.0f;
  float odd = 0.0f;
  float node = 12.0f;
  for (int k = LOW_ORDERS - 2; k >= 0; --k) {
    float next = even + lagrange_weight(exponent + 1.0f, node);
    node = node - 1.0f;
    even = odd;
    odd = next;
    orders.weights[k] = next;
  }
  orders.weights[LOW_ORDERS - 1] = even + lagrange_weight(exponent + 1.0f, 1.0f);
  return orders;
}

float low_orders_along(UnitArc arc, LowOrders orders)
{
  Moments moments = first_moments(arc);
  float sum = orders.weights[0] * moments.previous + orders.weights[1] * moments.last;
  float order = 1.0f;
  for (int k = 2; k < LOW_ORDERS - 1; ++k) {
    order = order + 1.0f;
    moments = next_moments(moments, arc, order);
    sum = sum + orders.weights[k] * moments.last;
  }
  return arc.s * sum + orders.weights[LOW_ORDERS - 1] * triangle_on(arc);
}

// The double moment int z^n (u.b) du has (n + 2) times it = n (r.b) M^(n-1) + sum_edges (m.b) J_n (Arvo 1995).
float moment_along(UnitArc arc, int order)
{
  Moments moments = first_moments(arc);
  float next = 1.0f;
  for (int k = 2; k <= order; ++k) {
    next = next + 1.0f;
    moments = next_moments(moments, arc, next);
  }
  return order == 0 ? moments.previous : moments.last;
}

// ---- Peaks ----
// The integrand I is a peak over phi, from I(0) = (1 - c^N)/(1 - c^2) down to 1 at phi = +- pi/2. We take the paper's
// even case for all n, whose ends are flat as the ellipse's are; with the odd case its error is five times larger.

#define HALF_PI_SQUARED 2.46740110027233966f

// (1 - (1 - x)^h)/x for x = 1 - z^2 and h = N/2. Plainly, as in the paper, it has no digits left in float32 for large N.
float peak_value(float x, float h)
{
  float logarithm = pick(x < 0.05f, -x * (1.0f + x * (0.5f + x * (1.0f / 3.0f + x * (0.25f + x * 0.2f)))),
                         log(max(1.0f - x, 1e-30f)));
  float e = h * logarithm;
  float series = -e * (1.0f + e * (0.5f + e * (1.0f / 6.0f + e * (1.0f / 24.0f))));
  return pick(x < 1e-12f, h, pick(e > -0.02f, series, 1.0f - exp(max(e, -80.0f))) / max(x, 1e-12f));
}

struct Peak {
  float least;
  float height; // greatest - least
  float x;      // half width
  float y;      // (I(x) - least)/height
  float x_tail;
  float tail; // I(x_tail)
};

// Eqs 6, 7 and 14. In eq 7 the power .45 belongs to the bracket alone, and its n is that of F, n - 1.
Peak peak_of(UnitArc arc, float exponent)
{
  float h = 0.5f * (exponent + 1.0f);
  float c2 = min(arc.c2, 1.0f);
  float s2 = arc.s * arc.s;
  float c = sqrt(c2);
  float quarter = 0.25f * PI_EXACT;
  float narrowed = c - c / (exponent - 2.0f);
  Peak peak;
  peak.least = 1.0f;
  peak.height = max(peak_value(s2, h) - 1.0f, 1e-6f);
  peak.x = quarter * pow(max(1.0f - pow(max(narrowed, 1e-9f), 2.5f), 1e-9f), 0.45f);
  float sine = sin(peak.x);
  peak.y = clamp((peak_value(s2 + c2 * sine * sine, h) - 1.0f) / peak.height, 1e-6f, 1.0f - 1e-6f);
  float rest = 1.0f - peak.x / quarter;
  float rest2 = rest * rest;
  float rest4 = rest2 * rest2;
  peak.x_tail = peak.x + 0.3946f * quarter * (1.0f - rest4 * rest4 * rest4);
  float sine_tail = sin(peak.x_tail);
  peak.tail = peak_value(s2 + c2 * sine_tail * sine_tail, h);
  return peak;
}

// height/(1 - low) (P - low) + least for a shape P that falls from 1 to `low`, given P or its integral over `width`.
float scaled_peak(Peak peak, float low, float shape, float width)
{
  float fall = 1.0f - low;
  float scale = peak.height / pick(abs(fall) < 1e-6f, 1e-6f, fall);
  return scale * shape + (peak.least - scale * low) * width;
}

// Eq 13: the mixture that passes through I(x_tail).
float blended(Peak peak, float wide_tail, float narrow_tail, float wide, float narrow)
{
  float difference = narrow_tail - wide_tail;
  float alpha = clamp((narrow_tail - peak.tail) / pick(abs(difference) < 1e-9f, 1e-9f, difference), 0.0f, 1.0f);
  return narrow + alpha * (wide - narrow);
}

// Eqs 11-12: P = 1/(1 + a phi^2). And section 6.2.2: P = 1/(1 + b phi^2)^2 with b = a/2, whose antiderivative is
// phi/(2(1 + b phi^2)) + atan(sqrt(b) phi)/(2 sqrt(b)): the paper's is another function's.
struct Lorentzian {
  float root_a;
  float phi0;
  float phi1;
  float wide; // the Lorentzian's own edge integral
};

Lorentzian lorentzian_of(UnitArc arc, Peak peak)
{
  float a = max((1.0f - peak.y - peak.x * peak.x / HALF_PI_SQUARED) / (peak.y * peak.x * peak.x), 1e-6f);
  Lorentzian l;
  l.root_a = sqrt(a);
  l.phi0 = safe_angle(arc.y0, arc.a0);
  l.phi1 = l.phi0 + arc.angle;
  float area = atan(l.root_a * arc.angle, 1.0f + a * l.phi0 * l.phi1) / l.root_a;
  l.wide = scaled_peak(peak, 1.0f / (1.0f + a * HALF_PI_SQUARED), area, arc.angle);
  return l;
}

float lorentzian_along(UnitArc arc, float exponent)
{
  return arc.s * lorentzian_of(arc, peak_of(arc, exponent)).wide;
}

float pearson_area(float b, float phi)
{
  float root = sqrt(b);
  return 0.5f * phi / (1.0f + b * phi * phi) + 0.5f * atan(root * phi, 1.0f) / root;
}

float lorentzian_pearson_along(UnitArc arc, float exponent)
{
  Peak peak = peak_of(arc, exponent);
  Lorentzian l = lorentzian_of(arc, peak);
  float a = l.root_a * l.root_a;
  float b = 0.5f * a;
  float low = 1.0f / (1.0f + b * HALF_PI_SQUARED);
  float narrow = scaled_peak(peak, low * low, pearson_area(b, l.phi1) - pearson_area(b, l.phi0), arc.angle);
  float x2 = peak.x_tail * peak.x_tail;
  float at_tail = 1.0f / (1.0f + b * x2);
  float wide_tail = scaled_peak(peak, 1.0f / (1.0f + a * HALF_PI_SQUARED), 1.0f / (1.0f + a * x2), 1.0f);
  float narrow_tail = scaled_peak(peak, low * low, at_tail * at_tail, 1.0f);
  return arc.s * blended(peak, wide_tail, narrow_tail, l.wide, narrow);
}

// int a/(1 + (a - 1) cos^2) over the arc: eq 16, as one angle.
float ellipse_area(UnitArc arc, float root_a)
{
  float across = arc.c2 * sin(arc.angle);
  return root_a * safe_angle(root_a * across, root_a * root_a * arc.a0 * arc.a1 + arc.y0 * arc.y1);
}

// The second term of eq 17, whose c is the bracket in the denominator.
float ellipse_square_end(float b, float a, float y)
{
  float a2 = a * a;
  float y2 = y * y;
  return b * (b - 1.0f) * a * y / max((b + 1.0f) * (a2 + y2) + (b - 1.0f) * (a2 - y2), 1e-20f);
}

// Eqs 15-18, errors mended: a = y tan^2(x)/(1 - y).
float ellipse_peak_along(UnitArc arc, float exponent)
{
  Peak peak = peak_of(arc, exponent);
  float tangent = sin(peak.x) / cos(peak.x);
  float a = peak.y * tangent * tangent / (1.0f - peak.y);
  float b = a * (2.1f + 1.28f * peak.x / (0.25f * PI_EXACT));
  float wide = scaled_peak(peak, a, ellipse_area(arc, sqrt(a)), arc.angle);
  float root_b = sqrt(b);
  float square = 0.5f * (b + 1.0f) * ellipse_area(arc, root_b) -
                 (ellipse_square_end(b, arc.a1, arc.y1) - ellipse_square_end(b, arc.a0, arc.y0));
  float narrow = scaled_peak(peak, b * b, square, arc.angle);
  float cosine = cos(peak.x_tail);
  float at_tail = b / (1.0f + (b - 1.0f) * cosine * cosine);
  float wide_tail = scaled_peak(peak, a, a / (1.0f + (a - 1.0f) * cosine * cosine), 1.0f);
  float narrow_tail = scaled_peak(peak, b * b, at_tail * at_tail, 1.0f);
  return arc.s * blended(peak, wide_tail, narrow_tail, wide, narrow);
}
