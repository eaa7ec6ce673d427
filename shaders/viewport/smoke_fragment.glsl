// SPDX-License-Identifier: GPL-3.0-or-later
// The smoke pass: for each pixel, march through the smoke of all media, lit by all lights, up to the first surface.
//
// Texture `surfaces` (Frame.surfaces): the radiance of the first surface in the shadow of the smoke, or with OVERLAY the
// share of its light that shadows take; alpha: distance along the ray. Those of the media are in smoke_textures.glsl.
//
// Variants:
//   COLOURS     1 where all smoke is grey, so that one march serves all colours, else 3
//   MEDIA       how many bodies of smoke there are
//   OVERLAY     the surfaces are Blender's own picture: it is multiplied by `transmittance`, whose alpha tells
//               surfaces (1) from background (0), and `radiance` is added

struct Crossing {
  vec3 origin;
  vec3 direction;
  Interval inside;
};

vec3 transform(int medium, vec4 place)
{
  return vec3(dot(view.media[6 * medium], place), dot(view.media[6 * medium + 1], place),
              dot(view.media[6 * medium + 2], place));
}

#if COLOURS == 1
#  define COLOUR float
#  define OF_COLOURS(v) (v).x
#  define SHARE_OF(v) (v).y
#else
#  define COLOUR vec3
#  define OF_COLOURS(v) (v).xyz
#  define SHARE_OF(v) (v).w
#endif

float largest(vec3 v)
{
  return max(max(v.x, v.y), v.z);
}

// What one step through a medium sends to the eye from all lights. `amount` is density times length.
vec3 scatter(int medium, float amount, COLOUR tau, COLOUR tau_eye, vec3 cell, vec3 world, vec3 direction)
{
  vec4 cells = view.media[6 * medium + 3];
  vec4 scattering = view.media[6 * medium + 5];
  vec3 sum = vec3(0.0f);
  for (float light = 0.0f; light < view.screen.z; light += 1.0f) {
    vec4 towards = view.lights[3 * int(light)];
    vec4 position = view.lights[3 * int(light) + 1];
    vec4 volume = light_at(medium, cell / cells.xyz, light, view.screen.z, cells.z);
    vec3 travel = towards.xyz;
    float incoming = SHARE_OF(volume);
    if (towards.w == 0.0f) {
      vec3 from_light = world - position.xyz;
      float distance2 = dot(from_light, from_light);
      incoming *= falloff(distance2, position.w);
      travel = from_light * inversesqrt(max(distance2, 1e-20f));
    }
    incoming *= henyey_greenstein(-dot(travel, direction), scattering.w);
    vec3 strength = view.lights[3 * int(light) + 2].xyz * incoming;
#if COLOURS == 1
    // Grey smoke may still scatter in colours.
    sum += strength * scattering.xyz * scattered_by_step(amount, tau, tau_eye, volume.x);
#else
    sum.x += strength.x * scattered_by_step(amount * scattering.x, tau.x, tau_eye.x, volume.x);
    sum.y += strength.y * scattered_by_step(amount * scattering.y, tau.y, tau_eye.y, volume.y);
    sum.z += strength.z * scattered_by_step(amount * scattering.z, tau.z, tau_eye.z, volume.z);
#endif
  }
  return sum;
}

void main()
{
  vec2 uv = gl_FragCoord.xy / view.screen.xy;
  Ray ray = camera_ray(view.near0.xyz, view.near_u.xyz, view.near_v.xyz, view.far0.xyz, view.far_u.xyz, view.far_v.xyz,
                       uv.x, uv.y);
  vec4 surface = texelFetch(surfaces, ivec2(gl_FragCoord.xy), 0);
  float reach = surface.w;
  bool hit = reach < ray.reach * 0.999999f;

  Crossing crossings[MEDIA];
  float near_t = 1e30f;
  float far_t = 0.0f;
  float step_length = 1e30f; // metres
  for (int m = 0; m < MEDIA; ++m) {
    crossings[m].origin = transform(m, vec4(ray.origin, 1.0f));
    crossings[m].direction = transform(m, vec4(ray.direction, 0.0f));
    Interval whole;
    whole.near_t = 0.0f;
    whole.far_t = reach;
    crossings[m].inside =
        clip_to_box(whole, crossings[m].origin, crossings[m].direction, view.media[6 * m + 3].xyz);
    if (crossings[m].inside.near_t < crossings[m].inside.far_t) {
      near_t = min(near_t, crossings[m].inside.near_t);
      far_t = max(far_t, crossings[m].inside.far_t);
      step_length = min(step_length, view.media[6 * m + 4].w / length(crossings[m].direction));
    }
  }

  vec3 smoke = vec3(0.0f);
  COLOUR depth = COLOUR(0.0f); // optical, towards the eye
  if (near_t < far_t) {
    float steps = march_steps(far_t - near_t, step_length);
    float dt = (far_t - near_t) / steps;
    float clearest = 0.0f;
    for (float k = 0.0f; k < steps && clearest < OPAQUE_DEPTH;) {
      float t = near_t + (k + 0.5f) * dt;
      float amounts[MEDIA];
      vec3 cells[MEDIA];
      COLOUR tau = COLOUR(0.0f);
      float leap = 1e6f;
      bool met = false;
      for (int m = 0; m < MEDIA; ++m) {
        Interval inside = crossings[m].inside;
        amounts[m] = 0.0f;
        if (t < inside.near_t) {
          leap = min(leap, (inside.near_t - t) / dt - 1.0f);
        } else if (t <= inside.far_t) {
          cells[m] = crossings[m].origin + crossings[m].direction * t;
          float clear = clearance_at(m, ivec3(cells[m] * view.media[6 * m + 3].w));
          if (clear < 0.0f) {
            met = true;
            amounts[m] = density_at(m, cells[m] / view.media[6 * m + 3].xyz) * dt;
            tau += amounts[m] * OF_COLOURS(view.media[6 * m + 4]);
          } else {
            leap = min(leap, clear / (largest(abs(crossings[m].direction)) * dt)); // cells a step
          }
        }
      }
      k += 1.0f;
      if (!met) {
        k += floor(max(leap, 0.0f));
        continue;
      }
      for (int m = 0; m < MEDIA; ++m) {
        if (amounts[m] > 0.0f) {
          smoke += scatter(m, amounts[m], tau, depth, cells[m], ray.origin + ray.direction * t, ray.direction);
        }
      }
      depth += tau;
#if COLOURS == 1
      clearest = depth;
#else
      clearest = min(min(depth.x, depth.y), depth.z);
#endif
    }
  }

  vec3 through = vec3(exp(-depth)); // transmittance_of(), for as many colours as there are
#ifdef OVERLAY
  transmittance = vec4(through * (1.0f - view.screen.w * surface.xyz), hit ? 1.0f : 0.0f);
  radiance = vec4(smoke, 0.0f);
#else
  float alpha = 1.0f - dot(through, vec3(1.0f / 3.0f));
  radiance = vec4(smoke + through * surface.xyz, hit ? 1.0f : alpha);
#endif
}
