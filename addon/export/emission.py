# SPDX-License-Identifier: GPL-3.0-or-later
"""What smoke emits: by constants, by one grid, or as a black body does, by its temperature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat
from . import materials

Array = NDArray[np.float64]

STEFAN_BOLTZMANN = 5.670373e-8  # W/(m^2 K^4), with which Cycles multiplies a millionth of it

# The colour of a black body of luminance 1, as Cycles' Blackbody node has it: kelvin, RGB. Measured in 3.4.1; 4.5.15 and
# 5.3.0 have the same. Linear in one over the temperature between these rows, the error is below .25 %. Below 800 K and
# above 12000 K it stays as it is. What is negative is 0 here: Cycles' fire, other than that node, emits negative blue
# below some 1900 K, and green below 950 K.
_BLACKBODY = np.array([
    (800, 5.4139, 0.0, 0.0), (840, 5.2355, 0.0, 0.0), (900, 4.984, 0.0, 0.0), (965, 4.7306, 0.0005, 0.0),
    (1050, 4.4272, 0.0909, 0.0), (1167, 4.0603, 0.1998, 0.0), (1300, 3.7027, 0.3055, 0.0), (1449, 3.3669, 0.4041, 0.0),
    (1650, 2.997, 0.5115, 0.0), (1902, 2.6376, 0.6141, 0.0), (2100, 2.4118, 0.6768, 0.0424),
    (2350, 2.1825, 0.7389, 0.1016), (2650, 1.9663, 0.7956, 0.1785), (3000, 1.7708, 0.8443, 0.2722),
    (3315, 1.6318, 0.8777, 0.3559), (3700, 1.4986, 0.9063, 0.4579), (4200, 1.3652, 0.9333, 0.5824),
    (4900, 1.229, 0.9581, 0.741), (5700, 1.1204, 0.9745, 0.8998), (6365, 1.0536, 0.983, 1.0142),
    (7300, 0.9862, 0.9888, 1.15), (8500, 0.9242, 0.993, 1.2926), (10000, 0.8714, 0.9949, 1.4305),
    (12000, 0.827, 0.9941, 1.5668),
])  # fmt: skip


def blackbody_colour(kelvin: Array) -> Array:
    """(n, 3) of temperatures (n,)."""
    inverse = -1.0 / _BLACKBODY[:, 0]  # ascending
    at = -1.0 / np.maximum(kelvin, 1.0)
    return np.stack([np.interp(at, inverse, _BLACKBODY[:, 1 + c]) for c in range(3)], axis=1)


@dataclass(frozen=True)
class Emitter:
    """What glows by the values of one grid: of those, (n,), radiance per metre, (n, 3), W/(m^3 sr). Without an attribute it
    is the same wherever there is smoke; and where the grid is not there, what it is for the value `absent`."""

    attribute: str
    radiance: Callable[[Array], Array]
    absent: float = 0.0
    scale: float = 1.0

    def of(self, values: Array) -> Array:
        """Not negative, and the same below 0 as at 0."""
        found: Array = np.maximum(self.radiance(np.maximum(values, 0.0)) * self.scale, 0.0)
        return found

    def everywhere(self) -> Emitter:
        """The same where the grid is not there."""
        constant = self.of(np.full(1, self.absent))
        return Emitter("", lambda values: np.repeat(constant, len(values), axis=0))


def constant(colour: Array) -> Emitter:
    return Emitter("", lambda values: np.tile(colour, (len(values), 1)))


def blackbody(attribute: str, kelvin: float, intensity: float, tint: Array) -> Emitter:
    """As Cycles' Principled Volume: Stefan and Boltzmann's law from an intensity of 1 on, in the colour of luminance 1."""

    def radiance(values: Array) -> Array:
        temperature = np.maximum(kelvin * values, 0.0)
        power = STEFAN_BOLTZMANN * 1e-6 / np.pi * (1.0 + intensity * (temperature**4 - 1.0))
        found: Array = np.maximum(power, 0.0)[:, None] * tint * blackbody_colour(temperature)
        return found

    return Emitter(attribute, radiance, absent=1.0)


def merged(emitters: list[Emitter]) -> tuple[Emitter, ...]:
    """Those of the same grid as one."""
    out: dict[tuple[str, float], Emitter] = {}
    for emitter in emitters:
        key = emitter.attribute, emitter.absent
        known = out.get(key)
        out[key] = emitter if known is None else _sum(known, emitter)
    return tuple(out.values())


def _sum(a: Emitter, b: Emitter) -> Emitter:
    return replace(a, radiance=lambda values: a.of(values) + b.of(values), scale=1.0)


def emitters_of(thing: Any, depsgraph: Any, notices: list[str]) -> tuple[Emitter, ...]:
    """What the volume shaders of an object's material emit, by grid."""
    found: list[Emitter] = []
    for node in materials.volume_shaders(thing, depsgraph):
        found += of_shader(node, thing.name, notices)
    if compat.constants_fill_more() and any(not emitter.attribute for emitter in found):
        notices.append(
            f"{thing.name}: it emits the same everywhere; around its smoke that fills less than in Cycles of this Blender"
        )
    return merged(found)


def of_shader(node: Any, name: str, notices: list[str]) -> list[Emitter]:
    """What one volume shader emits."""
    if node.type == "EMISSION":
        return _glow(node, "Strength", "Color", name, notices)
    if node.type == "PRINCIPLED_VOLUME":
        return _glow(node, "Emission Strength", "Emission Color", name, notices) + _blackbody(node, name, notices)
    return []


def _glow(node: Any, strength: str, colour: str, name: str, notices: list[str]) -> list[Emitter]:
    """A strength times a colour, of which one, or both by the same grid, may be an attribute."""
    by_strength, by_colour = attribute_behind(node, strength), attribute_behind(node, colour)
    if by_strength and by_colour and by_strength != by_colour:
        by_colour = ""
    power = 1.0 if by_strength else max(0.0, materials.value_of(node, strength, name, notices))
    if power == 0.0:
        return []
    tint = power * (np.ones(3) if by_colour else np.maximum(materials.value_of(node, colour, name, notices), 0.0))
    attribute, exponent = by_strength or by_colour, 2 if by_strength and by_colour else 1
    if not attribute:
        return [constant(tint)] if tint.any() else []

    def radiance(values: Array) -> Array:
        found: Array = values[:, None] ** exponent * tint
        return found

    return [Emitter(attribute, radiance)]


def _blackbody(node: Any, name: str, notices: list[str]) -> list[Emitter]:
    intensity = min(max(0.0, materials.value_of(node, "Blackbody Intensity", name, notices)), 1.0)
    if intensity <= 1e-5:
        return []
    tint = np.maximum(materials.value_of(node, "Blackbody Tint", name, notices), 0.0)
    kelvin = max(0.0, materials.value_of(node, "Temperature", name, notices))
    attribute = materials.value_of(node, "Temperature Attribute", name, notices)
    return [blackbody(attribute, kelvin, intensity, tint)]


def attribute_behind(node: Any, socket: str) -> str:
    """The grid that is linked to an input as it is, by an Attribute node or Volume Info; or nothing."""
    links = node.inputs[socket].links
    while links and links[0].from_node.type == "REROUTE":
        links = links[0].from_node.inputs[0].links
    if not links or links[0].from_node.mute:
        return ""
    source, output = links[0].from_node, links[0].from_socket.identifier
    if source.type == "ATTRIBUTE" and source.attribute_type == "GEOMETRY" and output != "Alpha":
        # Of a grid of colours, the outputs differ.
        return str(source.attribute_name) if source.attribute_name not in {"color", "velocity"} else ""
    if source.type == "VOLUME_INFO" and output in {"Density", "Flame", "Temperature"}:
        return str(output.lower())
    return ""
