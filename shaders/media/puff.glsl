// SPDX-License-Identifier: GPL-3.0-or-later
// A puff: a ball of smoke whose density falls as 1 - (r / R)^2 from its middle, so that it has no edge. Straight through
// the middle it has the optical depth that its opacity says, the most of any way through it.

// A puff narrower than this many texels of a light map is widened to them: then the sum over texels of what it adds is
// within 4 % of its integral wherever it stands between them. (At one texel it is within 20 %.) It keeps its total.
#define LEAST_RADIUS 1.5f

// Across all of a puff, its density varies along an axis as over a slab half as wide as this share of its radius: both
// have the variance R^2 / 7.
#define PUFF_SLAB 0.654653671f

// On a chord at the share q of R from the middle, of the optical depth through the middle: with inside = 1 - q^2, the
// length of the chord goes as its root, and the density at the chord's middle as itself.
// Nothing where it is 0.
float puff_column(float inside)
{
  return inside * inside * inversesqrt(max(inside, 1e-12f));
}

// Along a chord the density goes as 1 - u^2, with u from -1 to 1. The share of the chord's optical depth before u:
float puff_before(float u)
{
  float at = clamp(u, -1.0f, 1.0f);
  return 0.5f + at * (0.75f - 0.25f * at * at);
}

// A chord's k-th harmonic, against that of a flat absorber in its middle, is damped by 3 (sin k x - k x cos k x) / (k x)^3,
// where x is the angle of the first harmonic over half the chord. This is the part that depends on k, from the sine and
// cosine of k x.
float puff_damping(float sine, float cosine, float kx)
{
  return sine - kx * cosine;
}
