# SPDX-License-Identifier: GPL-3.0-or-later
"""Published ways to a lamp's light in even air that the product does not use, for the benchmark alone.

All take rays by the lamp's distance h from them, and the places of their eye and end along them from the lamp's foot, in
metres, and return what an intensity of 1 sends to the eye for a scattering of 1 per metre.
"""

from __future__ import annotations

import numpy as np

TEXELS = 512


def scattered(h: np.ndarray, s: np.ndarray, reach: float, g: float, least2: float = 0.0) -> np.ndarray:
    """Phase function over squared distance; s may have one more axis than h."""
    r2 = np.maximum(h * h + s * s, least2)
    cosine = -s / np.sqrt(r2)
    return np.asarray((1 - g * g) / (4 * np.pi * ((1 + g * g) - 2 * g * cosine) ** 1.5) / r2)


class Table:
    """Yusov, "High performance outdoor light scattering using epipolar sampling", GPU Pro 5, 2014: of the light from each
    place at each distance up to the end of a cube of half the size `reach`, 512 x 512 in single precision, added up with
    steps of a texel; bilinear."""

    def __init__(self, reach: float, extinction: float, g: float) -> None:
        self.reach, self.extinction = reach, extinction
        step = 2.0 * reach / (TEXELS - 1)
        s = np.linspace(-reach, reach, TEXELS)
        h = np.linspace(0.0, reach, TEXELS)[:, None]
        sent = scattered(h, s, reach, g, 1e-8 * reach * reach)
        # exp(-beta (r + s - s0)): the last two apart, from the far end to each place.
        sent = sent * np.exp(-extinction * np.sqrt(h * h + s * s))
        behind = np.exp(-extinction * step)
        table = np.zeros((TEXELS, TEXELS))
        for i in range(TEXELS - 2, -1, -1):
            table[:, i] = sent[:, i] * step + behind * table[:, i + 1]
        self.values = table.astype(np.float32).astype(float)

    def look_up(self, h: np.ndarray, s: np.ndarray) -> np.ndarray:
        x = np.clip((s / self.reach + 1.0) / 2.0, 0.0, 1.0) * (TEXELS - 1)
        y = np.clip(h / self.reach, 0.0, 1.0) * (TEXELS - 1)
        i, j = np.minimum(x.astype(int), TEXELS - 2), np.minimum(y.astype(int), TEXELS - 2)
        u, v = x - i, y - j
        t = self.values
        low = t[j, i] * (1 - u) + t[j, i + 1] * u
        high = t[j + 1, i] * (1 - u) + t[j + 1, i + 1] * u
        return np.asarray(low * (1 - v) + high * v)

    def sent(self, h: np.ndarray, eye: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """From the lit section between start and end, dimmed on the way to the eye."""
        near = np.exp(-self.extinction * (start - eye)) * self.look_up(h, start)
        far = np.exp(-self.extinction * (end - eye)) * self.look_up(h, end)
        return np.asarray(near - far)


def march(
    h: np.ndarray, eye: np.ndarray, start: np.ndarray, end: np.ndarray, extinction: float, g: float, steps: int
) -> np.ndarray:
    """The middles of equal steps from start to end."""
    step = (end - start) / steps
    s = start[:, None] + step[:, None] * (np.arange(steps) + 0.5)
    way = np.sqrt(h[:, None] ** 2 + s * s) + s - eye[:, None]
    return np.asarray((scattered(h[:, None], s, 1.0, g) * np.exp(-extinction * way)).sum(1) * step)
