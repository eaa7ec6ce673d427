// SPDX-License-Identifier: GPL-3.0-or-later
// A picture as it is, all four floats of it.

void main()
{
  colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
