// SPDX-License-Identifier: GPL-3.0-or-later
// Hands a finished picture to the target that is bound; the blend mode decides what happens there.

void main()
{
  vec4 texel = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
  colour = vec4(texel.xyz * gain, max(texel.w, least_alpha));
}
