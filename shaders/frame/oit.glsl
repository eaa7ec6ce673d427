// SPDX-License-Identifier: GPL-3.0-or-later
// needs: opacity basis
// Transparent fragments of a pixel, composited in whatever order they come.
//
// Three ways. All of them know exactly how much light passes all fragments (a sum of optical depths), and share the rest
// among the fragments' colours by weights, which estimate how much of each is seen:
//   fourier   Song, "order-independent transparency with Fourier series", 2021: a Fourier series over the depths of the
//             whole picture, in four steps; optionally Lanczos' sigma factors
//   nearest   ours: the nearest layers exactly, the others by a series over their own depths, from which each fragment's
//             own part is taken (self_harmonic() in opacity.glsl). 4 bytes for each of the nearest, and 4 + 2 H for a
//             series of H harmonics and its range: 22 for the usual four and one
//   weighted  McGuire and Mara, "Phenomenological Transparency", 2017: weights of opacity and depth alone
// Depths are in [0, 1], linear in the distance along the view; opacities in (0, 1], or there is no fragment.

// ---- The series as published ----

// sigma_k of the first `terms` terms (the constant is one), to the p-th power: Lanczos' local averages, which trade
// ringing for blur. p = 0 leaves the series as it is.
float sigma_factor(float k, float terms, float p)
{
  return pow(slab_factor(k, 1.0f / terms), p);
}

// What a fragment's colour counts. Deeper than an optical depth of 60 nothing is seen, but where a series errs about all
// fragments of a pixel the nearest of them must still count more than nothing.
float seen_of(float alpha, float tau_before)
{
  return alpha * exp(-min(tau_before, 60.0f));
}

// ---- The nearest layers ----
// 24 bits of depth and 8 of opacity each. Fragments at one depth are one layer: its optical depth is the sum of theirs.

#define FRAGMENT_DEPTHS 16777216.0f

// Exact in a texture of single floats.
float fragment_depth(float z)
{
  return min(floor(clamp(z, 0.0f, 1.0f) * FRAGMENT_DEPTHS), FRAGMENT_DEPTHS - 1.0f) / FRAGMENT_DEPTHS;
}

// The last depth that belongs to the layer whose nearest fragment is at `depth`: two passes over the same triangle may
// round its depth to neighbours.
float layer_end(float depth)
{
  return depth + 1.5f / FRAGMENT_DEPTHS;
}

// Levels are spaced by the root of opacity: thin layers matter as much, taken together. None is 0.
float opacity_level(float alpha)
{
  return clamp(floor(255.0f * sqrt(alpha) + 0.5f), 1.0f, 255.0f);
}

float stored_opacity(float level)
{
  return (level / 255.0f) * (level / 255.0f);
}

// What a fragment of a layer is seen as; `before` is the transmittance of the layers before it. A fragment that has the
// layer to itself, which is one that would be stored as the layer is, needs no rounding; others share what it shows.
float seen_in_layer(float alpha, float level, float before)
{
  float layer = stored_opacity(level);
  float share = min(optical_depth_of(alpha) / optical_depth_of(layer), 1.0f);
  return before * pick(abs(opacity_level(alpha) - level) < 0.5f, alpha, layer * share);
}

// ---- All fragments ----

// Their optical depth in 16 bits. The transmittance is never off by more than 1.2e-5 (with a half float: 9e-5), and the
// largest is 65534.
float total_level(float tau)
{
  return min(floor(tau / (1.0f + tau) * 65535.0f + 0.5f), 65534.0f);
}

float stored_total(float level)
{
  return level / (65535.0f - level);
}

// ---- The tail: the fragments behind the nearest layers ----

// Its optical depth: that of all fragments less that of the layers, as they are stored. So it makes up for their
// rounding.
float tail_total(float all, float layers)
{
  return max(all - layers, 0.0f);
}

// The range that its series spans, in eight bits an end: the near one between the last of the nearest layers and
// TAIL_END, the far one between the near one and that. Rounding widens it, so all of the tail is inside.
#define TAIL_END 1.0625f

DepthRange tail_range(float nearest, float furthest, float last)
{
  float pad = 0.03f * (furthest - nearest) + 0.001f;
  DepthRange range;
  range.low = floor(255.0f * max(nearest - pad - last, 0.0f) / (TAIL_END - last));
  float low = last + (TAIL_END - last) * range.low / 255.0f;
  range.high = clamp(ceil(255.0f * (furthest + pad - low) / (TAIL_END - low)), 1.0f, 255.0f);
  return range;
}

// Of the levels that tail_range() gives.
DepthRange stored_tail_range(DepthRange levels, float last)
{
  DepthRange range;
  range.low = last + (TAIL_END - last) * levels.low / 255.0f;
  range.high = range.low + (TAIL_END - range.low) * levels.high / 255.0f;
  return range;
}

// A coefficient of the tail, as one of 255 levels of its constant term.
float tail_level(float coefficient, float a0)
{
  return eight_bit_level(coefficient / max(a0, 1e-20f));
}

// The optical depth before a fragment of the tail: that of the series less its own part.
struct TailDepth {
  float tau;
  float own_share;
};

TailDepth tail_depth_start(float total, float d)
{
  TailDepth depth;
  depth.tau = total * d;
  depth.own_share = d;
  return depth;
}

// One harmonic more; a and b are ratios to the constant term, 2 total.
TailDepth tail_depth_step(TailDepth depth, float total, float a, float b, Harmonic h, float k)
{
  TailDepth next;
  next.tau = depth.tau + 2.0f * total * integral_harmonic(a, b, h, k);
  next.own_share = depth.own_share + self_harmonic(h, k);
  return next;
}

float seen_in_tail(float alpha, TailDepth depth, float total)
{
  return seen_of(alpha, optical_depth_of_others(depth.tau, total, optical_depth_of(alpha), depth.own_share));
}

// ---- What is shown ----
// Sums over fragments, and by what they are to be multiplied. `left` is what all fragments let through, `passed` what
// the layers do, `total` the tail's optical depth; `seen` are sums of weights.

float tail_opacity(float passed, float total, float seen)
{
  return pick(seen > 0.0f, passed * (1.0f - exp(-total)), 0.0f);
}

float layers_scale(float left, float seen, float of_tail)
{
  return (1.0f - left) / max(seen + of_tail, 1e-20f);
}

float tail_scale(float of_tail, float seen)
{
  return of_tail / max(seen, 1e-37f);
}

// Of a method that has weights alone.
float normalised(float left, float seen)
{
  return (1.0f - left) / max(seen, 1e-37f);
}

// ---- Weights ----

float blended_weight(float alpha, float z)
{
  float x = (8.0f * alpha + 0.01f) * (1.0f - 0.95f * z);
  return clamp(1e3f * x * x * x, 1e-2f, 3e2f);
}
