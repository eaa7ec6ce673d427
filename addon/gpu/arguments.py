# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of arguments, in the words of the native module: ValueError that names the argument and its value."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Doubles = NDArray[np.float64]


def finite(values: ArrayLike, name: str) -> Doubles:
    """An array without NaN and infinity."""
    array = np.asarray(values, np.float64)
    bad = ~np.isfinite(array)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(f"{name} holds {array.flat[at]:g} at flat index {at}; every value must be finite")
    return array


def each_within(array: Doubles, low: float, high: float, name: str) -> None:
    bad = ~((array >= low) & (array <= high))
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(
            f"{name} holds {array.flat[at]:g} at flat index {at}; every value must lie between {low:g} and {high:g}"
        )


def within(value: int, low: int, high: int, name: str) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name} is {value}, but must lie between {low} and {high}")


def one_each(values: ArrayLike, count: int, name: str) -> Doubles:
    """`count` values; one stands for all."""
    array = finite(values, name)
    if array.shape not in ((), (count,)):
        raise ValueError(f"{name} has shape {array.shape}, but must have () or ({count},), one for each point")
    return np.broadcast_to(array, (count,))


def odd_coefficients(count: int) -> int:
    """How many coefficients a Fourier opacity map can have."""
    within(count, 1, 63, "coefficients")
    if count % 2 == 0:
        raise ValueError(f"coefficients is {count}, but must be odd: a constant and pairs of harmonics")
    return count


def affine(matrix: ArrayLike, name: str) -> Doubles:
    """A matrix that can be inverted and keeps parallels parallel."""
    m = finite(matrix, name)
    if m.shape != (4, 4):
        raise ValueError(f"{name} has shape {m.shape}, but must be (4, 4)")
    for column, value in enumerate(m[3]):
        if value != (1.0 if column == 3 else 0.0):
            raise ValueError(f"{name} holds {value:g} at flat index {12 + column}; its last row must be 0, 0, 0, 1")
    if np.linalg.det(m) == 0.0:
        raise ValueError(f"{name} flattens space: its determinant is 0")
    return m
