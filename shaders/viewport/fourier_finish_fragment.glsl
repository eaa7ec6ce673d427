// SPDX-License-Identifier: GPL-3.0-or-later
// Step 4 of Song (2021), but for the opaque things behind: premultiplied radiance, and opacity.

void main()
{
  vec4 sum = texelFetch(sums, ivec2(gl_FragCoord.xy), 0);
  float left = transmittance_of(0.5f * texelFetch(layer0, ivec2(gl_FragCoord.xy), 0).x);
  picture = vec4(normalised(left, sum.w) * sum.xyz, 1.0f - left);
}
