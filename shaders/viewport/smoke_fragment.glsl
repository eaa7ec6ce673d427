// SPDX-License-Identifier: GPL-3.0-or-later
// The smoke pass: for each pixel, the march through the smoke of all media (media/march.glsl), up to the first surface.
//
// Texture `surfaces` (Frame.surfaces): the radiance of the first surface in the shadow of the smoke, or with OVERLAY the
// share of its light that shadows take; alpha: distance along the ray. Those of the media are in smoke_textures.glsl,
// what the march asks of them in smoke_media.glsl.
//
// Variants:
//   RAMPED      a medium has a transfer function: its parts (media/ramp.glsl) are a row of the texture `ramps`
//   COLOURS     1 where all smoke is grey, so that one march serves all colours, else 3
//   MEDIA       how many bodies of smoke there are
//   OVERLAY     the surfaces are Blender's own picture: it is multiplied by `transmittance`, whose alpha tells
//               surfaces (1) from background (0), and `radiance` is added

void main()
{
  vec2 uv = gl_FragCoord.xy / view.screen.xy;
  Ray ray = camera_ray(view.near0.xyz, view.near_u.xyz, view.near_v.xyz, view.far0.xyz, view.far_u.xyz, view.far_v.xyz,
                       uv.x, uv.y);
  vec4 surface = texelFetch(surfaces, ivec2(gl_FragCoord.xy), 0);
  bool hit = surface.w < ray.reach * 0.999999f;
#ifdef RAMPED
  Smoke smoke = march_ramped(ray, surface.w);
#else
  Smoke smoke = march(ray, surface.w);
#endif
  vec3 through = vec3(exp(-smoke.depth)); // transmittance_of(), for as many colours as there are
#ifdef OVERLAY
  transmittance = vec4(through * (1.0f - view.screen.w * surface.xyz), hit ? 1.0f : 0.0f);
  radiance = vec4(smoke.radiance, 0.0f);
#else
  float alpha = 1.0f - dot(through, vec3(1.0f / 3.0f));
  radiance = vec4(smoke.radiance + through * surface.xyz, hit ? 1.0f : alpha);
#endif
}
