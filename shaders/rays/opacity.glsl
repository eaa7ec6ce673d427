// SPDX-License-Identifier: GPL-3.0-or-later
// Fourier opacity maps: Jansen and Bavoil, "Fourier Opacity Mapping", I3D 2010.
//
// Along one light ray, with depth z in [0, 1], an absorption function sigma(z) is kept as the first harmonics of its
// Fourier series. Its integral, the optical depth, is then a sum that is exact at both ends of the range.
// A texel stores a_0, then a_k and b_k in turn. Our maps project the density itself, so that what comes back is a
// column density; the caller multiplies by the medium's extinction per unit density, one colour at a time.

#define TWO_PI 6.28318530717958648f

// One harmonic, cos(2 pi k z) and sin(2 pi k z).
struct Harmonic {
  float cosine;
  float sine;
};

Harmonic harmonic(float k, float z)
{
  Harmonic h;
  h.cosine = cos(TWO_PI * k * z);
  h.sine = sin(TWO_PI * k * z);
  return h;
}

// The next harmonic by the angle sums of section 4.1: no trigonometry beyond the first.
Harmonic next_harmonic(Harmonic h, Harmonic first)
{
  Harmonic next;
  next.cosine = h.cosine * first.cosine - h.sine * first.sine;
  next.sine = h.sine * first.cosine + h.cosine * first.sine;
  return next;
}

// Eqs 1-2 and 5-6: what a slab of optical depth tau, centred on the harmonic's depth, adds to (a_k, b_k).
// `thickness` is slab_factor() of the slab, or 1 for a particle without extent, as in the paper.
float project_cosine(float tau, Harmonic h, float thickness)
{
  return 2.0f * tau * thickness * h.cosine;
}

float project_sine(float tau, Harmonic h, float thickness)
{
  return 2.0f * tau * thickness * h.sine;
}

// A slab of width w is a particle spread evenly over w: its k-th harmonic is damped by sinc(pi k w).
// Not in the paper, whose particles are flat; it makes the projection of a stepwise constant density exact.
float slab_factor(float k, float width)
{
  float x = 0.5f * TWO_PI * k * width;
  float safe = max(x, 1e-4f);
  return sin(safe) / safe;
}

// Eq 4: the optical depth of an opacity alpha in [0, 1). An opaque primitive would be infinite; the series could not
// hold it, so alpha stops at 1 - 2^-20, an optical depth of 13.9.
float optical_depth_of(float alpha)
{
  return -log(1.0f - min(alpha, 0.99999905f));
}

// Eq 3, term by term: the constant term, and the k-th harmonic pair, with 2 pi k divided out before or not.
float integral_constant(float a0, float d)
{
  return 0.5f * a0 * d;
}

float integral_of_pair(float a, float b, Harmonic h)
{
  return a * h.sine + b * (1.0f - h.cosine);
}

float integral_harmonic(float a, float b, Harmonic h, float k)
{
  return integral_of_pair(a, b, h) / (TWO_PI * k);
}

// A receiver that casts too, such as a strand of hair, is among the absorbers, and the series smears its own absorption
// to both sides of it. Of its optical depth tau the series counts tau S(z) in front of it, where eq 3 with its own
// coefficients, 2 cos 2 pi k z and 2 sin 2 pi k z, is  S(z) = z + sum_k sin(2 pi k z) / (pi k),  about one half. What
// follows is the k-th term for flat receivers; taking tau S(z) off leaves what the others absorb. Not in the paper.
float self_harmonic(Harmonic h, float k)
{
  return 2.0f * h.sine / (TWO_PI * k);
}

// The optical depth that the others put before a receiver: its own is not in their total.
float optical_depth_of_others(float tau, float total, float own, float self_share)
{
  return clamp(tau - own * self_share, 0.0f, max(total - own, 0.0f));
}

// The truncated series overshoots both ways. An optical depth cannot leave [0, total] without T leaving [T(1), 1].
float clamp_optical_depth(float tau, float a0)
{
  return clamp(tau, 0.0f, 0.5f * a0);
}

// Beer and Lambert.
float transmittance_of(float tau)
{
  return exp(-tau);
}
