// SPDX-License-Identifier: GPL-3.0-or-later
// Soft sprites, which face the camera, and triangles: both in one batch.
//
// Attributes: place, in the world, and the radius, or 0 for a triangle's corner; shape, a sprite's corner in [-1, 1]^2, or
// of hair Triangles.strip, the opacity through its middle, or that of the triangle, and the slice of the sprite, where it
// is cut into SLICES; tint, its radiance at an opacity of 1.

void main()
{
  vec4 seen = view.from_world * vec4(place.xyz, 1.0f);
  seen.xy += place.w * shape.xy;
  gl_Position = view.projection * seen;
  spot = vec3(shape.xy, -seen.z);
  sent = tint;
  slice = vec4(place.w, 2.0f * shape.w / float(SLICES) - 1.0f, 2.0f * (shape.w + 1.0f) / float(SLICES) - 1.0f,
               optical_depth_of(shape.z));
#ifdef LIT
  // The rows of a rotation are its inverse's columns.
  mat3 to_world = transpose(mat3(view.from_world));
  in_map = (view.to_map * vec4(place.xyz + place.w * (to_world * vec3(shape.xy, 0.0f)), 1.0f)).xyz;
#endif
}
