# SPDX-License-Identifier: GPL-3.0-or-later
"""The text of pre-integration as GLSL, a stretch of smoke or a cell's cubic a pixel: the module's answers."""

from __future__ import annotations

import harness
import numpy as np
import sfumato
from evaluated_text import SIZE, evaluated

FILES = ("media/preintegration.glsl",)
RANDOM = np.random.default_rng(5)

STRETCH = """
  Stretch stretch;
  stretch.front = n0.x;
  stretch.back = n0.y;
  stretch.emission_front = vec3(n0.zw, n1.x);
  stretch.emission_back = n1.yzw;
  stretch.bow = vec3(0.0);
  float pieces = pieces_of(stretch);
  colour = vec4(0.0, 0.0, 0.0, 1.0);
  for (int k = 0; k < int(pieces); ++k) {
    Stretch piece = piece_of(stretch, float(k) / pieces, 1.0 / pieces);
    Attenuation over = attenuation_over(depth_of(piece));
    colour = vec4(colour.rgb + colour.a * radiance_of(piece, over), colour.a * over.behind);
  }
"""

CUBIC = """
  Cubic cubic = cubic_through(n0.x, n0.y, n0.z, n0.w);
  Turns turns = turns_of(cubic);
  float value = mix(n0.x, cubic_at(cubic, turns.first), n1.x);
  float u = cubic_crossing(cubic, 0.0, turns.first, value);
  colour = vec4(turns.first, turns.second, u, cubic_at(cubic, u) - value);
"""


def test_a_stretch_sends_what_it_does_on_the_cpu() -> None:
    """Depths from 1e-4 to 50, and emission of its own."""
    numbers = RANDOM.random((SIZE, SIZE, 8)).astype(np.float32)
    numbers *= np.float32(10.0) ** RANDOM.uniform(-4.0, 1.7, (SIZE, SIZE, 1)).astype(np.float32)
    found = evaluated(FILES, STRETCH, numbers).reshape(-1, 4)
    for one, own in zip(numbers.reshape(-1, 8).astype(float), found):
        transfer = sfumato.TransferFunction([0, 1], one[:2], [one[2:5], one[5:8]])
        wanted = transfer.segment(0.0, 1.0)
        assert np.allclose(own, wanted, rtol=1e-4, atol=1e-6), (one, own, wanted)


def test_a_cubic_turns_and_is_met_where_it_is_on_the_cpu() -> None:
    numbers = RANDOM.random((SIZE, SIZE, 8)).astype(np.float32)
    first, second, met, off = np.moveaxis(evaluated(FILES, CUBIC, numbers).astype(float), -1, 0)
    assert np.abs(off).max() < 1e-5
    assert ((met >= 0.0) & (met <= first)).all()
    cubics = np.linalg.solve(np.vander([0.0, 1 / 3, 2 / 3, 1.0]), numbers[..., :4].reshape(-1, 4).T.astype(float)).T
    for cubic, a, b in zip(cubics, first.ravel(), second.ravel()):
        turns = [u.real for u in np.roots(np.polyder(cubic)) if abs(u.imag) < 1e-9 and 0.0 < u.real < 1.0]
        if all(1e-3 < u < 0.999 for u in turns) and (len(turns) < 2 or abs(turns[0] - turns[1]) > 0.05):
            assert np.allclose([a, b], sorted([*turns, 1.0, 1.0])[:2], atol=1e-3), (cubic, a, b, turns)


harness.main()
