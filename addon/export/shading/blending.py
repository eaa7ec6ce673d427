# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Mix nodes, as Cycles calculates them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .colours import from_hsv, to_hsv

Array = NDArray[np.float64]


def _over(a: Array, b: Array) -> Array:
    found: Array = a / np.where(b != 0.0, b, 1.0)
    return found


def _overlay(t: Array, a: Array, b: Array) -> Array:
    dark = a * (1.0 - t + 2.0 * t * b)
    bright = 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a)
    return np.where(a < 0.5, dark, bright)


def _dodge(t: Array, a: Array, b: Array) -> Array:
    rest = 1.0 - t * b
    return np.where(a != 0.0, np.where(rest <= 0.0, 1.0, np.minimum(_over(a, rest), 1.0)), 0.0)


def _burn(t: Array, a: Array, b: Array) -> Array:
    rest = 1.0 - t + t * b
    return np.where(rest <= 0.0, 0.0, np.clip(1.0 - _over(1.0 - a, rest), 0.0, 1.0))


def _soft(t: Array, a: Array, b: Array) -> Array:
    screen = 1.0 - (1.0 - b) * (1.0 - a)
    return (1.0 - t) * a + t * ((1.0 - a) * b * a + a * screen)


def _with_hue(t: Array, a: Array, b: Array, parts: int) -> Array:
    """Of the first colour, so many parts of its hue and saturation from the second, unless that is grey."""
    a, b = (np.broadcast_to(colour, np.broadcast_shapes(a.shape, b.shape)) for colour in (a, b))
    of_a, of_b = to_hsv(a), to_hsv(b)
    changed = from_hsv(np.concatenate((of_b[:, :parts], of_a[:, parts:]), axis=1))
    return np.where(of_b[:, 1:2] != 0.0, a + t * (changed - a), a)


def _with_part(t: Array, a: Array, b: Array, part: int) -> Array:
    """Of the first colour, its saturation (1), unless it is grey, or value (2) mixed with the second's."""
    a, b, t = (np.broadcast_to(value, np.broadcast_shapes(a.shape, b.shape, t.shape)) for value in (a, b, t))
    of_a, of_b = to_hsv(a), to_hsv(b)
    changed = of_a.copy()
    changed[:, part] = of_a[:, part] + t[:, 0] * (of_b[:, part] - of_a[:, part])
    return np.where((of_a[:, 1:2] != 0.0) | (part == 2), from_hsv(changed), a)


# By Blender's names, of factors (n, 1) and colours (n, 3).
OF_COLOURS: dict[str, Callable[[Array, Array, Array], Any]] = {
    "MIX": lambda t, a, b: a + t * (b - a),
    "DARKEN": lambda t, a, b: a + t * (np.minimum(a, b) - a),
    "MULTIPLY": lambda t, a, b: a + t * (a * b - a),
    "BURN": _burn,
    "LIGHTEN": lambda t, a, b: a + t * (np.maximum(a, b) - a),
    "SCREEN": lambda t, a, b: 1.0 - (1.0 - t + t * (1.0 - b)) * (1.0 - a),
    "DODGE": _dodge,
    "ADD": lambda t, a, b: a + t * b,
    "OVERLAY": _overlay,
    "SOFT_LIGHT": _soft,
    "LINEAR_LIGHT": lambda t, a, b: a + t * (2.0 * b - 1.0),
    "DIFFERENCE": lambda t, a, b: a + t * (np.abs(a - b) - a),
    "EXCLUSION": lambda t, a, b: np.maximum(a + t * (b - 2.0 * a * b), 0.0),
    "SUBTRACT": lambda t, a, b: a - t * b,
    "DIVIDE": lambda t, a, b: np.where(b != 0.0, (1.0 - t) * a + t * _over(a, b), a),
    "HUE": lambda t, a, b: _with_hue(t, a, b, 1),
    "SATURATION": lambda t, a, b: _with_part(t, a, b, 1),
    "COLOR": lambda t, a, b: _with_hue(t, a, b, 2),
    "VALUE": lambda t, a, b: _with_part(t, a, b, 2),
}


def _mixed(factor: Array, a: Array, b: Array) -> Array:
    """Numbers by a number, or vectors by a vector."""
    return a + factor * (b - a)


OPERATIONS: dict[str, Callable[..., Any]] = {
    "mix": _mixed,
    "blend": lambda mode, factor, a, b: OF_COLOURS[mode](factor[:, None], a, b),
}
