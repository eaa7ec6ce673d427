// SPDX-License-Identifier: GPL-3.0-or-later
// Dims the viewport's background behind the smoke.
//
// Blender keeps the background apart from its picture, among the overlays: it adds it to the picture after the view
// transform, in display space. There the smoke's radiance L and the background B add up to encode(L) + B, but should
// be encode(L + T decode(B)). What the background must be multiplied by, for the sum to come out right, is the result.
// It takes the view transform to be sRGB's, as it is in Solid mode.

vec3 encode(vec3 linear)
{
  return mix(1.055f * pow(max(linear, 0.0031308f), vec3(1.0f / 2.4f)) - 0.055f, 12.92f * linear,
             vec3(lessThan(linear, vec3(0.0031308f))));
}

vec3 decode(vec3 encoded)
{
  return mix(pow((max(encoded, 0.04045f) + 0.055f) / 1.055f, vec3(2.4f)), encoded / 12.92f,
             vec3(lessThan(encoded, vec3(0.04045f))));
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 through = texelFetch(transmittance, pixel, 0);
  vec3 smoke = min(texelFetch(radiance, pixel, 0).xyz * gain, 1.0f);
  vec3 behind = max(background, 1e-4f);
  vec3 rest = encode(min(smoke + through.xyz * behind, 1.0f)) - encode(smoke);
  vec3 factor = decode(rest) / behind;
  // Where there is a surface, the smoke has dimmed that, and lines over it stay.
  colour = mix(vec4(factor, dot(through.xyz, vec3(1.0f / 3.0f))), vec4(1.0f), through.w);
}
