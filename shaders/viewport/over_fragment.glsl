// SPDX-License-Identifier: GPL-3.0-or-later
// A fragment of those that are drawn back to front.

void main()
{
  Fragment here = fragment_here();
  picture = vec4(here.alpha * here.colour, here.alpha);
}
