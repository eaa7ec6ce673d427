# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Math, Clamp and Map Range nodes, as Cycles calculates them: what has no value is 0."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _over(a: Array, b: Array) -> Array:
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def _power(a: Array, b: Array) -> Array:
    return np.where((a < 0.0) & (b != np.trunc(b)), 0.0, np.power(a, b))


def _logarithm(a: Array, base: Array) -> Array:
    proper = (a > 0.0) & (base > 0.0)
    return np.where(proper, _over(np.log(np.where(proper, a, 1.0)), np.log(np.where(proper, base, 1.0))), 0.0)


def _smooth_minimum(a: Array, b: Array, distance: Array) -> Array:
    near = np.maximum(_over(distance - np.abs(a - b), distance), 0.0)
    found: Array = np.minimum(a, b) - near**3 * distance / 6.0
    return found


def _fraction(a: Array) -> Array:
    found: Array = a - np.floor(a)
    return found


def _remainder(a: Array, b: Array) -> Array:
    return np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0)


def _wrapped(a: Array, high: Array, low: Array) -> Array:
    return np.where(high != low, a - (high - low) * np.floor(_over(a - low, high - low)), low)


def _ping_pong(a: Array, b: Array) -> Array:
    return np.where(b != 0.0, np.abs(_fraction(_over(a - b, 2.0 * b)) * 2.0 * b - b), 0.0)


# By Blender's names, of the numbers that the operation takes.
OF_NUMBERS: dict[str, Callable[..., Any]] = {
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "MULTIPLY": np.multiply,
    "DIVIDE": _over,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": _power,
    "LOGARITHM": _logarithm,
    "SQRT": lambda a: np.sqrt(np.maximum(a, 0.0)),
    "INVERSE_SQRT": lambda a: _over(np.ones(1), np.sqrt(np.maximum(a, 0.0))),
    "ABSOLUTE": np.abs,
    "EXPONENT": np.exp,
    "MINIMUM": np.minimum,
    "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: (a < b) * 1.0,
    "GREATER_THAN": lambda a, b: (a > b) * 1.0,
    "SIGN": np.sign,
    "COMPARE": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, 1e-5)) * 1.0,
    "SMOOTH_MIN": _smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": lambda a: np.floor(a + 0.5),
    "FLOOR": np.floor,
    "CEIL": np.ceil,
    "TRUNC": np.trunc,
    "FRACT": _fraction,
    "MODULO": _remainder,
    "FLOORED_MODULO": lambda a, b: a - np.floor(_over(a, b)) * b * (b != 0.0) - a * (b == 0.0),
    "WRAP": _wrapped,
    "SNAP": lambda a, b: np.floor(_over(a, b)) * b,
    "PINGPONG": _ping_pong,
    "SINE": np.sin,
    "COSINE": np.cos,
    "TANGENT": np.tan,
    "ARCSINE": lambda a: np.arcsin(np.clip(a, -1.0, 1.0)),
    "ARCCOSINE": lambda a: np.arccos(np.clip(a, -1.0, 1.0)),
    "ARCTANGENT": np.arctan,
    "ARCTAN2": np.arctan2,
    "SINH": np.sinh,
    "COSH": np.cosh,
    "TANH": np.tanh,
    "RADIANS": np.radians,
    "DEGREES": np.degrees,
}


def _clamped(a: Array, low: Array, high: Array) -> Array:
    return np.minimum(np.maximum(a, low), high)


def _clamped_between(a: Array, one: Array, other: Array) -> Array:
    return _clamped(a, np.minimum(one, other), np.maximum(one, other))


def _ranged(
    how: str, clamp: bool, a: Array, low: Array, high: Array, to_low: Array, to_high: Array, *steps: Array
) -> Array:
    """How is Blender's interpolation; all are numbers, or all vectors."""
    share = _over(a - low, high - low)
    if how == "STEPPED":
        share = _over(np.floor(share * (steps[0] + 1.0)), steps[0] * (steps[0] > 0.0))
    elif how == "SMOOTHSTEP":
        share = np.clip(share, 0.0, 1.0)
        share = share**2 * (3.0 - 2.0 * share)
    elif how == "SMOOTHERSTEP":
        share = np.clip(share, 0.0, 1.0)
        share = share**3 * (share * (6.0 * share - 15.0) + 10.0)
    found = np.where(high != low, to_low + share * (to_high - to_low), 0.0)
    return _clamped_between(found, to_low, to_high) if clamp else found


OPERATIONS: dict[str, Callable[..., Any]] = {
    "math": lambda name, *values: OF_NUMBERS[name](*values),
    "clamp": _clamped,
    "clamp between": _clamped_between,
    "map range": _ranged,
}
