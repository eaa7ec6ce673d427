// SPDX-License-Identifier: GPL-3.0-or-later
// A resolved light ray: its transmittance as straight lines between a few knots, with depths and values in eight bits.
//
// What Lokovic and Veach, "Deep Shadow Maps", 2000, keep as a list of any length, at a fixed size: knots that are
// chosen ray by ray (native/curve_fit.cpp) sit where the ray needs them, steps included. T falls by construction, from
// exactly 1 before the first knot to exactly the total behind the last. It is not linear in the absorbers, unlike a
// basis: make it when all of them are known, and filter T itself.

// The depths of the knots rise from 0 to 1, and so does the share of the ray's absorption that is done. Each is stored
// as the part of what the last one left to rise, in [0, 1]: so order is certain, and rounding is finest where much has
// been passed already, behind a gap or a dense front.
float next_knot(float last, float stored)
{
  return last + (1.0f - last) * stored;
}

// What the line from knot (z0, T0) to (z1, T1) takes from the light down to depth d, where drop = T0 - T1. Knots at the
// same depth are a step.
float line_drop(float d, float z0, float z1, float drop)
{
  return drop * clamp((d - z0) / max(z1 - z0, 1e-6f), 0.0f, 1.0f);
}

// The knots lie between depths low and high of the light ray. A step at the last knot is the reason for the second
// condition: a line would only begin to fall there.
float curve_transmittance(float z, DepthRange range, float inside, float total)
{
  return pick(z < range.low, 1.0f, pick(z < range.high, inside, total));
}
