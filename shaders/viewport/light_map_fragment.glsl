// SPDX-License-Identifier: GPL-3.0-or-later
// One layer of a light map as a picture, so that it can be read.

void main()
{
  colour = texelFetch(light_map, ivec3(ivec2(gl_FragCoord.xy), layer), 0);
}
