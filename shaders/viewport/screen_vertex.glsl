// SPDX-License-Identifier: GPL-3.0-or-later
// One triangle that covers the screen.

void main()
{
  gl_Position = vec4(corner, 0.0f, 1.0f);
}
