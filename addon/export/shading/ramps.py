# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's ColorRamp, as its own `evaluate()` has it; Cycles tabulates that at 256 places, and loses what lies between."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .colours import from_hsl, from_hsv, to_hsl, to_hsv

Array = NDArray[np.float64]
Stops = tuple[tuple[float, tuple[float, float, float, float]], ...]

_FROM_HUE: dict[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
    "HSV": (to_hsv, from_hsv),
    "HSL": (to_hsl, from_hsl),
}


def _weights(share: Array, tension: float) -> Array:
    """(n, 4): a cardinal spline's, of the four stops around."""
    t, c = share, tension
    return np.stack(
        (
            -c * t**3 + 2.0 * c * t**2 - c * t,
            (2.0 - c) * t**3 + (c - 3.0) * t**2 + 1.0,
            (c - 2.0) * t**3 + (3.0 - 2.0 * c) * t**2 + c * t,
            c * t**3 - c * t**2,
        ),
        axis=1,
    )


def _b_spline_weights(share: Array) -> Array:
    t = share
    found: Array = (
        np.stack(
            ((1.0 - t) ** 3, 3.0 * t**3 - 6.0 * t**2 + 4.0, -3.0 * t**3 + 3.0 * t**2 + 3.0 * t + 1.0, t**3),
            axis=1,
        )
        / 6.0
    )
    return found


def _hues(how: str, share: Array, left: Array, right: Array) -> Array:
    """Between two hues, the shorter way, the longer, clockwise or not."""
    left, right = left % 1.0, right % 1.0
    away = right - left
    if how == "NEAR":
        turn = np.where(away > 0.5, -1.0, np.where(away < -0.5, 1.0, 0.0))
    elif how == "FAR":  # of equal hues, all around
        turn = np.where(away == 0.0, 1.0, 0.0)
        turn = np.where((away < 0.0) & (away > -0.5), 1.0, np.where((away > 0.0) & (away < 0.5), -1.0, turn))
    elif how == "CW":
        turn = np.where(away < 0.0, 1.0, 0.0)
    else:
        turn = np.where(away > 0.0, -1.0, 0.0)
    found: Array = (left + share * (away + turn)) % 1.0
    return found


def _ramp(interpolation: str, mode: str, hue: str, stops: Stops, at: Array) -> Array:
    """(n, 4) at the places (n,); stops are a place and a colour with its alpha."""
    places, values = np.array([place for place, _ in stops]), np.array([value for _, value in stops])
    last = len(stops) - 1
    # Between the last stop that is not beyond the place, and the next: of coincident stops the later one counts,
    # except of those that the ramp begins with.
    at = np.clip(at, 0.0, 1.0)
    after = np.searchsorted(places, at, side="right")
    spline = mode == "RGB" and interpolation in {"CARDINAL", "B_SPLINE"}
    if not spline:
        after = np.where(at <= places[0], 0, after)
    left, right = np.maximum(after - 1, 0), np.minimum(after, last)
    begin, end = np.where(after == 0, 0.0, places[left]), np.where(after > last, 1.0, places[right])
    width = np.where(end > begin, end - begin, 1.0)
    share = np.where(end > begin, np.clip((at - begin) / width, 0.0, 1.0), 0.0)
    if mode == "RGB" and interpolation == "CONSTANT":
        return np.asarray(values[left])
    if spline:
        weights = _weights(share, 0.71) if interpolation == "CARDINAL" else _b_spline_weights(share)
        before = np.where(after < 2, left, left - 1)
        beyond = np.where(after >= last, right, right + 1)
        around = np.stack([values[stop] for stop in (before, left, right, beyond)], axis=1)
        found: Array = np.clip(np.einsum("nk,nkc->nc", weights, around), 0.0, 1.0)
        return found
    if mode == "RGB" and interpolation == "EASE":
        share = share**2 * (3.0 - 2.0 * share)
    share = np.where((after == 0) | (after > last), 0.0, share)
    mixed: Array = values[left] + share[:, None] * (values[right] - values[left])
    if mode != "RGB":
        to_hue, from_hue = _FROM_HUE[mode]
        a, b = to_hue(values[:, :3])[left], to_hue(values[:, :3])[right]
        between = a + share[:, None] * (b - a)
        between[:, 0] = _hues(hue, share, a[:, 0], b[:, 0])
        mixed[:, :3] = from_hue(between)
    return mixed


OPERATIONS: dict[str, Callable[..., Any]] = {
    "ramp's colour": lambda *settings: _ramp(*settings)[:, :3],
    "ramp's alpha": lambda *settings: _ramp(*settings)[:, 3],
}
