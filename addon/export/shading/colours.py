# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours (n, 3) and their parts, as Cycles' nodes calculate them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LUMINANCE = (0.2126729, 0.7151522, 0.072175)  # of Rec. 709, Blender's working space


def to_hsv(rgb: Array) -> Array:
    """Hue in [0, 1), saturation and the strongest channel."""
    top, low = rgb.max(axis=1), rgb.min(axis=1)
    return np.stack((_hue(rgb, top, top - low), _ratio(top - low, top), top), axis=1)


def from_hsv(hsv: Array) -> Array:
    """Hues beyond [0, 1) are as if in the last sixth."""
    hue = hsv[:, 0]
    last = (hue < 0.0) | (hue > 1.0)
    return _from_hue(np.where(last, (5.0 + 6.0 * hue % 1.0) / 6.0, hue % 1.0), hsv[:, 2], hsv[:, 2] * hsv[:, 1])


def to_hsl(rgb: Array) -> Array:
    """Hue, saturation and lightness."""
    top, low = rgb.max(axis=1), rgb.min(axis=1)
    light = np.minimum(0.5 * (top + low), 1.0)
    span = np.where(light > 0.5, 2.0 - top - low, top + low)
    return np.stack((_hue(rgb, top, top - low), _ratio(top - low, span), light), axis=1)


def from_hsl(hsl: Array) -> Array:
    chroma = (1.0 - np.abs(2.0 * hsl[:, 2] - 1.0)) * hsl[:, 1]
    return _from_hue(hsl[:, 0], hsl[:, 2] + 0.5 * chroma, chroma)


def _ratio(a: Array, b: Array) -> Array:
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def _hue(rgb: Array, top: Array, span: Array) -> Array:
    red, green, blue = rgb.T
    sixth = np.where(
        red == top,
        _ratio(green - blue, span),
        np.where(green == top, 2.0 + _ratio(blue - red, span), 4.0 + _ratio(red - green, span)),
    )
    found: Array = np.where(span != 0.0, (sixth / 6.0) % 1.0, 0.0)
    return found


def _from_hue(hue: Array, top: Array, chroma: Array) -> Array:
    """Of the hue, the strongest channel, and how far below it the weakest is."""
    share = np.clip(
        np.stack((np.abs(6.0 * hue - 3.0) - 1.0, 2.0 - np.abs(6.0 * hue - 2.0), 2.0 - np.abs(6.0 * hue - 4.0)), axis=1),
        0.0,
        1.0,
    )
    found: Array = top[:, None] - chroma[:, None] * (1.0 - share)
    return found


_TO: dict[str, Callable[[Array], Array]] = {"RGB": lambda rgb: rgb, "HSV": to_hsv, "HSL": to_hsl}
_FROM: dict[str, Callable[[Array], Array]] = {"RGB": lambda rgb: rgb, "HSV": from_hsv, "HSL": from_hsl}


def _combined(mode: str, *parts: Array) -> Array:
    return _FROM[mode](np.stack(np.broadcast_arrays(*parts), axis=1))


def _gamma(rgb: Array, gamma: Array) -> Array:
    exponent = gamma[:, None]
    changed = np.where(rgb > 0.0, np.power(np.maximum(rgb, 1e-30), exponent), rgb)
    return np.where(exponent == 0.0, 1.0, changed)


def _hue_saturation(hue: Array, saturation: Array, value: Array, factor: Array, rgb: Array) -> Array:
    hsv = to_hsv(rgb)
    turned = (
        (hsv[:, 0] + hue + 0.5) % 1.0,
        np.clip(hsv[:, 1] * saturation, 0.0, 1.0),
        hsv[:, 2] * value,
    )
    changed = from_hsv(np.stack(np.broadcast_arrays(*turned), axis=1))
    return np.maximum(rgb + factor[:, None] * (changed - rgb), 0.0)


# The colour of a black body of luminance 1, as Cycles' Blackbody node has it: kelvin, RGB. Measured in 3.4.1; 4.5.15,
# 5.2.2 and 5.3.0 have the same. Linear in one over the temperature between these rows, the error is below .25 %. Below
# 800 K and above 12000 K it stays as it is. What is negative is 0 here: Cycles' fire, other than that node, emits
# negative blue below some 1900 K, and green below 950 K.
_BLACKBODY = np.array([
    (800, 5.4139, 0.0, 0.0), (840, 5.2355, 0.0, 0.0), (900, 4.984, 0.0, 0.0), (965, 4.7306, 0.0005, 0.0),
    (1050, 4.4272, 0.0909, 0.0), (1167, 4.0603, 0.1998, 0.0), (1300, 3.7027, 0.3055, 0.0), (1449, 3.3669, 0.4041, 0.0),
    (1650, 2.997, 0.5115, 0.0), (1902, 2.6376, 0.6141, 0.0), (2100, 2.4118, 0.6768, 0.0424),
    (2350, 2.1825, 0.7389, 0.1016), (2650, 1.9663, 0.7956, 0.1785), (3000, 1.7708, 0.8443, 0.2722),
    (3315, 1.6318, 0.8777, 0.3559), (3700, 1.4986, 0.9063, 0.4579), (3984, 1.4185, 0.9228, 0.5296),
    (4200, 1.3652, 0.9333, 0.5824), (4900, 1.229, 0.9581, 0.741), (5700, 1.1204, 0.9745, 0.8998),
    (6365, 1.0536, 0.983, 1.0142), (7300, 0.9862, 0.9888, 1.15), (8500, 0.9242, 0.993, 1.2926),
    (10000, 0.8714, 0.9949, 1.4305), (12000, 0.827, 0.9941, 1.5668),
])  # fmt: skip


def blackbody(kelvin: Array) -> Array:
    """(n, 3) of temperatures (n,)."""
    inverse = -1.0 / _BLACKBODY[:, 0]  # ascending
    at = -1.0 / np.maximum(kelvin, 1.0)
    return np.stack([np.interp(at, inverse, _BLACKBODY[:, 1 + c]) for c in range(3)], axis=1)


STEFAN_BOLTZMANN = 5.670373e-8  # W/(m^2 K^4), with which Cycles multiplies a millionth of it


def _fire(kelvin: Array, intensity: Array, tint: Array) -> Array:
    """As Cycles' Principled Volume: Stefan and Boltzmann's law from an intensity of 1 on, in the colour of luminance 1."""
    share = np.where(intensity > 1e-5, np.clip(intensity, 0.0, 1.0), 0.0)
    temperature = np.maximum(kelvin, 0.0)
    power = STEFAN_BOLTZMANN * 1e-6 / np.pi * (1.0 + share * (temperature**4 - 1.0))
    found: Array = (
        (share > 0.0)[:, None] * np.maximum(power, 0.0)[:, None] * np.maximum(tint, 0.0) * blackbody(temperature)
    )
    return found


_ARITHMETIC: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: _ratio(a, b),
    "minimum": np.minimum,
    "maximum": np.maximum,
}


def _calculated(name: str, a: Array, b: Array) -> Array:
    """Of a number and a colour, with each of its parts."""
    a, b = (each[:, None] if each.ndim < other.ndim else each for each, other in ((a, b), (b, a)))
    found: Array = _ARITHMETIC[name](a, b)
    return found


OPERATIONS: dict[str, Callable[..., Any]] = {
    "grey": lambda rgb: rgb @ np.array(_LUMINANCE),
    "mean": lambda vector: vector.mean(axis=1),
    "spread": lambda number: np.repeat(number[:, None], 3, axis=1),
    "part": lambda mode, part, rgb: _TO[mode](rgb)[:, part],
    "combine": _combined,
    "invert": lambda factor, rgb: rgb + factor[:, None] * (1.0 - 2.0 * rgb),
    "gamma": _gamma,
    "hue and saturation": _hue_saturation,
    "brightness": lambda rgb, bright, contrast: np.maximum(
        (1.0 + contrast[:, None]) * rgb + (bright - 0.5 * contrast)[:, None], 0.0
    ),
    "black body": blackbody,
    "fire": _fire,
    "arithmetic": _calculated,
    "weighted": lambda weights, rgb: rgb @ np.array(weights),
    "over or one": lambda rgb, number: np.where(number[:, None] > 0.0, _ratio(rgb, number[:, None]), 1.0),
    "scaled": lambda number, rgb: number[:, None] * rgb,
    "each": lambda name, *values: _EACH[name](*values),
}

# Of colours and vectors, part by part.
_EACH: dict[str, Callable[..., Any]] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: a - b,
    "product": lambda a, b: a * b,
    "not negative": lambda a: np.maximum(a, 0.0),
    "root": lambda a: np.sqrt(np.maximum(a, 0.0)),
    "rest": lambda a: np.maximum(1.0 - a, 0.0),
}
