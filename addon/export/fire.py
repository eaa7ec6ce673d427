# SPDX-License-Identifier: GPL-3.0-or-later
"""What glows in grids of values, and the spheres that light what is around it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .emission import Emitter

Array = NDArray[np.float64]

ROWS = 128  # of emission, at most (EMISSION_ROWS of native/media/medium_view.hpp)


@dataclass(frozen=True)
class Fire:
    """What glows in a grid (z, y, x), in [0, 1], and what that emits, (n, 3), W/(m^3 sr) from black on."""

    glow: NDArray[np.float32]
    emission: Array


# Values below this share of the highest count as none: what they emit is lost in the rest.
_FAINT = 1e-3


def fire_of(
    values: NDArray[np.float32], emitter: Emitter, filled: NDArray[np.bool_], mixed: bool = False
) -> Fire | None:
    """What a grid of values emits; where they are 0 and that emits something, in the cells that are `filled`. None where
    nothing does. Between cells the values are mixed, or what they emit."""
    top = max(float(values.max()), 0.0)
    shares = np.linspace(0.0, 1.0, ROWS)
    to_glow, emission_of = _by_power(emitter, top) if mixed and top > 0.0 else _by_value(emitter, top)
    if not emitter.of(np.zeros(1)).any() or not filled.any():
        emission = emission_of(shares)
        emission[0] = 0.0
        if not emission.any():
            return None
        glow = to_glow(np.maximum(values, 0.0, dtype=np.float32) / np.float32(top))
        glow[glow < _FAINT] = 0.0
        return Fire(np.minimum(glow, np.float32(1.0)), emission)
    # The first half of the rows leads from the outside, which is black, to the value 0, which has a row of its own.
    if top == 0.0:
        return Fire(filled.astype(np.float32), np.stack((np.zeros(3), emitter.of(np.zeros(1))[0])))
    shares = np.linspace(0.0, 1.0, ROWS - 1)
    emission = emission_of(np.maximum(2.0 * shares - 1.0, 0.0)) * np.minimum(2.0 * shares, 1.0)[:, None]
    inside = 0.5 + 0.5 * to_glow(np.clip(values, 0.0, top) / np.float32(top))
    return Fire(np.where(filled, inside, 0.0).astype(np.float32), emission)


# What a share of the highest value glows, and what a glow emits.
_Scale = tuple[Callable[[NDArray[np.float32]], NDArray[np.float32]], Callable[[Array], Array]]


def _by_value(emitter: Emitter, top: float) -> _Scale:
    return lambda shares: shares, lambda glow: emitter.of(glow * top)


def _by_power(emitter: Emitter, top: float) -> _Scale:
    """A glow that is linear in the sum of what is emitted. The colour between two cells is that of one value, not of a
    mixture."""
    finely = np.linspace(0.0, 1.0, 4096)
    sums = np.maximum.accumulate(emitter.of(finely * top).sum(axis=1))
    lowest, highest = float(sums[0]), float(sums[-1])
    power = (sums - lowest) / max(highest - lowest, 1e-30)

    def emission_of(glow: Array) -> Array:
        emission = emitter.of(np.interp(glow, power, finely) * top)
        wanted = lowest + glow * (highest - lowest)
        scaled: Array = emission * (wanted / np.maximum(emission.sum(axis=1), 1e-30))[:, None]
        return scaled

    return lambda shares: np.interp(shares, finely, power).astype(np.float32), emission_of


BLOCK = 8


def in_blocks(active: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The cells that Cycles' mesh of a volume encloses: all of each block of 8^3 that has an active cell or the neighbour
    of one, of a grid whose blocks are whole and whose outermost cells are none. There what asks no grid glows. Seen: 3.4.1, 4.5.15; 5.0.1 fills more, 9 % of the light of
    blend_samples/fire.blend."""
    near = active.copy()
    for axis in range(3):
        for away in (-1, 1):
            near |= np.roll(active, away, axis=axis)
    parts = [n for size in near.shape for n in (size // BLOCK, BLOCK)]
    blocks: NDArray[np.bool_] = near.reshape(parts).any(axis=(1, 3, 5))
    for axis in range(3):
        blocks = np.repeat(blocks, BLOCK, axis=axis)
    return blocks


# ---- Light of fire ----


@dataclass(frozen=True)
class Flame:
    """A sphere that shines as a part of a fire does: metres in the world, W/sr."""

    position: Array
    radius: float
    intensity: Array


MOST_FLAMES = 6
# Weaker parts than this share of a fire are added to the others.
_WEAK = 0.02


def flames_of(fires: Sequence[Fire], grid_to_world: Array) -> list[Flame]:
    """The spheres that stand for fires of the same cells: these are divided where they are spread widest, by their power,
    until there are as many as there may be; a sphere has the middle, the power and the spread of its part."""
    lit = [_emitted(fire) for fire in fires if fire.glow.any()]
    if not lit:
        return []
    cells, emitted = (np.concatenate(parts) for parts in zip(*lit))
    # Of a volume that emits e into each direction, the intensity is e times the volume.
    emitted *= abs(float(np.linalg.det(grid_to_world[:3, :3])))
    weights = emitted.sum(axis=1)
    total = float(weights.sum())
    shown = weights > 1e-6 * total / len(weights)
    places = (cells[shown, ::-1] + 0.5) @ grid_to_world[:3, :3].T + grid_to_world[:3, 3]
    parts = [np.flatnonzero(weights[shown] > 0.0)]
    emitted, weights = emitted[shown], weights[shown]
    while len(parts) < MOST_FLAMES:
        spreads = [_spread(places[part], weights[part]) for part in parts]
        worth = [float(weights[part].sum()) * widest for part, (widest, _) in zip(parts, spreads)]
        widest = int(np.argmax(worth))
        if worth[widest] <= 1e-12 * total:
            break
        part, along = parts.pop(widest), spreads[widest][1]
        across = places[part] @ along
        middle = float(np.average(across, weights=weights[part]))
        halves = part[across < middle], part[across >= middle]
        parts += [half for half in halves if len(half)]
        if not all(len(half) for half in halves):
            break
    flames = []
    for part in parts:
        middle_at = np.average(places[part], axis=0, weights=weights[part])
        away2 = float(np.average(((places[part] - middle_at) ** 2).sum(axis=1), weights=weights[part]))
        cell = abs(float(np.linalg.det(grid_to_world[:3, :3]))) ** (1.0 / 3.0)
        # The root mean square of the places in a sphere is sqrt(3 / 5) of its radius.
        radius = max(float(np.sqrt(away2 * 5.0 / 3.0)), cell)
        flames.append(Flame(middle_at, radius, emitted[part].sum(axis=0)))
    return _without_weak(flames, total)


def _emitted(fire: Fire) -> tuple[NDArray[np.int64], Array]:
    """Cells (n, 3), along z, y and x, and the mean of what each emits (n, 3), between whose middles the glow is linear: it
    is no more than a third of what the middle emits beside a cell that is dark, where that goes with the fifth power of a
    temperature. By Gauss and Legendre's rule of two points along each axis."""
    lit = np.argwhere(fire.glow > 0.0)
    low, high = lit.min(axis=0), lit.max(axis=0) + 1
    glow = np.pad(fire.glow[tuple(slice(a, b) for a, b in zip(low, high))], 2)
    rows = np.arange(len(fire.emission)) / (len(fire.emission) - 1)
    near = glow > 0.0
    for axis in range(3):
        near |= np.roll(near, 1, axis=axis) | np.roll(near, -1, axis=axis)
    mean = np.zeros((int(near.sum()), 3))
    aside = np.float32(0.5 / np.sqrt(3.0))
    for sides in np.ndindex(2, 2, 2):
        there = glow
        for axis, side in enumerate(sides):
            there = (1 - aside) * there + aside * np.roll(there, 1 if side else -1, axis=axis)
        for c in range(3):
            mean[:, c] += 0.125 * np.interp(there[near], rows, fire.emission[:, c])
    cells: NDArray[np.int64] = np.argwhere(near) + low - 2
    return cells, mean


def _spread(places: Array, weights: Array) -> tuple[float, Array]:
    """The highest variance of places (n, 3) along a direction, square metres, and that direction."""
    away = places - np.average(places, axis=0, weights=weights)
    values, vectors = np.linalg.eigh((away * weights[:, None]).T @ away / weights.sum())
    return float(values[-1]), vectors[:, -1]


def _without_weak(flames: list[Flame], total: float) -> list[Flame]:
    strong = [flame for flame in flames if flame.intensity.sum() >= _WEAK * total]
    kept = sum(float(flame.intensity.sum()) for flame in strong)
    return [replace(flame, intensity=flame.intensity * (total / kept)) for flame in strong]
