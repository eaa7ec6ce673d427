// SPDX-License-Identifier: GPL-3.0-or-later
// What a fragment shows by its depth and opacity alone, with the weight in alpha; and its optical depth.

void main()
{
  Fragment here = fragment_here();
  float seen = here.alpha * blended_weight(here.alpha, here.z);
  sums = vec4(seen * here.colour, seen);
  total = vec4(here.tau);
}
