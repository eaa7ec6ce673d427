// SPDX-License-Identifier: GPL-3.0-or-later
// The sums of nearest_fragment.glsl as a picture: premultiplied radiance, and opacity.

void main()
{
  Kept pixel = kept_here();
  vec4 layers = texelFetch(of_layers, ivec2(gl_FragCoord.xy), 0);
  vec4 tail = texelFetch(of_tail, ivec2(gl_FragCoord.xy), 0);
  float left = transmittance_of(pixel.all);
  float opacity = tail_opacity(pixel.passed, pixel.tail, tail.w);
  float scale = layers_scale(left, layers.w, opacity);
  picture = vec4(scale * (layers.xyz + tail_scale(opacity, tail.w) * tail.xyz), 1.0f - left);
}
