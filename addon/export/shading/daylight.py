# SPDX-License-Identifier: GPL-3.0-or-later
"""Daylight by formulas that were fitted to skies (Preetham, Shirley and Smits 1999, "A Practical Analytic Model for
Daylight")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .scattering import RGB_OF_XYZ

Array = NDArray[np.float64]

# Of x, y and Y (their appendix A.2): Perez' five numbers, by the turbidity and one.
_PEREZ = np.array(
    (
        ((-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)),
        ((-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)),
        ((0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)),
    )
)
# Of x and y at the zenith: by the square of the turbidity, the turbidity and one, and by the third to no power of the
# sun's angle from there.
_ZENITH = np.array(
    (
        (
            (0.00166, -0.00375, 0.00209, 0.0),
            (-0.02903, 0.06377, -0.03202, 0.00394),
            (0.11693, -0.21196, 0.06052, 0.25886),
        ),
        (
            (0.00275, -0.00610, 0.00317, 0.0),
            (-0.04214, 0.08970, -0.04153, 0.00516),
            (0.15346, -0.26756, 0.06670, 0.26688),
        ),
    )
)
# Cycles' unit of luminance: of thousands of candela per square metre, by the brightness that it gives a sky.
_UNIT = 0.06
_LOWEST = 1e-3  # radians above the horizon: so low it is for all below


def preetham(turbidity: float, sun: Array, directions: Array) -> Array:
    """Radiance (n, 3) from directions (n, 3), by the direction of a sun (3,), all of length 1."""
    numbers = _PEREZ @ (turbidity, 1.0)
    upward = np.maximum(directions[:, 2], np.sin(_LOWEST))
    cosine = np.clip(directions @ sun, -1.0, 1.0)
    shown = _perez(numbers, upward, cosine) / _perez(numbers, np.ones(1), sun[2:])
    x, y, luminance = shown * _at_zenith(turbidity, float(np.arccos(sun[2])))[:, None]
    luminance = _UNIT * luminance
    xyz = np.stack((x / y * luminance, luminance, (1.0 - x - y) / y * luminance), axis=1)
    return np.asarray(xyz @ RGB_OF_XYZ.T)


def _perez(numbers: Array, upward: Array, cosine: Array) -> Array:
    """(3, n) by the cosines (n,) of the angles from the zenith and from the sun (equation 3)."""
    a, b, c, d, e = numbers.T[..., None]
    found: Array = (1.0 + a * np.exp(b / upward)) * (1.0 + c * np.exp(d * np.arccos(cosine)) + e * cosine * cosine)
    return found


def _at_zenith(turbidity: float, sun: float) -> Array:
    """x, y and Y, in thousands of candela per square metre."""
    x, y = np.array((turbidity * turbidity, turbidity, 1.0)) @ _ZENITH @ (sun**3, sun**2, sun, 1.0)
    chi = (4.0 / 9.0 - turbidity / 120.0) * (np.pi - 2.0 * sun)
    return np.array((x, y, (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192))
