// SPDX-License-Identifier: GPL-3.0-or-later
// needs: opacity
// More bases for the absorption along a light ray, the range of depth that a basis spans, and eight bits a coefficient.
//
// A basis is a pair for each k. An absorber of optical depth tau at depth z adds tau F_k(z) to coefficient c_k, and the
// optical depth down to d is sum_k c_k G_k(d). Both are sums: absorbers and maps add in any order, and filtering
// coefficients is filtering optical depth. G_k(1) F_k sums to 1, so that the total is exact. F and G of
//   Fourier (opacity.glsl): 2, 2 cos 2 pi k z, 2 sin 2 pi k z; d/2, sin(2 pi k d)/(2 pi k), (1 - cos 2 pi k d)/(2 pi k)
//   half-range cosine:      1, 2 cos pi k z;                   d, sin(pi k d)/(pi k)
//   piecewise constant:     1 inside slice k, else 0;          clamp(n d - k, 0, 1)
//   learned:                two tables, made from the scene's own rays (native/rays/learned_basis.hpp)

// The cosine basis is the series of the function mirrored at d = 1: harmonics of half the frequency, without sines. So
// depths 0 and 1 are no longer neighbours, as they are in the paper's series, which rings where they differ.
// Start from harmonic(0.5f, z) and go on with next_harmonic().
float integral_half_harmonic(float a, Harmonic half_harmonic, float k)
{
  return a * half_harmonic.sine / (0.5f * TWO_PI * k);
}

// cos (k + 1) x from the last two of them, 2 cos x cos k x - cos (k - 1) x: a quarter of the work of next_harmonic(), but
// the error grows with k^2.
float next_cosine(float two_cosine, float here, float last)
{
  return two_cosine * here - last;
}

// A whole series of sines for the price of one: sum_k c_k sin(k x) = s_1 sin x, where s_k = c_k + 2 cos x s_{k+1} -
// s_{k+2}, from the last coefficient to the first (Clenshaw, "A note on the summation of Chebyshev series", 1955).
// With c_k = a_k / (pi k) and x = pi d that is the cosine basis, less its constant term.
float clenshaw(float c, float two_cosine, float next, float after)
{
  return c + (two_cosine * next - after);
}

// Piecewise constant absorption, the opacity shadow maps of Kim and Neumann, "Opacity Shadow Maps", 2001: the part of
// an absorber from `front` to `back` that lies in slice k of n, and the integral of that slice down to d.
float slice_integral(float k, float n, float d)
{
  return clamp(n * d - k, 0.0f, 1.0f);
}

float slice_share(float k, float n, float front, float back)
{
  float near = clamp(front, 0.0f, 1.0f);
  float far = clamp(back, 0.0f, 1.0f);
  float width = n * (far - near);
  float share = (slice_integral(k, n, far) - slice_integral(k, n, near)) / max(width, 1e-4f);
  float cell = min(floor(0.5f * n * (near + far)), n - 1.0f);
  return pick(width < 1e-3f, pick(cell < k, 0.0f, pick(cell > k, 0.0f, 1.0f)), share);
}

// Where depth d lies in a table over [0, 1] that is cut into `cells`: the cell, and how far into it.
struct TablePosition {
  float cell;
  float fraction;
};

TablePosition table_position(float d, float cells)
{
  float x = clamp(d, 0.0f, 1.0f) * cells;
  TablePosition position;
  position.cell = min(floor(x), cells - 1.0f);
  position.fraction = x - position.cell;
  return position;
}

// ---- The range of a ray's depths that the basis spans ----
// Before it nothing is absorbed, behind it everything is. Rays whose coefficients are filtered must share one range.

struct DepthRange {
  float low;
  float high;
};

float relative_depth(DepthRange range, float z)
{
  return clamp((z - range.low) / max(range.high - range.low, 1e-7f), 0.0f, 1.0f);
}

// From the nearest to the furthest absorber, with room, since a series cannot step at its very ends.
DepthRange padded_range(float nearest, float furthest)
{
  float pad = 0.05f * (furthest - nearest) + 0.001f;
  DepthRange range;
  range.low = nearest - pad;
  range.high = furthest + pad;
  return range;
}

// Thin smoke around a ray's core widens its range and takes coefficients from what can be seen: without it real smoke
// has two thirds to a half of the error. What is left out counts at the ends. So it changes T by at most 0.002 in front,
// and behind by less, since T is small there; it must be small in optical depth all the same, for a large amount at the
// very end would ring through the whole range. What may be left out of a ray of optical depth `total`, at either end:
float trimmed_before(float total)
{
  return 0.002f * min(total, 1.0f);
}

float trimmed_behind(float total)
{
  return 0.002f * total;
}

// Mean +- q standard deviations from sums that add and filter: s0 = sum tau, s1 = sum tau z, s2 = sum tau z^2. Outliers
// hardly widen it; what lies outside counts at its ends. Chebyshev's inequality: at most 1/q^2 of the optical depth.
DepthRange moment_range(float s0, float s1, float s2, float q)
{
  float weight = max(s0, 1e-20f);
  float mean = s1 / weight;
  float reach = q * sqrt(max(s2 / weight - mean * mean, 0.0f)) + 0.001f;
  DepthRange range;
  range.low = mean - reach;
  range.high = mean + reach;
  return range;
}

DepthRange common_range(DepthRange a, DepthRange b)
{
  DepthRange range;
  range.low = max(a.low, b.low);
  range.high = max(range.low, min(a.high, b.high));
  return range;
}

// ---- Eight bits a coefficient ----
// |c_k| <= total max_z |F_k(z)|, so the ratio of the two, in [-1, 1], is stored as one of 255 levels, zero among them.
// Only after accumulation: levels do not add.

float eight_bit_level(float ratio)
{
  return floor(clamp(ratio, -1.0f, 1.0f) * 127.0f + 127.5f);
}

float eight_bit_ratio(float level)
{
  return (level - 127.0f) / 127.0f;
}

// Depths in 16 bits from -1/6 to 7/6, since ranges are padded; 0 and 1 are among them.
#define ZERO_DEPTH 8192.0f
#define UNIT_DEPTH 49152.0f

float stored_depth(float code)
{
  return (code - ZERO_DEPTH) / UNIT_DEPTH;
}

float depth_code(float z)
{
  return clamp(ZERO_DEPTH + z * UNIT_DEPTH, 0.0f, 65535.0f);
}
