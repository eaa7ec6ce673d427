# SPDX-License-Identifier: GPL-3.0-or-later
"""The text of air as GLSL, a ray a pixel: the module's answers. Test-only GLSL: nothing draws with it yet."""

from __future__ import annotations

import harness
import numpy as np
import sfumato
from evaluated_text import SIZE, evaluated

FILES = ("media/phase.glsl", "media/air.glsl")
RANDOM = np.random.default_rng(5)

# Without a table of Gauss' points: many even ones.
LAMP = """
  float h = n0.x, from = n0.y, g = n0.w, extinction = n1.x;
  float squeeze = squeeze_of(g);
  RayPart cone = part_in_cone(h, n1.y, n1.z, n1.w);
  float begin = max(from, cone.from), end = min(from + n0.z, cone.to);
  end = max(min(end, lit_until(h, begin, extinction, squeeze)), begin);
  LitStretch stretch = lit_stretch(h, begin, end, squeeze);
  float sum = 0.0;
  for (int k = 0; k < 128; ++k) {
    LitPoint point = lit_point(stretch, (float(k) + 0.5) / 128.0);
    sum += point.weight * henyey_greenstein(point.half_sine2, point.half_cosine2, g) *
           exp(-extinction * (point.radius + point.place - from));
  }
  colour = vec4(sum / 128.0, begin, end, 1.0);
"""

SUN = """
  float column = air_column(n0.x, n0.y, n0.z);
  float front = n0.w * air_column_above(n0.x, n1.x);
  float back = n0.w * (column + air_column_above(n0.x + n0.y * n0.z, n1.x));
  colour = vec4(lit_by_sun(column, front, back), column, front, back);
"""


def test_a_lamp_sends_what_it_does_on_the_cpu() -> None:
    """Rays along x, at a distance h along y from a spot at the origin, whose axis is any."""
    h, extinction = 10.0 ** RANDOM.uniform(-2.0, 0.5, (2, SIZE, SIZE))
    start, length = RANDOM.uniform(-5.0, 3.0, (SIZE, SIZE)), RANDOM.uniform(0.1, 8.0, (SIZE, SIZE))
    axis = RANDOM.standard_normal((SIZE, SIZE, 3))
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    for g in (-0.9, 0.0, 0.99):
        cone = 2.2
        each = (h, start, length, np.full_like(h, g), extinction, h * axis[..., 1], axis[..., 0])
        numbers = np.stack([*each, np.full_like(h, np.cos(0.5 * cone))], -1).astype(np.float32)
        found = evaluated(FILES, LAMP, numbers)[..., 0].astype(float)
        wanted = np.array(
            [
                sfumato.airlight([a, y, 0.0], [a + b, y, 0.0], (0, 0, 0), e, anisotropy=g, direction=towards, cone=cone)
                for a, b, y, e, towards in zip(
                    start.ravel(), length.ravel(), h.ravel(), extinction.ravel(), axis.reshape(-1, 3)
                )
            ]
        ).reshape(SIZE, SIZE)
        assert (wanted > 1e-3 * wanted.max()).sum() > 20, g
        assert (np.abs(found - wanted) <= 1e-3 * wanted + 1e-6 * wanted.max()).all(), g


def test_a_sun_sends_what_it_does_on_the_cpu() -> None:
    """Heights from -2 to 4 scale heights of 5 m, the sun at any elevation, from level rays to steep ones."""
    scale = 5.0
    height, climb = RANDOM.uniform(-2.0, 4.0, (SIZE, SIZE)), RANDOM.uniform(-1.0, 1.0, (SIZE, SIZE)) ** 5
    length, extinction = RANDOM.uniform(0.1, 8.0, (SIZE, SIZE)), 10.0 ** RANDOM.uniform(-3.0, 0.0, (SIZE, SIZE))
    sine = RANDOM.uniform(0.05, 1.0, (SIZE, SIZE))
    each = (height, climb / scale, length, extinction, sine / scale, sine, sine, sine)
    found = evaluated(FILES, SUN, np.stack(each, -1).astype(np.float32))[..., 0].astype(float)
    for i in np.ndindex(SIZE, SIZE):
        start = np.array([0.0, 0.0, height[i] * scale])
        end = start + length[i] * np.array([np.sqrt(1 - climb[i] ** 2), 0.0, climb[i]])
        sun = (0.0, -np.sqrt(1 - sine[i] ** 2), -sine[i])
        wanted = 4 * np.pi * float(sfumato.sunlight(start, end, sun, extinction[i], scale_height=scale))
        assert abs(found[i] - wanted) <= 2e-4 * wanted + 1e-9, (i, found[i], wanted)


harness.main()
