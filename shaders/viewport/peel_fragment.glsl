// SPDX-License-Identifier: GPL-3.0-or-later
// The depth of the nearest fragment behind the layer that texture `previous` has the depth of, by the depth test; of the
// furthest, where that is turned round. Where there is none it stays NO_DEPTH, behind which there is none either.

void main()
{
  Fragment here = fragment_here();
  if (here.z <= layer_end(texelFetch(previous, ivec2(gl_FragCoord.xy), 0).x)) {
    discard;
  }
  depth = vec4(here.z);
  gl_FragDepth = here.z;
}
