# SPDX-License-Identifier: GPL-3.0-or-later
"""The particles that bench.py measures: a plume like that of Jansen and Bavoil (2010), in a cube of 1 m."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

COUNT = 16384
SUN = (0.3, 0.5, -0.8)


def plume(count: int = COUNT) -> tuple[Floats, Floats, Floats]:
    """Points (n, 3), radii (n,) in metres and opacities (n,): it widens and thins as it rises. More particles are smaller,
    so that as much of the cube is filled."""
    random = np.random.default_rng(16)
    height = random.random(count)
    angle = random.uniform(0.0, 2.0 * np.pi, count)
    away = (0.04 + 0.26 * height) * np.sqrt(random.random(count))
    points = np.stack((away * np.cos(angle), away * np.sin(angle), 0.1 + 0.8 * height), axis=1)
    return points, (0.01 + 0.04 * height) * (COUNT / count) ** (1 / 3), 0.3 - 0.25 * height


def optical_depth(points: Floats, radius: Floats, opacity: Floats, places: Floats, towards: Floats) -> Floats:
    """Exactly, from each of places (m, 3) to a sun in the unit direction `towards` (3,): a puff's column beside its middle
    goes as (1 - q^2)^(3/2), and of a chord's the part before its share u of half the chord as 1/2 + 3/4 u - 1/4 u^3."""
    through = -np.log1p(-opacity)
    out = np.zeros(len(places))
    for at, place in enumerate(places):
        away = points - place
        along = away @ towards
        inside = 1.0 - (np.einsum("ij,ij->i", away, away) - along**2) / radius**2
        met = inside > 0.0
        half = radius[met] * np.sqrt(inside[met])
        u = np.clip(along[met] / half, -1.0, 1.0)  # of the chord, what lies between the place and the sun
        out[at] = np.sum(through[met] * inside[met] ** 1.5 * (0.5 + u * (0.75 - 0.25 * u * u)))
    return out
