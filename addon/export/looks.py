# SPDX-License-Identifier: GPL-3.0-or-later
"""What is modelled of a surface: one diffuse part, layers of gloss above it, and what it lets straight through."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat
from .shading import fields
from .shading.fields import Field

MOST_LAYERS = 4
LEAVES_REST, LEAVES_NOTHING = 0.5, 1.0  # to what is below a layer of gloss
SMOOTHEST = 0.1  # roughness that lamps know
MIRROR = 0.01  # what surfaces are mirrored with
LAMBERT, BURLEY = 0, 1  # native kinds of what is diffuse
SHEEN, VELVET, FIBRES = 5, 6, 7  # and of sheens

BLACK = fields.constant((0.0, 0.0, 0.0))
WHITE = fields.constant((1.0, 1.0, 1.0))
NONE = fields.constant(0.0)
ALL = fields.constant(1.0)


@dataclass
class Layer:
    """A layer of gloss, as native Gloss has it."""

    reflectance: Field
    alpha: tuple[Field, Field]
    edge: float = 0.0
    index: Field = NONE
    lossless: bool = False
    below: float = 0.0
    dip: Field = BLACK
    beckmann: bool = False
    share: Field = ALL
    turn: Field = NONE
    part: str = ""  # of a shader with several of a kind, which


@dataclass
class Look:
    """How a material reflects, glows, and lets light straight through; of what it does, its share of the surface is taken.
    Any of it may differ from place to place."""

    albedo: Field = BLACK
    layers: list[Layer] = field(default_factory=list)  # from the top
    emission: Field = BLACK
    diffuse: int = LAMBERT
    roughness: Field = NONE  # of what is diffuse
    transmittance: Field = BLACK
    normal: Field | None = None
    glass: bool = False  # whether what it lets through, Cycles would bend
    translucence: Field = BLACK  # of light that falls on the other side
    sheen: Field = BLACK
    sheen_kind: int = SHEEN
    sheen_roughness: Field = NONE

    @property
    def shades(self) -> bool:
        """Whether its normal matters."""
        return bool(self.layers) or not all(each.always(0.0) for each in (self.albedo, self.translucence, self.sheen))


def besides(first: Look, second: Look, part: Field, rest: Field) -> dict[str, Any]:
    """What is not layered, of shares of both; of two sheens one, of the kind of the first."""
    of = first if second.sheen.always(0.0) else second
    roughness = of.sheen_roughness
    if not first.sheen.always(0.0) and not second.sheen.always(0.0):
        roughness = 0.5 * (first.sheen_roughness + second.sheen_roughness)
        of = first
    return {
        "glass": first.glass or second.glass,
        "translucence": part * first.translucence + rest * second.translucence,
        "sheen": part * first.sheen + rest * second.sheen,
        "sheen_kind": of.sheen_kind,
        "sheen_roughness": roughness,
    }


CLEARCOAT = "clearcoat"


def in_few(look: Look) -> Look:
    """With no more layers than there may be, where those that stand for one clearcoat can be one."""
    coats = [layer for layer in look.layers if layer.part.startswith(CLEARCOAT)]
    if len(look.layers) <= MOST_LAYERS or len(coats) < 2:
        return look
    middle = coats[len(coats) // 2]
    share = coats[0].share
    for layer in coats[1:]:
        share = share + layer.share
    rest = [layer for layer in look.layers if layer not in coats]
    place = look.layers.index(coats[0])
    return replace(look, layers=[*rest[:place], replace(middle, share=share), *rest[place:]])


def laid_beside(top: Look, below: Look, part: Field) -> Look:
    """What has, of a surface, a `part` like `top`, which has no diffuse part and at most one layer of gloss."""
    if part.always(0.0):
        return below
    rest = 1.0 - part
    emission = part * top.emission + rest * below.emission
    transmittance = part * top.transmittance + rest * below.transmittance
    normal, more = below.normal or top.normal, besides(top, below, part, rest)
    if not top.layers and not below.layers and below.diffuse == LAMBERT:
        return Look(rest * below.albedo, [], emission, transmittance=transmittance, normal=normal, **more)
    layers = [replace(layer, share=layer.share * part, below=LEAVES_NOTHING) for layer in top.layers]
    left = part
    for layer in layers:
        left = left - layer.share
    known = left.constant
    if known is None or float(known[0]) > 1e-6:  # of the top, without gloss
        share = left / fields.maximum(1.0 - part + left, 1e-6)
        layers.append(Layer(BLACK, (ALL, ALL), below=LEAVES_NOTHING, share=share))
    return Look(
        below.albedo, [*layers, *below.layers], emission, below.diffuse, below.roughness, transmittance, normal, **more
    )


def _usual_black() -> NDArray[np.float64]:
    return np.zeros(3)


@dataclass
class Gloss:
    """What is usual of a layer of gloss."""

    reflectance: NDArray[np.float64]
    alpha: tuple[float, float]
    row: tuple[float, ...] = ()  # of native Gloss


# The slots of native patterns.
_ALBEDO, _EMISSION, _TRANSMITTANCE, _ROUGHNESS, _NORMAL, _FIRST_LAYER, _OF_LAYER = 0, 3, 6, 9, 10, 13, 11
_TRANSLUCENCE, _SHEEN, _SHEEN_ROUGHNESS = 57, 60, 63
_REFLECTANCE, _DIP, _ALPHA, _INDEX, _SHARE, _TURN = 0, 3, 6, 8, 9, 10


@dataclass
class Surface:
    """What is usual of a look; and by their slots in native patterns, the numbers that vary over the surface."""

    albedo: NDArray[np.float64] = field(default_factory=_usual_black)
    gloss: list[Gloss] = field(default_factory=list)  # from the top
    emission: NDArray[np.float64] = field(default_factory=_usual_black)
    diffuse: tuple[int, float] = (LAMBERT, 0.0)  # a native kind, and its roughness
    transmittance: NDArray[np.float64] = field(default_factory=_usual_black)
    varying: dict[int, Field] = field(default_factory=dict)
    glass: bool = False
    translucence: NDArray[np.float64] = field(default_factory=_usual_black)
    sheen: tuple[float, ...] = (0.0, 0.0, 0.0, SHEEN, 0.0)  # a colour, a native kind and its roughness

    @property
    def glows(self) -> bool:
        return bool(self.emission.any()) or _EMISSION in self.varying

    @property
    def lets_through(self) -> bool:
        return bool(self.transmittance.any()) or _TRANSMITTANCE in self.varying

    @property
    def brushed(self) -> bool:
        """Whether gloss needs to know the direction of the surface's tangents."""
        if any(gloss.alpha[0] != gloss.alpha[1] for gloss in self.gloss):
            return True
        firsts = (_FIRST_LAYER + k * _OF_LAYER + _ALPHA for k in range(len(self.gloss)))
        slopes = [[self.varying.get(first + axis) for axis in (0, 1)] for first in firsts]
        return any((a and a.digest) != (b and b.digest) for a, b in slopes)


def settled(look: Look) -> Surface:
    out = Surface(glass=look.glass)

    def number(slot: int, value: Field, low: float, high: float) -> float:
        value = fields.clipped(value, low, high)
        if value.constant is None:
            out.varying[slot] = value
        return float(fields.usual(value)[0])

    def colour(slot: int, value: Field, high: float = 1.0) -> NDArray[np.float64]:
        value = fields.clipped(value, 0.0, high)
        if value.constant is None:
            out.varying |= {slot + k: part for k, part in enumerate(fields.of_parts(value))}
        return np.broadcast_to(fields.usual(value)[0], 3).copy()

    out.albedo = colour(_ALBEDO, look.albedo)
    out.emission = colour(_EMISSION, look.emission, 1e30)
    out.transmittance = colour(_TRANSMITTANCE, look.transmittance)
    out.diffuse = look.diffuse, number(_ROUGHNESS, look.roughness, 0.0, 1.0)
    out.translucence = colour(_TRANSLUCENCE, look.translucence)
    of_sheen = colour(_SHEEN, look.sheen, 1e6)
    if not look.sheen.always(0.0):
        out.sheen = (*of_sheen, look.sheen_kind, number(_SHEEN_ROUGHNESS, look.sheen_roughness, 0.0, 1.0))
    for k, layer in enumerate(look.layers):
        first = _FIRST_LAYER + k * _OF_LAYER
        reflectance = colour(first + _REFLECTANCE, layer.reflectance)
        dip = colour(first + _DIP, layer.dip)
        alpha = tuple(number(first + _ALPHA + i, each, 1e-6, 1.0) for i, each in enumerate(layer.alpha))
        index = number(first + _INDEX, layer.index, 0.0, 1000.0)
        share, turn = number(first + _SHARE, layer.share, 0.0, 1.0), number(first + _TURN, layer.turn, 0.0, 1.0)
        once = (*reflectance, layer.edge, *alpha, compat.masks_apart(), index)
        rest = (float(layer.lossless), layer.below, *dip, float(layer.beckmann), share, turn)
        out.gloss.append(Gloss(reflectance, (alpha[0], alpha[1]), (*once, *rest)))
    if look.normal is not None:
        out.varying |= {_NORMAL + k: part for k, part in enumerate(fields.of_parts(look.normal))}
    return out


def brushed(surfaces: list[Surface]) -> bool:
    return any(surface.brushed for surface in surfaces)


def rows_of_gloss(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """All layers of all surfaces, (k, n, 16); None where there are none."""
    most = max(len(surface.gloss) for surface in surfaces)
    if most == 0:
        return None
    rows = np.zeros((len(surfaces), most, 16))
    for row, surface in zip(rows, surfaces):
        for k, gloss in enumerate(surface.gloss):
            row[k] = gloss.row
    return rows


def transmittances(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """Of all surfaces, (k, 3); None where they are opaque."""
    rows = np.array([surface.transmittance for surface in surfaces])
    return rows if rows.any() else None


def translucences(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """Of all surfaces, (k, 3); None where there is none."""
    rows = np.array([surface.translucence for surface in surfaces])
    varies = any(_TRANSLUCENCE in surface.varying for surface in surfaces)
    return rows if varies or rows.any() else None


def sheens(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """Of all surfaces, (k, 5); None where there is none."""
    rows = np.array([surface.sheen for surface in surfaces])
    return rows if any(_SHEEN in surface.varying for surface in surfaces) or rows[:, :3].any() else None


def diffuse_share(surface: Surface) -> float:
    """What the layers above a diffuse part that leave it nothing leave of the surface."""
    below, share = 9, 14
    return math.prod(1.0 - layer.row[share] for layer in surface.gloss if layer.row[below] == LEAVES_NOTHING)


def diffuse_kinds(surfaces: list[Surface]) -> list[tuple[int, float]] | None:
    """None where all are Lambert's."""
    kinds = [surface.diffuse for surface in surfaces]
    return kinds if any(kind != LAMBERT for kind, _ in kinds) else None
