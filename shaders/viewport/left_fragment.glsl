// SPDX-License-Identifier: GPL-3.0-or-later
// What a premultiplied picture leaves of all that lies behind it; to be multiplied by.

void main()
{
  colour = vec4(vec3(1.0f - texelFetch(picture, ivec2(gl_FragCoord.xy), 0).w), 1.0f);
}
