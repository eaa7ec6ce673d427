// SPDX-License-Identifier: GPL-3.0-or-later
// How far away along the view the first surface is, of a picture that has the distance along each ray (Frame.surfaces).
// near0 ... far_v are camera_ray()'s; `axis` gives a place's distance along the view.

void main()
{
  vec4 surface = texelFetch(surfaces, ivec2(gl_FragCoord.xy), 0);
  vec2 uv = gl_FragCoord.xy / vec2(textureSize(surfaces, 0));
  Ray ray = camera_ray(near0, near_u, near_v, far0, far_u, far_v, uv.x, uv.y);
  distance_to_solid = vec4(dot(axis, vec4(ray.origin + surface.w * ray.direction, 1.0f)));
}
