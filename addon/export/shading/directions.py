# SPDX-License-Identifier: GPL-3.0-or-later
"""Vectors (n, 3), and what textures make of directions, as Cycles' nodes calculate them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Picture:
    """Colours (height, width, 3), rows from the bottom up: linear, or `curved` as sRGB's are; `digest` is the same for
    equal ones."""

    rgb: NDArray[np.float32]
    digest: str
    curved: bool = False

    def __repr__(self) -> str:
        return f"Picture({self.digest})"


def normalised(v: Array) -> Array:
    length = np.linalg.norm(v, axis=1)[:, None]
    found: Array = v / np.where(length > 0.0, length, 1.0)
    return found


def _turned(v: Array, angles: Array, *, back: bool) -> Array:
    """By angles (n, 3) about x, then y, then z; or back."""
    out = np.broadcast_to(v, np.broadcast_shapes(v.shape, angles.shape)).copy()
    for axis in (2, 1, 0) if back else (0, 1, 2):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        sine, cosine = np.sin(angles[:, axis]), np.cos(angles[:, axis])
        sine = -sine if back else sine
        out[:, a], out[:, b] = cosine * out[:, a] - sine * out[:, b], sine * out[:, a] + cosine * out[:, b]
    return out


def _divided(v: Array, by: Array) -> Array:
    found: Array = np.where(by != 0.0, v / np.where(by != 0.0, by, 1.0), 0.0)
    return found


def _mapped(kind: str, v: Array, location: Array, rotation: Array, scale: Array) -> Array:
    if kind == "TEXTURE":
        return _divided(_turned(v - location, rotation, back=True), scale)
    if kind == "NORMAL":
        return normalised(_turned(_divided(v, scale), rotation, back=False))
    turned = _turned(v * scale, rotation, back=False)
    return turned + location if kind == "POINT" else turned


def _gradient(kind: str, v: Array) -> Any:
    x, y = v[:, 0], v[:, 1]
    found: Any
    if kind == "LINEAR":
        found = x
    elif kind == "QUADRATIC":
        found = np.maximum(x, 0.0) ** 2
    elif kind == "EASING":
        r = np.clip(x, 0.0, 1.0)
        found = r * r * (3.0 - 2.0 * r)
    elif kind == "DIAGONAL":
        found = 0.5 * (x + y)
    elif kind == "RADIAL":
        found = np.arctan2(y, x) / (2.0 * np.pi) + 0.5
    else:
        inside = np.maximum(0.999999 - np.linalg.norm(v, axis=1), 0.0)
        found = inside**2 if kind == "QUADRATIC_SPHERE" else inside
    return np.clip(found, 0.0, 1.0)


def equirectangular(direction: Array) -> tuple[Array, Array]:
    """Where a direction lies on a picture, in [0, 1] from the left and from below."""
    x, y, z = direction.T
    across = np.sqrt(x * x + y * y)
    return 0.5 - np.arctan2(y, x) / (2.0 * np.pi), np.arctan2(z, across) / np.pi + 0.5


def mirror_ball(direction: Array) -> tuple[Array, Array]:
    """The same on a picture of a small mirrored ball, from far behind which one looks along y."""
    x, y, z = direction.T
    size = 2.0 * np.sqrt(np.maximum(0.5 * (1.0 - y), 0.0))
    size = np.where(size > 0.0, size, 1.0)
    return 0.5 * (x / size + 1.0), 0.5 * (z / size + 1.0)


_ON_PICTURE: dict[str, Callable[[Array], tuple[Array, Array]]] = {
    "EQUIRECTANGULAR": equirectangular,
    "MIRROR_BALL": mirror_ball,
}


def looked_up(picture: Picture, u: Array, v: Array, *, closest: bool) -> Array:
    """The linear colours at places on a picture that repeats. As in Cycles, curved ones are mixed as they are."""
    found = _between(picture, u, v) if not closest else _nearest(picture, u, v)
    return linear_of(found) if picture.curved else found


def _nearest(picture: Picture, u: Array, v: Array) -> Array:
    height, width = picture.rgb.shape[:2]
    row, column = np.floor(v * height).astype(np.int64), np.floor(u * width).astype(np.int64)
    found: Array = picture.rgb[row % height, column % width].astype(np.float64)
    return found


def linear_of(encoded: Array) -> Array:
    """Of sRGB's curve, IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4)


def _between(picture: Picture, u: Array, v: Array) -> Array:
    height, width = picture.rgb.shape[:2]
    x, y = u * width - 0.5, v * height - 0.5
    left, low = np.floor(x), np.floor(y)
    column, row = left.astype(np.int64) % width, low.astype(np.int64) % height
    right, above = (column + 1) % width, (row + 1) % height
    s, t = (x - left)[:, None], (y - low)[:, None]
    rgb = picture.rgb
    below = rgb[row, column] * (1.0 - s) + rgb[row, right] * s
    over = rgb[above, column] * (1.0 - s) + rgb[above, right] * s
    between: Array = below * (1.0 - t) + over * t
    return between


def _environment(picture: Picture, projection: str, closest: bool, direction: Array) -> Array:
    u, v = _ON_PICTURE[projection](normalised(direction))
    return looked_up(picture, u, v, closest=closest)


def _cross(a: Array, b: Array) -> Array:
    found: Array = np.cross(a, b)
    return found


def dot(a: Array, b: Array) -> Array:
    found: Array = np.sum(a * b, axis=1)
    return found


_VECTOR_MATH: dict[str, Callable[..., Any]] = {
    "ADD": lambda a, b, *_: a + b,
    "SUBTRACT": lambda a, b, *_: a - b,
    "MULTIPLY": lambda a, b, *_: a * b,
    "DIVIDE": lambda a, b, *_: _divided(a, b),
    "MULTIPLY_ADD": lambda a, b, c, *_: a * b + c,
    "CROSS_PRODUCT": lambda a, b, *_: _cross(a, b),
    "DOT_PRODUCT": lambda a, b, *_: dot(a, b),
    "DISTANCE": lambda a, b, *_: np.linalg.norm(a - b, axis=1),
    "LENGTH": lambda a, *_: np.linalg.norm(a, axis=1),
    "SCALE": lambda a, _b, _c, scale: a * scale[:, None],
    "NORMALIZE": lambda a, *_: normalised(a),
    "ABSOLUTE": lambda a, *_: np.abs(a),
    "FLOOR": lambda a, *_: np.floor(a),
    "CEIL": lambda a, *_: np.ceil(a),
    "FRACTION": lambda a, *_: a - np.floor(a),
    "MINIMUM": lambda a, b, *_: np.minimum(a, b),
    "MAXIMUM": lambda a, b, *_: np.maximum(a, b),
    "SINE": lambda a, *_: np.sin(a),
    "COSINE": lambda a, *_: np.cos(a),
}
OF_VECTORS = frozenset(_VECTOR_MATH)


def _moved(matrix: tuple[float, ...], v: Array) -> Array:
    """By the first three rows of a matrix."""
    rows = [matrix[0:4], matrix[4:8], matrix[8:12]]
    return np.stack([v[:, 0] * x + v[:, 1] * y + v[:, 2] * z + w for x, y, z, w in rows], axis=1)


def _wrapped(sphere: bool, v: Array) -> Array:
    """Where a point of a cube from 0 to 1 lies on a picture around a sphere in its middle, or around an upright tube."""
    x, y, z = (2.0 * v - 1.0).T
    u = 0.5 - np.arctan2(x, y) / (2.0 * np.pi)
    up = 1.0 - np.arctan2(np.sqrt(x * x + y * y), z) / np.pi if sphere else 0.5 * (z + 1.0)
    return np.stack((u, up, 0.0 * u), axis=1)


def _side_of_box(axis: int, v: Array, normal: Array) -> Array:
    """Where a point lies on the picture on that side of a box that a normal faces, mirrored on none."""
    across, up = ((1, 2), (0, 2), (1, 0))[axis]
    turned = normal[:, axis] < 0.0 if axis == 0 else normal[:, axis] > 0.0
    return np.stack((np.where(turned, 1.0 - v[:, across], v[:, across]), v[:, up], 0.0 * v[:, up]), axis=1)


def _sides_of_box(blend: float, normal: Array) -> Array:
    """How much of the picture on each pair of a box's sides is seen: of two sides between which a normal lies one alone
    where its share of both is above (1 + blend) / 2."""
    size = np.abs(normal)
    size = size / np.maximum(np.sum(size, axis=1), 1e-12)[:, None]
    x, y, z = size.T
    limit = 0.5 * (1.0 + blend)

    def alone(a: Array, b: Array, c: Array) -> Any:
        return (a > limit * (a + b)) & (a > limit * (a + c))

    def between(a: Array, b: Array) -> Array:
        share = _divided(a, a + b)
        return np.clip((share - 0.5 * (1.0 - blend)) / max(blend, 1e-6), 0.0, 1.0)

    one, none = 0.0 * x + 1.0, 0.0 * x
    if blend > 0.0:
        found = [((2.0 - limit) * a + (limit - 1.0)) / (2.0 * limit - 1.0) for a in (x, y, z)]
        pairs = (
            (y < (1.0 - limit) * (x + z), between(x, z), (0, 2)),
            (x < (1.0 - limit) * (y + z), between(y, z), (1, 2)),
            (z < (1.0 - limit) * (x + y), between(x, y), (0, 1)),
        )
        for lies, share, (first, second) in pairs:
            of_pair = [none, none, none]
            of_pair[first], of_pair[second] = share, 1.0 - share
            found = [np.where(lies, a, b) for a, b in zip(of_pair, found)]
    else:
        found = [one, none, none]
    for lies, k in ((alone(z, x, y), 2), (alone(y, x, z), 1), (alone(x, y, z), 0)):
        found = [np.where(lies, one if i == k else none, old) for i, old in enumerate(found)]
    return np.stack(found, axis=1)


OPERATIONS: dict[str, Callable[..., Any]] = {
    "wrapped": _wrapped,
    "side of a box": _side_of_box,
    "sides of a box": _sides_of_box,
    "moved": _moved,
    "unit": normalised,
    "mirrored": lambda v, normal: 2.0 * dot(v, normal)[:, None] * normal - v,
    "mapping": _mapped,
    "gradient": _gradient,
    "environment": _environment,
    "vector math": lambda name, *values: _VECTOR_MATH[name](*values),
    "opposite": lambda v: -v,
}
