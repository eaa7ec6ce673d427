# SPDX-License-Identifier: GPL-3.0-or-later
"""Values in space, as expressions of the grids that they are made of: evaluated for any number of cells at once.

An expression is data alone and holds nothing of Blender, so it may be kept, and compared by its digest.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import blending, colours, directions, mathematics, ramps, skies

Array = NDArray[np.float64]

# Of numbers (n,) and colours or vectors (n, 3), with n of 1 for what is the same everywhere, the same. What an operation
# takes besides comes first.
_OPERATIONS: dict[str, Callable[..., Any]] = {
    **mathematics.OPERATIONS,
    **blending.OPERATIONS,
    **colours.OPERATIONS,
    **ramps.OPERATIONS,
    **directions.OPERATIONS,
    **skies.OPERATIONS,
}
# Of grids: their values (n,), or (n, 3) or (n, 4) of colours, which are kept times the fourth.
_GRID, _CONSTANT = "grid", "constant"


@dataclass(frozen=True, eq=False)
class Field:
    """An operation, what it takes besides, and the fields that it is done to; `digest` is the same for equal ones."""

    operation: str
    settings: tuple[Any, ...]
    inputs: tuple[Field, ...]
    digest: bytes
    attributes: frozenset[str]

    @property
    def constant(self) -> Array | None:
        """(1,) or (1, 3), or None where it differs from cell to cell."""
        return np.array(self.settings[0])[None] if self.operation == _CONSTANT else None


def _field(operation: str, settings: tuple[Any, ...], inputs: tuple[Field, ...], own: frozenset[str]) -> Field:
    told = repr((operation, settings)).encode() + b"".join(field.digest for field in inputs)
    attributes = own.union(*(field.attributes for field in inputs))
    return Field(operation, settings, inputs, hashlib.blake2b(told, digest_size=16).digest(), attributes)


def constant(value: Any) -> Field:
    """A number, or a colour or vector of three."""
    settled = np.array(value, np.float64)
    return _field(_CONSTANT, (settled.tolist(),), (), frozenset())


def grid(name: str, output: str, absent: float = 0.0) -> Field:
    """A grid's value as a number ('Fac'), its 'Color' or its 'Alpha'; `absent` where it is not there."""
    return _field(_GRID, (name, output, absent), (), frozenset((name,)))


def of(operation: str, *inputs: Field, settings: tuple[Any, ...] = ()) -> Field:
    """An operation on fields: of constants, a constant."""
    made = _field(operation, settings, inputs, frozenset())
    known = [field.constant for field in inputs]
    if any(value is None for value in known):
        return made
    return constant(_done(operation, settings, known)[0])


def _done(operation: str, settings: tuple[Any, ...], values: Sequence[Any]) -> Array:
    with np.errstate(all="ignore"):  # Cycles takes what has no value for none
        found: Array = np.nan_to_num(_OPERATIONS[operation](*settings, *values), posinf=1e30, neginf=-1e30)
    return found


def evaluate(wanted: Sequence[Field], grids: Mapping[str, Array]) -> list[Array]:
    """Of n cells whose values `grids` tells, by name, those of fields: (n,) or (n, 3), or with 1 for n."""
    known: dict[bytes, Array] = {}
    return [_evaluated(field, grids, known) for field in wanted]


def _evaluated(field: Field, grids: Mapping[str, Array], known: dict[bytes, Array]) -> Array:
    found = known.get(field.digest)
    if found is None:
        constant = field.constant
        if constant is not None:
            found = constant
        elif field.operation == _GRID:
            found = _looked_up(grids, *field.settings)
        else:
            found = _done(field.operation, field.settings, [_evaluated(i, grids, known) for i in field.inputs])
        known[field.digest] = found
    return found


def _looked_up(grids: Mapping[str, Array], name: str, output: str, absent: float) -> Array:
    """As Cycles reads a grid: colours divided by the fourth number where there is one, but not their mean."""
    cells = grids.get(name)
    if cells is None:
        return np.full((1, 3) if output == "Color" else 1, absent)
    if cells.ndim == 1:
        if output == "Alpha":
            return np.ones(1)
        return np.repeat(cells[:, None], 3, axis=1) if output == "Color" else cells
    alpha = cells[:, 3] if cells.shape[1] == 4 else np.ones(1)
    if output == "Alpha":
        return alpha
    if output == "Fac":
        return np.asarray(cells[:, :3].mean(axis=1))
    found: Array = cells[:, :3] / np.where(alpha > 1e-6, alpha, 1.0)[:, None]
    return found


def ramp_of(wanted: Sequence[Field]) -> tuple[str, Callable[[Array], list[Array]]] | None:
    """Where fields are functions of one grid of numbers, and of nothing else: its name, and what gives their values for
    (n,) of its values, each (n,) or (n, 3), or with 1 for n."""
    attributes = frozenset[str]().union(*(field.attributes for field in wanted))
    if len(attributes) != 1:
        return None
    (name,) = attributes
    return name, lambda values: evaluate(wanted, {name: values})
