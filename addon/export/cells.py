# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke and fire whose shaders ask more of grids than one density: calculated cell by cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from . import fire, voxels
from .shading import fields
from .shading.fields import Field
from .shading.shaders import Body

Cells = NDArray[np.float32]
Array = NDArray[np.float64]

_AT_ONCE = 1 << 17  # cells, so that what is in between stays small
_ENDLESS = 1 << 31  # of the lattice of all grids together, which files far apart make endless
_SAME = 1e-3  # by which colours may differ that are taken for one
_MOST_CELLS, _MOST_FINER = 1 << 22, 4  # of a finer lattice, and along each axis


@dataclass(frozen=True)
class Lattice:
    """The grids that shaders ask for, (z, y, x), or (z, y, x, 3 or 4) of colours, cell by cell at the same places; and the
    cells that Cycles fills with what is the same everywhere."""

    grids: Mapping[str, Cells]
    filled: NDArray[np.bool_]
    grid_to_object: Array

    def evaluated(self, wanted: Sequence[Field]) -> tuple[NDArray[np.intp], list[Cells]]:
        """The cells in which some of the fields is not 0, by number, and what each is there: (n,) or (n, 3)."""
        asked = {
            name: self.grids[name] for name in frozenset[str]().union(*(f.attributes for f in wanted)) & set(self.grids)
        }
        somewhere = np.zeros(self.filled.shape, np.bool_)
        for cells in asked.values():
            somewhere |= cells.any(axis=3) if cells.ndim == 4 else cells != 0.0
        outside = {name: np.zeros((1, *cells.shape[3:])) for name, cells in asked.items()}
        if any(value.any() for value in fields.evaluate(wanted, outside)):
            somewhere |= self.filled
        numbers = np.flatnonzero(somewhere & self.filled)
        out = [np.empty((len(numbers), 3) if _is_colour(f, outside) else len(numbers), np.float32) for f in wanted]
        for start in range(0, len(numbers), _AT_ONCE):
            part = numbers[start : start + _AT_ONCE]
            values = {
                name: cells.reshape(-1, *cells.shape[3:])[part].astype(np.float64) for name, cells in asked.items()
            }
            for whole, found in zip(out, fields.evaluate(wanted, values)):
                whole[start : start + len(part)] = found
        return numbers, out


def _is_colour(field: Field, cell: Mapping[str, Array]) -> bool:
    return fields.evaluate([field], cell)[0].ndim == 2


def fineness(wanted: Sequence[Field], grids: Mapping[str, voxels.Values]) -> int:
    """Into how many parts a cell is to be cut along each axis, where what is between cells is what shaders make of a
    mixture: none where that is linear."""
    ramp = fields.ramp_of(wanted)
    if ramp is not None and ramp[0] in grids and grids[ramp[0]].cells.ndim == 3:
        top = max(float(grids[ramp[0]].cells.max()), 0.0)
        along = np.linspace(0.0, top, 65)
        found = [np.broadcast_to(value.T, value.T.shape[:-1] + along.shape) for value in ramp[1](along)]
        if all(_is_straight(value) for value in found):
            return 1
    largest = max(int(np.prod(grid.cells.shape[:3])) for grid in grids.values())
    return next((n for n in range(_MOST_FINER, 1, -1) if largest * n**3 <= _MOST_CELLS), 1)


def _is_straight(values: Array) -> bool:
    line = np.linspace(values[..., 0], values[..., -1], values.shape[-1], axis=-1)
    return bool(np.abs(values - line).max() <= 1e-4 * np.abs(values).max())


def lattice_of(grids: Mapping[str, voxels.Values], finer: int = 1) -> Lattice:
    """Of the finest grid, with room for the blocks that Cycles' mesh of a volume with all of these consists of; the others
    are linear between their cells. `finer`: into how many a cell is cut along each axis. Raises ValueError for grids that
    are turned against each other."""
    main = min(grids.values(), key=lambda one: abs(float(np.linalg.det(one.grid_to_object[:3, :3]))))
    places = {name: _place_in(main, other, name) for name, other in grids.items()}
    begins = np.array([begin for begin, _ in places.values()])
    ends = np.array([begin + size * grids[name].cells.shape[:3] for name, (begin, size) in places.items()])
    low = np.floor(begins.min(axis=0) + 1e-3).astype(np.int64) + main.first
    high = np.ceil(ends.max(axis=0) - 1e-3).astype(np.int64) + main.first
    low = (low - 1) // fire.BLOCK * fire.BLOCK - main.first
    shape = -(-(high + 1) // fire.BLOCK) * fire.BLOCK - main.first - low
    if float(np.prod(shape, dtype=np.float64)) * finer**3 > _ENDLESS:
        raise ValueError(f"its grids together need {'x'.join(map(str, shape[::-1]))} cells: nothing is shown")
    active = np.zeros(shape, np.bool_)
    out = {}
    for name, (begin, size) in places.items():
        cells = _resampled(grids[name].cells, begin - low, size, shape)
        active |= (cells.any(axis=3) if cells.ndim == 4 else cells) > voxels.CLIPPING
        finely = _resampled(grids[name].cells, (begin - low) * finer, size * finer, shape * finer)
        out[name] = cells if finer == 1 else finely
    filled = fire.in_blocks(active)
    for axis in range(3):
        filled = np.repeat(filled, finer, axis=axis)
    moved = main.grid_to_object @ np.diag([*np.full(3, 1.0 / finer), 1.0])
    moved[:3, 3] += main.grid_to_object[:3, :3] @ low[::-1]
    return Lattice(out, filled, moved)


def _place_in(main: voxels.Values, other: voxels.Values, name: str) -> tuple[Array, Array]:
    """Where another grid begins, and how large its cells are, in cells of one, along z, y and x."""
    to_main = np.linalg.inv(main.grid_to_object) @ other.grid_to_object
    size = np.diag(to_main)[:3]
    if np.abs(to_main[:3, :3] - np.diag(size)).max() > 1e-4 * size.max() or size.min() <= 0.0:
        raise ValueError(f"its grid '{name}' is turned against the others: nothing is shown")
    return to_main[2::-1, 3], size[::-1]


def _resampled(cells: Cells, begin: Array, size: Array, shape: NDArray[np.int64]) -> Cells:
    """A grid on another lattice, in whose cells it begins and has its cells' size; linear between cells, 0 outside."""
    out = cells
    for axis in range(3):
        count = cells.shape[axis]
        at = (np.arange(shape[axis]) + 0.5 - begin[axis]) / size[axis] - 0.5
        at = np.where(np.abs(at - np.round(at)) < 1e-4, np.round(at), at)
        before = np.floor(at).astype(np.int64)
        share = (at - before).astype(np.float32)
        width = [1] * out.ndim
        width[axis] = -1
        padded = np.pad(out, [(1, 1) if a == axis else (0, 0) for a in range(out.ndim)])
        near, far = (np.clip(before + step, 0, count + 1) for step in (1, 2))
        out = np.take(padded, near, axis=axis)
        if share.any():
            out = out + share.reshape(width) * (np.take(padded, far, axis=axis) - out)
    return out


@dataclass(frozen=True)
class Part:
    """A native grid of densities, in a colour each where these differ, and what a unit of it is, per metre."""

    grid: Any
    scattering: Array
    absorption: Array
    anisotropy: float


def parts_of(body: Body, lattice: Lattice, grid_to_world: Array, scale: float) -> list[Part]:
    """The smoke that a body is: one grid where its extinction is of one colour, one for each channel where it is of many."""
    numbers, (scattering, absorption, leaning) = lattice.evaluated((body.scattering, body.absorption, body.anisotropy))
    scattering, absorption = np.maximum(scattering, 0.0), np.maximum(absorption, 0.0)
    extinction = scattering + absorption
    weights = scattering.sum(axis=1, dtype=np.float64)
    anisotropy = float(np.average(leaning, weights=weights)) if weights.any() else 0.0
    out = []
    for colour, density in _by_colour(extinction):
        albedo = np.divide(scattering, extinction, out=np.zeros_like(scattering), where=extinction > 0.0)
        shown = colour > 0.0
        mean = np.where(shown, _ratio(scattering.sum(axis=0), extinction.sum(axis=0)), 0.0)
        alike = bool((np.abs(albedo - mean)[:, shown] <= _SAME).all())
        thickness = colour * scale
        emptiness = core.module().emptiness(lattice.filled.shape, grid_to_world, thickness)
        tint = None if alike else _spread(albedo, numbers, lattice)
        grid = core.module().Grid(_spread(density, numbers, lattice), emptiness, colour=tint)
        scattered = thickness * mean if alike else thickness
        out.append(Part(grid, scattered, thickness - scattered, anisotropy))
    return out


def _by_colour(extinction: Cells) -> list[tuple[Array, Cells]]:
    """Colours, the strongest channel 1, and how much there is of each in the cells: one where that is all."""
    whole = extinction.sum(axis=0, dtype=np.float64)
    if not whole.any():
        return []
    colour = whole / whole.max()
    amount = extinction @ (colour / (colour @ colour)).astype(np.float32)
    if (np.abs(extinction - amount[:, None] * colour) <= _SAME * amount[:, None]).all():
        return [(colour, amount)]
    return [(np.eye(3)[c], extinction[:, c]) for c in range(3) if whole[c] > 0.0]


def _ratio(a: Any, b: Any) -> Array:
    return np.asarray(np.divide(a, b, out=np.zeros(3), where=b > 0.0))


def _spread(values: Cells, numbers: NDArray[np.intp], lattice: Lattice) -> Cells:
    """Values of some cells in all of them, 0 in the others."""
    out = np.zeros((lattice.filled.size, *values.shape[1:]), np.float32)
    out[numbers] = values
    return out.reshape(*lattice.filled.shape, *values.shape[1:])


def fires_of(glow: Field, lattice: Lattice, scale: float) -> list[fire.Fire]:
    """What cells emit: one where that is of one colour, one for each channel where it is of many."""
    numbers, (found,) = lattice.evaluated((glow,))
    out = []
    for colour, amount in _by_colour(np.maximum(found, 0.0)):
        top = float(amount.max())
        rows = np.stack((np.zeros(3), colour * top * scale))
        out.append(fire.Fire(_spread(amount / np.float32(top), numbers, lattice), rows))
    return out
