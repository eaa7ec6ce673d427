# SPDX-License-Identifier: GPL-3.0-or-later
"""What varies over the surfaces of an object: native patterns, and what these ask for of the mesh and of its places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from . import looks, meshes, pictures
from .channels import Channel
from .parts import Parts
from .shading import patterns, places
from .shading.fields import Field
from .shading.patterns import Tracer
from .shading.tracing import Symbols

# Where native patterns find a point's own: the first of its numbers, and how many.
_POINT = {
    places.POSITION: (0, 3), places.OWN: (3, 3), places.NORMAL: (6, 3), places.FACE: (9, 3), places.INCOMING: (12, 3),
    places.BACK: (15, 1), places.COLUMNS[0]: (16, 3), places.COLUMNS[1]: (19, 3), places.COLUMNS[2]: (22, 3),
    patterns.STANDS_FOR: (25, 1), places.LOCATION: (26, 3), places.OBJECT_COLOUR: (29, 3), places.OBJECT_ALPHA: (32, 1),
    places.OBJECT_INDEX: (33, 1), places.RANDOM: (34, 1),
}  # fmt: skip
_FIRST_CHANNEL = 64
MOST_CHANNELS = 64
# What is not the same a pixel further.
_MOVES = {places.POSITION, places.OWN, places.GENERATED}


def values_of(instance: Any) -> tuple[float, ...]:
    """What patterns ask for of an object in one place: all that is so asked for, from its location on."""
    thing = instance.object
    random = instance.random_id if instance.is_instance else name_hash(thing.name)
    return (*instance.matrix_world.translation, *thing.color, float(thing.pass_index), (random & _BITS) / _BITS)


_BITS = 0xFFFFFFFF


def name_hash(name: str) -> int:
    """What Cycles makes of the name of an object that is no instance: its letters as the digits of a number, mixed by Bob
    Jenkins' lookup3 (2006)."""
    number = 0
    for letter in name.encode():
        number = (37 * number + letter) & _BITS
    a = b = c = 0xDEADBEEF + 8 + 13
    a += number

    def turned(value: int, by: int) -> int:
        value &= _BITS
        return (value << by | value >> (32 - by)) & _BITS

    c = ((c ^ b) - turned(b, 14)) & _BITS
    a = ((a ^ c) - turned(c, 11)) & _BITS
    b = ((b ^ a) - turned(a, 25)) & _BITS
    c = ((c ^ b) - turned(b, 16)) & _BITS
    a = ((a ^ c) - turned(c, 4)) & _BITS
    b = ((b ^ a) - turned(a, 14)) & _BITS
    return ((c ^ b) - turned(b, 24)) & _BITS


def readers(owner: str, parts: Parts, notices: list[str]) -> places.Readers:
    """Of nodes on the surfaces of an object."""

    return places.readers(
        lambda image, user, alpha: pictures.texels_of(image, user, parts, owner, notices, alpha_linked=alpha)
    )


@dataclass
class Textures:
    """Of each material a native Pattern or None, and the channels that these ask for."""

    patterns: list[Any]
    channels: tuple[Channel, ...]
    emission: dict[int, Any]  # by the number of a material, the Pattern of what it emits

    def add_emission(
        self, mesh: Any, rows: NDArray[np.int32], matrix: NDArray[np.float64], values: Any, out: NDArray[np.float64]
    ) -> None:
        """What the triangles of materials `rows` emit on the average: (m, 3) in place of what is usual."""
        for number, pattern in self.emission.items():
            which = np.flatnonzero(rows == number)
            if len(which) > MOST_GLOWING:  # which light nothing
                continue
            u, v = _EVENLY
            asked = np.repeat(which, len(u))
            found = pattern.at(mesh, asked, np.tile(u, len(which)), np.tile(v, len(which)), matrix, values)
            out[which] = np.clip(found, 0.0, 1e30).reshape(len(which), len(u), -1).mean(axis=1)


def _evenly(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places on a triangle (Roberts' sequence, 2018, folded)."""
    number = np.arange(count) + 1.0
    u, v = (0.5 + number * 0.7548776662) % 1.0, (0.5 + number * 0.5698402910) % 1.0
    beyond = u + v > 1.0
    return np.where(beyond, 1.0 - u, u), np.where(beyond, 1.0 - v, v)


_EVENLY = _evenly(64)
MOST_GLOWING = 1000  # triangles


def textures_of(
    thing: Any, found: list[looks.Surface], parts: Parts, origin: NDArray[np.float64], notices: list[str]
) -> Textures | None:
    """Of an object's surfaces; None where nothing varies."""
    if not any(surface.varying for surface in found):
        return None
    names = frozenset[str]().union(*(value.attributes for surface in found for value in surface.varying.values()))
    channels = meshes.channels_of(thing, names - _POINT.keys())
    while sum(channel.width for channel in channels) > MOST_CHANNELS:
        notices.append(f"{thing.name}: its material asks for more than {MOST_CHANNELS} numbers of its mesh; "
                       f"{channels[-1].name} is 0 everywhere")  # fmt: skip
        channels = channels[:-1]
    missing = sorted(names - _POINT.keys() - {channel.name for channel in channels})
    notices += [f"{thing.name}: {_said(name)}" for name in missing]
    made: list[Any] = []
    emission: dict[int, Any] = {}
    for number, surface in enumerate(found):
        try:
            made.append(_pattern(surface.varying, channels, parts, origin))
            glow = {slot: value for slot, value in surface.varying.items() if slot in range(3, 6)}
            if glow:
                if _differs(glow.values()):
                    notices.append(f"{thing.name}: each of its faces lights evenly, whatever its texture")
                emission[number] = _pattern(glow, channels, parts, origin)
        except (patterns.TooLarge, RecursionError):
            made.append(None)
            notices.append(f"{thing.name}: its material's nodes are too many to follow; it is shown without them")
    return Textures(made, channels, emission)


def _differs(wanted: Iterable[Field]) -> bool:
    """From place to place, and not only with the angle."""
    return not frozenset[str]().union(*(value.attributes for value in wanted)) <= {places.NORMAL, places.INCOMING}


def _said(name: str) -> str:
    kind, _, own = name.partition(" ")
    if name in {places.UV, places.TANGENT}:
        return "it has no UV map, which its material asks for; all of it has the texture's place 0, 0"
    if kind in {"uv", "tangent"}:
        return f"it has no UV map '{own}', which its material asks for; all of it has the texture's place 0, 0"
    return f"it has no attribute '{own}', which its material asks for; it is 0 everywhere"


def _looked_up(wanted: Iterable[Field]) -> Iterator[tuple[pictures.Texels, str]]:
    """The images that fields look up, and how."""
    seen: set[bytes] = set()
    waiting = list(wanted)
    while waiting:
        value = waiting.pop()
        if value.digest not in seen:
            seen.add(value.digest)
            waiting += value.inputs
            if value.operation.startswith("image's"):
                yield value.settings[0], value.settings[1]


def _pattern(
    varying: dict[int, Any], channels: tuple[Channel, ...], parts: Parts, origin: NDArray[np.float64]
) -> Any | None:
    if not varying:
        return None
    told = repr(([(slot, value.digest) for slot, value in varying.items()], channels, tuple(origin))).encode()
    for texels, how in _looked_up(varying.values()):
        for each in (texels, *texels.tiles.values()):
            _image(each, how, parts)  # asked for in this export too, though the pattern may be known
    made = parts.part(
        lambda: (np.frombuffer(told, np.uint8),), ("pattern",), lambda _: _made(varying, channels, origin, parts)
    )
    return made


def _made(varying: dict[int, Any], channels: tuple[Channel, ...], origin: NDArray[np.float64], parts: Parts) -> Any:
    first, at = {}, _FIRST_CHANNEL
    for channel in channels:
        first[channel.name] = at, channel.width
        at += channel.width

    def inputs(symbols: Symbols, name: str, output: str, absent: float, where: int) -> Any:
        moves = name in _MOVES or name in first
        found = _POINT.get(name) or first.get(name)
        if found is None:
            return np.full((1, 3) if output == "Color" else 1, absent)
        numbers = [symbols.of("input", setting=(found[0] + k, where if moves else 0)) for k in range(found[1])]
        if output == "Alpha":
            return symbols.array([numbers[3]]) if found[1] == 4 else np.ones(1)
        values: Any = symbols.array([numbers[:3] + [0.0] * (3 - found[1]) if found[1] > 1 else numbers * 3])
        if name == places.POSITION:
            values = values + origin
        if output == "Color":
            return values
        return symbols.array([numbers[0]]) if found[1] < 3 else values.sum(axis=1) * (1.0 / 3.0)

    tracer = Tracer(inputs)
    wanted = {slot: tracer.traced(value)[0] for slot, value in varying.items()}
    program = patterns.program_of(wanted, core.module().Pattern.operations())
    images = [(_image(texels, interpolation, parts), interpolation, extension)
              for texels, interpolation, extension in program.images]  # fmt: skip
    return core.module().Pattern(
        program.steps, program.outputs, program.constants, program.tables, program.integers, images
    )


def _image(texels: pictures.Texels, interpolation: str, parts: Parts) -> Any:
    """The native Image, one for all surfaces that show it."""
    closest = interpolation == "closest"
    told = f"{texels.digest}{texels.curved}{texels.divided}{closest}".encode()
    return parts.part(
        lambda: (np.frombuffer(told, np.uint8),),
        ("image",),
        lambda _: core.module().Image(texels.pixels, texels.curved, texels.divided, closest),
    )
