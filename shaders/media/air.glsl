// SPDX-License-Identifier: GPL-3.0-or-later
// Air: a medium that is even, or falls off exponentially with height, and what it scatters of a light along a ray.
//
// A stretch [a, b] of a ray sends to the eye, of one light and in one colour,
//     L = int_a^b beta_s rho(t) p E exp(-D) dt ,
// with the density rho, 1 where the coefficients are given, the phase function p, the irradiance E on whatever faces
// the light, and the optical depth D of the air before the light and before the eye.

// ---- How much air there is ----

// The mean of exp(-x t) over t in [0, 1], x not negative. 1 - exp(-x) is exp(-x / 2) 2 sinh(x / 2), which is a series
// where the difference has no digits.
float mean_decay(float x)
{
  float y2 = x * x * 0.25f;
  float series = 1.0f + y2 * (1.0f / 6.0f) * (1.0f + y2 * (1.0f / 20.0f) * (1.0f + y2 * (1.0f / 42.0f)));
  return pick(x < 1.0f, exp(-0.5f * x) * series, (1.0f - exp(-x)) / max(x, 1.0f));
}

// The mean of exp(-depth) where the depth goes straight from one end to the other.
float mean_decay(float front, float back)
{
  return exp(-min(front, back)) * mean_decay(abs(back - front));
}

// Metres of air of density 1 along `length` metres of a ray. Heights are in scale heights above where the density is 1:
// `height` where the ray begins, `climb` what it gains in a metre. Even air has both 0. Nothing is divided by the climb, so
// that level rays are as good as others; a ray that climbs may be 1e30 long. Denser than 3e17 no air becomes.
float air_column(float height, float climb, float length)
{
  float gain = climb * length;
  float lowest = max(min(height, height + gain), -40.0f);
  return exp(-lowest) * length * mean_decay(abs(gain));
}

// Metres of air of density 1 between a place and a sun, whose direction climbs so much a metre; 1e18 where it is
// below the horizon. Of even air there is no end, so there the sun's strength is what arrives.
float air_column_above(float height, float climb)
{
  return pick(climb > 0.0f, exp(-max(height, -40.0f)) / max(climb, 1e-18f), 1e18f);
}

// ---- A sun ----

// What a lit stretch sends to the eye per unit of beta_s p E. `column` is its metres of air of density 1, and the depths
// are D at both its ends. Exact: along a straight ray density and column are linear in each other, and so the depth
// towards the sun, which is proportional to the density, and that towards the eye are both linear in the column.
float lit_by_sun(float column, float depth_front, float depth_back)
{
  return column * mean_decay(depth_front, depth_back);
}

// ---- A light that is a point ----
//
// With h the light's distance from the ray, s the place along the ray from the light's foot, and r the distance of both,
// let psi be the angle at the light between the way to the eye's side and that to the place. That is the angle by which
// light is scattered to the eye, s = -h cot psi, ds / r^2 = dpsi / h and r + s = h tan(psi / 2): neither the light's
// own falloff nor a ray that passes it close by is left in the integrand. The phase function's peak goes by
//     tan(psi / 2) = k tan zeta,  k = (1 - g) / (1 + g):  p_HG dpsi = sqrt(cos^2 zeta + k^2 sin^2 zeta) dzeta / (2 pi (1 - g)) .
// What is left is how the air's extinction sets in near either end; there x^2 (3 - 2 x) puts more of the points.
// Sixteen of Gauss' points over x in (0, 1) leave 7e-5 before rounding, for g in [-.98, .999] and depths of .1 to 200.
// Angles enter by their unit vectors, which are interpolated on the circle: an angle near pi / 2 would have lost digits.

// A part of a ray before a point light.
struct LitStretch {
  float distance; // of the light from the ray, metres
  float squeeze;  // k
  float front_cosine; // of zeta at the end nearer to the eye
  float front_sine;
  float back_cosine;
  float back_sine;
  float angle; // between them
  float sine;  // of that
};

// A place on it. An integral over the stretch of f / r^2 is the integral over x in (0, 1) of weight * f.
struct LitPoint {
  float place;  // s, metres from the light's foot
  float radius; // r
  float weight;
  float half_sine2; // of psi / 2, squared
  float half_cosine2;
};

// k for a phase function of Henyey and Greenstein or of Cornette and Shanks. Rayleigh's asks for 0.
float squeeze_of(float g)
{
  return (1.0f - g) / (1.0f + g);
}

// Up to where a stretch that begins at `from` is worth looking at, in air that takes at least `extinction` everywhere:
// an optical depth of 12 more, 6e-6 of what the stretch sends.
float lit_until(float distance, float from, float extinction, float squeeze)
{
  float radius = sqrt(distance * distance + from * from);
  float way = pick(from > 0.0f, radius + from, distance * distance / max(radius - from, 1e-30f));
  way = way + (12.0f + max(log(squeeze), 0.0f)) / max(extinction, 1e-18f);
  return max(0.5f * (way - distance * (distance / max(way, 1e-30f))), from);
}

// From s = from to s = to, which lies behind it. A light on the ray itself, if nothing of its size keeps places away, is
// taken for one that passes it by a ten-millionth of the way.
LitStretch lit_stretch(float distance, float from, float to, float squeeze)
{
  float h = max(distance, 1e-7f * max(abs(from), abs(to)) + 1e-9f);
  float front = sqrt(h * h + from * from), back = sqrt(h * h + to * to);
  // tan(psi / 2) = y / x, without a difference.
  float front_x = pick(from > 0.0f, h, front - from), front_y = pick(from > 0.0f, front + from, h);
  float back_x = pick(to > 0.0f, h, back - to), back_y = pick(to > 0.0f, back + to, h);
  float bend = (from + to) / (front + back);
  float one_side = h * (to - from) * (1.0f + abs(bend));
  float both_sides = (front * back - h * h) + (front - from) * to - from * back;
  float turned = pick(from < 0.0f && to > 0.0f, both_sides, one_side);
  float front_size = inversesqrt(squeeze * squeeze * front_x * front_x + front_y * front_y);
  float back_size = inversesqrt(squeeze * squeeze * back_x * back_x + back_y * back_y);
  LitStretch stretch;
  stretch.distance = h;
  stretch.squeeze = squeeze;
  stretch.front_cosine = squeeze * front_x * front_size;
  stretch.front_sine = front_y * front_size;
  stretch.back_cosine = squeeze * back_x * back_size;
  stretch.back_sine = back_y * back_size;
  stretch.sine = max(squeeze * turned * front_size * back_size, 0.0f);
  stretch.angle = atan(stretch.sine, stretch.front_cosine * stretch.back_cosine + stretch.front_sine * stretch.back_sine);
  return stretch;
}

LitPoint lit_point(LitStretch stretch, float x)
{
  float rest = 1.0f - x;
  float before = rest * rest * (1.0f + 2.0f * x), behind = x * x * (3.0f - 2.0f * x);
  float small = 1e-12f;
  float over = 1.0f / max(stretch.sine, small);
  float from = pick(stretch.sine > small, sin(before * stretch.angle) * over, before);
  float to = pick(stretch.sine > small, sin(behind * stretch.angle) * over, behind);
  float cosine = from * stretch.front_cosine + to * stretch.back_cosine;
  float sine = (from * stretch.front_sine + to * stretch.back_sine) * stretch.squeeze;
  float size2 = cosine * cosine + sine * sine;
  float inverse = 1.0f / size2;
  float along = 0.5f * stretch.distance / max(cosine * sine, 1e-30f);
  LitPoint point;
  point.half_sine2 = sine * sine * inverse;
  point.half_cosine2 = cosine * cosine * inverse;
  point.place = (sine - cosine) * (sine + cosine) * along;
  point.radius = size2 * along;
  point.weight = 12.0f * x * rest * stretch.squeeze * stretch.angle * inverse / stretch.distance;
  return point;
}

// The x of lit_point() whose place is s.
float lit_share(LitStretch stretch, float place)
{
  float radius = sqrt(stretch.distance * stretch.distance + place * place);
  float along = stretch.squeeze * pick(place > 0.0f, stretch.distance, radius - place);
  float across = pick(place > 0.0f, radius + place, stretch.distance);
  float turned = atan(stretch.front_cosine * across - stretch.front_sine * along,
                      stretch.front_cosine * along + stretch.front_sine * across);
  float share = clamp(turned / max(stretch.angle, 1e-30f), 0.0f, 1.0f);
  float arcsine = atan(1.0f - 2.0f * share, 2.0f * sqrt(share * (1.0f - share)));
  return 0.5f - sin(arcsine * (1.0f / 3.0f));
}

// ---- Where a light has a size, or a cone ----
//
// Such a stretch is cut where the integrand has a kink.

// A part of a ray, by distances from the light's foot; none where `to` does not lie behind `from`.
struct RayPart {
  float from;
  float to;
};

RayPart part_in_sphere(float distance, float radius)
{
  float half_chord = sqrt(max((radius - distance) * (radius + distance), 0.0f));
  RayPart part;
  part.from = -half_chord;
  part.to = half_chord;
  return part;
}

// Where a ray lies in a spot's cone, of at most a half-space. `foot` is how far along the cone's axis the light's foot on
// the ray lies before the light, `along` the cosine between ray and axis. The ray is in the double cone where
// a s^2 + 2 b s + c is positive, and in the half of it that shines where foot + along s is.
RayPart part_in_cone(float distance, float foot, float along, float cosine_of_edge)
{
  float edge = max(cosine_of_edge, 1e-8f);
  float a = (along - edge) * (along + edge), b = foot * along;
  float c = (foot - edge * distance) * (foot + edge * distance);
  a = pick(abs(a) < 1e-14f, -1e-14f, a);
  float root2 = foot * foot + distance * distance * a;
  float root = edge * sqrt(max(root2, 0.0f));
  float sum = pick(b < 0.0f, root - b, -root - b);
  float first = sum / a, second = c / pick(abs(sum) < 1e-30f, 1e-30f, sum);
  float low = min(first, second), high = max(first, second);
  RayPart part;
  part.from = pick(a < 0.0f, low, pick(along > 0.0f, high, -1e30f));
  part.to = pick(a < 0.0f, pick(foot > 0.0f && root2 > 0.0f, high, low), pick(along > 0.0f, 1e30f, low));
  return part;
}

// The mean way, within a twentieth of its radius, from outside a sphere to what is seen of it.
float way_to_sphere(float to_middle, float radius)
{
  return to_middle - radius * (2.0f + radius / max(to_middle, radius + 1e-20f)) * (1.0f / 3.0f);
}
