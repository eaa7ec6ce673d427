// SPDX-License-Identifier: GPL-3.0-or-later
// What the smoke pass knows about camera, lights and smoke. addon/gpu/smoke.py packs it in this order.

#define MAX_LIGHTS 16
#define MAX_MEDIA 5
#define EMISSION_ROWS 128

struct SmokeView {
  vec4 near0, near_u, near_v, far0, far_u, far_v; // see camera_ray
  vec4 screen;                                    // width, height; number of lights; strength of shadows in an overlay
  vec4 lights[3 * MAX_LIGHTS];                    // Frame.lights: direction, 1 for a sun; position, size^2; strength
  vec4 media[6 * MAX_MEDIA]; // rows of world -> grid; cells along x, y, z, bricks a cell; extinction, longest step in
                             // cells; scattering, anisotropy
#ifdef RAMPED
  vec4 ramps[MAX_MEDIA]; // the number of parts, 0 where density is density; 1 where steps are split
#endif
#ifdef EMITTING
  vec4 emission[EMISSION_ROWS * MAX_MEDIA]; // of each medium's rows; the first has the number of the last
#endif
};
