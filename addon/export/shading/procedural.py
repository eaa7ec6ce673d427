# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures that are formulas, which native patterns have: of nodes what these take, and for arrays their values."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import core

Array = NDArray[np.float64]

# How many numbers each gives.
OUTPUTS = {"noise": 4, "musgrave": 1, "voronoi": 8, "checker": 1, "brick": 2, "magic": 4, "wave": 1, "white noise": 4}


@functools.lru_cache(maxsize=64)
def _program(name: str, integers: tuple[int, ...], count: int) -> Any:
    """A native Pattern of one texture, of so many channels."""
    codes = core.module().Pattern.operations()
    steps = [[codes.index("input"), k, 64 + k, *[0] * 10] for k in range(count)]
    steps.append([codes.index(name), count, 0, *range(count), *[0] * (10 - count)])
    outputs = [(k, count + k) for k in range(OUTPUTS[name])]
    return core.module().Pattern(steps, outputs, integers=[integers])


def _values(name: str, integers: tuple[int, ...], first: int, count: int, *inputs: Array) -> Array:
    """(n,) or (n, 3): so many of its numbers, from the first on."""
    columns = [part for value in inputs for part in np.atleast_2d(value.T)]
    rows = np.stack(np.broadcast_arrays(*columns), axis=1)
    found: Array = _program(name, integers, rows.shape[1]).of(rows)[:, first : first + count].astype(np.float64)
    return np.asarray(found[:, 0]) if count == 1 else found


OPERATIONS: dict[str, Callable[..., Any]] = {"texture": _values}
