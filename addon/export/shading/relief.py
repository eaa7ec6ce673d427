# SPDX-License-Identifier: GPL-3.0-or-later
"""How surfaces look to the eye by their normals, and what bends these, as Cycles' nodes calculate it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .directions import dot, normalised

Array = NDArray[np.float64]


def _fresnel(index: Array, normal: Array, incoming: Array, back: Array) -> Array:
    """Of a dielectric, unpolarised (Fresnel 1823); from inside by one over its index."""
    n = np.maximum(index, 1e-5)
    n = np.where(back > 0.0, 1.0 / n, n)
    c = np.abs(dot(normal, incoming))
    rest = n * n - 1.0 + c * c
    g = np.sqrt(np.maximum(rest, 0.0))
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return np.where(rest > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def _facing(blend: Array, normal: Array, incoming: Array) -> Array:
    facing = np.abs(dot(normal, incoming))
    b = np.clip(blend, 0.0, 1.0 - 1e-5)
    power = np.where(b < 0.5, 2.0 * b, 0.5 / (1.0 - b))
    found: Array = 1.0 - np.where(blend != 0.5, np.power(facing, power), facing)
    return found


def _toward(bent: Array, strength: Array, normal: Array) -> Array:
    share = np.maximum(strength, 0.0)[:, None]
    return normalised(normal + share * (bent - normal))


def _normal_to_world(v: Array, x: Array, y: Array, z: Array) -> Array:
    """By the cofactors of the matrix of these columns; where it mirrors, the other way."""
    a: Any = np.cross(y, z)
    b: Any = np.cross(z, x)
    c: Any = np.cross(x, y)
    side = np.where(dot(x, a) < 0.0, -1.0, 1.0)
    found: Array = (v[:, :1] * a + v[:, 1:2] * b + v[:, 2:3] * c) * side[:, None]
    return found


def _normal_map(
    colour: Array,
    strength: Array,
    normal: Array,
    own: Array,
    tangent: Array,
    sign: Array,
    back: Array,
    *columns: Array,
) -> Array:
    """By a mesh's tangents, in its own space, where the normal is `own`. Normals are towards the eye, tangents the front's."""
    side = np.where(back > 0.0, -1.0, 1.0)[:, None]
    front = own * side
    across = np.cross(front, tangent) * sign[:, None]
    v = 2.0 * colour - 1.0
    bent = normalised(_normal_to_world(v[:, :1] * tangent + v[:, 1:2] * across + v[:, 2:3] * front, *columns)) * side
    return np.where((dot(tangent, tangent) > 0.0)[:, None], _toward(bent, strength, normal), normal)


def _normal_of_colour(space: str, colour: Array, strength: Array, normal: Array, back: Array, *columns: Array) -> Array:
    side = np.where(back > 0.0, -1.0, 1.0)[:, None]
    v = 2.0 * colour - 1.0
    if space == "OBJECT":
        v = _normal_to_world(v, *columns)
    return _toward(normalised(v) * side, strength, normal)


def bumped(
    heights: tuple[Array, Array, Array],
    steps: tuple[Array, Array],
    strength: Array,
    distance: Array,
    normal: Array,
) -> Array:
    """By heights here and a pixel further along two axes (Mikkelsen, "Bump mapping unparametrized surfaces on the GPU",
    2010, eq 4), metres, and these steps."""
    along, across = steps
    r_along, r_across = np.cross(across, normal), np.cross(normal, along)
    area = dot(along, r_along)
    slope = (heights[1] - heights[0])[:, None] * r_along + (heights[2] - heights[0])[:, None] * r_across
    turned = np.abs(area)[:, None] * normal - (distance * np.sign(area))[:, None] * slope
    bent = normalised(turned)
    share = np.maximum(strength, 0.0)[:, None]
    found = normalised(share * bent + (1.0 - share) * normal)
    return np.where((area != 0.0)[:, None], found, normal)


# Of the logarithm of what fibres send of light from all sides: for each power of the cosine to the eye, of each of roughness.
_FIBRES = (
    (-0.17078, -1.5132, 3.723, -3.7972, 1.4706),
    (-29.298, 184.54, -451.0, 475.08, -180.22),
    (-50.471, 122.7, 53.419, -310.13, 184.59),
    (127.5, -600.16, 981.01, -641.49, 133.12),
    (-64.587, 341.64, -644.48, 514.79, -147.35),
)  # fmt: skip


def _of_fibres(cosine: Array, roughness: Array) -> Array:
    """What Cycles 5.0.1 shows of Zeltner, Burley and Chiang's sheen (2022), within .02; shaders/surfaces/surface.glsl has the
    lobe."""
    c, r = np.clip(cosine, 0.0, 1.0), np.clip(roughness, 0.15, 1.0)
    exponent: Any = 0.0
    for row in reversed(_FIBRES):
        of_roughness: Any = 0.0
        for factor in reversed(row):
            of_roughness = of_roughness * r + factor
        exponent = exponent * c + of_roughness
    found: Array = np.minimum(np.exp(exponent), 1.0)
    return found


OPERATIONS: dict[str, Callable[..., Any]] = {
    "fresnel": _fresnel,
    "layer's index": lambda blend: 1.0 / np.maximum(1.0 - blend, 1e-5),
    "facing": _facing,
    "of fibres": _of_fibres,
    "normal map": _normal_map,
    "normal of colour": _normal_of_colour,
    # Of cells without neighbours.
    "bump": lambda height, strength, distance, normal, position: normal,
    # Where there is no place on pictures.
    "image's colour": lambda *_: np.full((1, 3), 0.5),
    "image's alpha": lambda *_: np.ones(1),
}
