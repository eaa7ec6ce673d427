# SPDX-License-Identifier: GPL-3.0-or-later
"""The skies of Sky Textures, as Cycles shows them."""

from __future__ import annotations

import functools
import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import daylight, hosek_wilkie, scattering
from .directions import normalised
from .scattering import Air

Array = NDArray[np.float64]

# How a model is named before Blender 5.0, and the two of later ones.
_ONCE_BEFORE, _ONCE, _MULTIPLE = "NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"
_SCATTERING = frozenset((_ONCE_BEFORE, _ONCE, _MULTIPLE))
_PREETHAM, _HOSEK_WILKIE = "PREETHAM", "HOSEK_WILKIE"
_FORMULAS = frozenset((_PREETHAM, _HOSEK_WILKIE))

# Of Cycles' pictures of skies: elevations from -90 to 90 degrees, closer to each other at the horizon, and azimuths from
# the sun's to the opposite one.
_ROWS, _COLUMNS = 256, 257
# In those of single scattering, what is shown at a place is calculated for half a texel from there, and the elevations of
# the older ones end half a texel above the zenith.
_ROW, _COLUMN, _STRETCHED = 1.0 / _ROWS, np.pi / 512.0, 1.0 + 1.0 / _ROWS
_STRIPS = 256  # of the sun's disc, from below to above
_drawing = threading.Lock()


@dataclass(frozen=True)
class Atmosphere:
    """A node's settings: angles in radians, the altitude in metres, and a direction to the sun (3,)."""

    model: str
    sun_disc: bool = False
    sun_size: float = 0.009512
    sun_intensity: float = 1.0
    sun_elevation: float = 0.0
    sun_rotation: float = 0.0
    altitude: float = 0.0
    air_density: float = 1.0
    aerosol_density: float = 1.0
    ozone_density: float = 1.0
    sun_direction: tuple[float, float, float] = (0.0, 0.0, 1.0)
    turbidity: float = 2.2
    ground_albedo: float = 0.0

    @classmethod
    def of(cls, node: Any) -> Atmosphere | None:
        """None for a model that is not followed. What a model does not use is left out."""
        if node.sky_type in _FORMULAS:
            x, y, z = node.sun_direction
            albedo = node.ground_albedo if node.sky_type == _HOSEK_WILKIE else 0.0
            return cls(node.sky_type, sun_direction=(x, y, z), turbidity=node.turbidity, ground_albedo=albedo)
        if node.sky_type not in _SCATTERING:
            return None
        aerosols = "aerosol_density" if hasattr(node, "aerosol_density") else "dust_density"
        return cls(
            node.sky_type,
            bool(node.sun_disc),
            node.sun_size,
            node.sun_intensity,
            node.sun_elevation,
            node.sun_rotation,
            node.altitude,
            node.air_density,
            getattr(node, aerosols),
            node.ozone_density,
        )

    @staticmethod
    def told(node: Any) -> list[str]:
        """What is shown differently."""
        if node.sky_type != _HOSEK_WILKIE:
            return []
        said = []
        closest = min(max(node.turbidity, hosek_wilkie.LEAST), hosek_wilkie.MOST)
        if closest != node.turbidity:
            said.append(f"{node.bl_rna.name}'s Turbidity {node.turbidity:.1f} is shown as {closest:.0f}")
        if node.sun_direction[2] < hosek_wilkie.LOWEST_SUN:
            said.append(f"{node.bl_rna.name}'s Hosek / Wilkie is too bright where its sun is at the horizon or below")
        return said

    @property
    def sun(self) -> Array:
        """The direction to it, (3,)."""
        if self.model in _FORMULAS:
            return np.asarray(normalised(np.array(self.sun_direction)[None])[0])
        level = np.cos(self.sun_elevation)
        return np.array(
            (level * np.sin(self.sun_rotation), level * np.cos(self.sun_rotation), np.sin(self.sun_elevation))
        )

    @property
    def air(self) -> Air:
        most = 99999.0 if self.model == _MULTIPLE else 59999.0
        densities = (self.air_density, self.aerosol_density, self.ozone_density)
        elevation = math.remainder(self.sun_elevation, 2.0 * math.pi)
        if abs(elevation) > 0.5 * math.pi:  # beyond the zenith it sinks again
            elevation = math.copysign(math.pi, elevation) - elevation
        return Air(elevation, float(np.clip(self.altitude, 1.0, most)), densities)

    def radiance(self, directions: Array, texel: float) -> Array:
        """Linear colours (n, 3) of Rec.709 from directions (n, 3) of length 1. The sun's disc is drawn so wide that its
        light is that of a picture's texels, `texel` radians apart."""
        if self.model == _PREETHAM:
            return np.maximum(daylight.preetham(self.turbidity, self.sun, directions), 0.0)
        if self.model == _HOSEK_WILKIE:
            return hosek_wilkie.radiance(self.turbidity, self.ground_albedo, self.sun, directions)
        shown = _sky(self, directions)
        if self.sun_disc and self.sun_size > 0.0:
            shown += self._disc(directions, texel)
        return shown

    def _disc(self, directions: Array, texel: float) -> Array:
        """A distribution of Fisher (1953) around the middle of what of the disc is above the horizon, with the disc's
        light. It is as wide as the disc, but not less than what texels can hold."""
        irradiance, elevation = disc(self.model, self.air, self.sun_size, self.sun_intensity)
        width = max(0.25 * self.sun_size, 0.8 * texel)
        along = np.array((*_level(self.sun) * np.cos(elevation), np.sin(elevation)))
        apart = np.sum((directions - along) ** 2, axis=1) / (2.0 * width**2)
        peak = 1.0 / (2.0 * np.pi * width**2 * -np.expm1(-2.0 / width**2))
        return np.asarray(irradiance * (peak * np.exp(-apart))[:, None])


def _level(direction: Array) -> Array:
    """Its part along the ground, (2,), of length 1."""
    length = np.hypot(direction[0], direction[1])
    found: Array = direction[:2] / length if length > 0.0 else np.array((0.0, 1.0))
    return found


@functools.lru_cache(maxsize=8)
def disc(model: str, air: Air, size: float, intensity: float) -> tuple[Array, float]:
    """The irradiance (3,) of a sun of a size in radians across its rays, of what is above the horizon, and the elevation
    of the middle of it.

    Cycles has the radiance at the lower and the upper border from the air, between them a mixture of the two, and
    darkens it towards the limb by 0.6 of one less the cosine of the angle that the sun's surface is seen at.
    """
    half = 0.5 * size
    low, high = air.elevation - half, air.elevation + half
    if model != _MULTIPLE:  # which goes on below the horizon
        low, high = max(low, 0.0), max(high, 0.0)
    arriving = scattering.sun_multiple if model == _MULTIPLE else scattering.sun_once
    at_low, at_high = arriving(air, low), arriving(air, high)
    up = (np.arange(_STRIPS) + 0.5) / (0.5 * _STRIPS) - 1.0
    elevation = air.elevation + up * half
    across = np.sqrt(1.0 - up * up)
    weight = (0.8 * across + 0.3 * np.pi * across**2) * (elevation > 0.0)
    cut = model == _ONCE_BEFORE and air.elevation < half
    share = elevation / max(high, 1e-9) if cut else 0.5 + 0.5 * up
    radiance = (at_low + share[:, None] * (at_high - at_low)) / (2.0 * np.pi * (1.0 - np.cos(half)))
    light = weight[:, None] * np.maximum(radiance, 0.0) * half * half * (2.0 / _STRIPS)
    total = light.sum()
    middle = float(light.sum(axis=1) @ elevation / total) if total > 0.0 else air.elevation
    return intensity * light.sum(axis=0), middle


def _sky(atmosphere: Atmosphere, directions: Array) -> Array:
    """Without the sun's disc, between the texels of a picture."""
    elevation = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
    place = np.copysign(np.sqrt(np.abs(elevation) / (0.5 * np.pi)), elevation)
    level = _level(atmosphere.sun)
    # How far around from the sun, (0, 0) being anywhere.
    ahead, aside = directions[:, :2] @ level, directions[:, :2] @ (level[1], -level[0])
    column = np.abs(np.arctan2(aside, ahead)) * ((_COLUMNS - 1) / np.pi)
    row = (place + 1.0) * (0.5 * _ROWS) - 0.5
    with _drawing:
        drawn = picture(atmosphere.model, atmosphere.air)
    row = np.clip(row - (_ROWS - len(drawn)), 0.0, len(drawn) - 1.0)
    shown = _between(drawn, row, column)
    if atmosphere.model != _MULTIPLE:  # of single scattering the horizon's is faded
        shown *= _fading(atmosphere.model, place)[:, None]
    return shown


def _fading(model: str, place: Array) -> Array:
    """Of the light from below the horizon."""
    below = np.minimum(place if model == _ONCE_BEFORE else place - _ROW * (place < 0.0), 0.0)
    return np.asarray(np.maximum(1.0 - 2.5 * np.sin(0.5 * np.pi * below * below), 0.0) ** 3)


def _between(drawn: NDArray[np.float32], row: Array, column: Array) -> Array:
    first, left = np.minimum(row.astype(np.int32), len(drawn) - 2), np.minimum(column.astype(np.int32), _COLUMNS - 2)
    t, s = (row - first).astype(np.float32)[:, None], (column - left).astype(np.float32)[:, None]
    flat, corner = drawn.reshape(-1, 3), first * _COLUMNS + left
    low = flat[corner] * (1.0 - s) + flat[corner + 1] * s
    high = flat[corner + _COLUMNS] * (1.0 - s) + flat[corner + _COLUMNS + 1] * s
    return np.asarray(low + (high - low) * t, np.float64)


@functools.lru_cache(maxsize=8)
def picture(model: str, air: Air) -> NDArray[np.float32]:
    """A sky (rows, 257, 3): of single scattering its upper half, the other's all."""
    place = (2.0 * np.arange(_ROWS) + 1.0) / _ROWS - 1.0
    azimuth = np.linspace(0.0, np.pi, _COLUMNS)
    if model == _MULTIPLE:
        found = scattering.sky_multiple(air, 0.5 * np.pi * np.copysign(place * place, place), azimuth)
    else:
        elevation = 0.5 * np.pi * (place[_ROWS // 2 :] - _ROW) ** 2 * (_STRETCHED if model == _ONCE_BEFORE else 1.0)
        found = scattering.sky_once(air, elevation, azimuth + _COLUMN)
    return np.maximum(found, 0.0).astype(np.float32)


def _operation(atmosphere: Atmosphere, directions: Array, texel: Array) -> Array:
    return atmosphere.radiance(normalised(directions), float(texel[0]))


OPERATIONS: dict[str, Callable[..., Any]] = {"sky": _operation}
