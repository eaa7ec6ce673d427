# SPDX-License-Identifier: GPL-3.0-or-later
"""Sunlight in clear air: what it scatters towards an eye, and what of it arrives.

Two models, each as Cycles has it: light that is scattered once, in 21 wavelengths (Nishita et al. 1993, "Display of the
Earth Taking into Account Atmospheric Scattering"), and light that is scattered any number of times, in four (García
Liñán 2023, after Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique"). All lengths are
in metres of the first model and in kilometres of the second, as published.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# XYZ to Rec.709's primaries, D65 (IEC 61966-2-1).
RGB_OF_XYZ = np.array(
    ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
)
# Azimuths at which the smooth part of a sky is calculated: it is mirrored at the sun's, and goes on between them.
_AZIMUTHS = 24


@dataclass(frozen=True)
class Air:
    """Where the sun stands, in radians above the horizon, and the eye, in metres above the sea; and factors of the
    densities of air, aerosols and ozone."""

    elevation: float
    altitude: float
    densities: tuple[float, float, float]


def _way_out(radius: Array, cosine: Array, limit: float) -> Array:
    """From a radius, in a direction whose angle with the upward one has a cosine, to the sphere around it."""
    inside: Array = limit * limit - radius * radius * (1.0 - cosine * cosine)
    out: Array = np.sqrt(np.maximum(inside, 0.0)) - radius * cosine
    return out


def _risen(radius: Array, cosine: Array, way: Array) -> Array:
    """The radius after a way."""
    found: Array = np.sqrt(radius * radius + way * way + 2.0 * radius * cosine * way)
    return found


def _towards_sun(start: float, sine: Array, azimuth: Array, way: Array, radius: Array, sun: float) -> Array:
    """Cosines (n, m, s) of the angle between the sun and what is upward, at ways (n, s) along rays from `start` with
    sines (n,) of their elevations, at azimuths (m,) from the sun's."""
    across = np.sqrt(1.0 - sine * sine)[:, None] * np.cos(azimuth)
    upward = (start + sine[:, None] * way) * np.sin(sun)
    towards: Array = (upward[:, None] + across[..., None] * way[:, None] * np.cos(sun)) / radius[:, None]
    return np.clip(towards, -1.0, 1.0)


def _angle_to_sun(elevation: Array, azimuth: Array, sun: float) -> Array:
    """Its cosines, (n, m)."""
    across = np.cos(elevation)[:, None] * np.cos(azimuth) * np.cos(sun)
    found: Array = across + np.sin(elevation)[:, None] * np.sin(sun)
    return found


def _between(azimuth: Array) -> tuple[Array, Array]:
    """Azimuths (k,), and weights (m, k) of what is known there, for what it is at others: even ones between even
    ones, as series of cosines."""
    known = np.linspace(0.0, np.pi, _AZIMUTHS)
    order = np.arange(_AZIMUTHS)
    series, solved = np.cos(np.outer(azimuth, order)), np.linalg.inv(np.cos(np.outer(known, order)))
    return known, np.asarray(series @ solved, np.float64)


def _rayleigh(cosine: Array) -> Array:
    found: Array = 3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine)
    return found


# -- Scattered once. Lengths in metres.

_EARTH, _TOP = 6360e3, 6420e3
_STEPS = 32  # along a ray
_WAVELENGTHS = np.arange(380.0, 781.0, 20.0)  # in nanometres
# CIE 1931's two-degree observer at these, in millionths.
_OBSERVER = (
    1e-6
    * np.array(
        """1368 39 6450  14310 396 67850  134380 4000 645600  348280 23000 1747060  290800 60000 1669200  95640 139020 812950
    4900 323000 272000  63270 710000 78250  290400 954000 20300  594500 995000 3900  916300 870000 1650  1062200 631000 800
    854450 381000 190  447900 175000 20  164900 61000 0  46770 17000 0  11359 4102 0  2899 1047 0  690 249 0  166 60 0
    42 15 0""".split(),
        np.float64,
    ).reshape(21, 3)
)
# Ozone's absorption per metre where it is densest: the Chappuis band (Gorshelev et al. 2014), in millionths.
_OZONE = 1e-6 * np.array(
    """0.00325 0.00585 0.01977 0.0731 0.2008 0.4038 0.6355 0.9671 1.548 2.0904 2.4613 2.7355 2.1513 1.5905 1.1236 0.7353
    0.4645 0.3310 0.2251 0.1488 0.1683""".split(),
    np.float64,
)
# Scattering per metre at the sea: Rayleigh's law for air of index 1.0003, and aerosols, which also absorb.
_AIR = 1.131e-6 * (1e-3 * _WAVELENGTHS) ** -4
_AEROSOLS, _AEROSOLS_LOSS, _FORWARD = 2e-5, 1.11 * 2e-5, 0.76
# Cycles takes the ways to the sun in eight steps, by the rule of Gauss and Laguerre, as if 25 of its lengths went to the
# border of the air.
_NODES, _WEIGHTS = np.polynomial.laguerre.laggauss(8)  # type: ignore[no-untyped-call]
_NODES, _WEIGHTS = _NODES / 25.0, _WEIGHTS * np.exp(_NODES) / 25.0


def _irradiance() -> Array:
    """The sun's above the air, of a black body of 5778 K (Planck's law), in W / m² / nm."""
    planck, light, boltzmann = 6.62607015e-34, 299792458.0, 1.380649e-23
    length = 1e-9 * _WAVELENGTHS
    radiance = 2.0 * planck * light**2 / length**5 / np.expm1(planck * light / (length * boltzmann * 5778.0))
    found: Array = radiance * 6.79016e-5 * 1e-9  # over its solid angle
    return found


# The linear colour of the sun's light at each of the wavelengths, (21, 3).
_SUN = (20.0 * _irradiance())[:, None] * _OBSERVER @ RGB_OF_XYZ.T


def _densities_once(height: Array) -> Array:
    """(..., 3) of air, aerosols and ozone at heights, of their largest."""
    ozone = np.maximum(np.minimum(height / 15e3 - 2.0 / 3.0, 8.0 / 3.0 - height / 15e3), 0.0)
    return np.stack((np.exp(height / -8e3), np.exp(height / -1.2e3), ozone), axis=-1)


def _depths_to_sun(radius: Array, cosine: Array) -> Array:
    """(..., 3): metres of the largest density on the way out of the air."""
    way = _way_out(radius, cosine, _TOP)
    found = np.zeros((*way.shape, 3))
    for node, weight in zip(_NODES, _WEIGHTS):
        found += weight * _densities_once(_risen(radius, cosine, node * way) - _EARTH)
    return np.asarray(found * way[..., None])


def _losses(air: Air) -> Array:
    """(3, 21) per metre."""
    of_air, aerosols, ozone = air.densities
    return np.stack((of_air * _AIR, np.full(21, aerosols * _AEROSOLS_LOSS), ozone * _OZONE))


def sun_once(air: Air, elevation: float) -> Array:
    """The irradiance (3,) of a sun at an elevation across its rays. As in Cycles, ozone takes nothing of it."""
    depths = _depths_to_sun(np.array(_EARTH + air.altitude), np.array(np.sin(elevation)))
    return np.asarray(np.exp(-depths[:2] @ _losses(air)[:2]) @ _SUN)


def sky_once(air: Air, elevation: Array, azimuth: Array) -> Array:
    """Radiance (n, m, 3) from elevations (n,) of 0 and more, at azimuths (m,) from the sun's."""
    start, sine = _EARTH + air.altitude, np.sin(elevation)
    step = _way_out(np.full_like(sine, start), sine, _TOP) / _STEPS
    way = (np.arange(_STEPS) + 0.5) * step[:, None]
    radius = _risen(np.array(start), sine[:, None], way)
    densities = _densities_once(radius - _EARTH) * step[:, None, None]
    known, weights = _between(azimuth)
    cosine = _towards_sun(start, sine, known, way, radius, air.elevation)
    radius = np.broadcast_to(radius[:, None], cosine.shape)
    depths = np.minimum(_depths_to_sun(radius, cosine) + np.cumsum(densities, axis=1)[:, None], 1e12)
    arrives = np.exp((-depths).astype(np.float32) @ _losses(air).astype(np.float32))
    shadow = (cosine < 0.0) & (radius * np.sqrt(1.0 - cosine * cosine) < _EARTH)
    arrives[shadow] = 0.0
    # By what scatters it, (n, k, 2, 21).
    scattered = np.swapaxes(densities[:, None, :, :2], 2, 3).astype(np.float32) @ arrives
    by_air = scattered[:, :, 0] @ (air.densities[0] * _AIR[:, None] * _SUN)
    by_aerosols = scattered[:, :, 1] @ (air.densities[1] * _AEROSOLS * _SUN)
    angle = _angle_to_sun(elevation, azimuth, air.elevation)[..., None]
    return np.asarray(_rayleigh(angle) * (weights @ by_air) + _cornette_shanks(angle) * (weights @ by_aerosols))


def _cornette_shanks(cosine: Array) -> Array:
    """Aerosols' phase function (Cornette and Shanks 1992)."""
    g = _FORWARD
    found: Array = 1.5 * (1.0 - g * g) / (2.0 + g * g) * (1.0 + cosine * cosine)
    return found / (1.0 + g * g - 2.0 * g * cosine) ** 1.5 / (4.0 * np.pi)


# -- Scattered any number of times, in wavelengths of 630, 560, 490 and 430 nm. Lengths in kilometres.

_GLOBE, _THICKNESS = 6371.0, 100.0
_PARTS = 64  # along a ray
_SUN_OF_FOUR = np.array((1.679, 1.828, 1.986, 1.307))  # W / m² / nm above the air
# Of one, to XYZ: the observer's curves as these four see them.
_XYZ_OF_FOUR = np.array(
    (
        (53.3869177, 22.9813375, 0.0),
        (43.9048445, 71.3477957, 0.1025069),
        (1.6137278, 18.4229606, 31.7429212),
        (20.7626687, 2.3614214, 110.4800964),
    )
)
_RGB_OF_FOUR = _XYZ_OF_FOUR @ RGB_OF_XYZ.T
# Per km: scattering by air at the sea (Bucholtz 1995); of particles, in km²: the absorption of ozone (Gorshelev et al.
# 2014) times its mean column of 334.5 Dobson units, and what aerosols of a town scatter and absorb (Guimera et al. 2018).
_AIR_OF_FOUR = np.array((6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2))
_OZONE_OF_FOUR = 334.5 * np.array((3.472e-25, 3.914e-25, 1.349e-25, 1.103e-26))
_TOWN = np.array((1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22))
_TOWN_LOSS = _TOWN + np.array((2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23))
_TOWN_FORWARD = 0.8
_ALBEDO = 0.3  # of the ground, which the air's light is reflected by
_ORDERS = 0.02 * np.array((0.217, 0.347, 0.594, 1.0))  # the light of all further ones, fitted for the sun overhead


def _densities(height: Array) -> Array:
    """(..., 3) of air, of its own at the sea; of aerosols, per km³; and of ozone, per km³ and Dobson unit."""
    height = np.maximum(height, 0.0)
    air = np.exp(-0.07771971 * height**1.16364243)
    aerosols = 1.3681e20 * np.exp(height / -0.73) + 2e6
    level = np.log(height + 1e-4)
    ozone = 3.78547397e20 * np.exp(-((level - 3.22261) ** 2) * 5.55555555 - level)
    return np.stack((air, aerosols, ozone), axis=-1)


def _depths_from(radius: Array, cosine: Array) -> Array:
    """(..., 3): densities times kilometres on the way out of the air, by the cosine of its angle with the upward
    direction."""
    step = _way_out(radius, cosine, _GLOBE + _THICKNESS) / _PARTS
    found = np.zeros((*step.shape, 3))
    for part in range(_PARTS):
        found += _densities(_risen(radius, cosine, (part + 0.5) * step) - _GLOBE)
    return np.asarray(found * step[..., None])


@functools.lru_cache(maxsize=1)
def _depths() -> Array:
    """The same by the cosine and by the height, (256, 64, 3). Of the sky, Cycles, too, has no more of them, which tells
    near the horizon."""
    return _depths_from(_GLOBE + np.linspace(0.0, _THICKNESS, 64), np.linspace(-1.0, 1.0, 256)[:, None])


def _looked_up(table: Array, cosine: Array, height: Array) -> Array:
    """(..., k) between the numbers (256, 64, k) of a table like the depths'."""
    across, up = (cosine * 0.5 + 0.5) * 255.0, np.clip(height / _THICKNESS, 0.0, 1.0) * 63.0
    column, row = np.minimum(across.astype(np.int64), 254), np.minimum(up.astype(np.int64), 62)
    s, t = (across - column)[..., None], (up - row)[..., None]
    flat, first = table.reshape(-1, table.shape[2]), column * 64 + row
    low = flat[first] * (1.0 - s) + flat[first + 64] * s
    high = flat[first + 1] * (1.0 - s) + flat[first + 65] * s
    found: Array = low + (high - low) * t
    return found


def _losses_of_four(air: Air) -> Array:
    """(3, 4) per km and density."""
    of_air, aerosols, ozone = air.densities
    return np.stack((of_air * _AIR_OF_FOUR, aerosols * _TOWN_LOSS, ozone * _OZONE_OF_FOUR))


def sun_multiple(air: Air, elevation: float) -> Array:
    """The irradiance (3,) of a sun at an elevation across its rays."""
    depths = _depths_from(np.array(_GLOBE + 1e-3 * air.altitude), np.array(np.sin(elevation)))
    found: Array = (_SUN_OF_FOUR * np.exp(-depths @ _losses_of_four(air))) @ _RGB_OF_FOUR
    return found


def sky_multiple(air: Air, elevation: Array, azimuth: Array) -> Array:
    """Radiance (n, m, 3) from elevations (n,), at azimuths (m,) from the sun's: below the horizon, of the air before the
    ground."""
    start, sine, losses = _GLOBE + 1e-3 * air.altitude, np.sin(elevation), _losses_of_four(air)
    step = _way(start, sine) / _PARTS
    way = (np.arange(_PARTS) + 0.5) * step[:, None]
    radius = _risen(np.array(start), sine[:, None], way)
    densities = _densities(radius - _GLOBE)
    loss = densities @ losses
    passed = np.exp(-loss * step[:, None, None])
    before = np.cumprod(passed, axis=1) / passed
    seen = before * (1.0 - passed) / np.maximum(loss, 1e-7)  # each part's light by its scattering, (n, s, 4)
    known, weights = _between(azimuth)
    cosine = _towards_sun(start, sine, known, way, radius, air.elevation)
    arrives = np.exp(-_depths() @ losses)
    lit = _looked_up(arrives, cosine, np.broadcast_to((radius - _GLOBE)[:, None], cosine.shape))
    diffuse = _diffuse(arrives, cosine, radius)
    by_air, by_town = (
        densities[..., :1] * air.densities[0] * _AIR_OF_FOUR,
        densities[..., 1:2] * air.densities[1] * _TOWN,
    )
    of_air = _sum(seen * by_air, lit)
    of_town = _sum(seen * by_town, lit)
    of_all = _sum(seen * (by_air + by_town), diffuse)
    angle = _angle_to_sun(elevation, azimuth, air.elevation)[..., None]
    scattered = _rayleigh(angle) * (weights @ of_air) + _henyey_greenstein(angle) * (weights @ of_town)
    return np.asarray(scattered + weights @ of_all)


def _way(start: float, sine: Array) -> Array:
    """To the ground, or out of the air."""
    inside = _GLOBE**2 - start**2 * (1.0 - sine * sine)
    ground = (sine < 0.0) & (inside >= 0.0)
    out = _way_out(np.full_like(sine, start), sine, _GLOBE + _THICKNESS)
    return np.where(ground, -start * sine - np.sqrt(np.maximum(inside, 0.0)), out)


def _diffuse(arrives: Array, cosine: Array, radius: Array) -> Array:
    """Light (n, m, s, 4) that comes from all around: from the ground, and from the air after two and more scatterings."""
    level = np.zeros_like(radius)
    solid = 2.0 * np.pi * (1.0 - np.sqrt(np.maximum(radius**2 - _GLOBE**2, 0.0)) / radius)
    up = _looked_up(arrives, np.ones_like(radius), level) / _looked_up(arrives, np.ones_like(radius), radius - _GLOBE)
    ground = (_ALBEDO / np.pi / (4.0 * np.pi) * solid[..., None] * up)[:, None]
    overhead = 1.0 / (1.0 + 5.0 * np.exp(-17.92 * cosine))
    of_ground = _looked_up(arrives, cosine, np.zeros_like(cosine)) * cosine[..., None]
    return np.asarray(ground * of_ground + _ORDERS * overhead[..., None])


def _sum(weights: Array, light: Array) -> Array:
    """Of light (n, m, s, 4), seen by weights (n, s, 4): its colour, (n, m, 3)."""
    return np.asarray(np.einsum("nsw,nmsw->nmw", weights, light) * _SUN_OF_FOUR @ _RGB_OF_FOUR)


def _henyey_greenstein(cosine: Array) -> Array:
    """A phase function (1941), of the second model's aerosols."""
    g = _TOWN_FORWARD
    found: Array = (1.0 - g * g) / (4.0 * np.pi) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5
    return found
