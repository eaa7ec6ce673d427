# SPDX-License-Identifier: GPL-3.0-or-later
"""Values in space, as expressions of the grids that they are made of: evaluated for any number of cells at once.

An expression is data alone and holds nothing of Blender, so it may be kept, and compared by its digest.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import blending, colours, directions, mathematics, procedural, ramps, relief, skies

Array = NDArray[np.float64]

# Of numbers (n,) and colours or vectors (n, 3), with n of 1 for what is the same everywhere, the same. What an operation
# takes besides comes first.
OPERATIONS: dict[str, Callable[..., Any]] = {
    **mathematics.OPERATIONS,
    **blending.OPERATIONS,
    **colours.OPERATIONS,
    **ramps.OPERATIONS,
    **directions.OPERATIONS,
    **skies.OPERATIONS,
    **relief.OPERATIONS,
    **procedural.OPERATIONS,
}
# Of grids: their values (n,), or (n, 3) or (n, 4) of colours, which are kept times the fourth.
GRID, _CONSTANT = "grid", "constant"


@dataclass(frozen=True, eq=False)
class Field:
    """An operation, what it takes besides, and the fields that it is done to."""

    operation: str
    settings: tuple[Any, ...]
    inputs: tuple[Field, ...] = ()

    @functools.cached_property
    def digest(self) -> bytes:
        """The same for equal ones."""
        told = repr((self.operation, self.settings)).encode() + b"".join(field.digest for field in self.inputs)
        return hashlib.blake2b(told, digest_size=16).digest()

    @functools.cached_property
    def attributes(self) -> frozenset[str]:
        """The names of the grids that it is made of."""
        own = frozenset(self.settings[:1] if self.operation == GRID else ())
        return own.union(*(field.attributes for field in self.inputs))

    @property
    def constant(self) -> Array | None:
        """(1,) or (1, 3), or None where it differs from cell to cell."""
        return np.array(self.settings[0])[None] if self.operation == _CONSTANT else None

    def always(self, value: float) -> bool:
        """Whether it, or each of its parts, is nothing else anywhere."""
        known = self.constant
        return known is not None and bool((known == value).all())

    @property
    def is_number(self) -> bool:
        """Of a constant, whether it is no colour."""
        known = self.constant
        return known is not None and known.ndim == 1

    # Numbers are the same for all parts of colours.
    def __add__(self, other: Field | float) -> Field:
        return _arithmetic("add", self, other)

    def __sub__(self, other: Field | float) -> Field:
        return _arithmetic("subtract", self, other)

    def __rsub__(self, other: Field | float) -> Field:
        return _arithmetic("subtract", other, self)

    def __mul__(self, other: Field | float) -> Field:
        return _arithmetic("multiply", self, other)

    def __truediv__(self, other: Field | float) -> Field:
        return _arithmetic("divide", self, other)

    def __rtruediv__(self, other: Field | float) -> Field:
        return _arithmetic("divide", other, self)

    __radd__, __rmul__ = __add__, __mul__


def constant(value: Any) -> Field:
    """A number, or a colour or vector of three."""
    return Field(_CONSTANT, (np.asarray(value, np.float64).tolist(),))


def grid(name: str, output: str, absent: float = 0.0) -> Field:
    """A grid's value as a number ('Fac'), its 'Color' or its 'Alpha'; `absent` where it is not there."""
    return Field(GRID, (name, output, absent))


def of(operation: str, *inputs: Field, settings: tuple[Any, ...] = ()) -> Field:
    """An operation on fields: of constants, a constant."""
    if any(field.operation != _CONSTANT for field in inputs):
        return Field(operation, settings, inputs)
    return constant(_done(operation, settings, [field.constant for field in inputs])[0])


def _done(operation: str, settings: tuple[Any, ...], values: Sequence[Any]) -> Array:
    with np.errstate(all="ignore"):  # Cycles takes what has no value for none
        found: Array = np.nan_to_num(OPERATIONS[operation](*settings, *values), posinf=1e30, neginf=-1e30)
    return found


def _arithmetic(name: str, a: Field | float, b: Field | float) -> Field:
    a, b = (each if isinstance(each, Field) else constant(each) for each in (a, b))
    if name == "multiply":
        for one, other in ((a, b), (b, a)):
            if one.always(0.0) and not one.is_number:
                return one
            if one.always(1.0) and one.is_number:
                return other
    if name == "add":
        for one, other in ((a, b), (b, a)):
            if one.always(0.0) and one.is_number:
                return other
    return of("arithmetic", a, b, settings=(name,))


def minimum(a: Field, b: Field | float) -> Field:
    return _arithmetic("minimum", a, b)


def maximum(a: Field, b: Field | float) -> Field:
    return _arithmetic("maximum", a, b)


def clipped(value: Field, low: float, high: float) -> Field:
    return minimum(maximum(value, low), high)


def root(value: Field) -> Field:
    return of("math", value, settings=("SQRT",))


def colour(red: Field, green: Field, blue: Field) -> Field:
    return of("combine", red, green, blue, settings=("RGB",))


def of_parts(value: Field) -> list[Field]:
    """The three numbers of a colour."""
    return [of("part", value, settings=("RGB", k)) for k in range(3)]


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
        elif field.operation == GRID:
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


class _Halves(dict[str, Array]):
    """A half of whatever is asked for."""

    def get(self, name: str, default: Any = None) -> Any:
        return np.full(1, 0.5)


def usual(value: Field) -> Array:
    """(1,) or (1, 3): its value where all that it is made of is a half; of constants theirs."""
    return evaluate([value], _Halves())[0]


def ramp_of(wanted: Sequence[Field]) -> tuple[str, Callable[[Array], list[Array]]] | None:
    """Where fields are functions of one grid of numbers, and of nothing else: its name, and what gives their values for
    (n,) of its values, each (n,) or (n, 3), or with 1 for n."""
    attributes = frozenset[str]().union(*(field.attributes for field in wanted))
    if len(attributes) != 1:
        return None
    (name,) = attributes
    return name, lambda values: evaluate(wanted, {name: values})
