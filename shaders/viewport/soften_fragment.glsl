// SPDX-License-Identifier: GPL-3.0-or-later
// The mean over 2 reach + 1 texels along an axis, a half of a box filter of coefficients: since all texels of a map have
// one range of depths, that is the map of filtered density (Jansen and Bavoil 2010, section 3). Outside there is none.
// TEXEL(at) reads one.

void main()
{
  ivec2 middle = ivec2(gl_FragCoord.xy);
  colour = vec4(0.0f);
  for (int i = -reach; i <= reach; ++i) {
    ivec2 at = middle + i * along;
    if (all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size))) {
      colour += TEXEL(at);
    }
  }
  colour /= float(2 * reach + 1);
}
