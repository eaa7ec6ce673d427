// SPDX-License-Identifier: GPL-3.0-or-later
// What the smoke pass knows about camera, smoke and sun. viewport.py packs it in this order.

struct SmokeView {
  vec4 near0, near_u, near_v, far0, far_u, far_v; // see camera_ray
  vec4 grid_x, grid_y, grid_z;                    // rows of world -> grid space, in cells
  vec4 map_x, map_y, map_z;                       // rows of world -> light map, in [0, 1]^3
  vec4 extinction;                                // RGB, per metre and unit density; anisotropy
  vec4 source;                                    // RGB of the sun's irradiance times albedo; longest step, metres
  vec4 sun;                                       // the way its light travels; strength of its shadow in an overlay
  vec4 grid;                                      // cells along x, y, z; bricks per cell
  vec4 screen;                                    // width, height; harmonics in the light map; 1 where solids cast shadows already
};
