// SPDX-License-Identifier: GPL-3.0-or-later
// What a camera sees transparent fragments by, as both stages read it.

struct FragmentView {
  mat4 from_world;
  mat4 projection;
  mat4 to_map; // from the world to the light map that shades sprites
  vec4 depths; // the distance along the view at which depth is 0, and depth a metre
};
