// SPDX-License-Identifier: GPL-3.0-or-later
// The sums of weighted_fragment.glsl as a picture: premultiplied radiance, and opacity.

void main()
{
  vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
  float left = transmittance_of(texelFetch(total, ivec2(gl_FragCoord.xy), 0).x);
  picture = vec4(normalised(left, sum.w) * sum.xyz, 1.0f - left);
}
