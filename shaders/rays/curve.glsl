// SPDX-License-Identifier: GPL-3.0-or-later
// needs: basis
// A resolved light ray: its transmittance as straight lines between a few knots, with depths and values in eight bits.
//
// What Lokovic and Veach, "Deep Shadow Maps", 2000, keep as a list of any length, at a fixed size: knots that are
// chosen ray by ray (native/rays/curve_fit.cpp) sit where the ray needs them, steps included. T falls by construction, from
// exactly 1 before the first knot to exactly the total behind the last. It is not linear in the absorbers, unlike a
// basis: make it when all of them are known, and filter T itself.

// The depths of the knots rise from 0 to 1, and so does the share of the ray's absorption that is done. Each is stored
// as the part of what the last one left to rise, in [0, 1]: so order is certain, and rounding is finest where much has
// been passed already, behind a gap or a dense front.
float next_left(float left, float level)
{
  return left * (255.0f - level) * (1.0f / 255.0f);
}

// Between which knots depth d lies, without a search: all are looked at in turn, front to back. Kept is what remains to
// rise, 1 - z and 1 - share, since each knot takes a part of that: (near, near_left) of the last knot before d and (far,
// far_left) of the first one behind, which are the largest behind.
struct CurveSegment {
  float near;
  float near_left;
  float far;
  float far_left;
};

CurveSegment curve_start()
{
  CurveSegment segment;
  segment.near = 1.0f;
  segment.near_left = 1.0f;
  segment.far = 0.0f;
  segment.far_left = 0.0f;
  return segment;
}

CurveSegment curve_step(CurveSegment segment, float d, float left_of_depth, float left_of_share)
{
  CurveSegment next;
  next.near = pick(1.0f - d < left_of_depth, left_of_depth, segment.near);
  next.near_left = pick(1.0f - d < left_of_depth, left_of_share, segment.near_left);
  next.far = max(segment.far, pick(1.0f - d < left_of_depth, 0.0f, left_of_depth));
  next.far_left = max(segment.far_left, pick(1.0f - d < left_of_depth, 0.0f, left_of_share));
  return next;
}

// The transmittance at depth d of the segment. Knots at the same depth are a step, which d has not passed when equal.
float curve_inside(CurveSegment segment, float d, float total)
{
  float part = clamp((1.0f - d - segment.far) / max(segment.near - segment.far, 1e-6f), 0.0f, 1.0f);
  float left = segment.far_left + (segment.near_left - segment.far_left) * part;
  return total + (1.0f - total) * left;
}

// The knots lie between depths low and high of the light ray. A step at the last knot is the reason for the second
// condition: a line would only begin to fall there.
float curve_transmittance(float z, DepthRange range, float inside, float total)
{
  return pick(z < range.low, 1.0f, pick(z < range.high, inside, total));
}
