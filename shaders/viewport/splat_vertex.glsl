// SPDX-License-Identifier: GPL-3.0-or-later
// A particle becomes the rectangle of texels that it covers.
//
// Attributes: puff, the centre in the space of the light map and the radius in metres; shape, a corner of the rectangle
// in [-1, 1]^2 and the particle's opacity.

void main()
{
  vec2 axes = puff.w * metre.xy * texels;
  // Sampled at the centres of texels, a narrower puff might be met or missed. Widened, it keeps its total.
  vec2 widened = max(axes, LEAST_RADIUS);
  footprint = vec4(puff.xy * texels, widened);
  column = vec3(puff.z, SLAB * puff.w * metre.z,
                optical_depth_of(shape.z) * (axes.x * axes.y) / (widened.x * widened.y));
  gl_Position = vec4(2.0f * (puff.xy + shape.xy * widened / texels) - 1.0f, 0.0f, 1.0f);
}
