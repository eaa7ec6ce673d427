// SPDX-License-Identifier: GPL-3.0-or-later
// What the smoke pass knows about the camera, the medium and the sun. viewport.py packs it in this order.

struct SmokeView {
  vec4 near0, near_u, near_v, far0, far_u, far_v; // see camera_ray
  vec4 grid_x, grid_y, grid_z;                    // rows of world -> grid space, in cells
  vec4 map_x, map_y, map_z;                       // rows of world -> light map, in [0, 1]^3
  vec4 extinction;                                // per unit density, rgb; anisotropy
  vec4 source;                                    // irradiance of the sun times albedo, rgb; longest step, metres
  vec4 sun;                                       // the way its light travels; strength of its shadow in an overlay
  vec4 grid;                                      // cells along x, y, z; density below which nothing is seen
  vec4 screen;                                    // width, height; harmonics in the light map; cells in a brick's edge
};
