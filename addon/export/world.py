# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: what it shows to the eye, and the light that it gives."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import air, materials, pictures, visibility
from .parts import Parts
from .shading import fields, shaders, surroundings
from .shading.directions import Picture, linear_of
from .shading.fields import Field
from .shading.reading import NotFollowed, Place, Reader, Source, converted
from .visibility import Reach

Array = NDArray[np.float64]

# Columns of the pictures that are made of a world, which has half as many rows: as many as its largest image has, within
# these; without images the first.
_LEAST, _MOST = 1024, 4096
_BAND = 64  # rows at a time


@dataclass(frozen=True)
class Radiance:
    """A radiance (3,), or a native Sky, times a number: dragging that does not draw the Sky again."""

    shown: Any
    gain: float = 1.0

    def __bool__(self) -> bool:
        return self.gain > 0.0 and not (isinstance(self.shown, np.ndarray) and not self.shown.any())


BLACK = Radiance(np.zeros(3))


def background(depsgraph: Any, parts: Parts, notices: list[str]) -> tuple[Radiance, Radiance]:
    """Of the world, what gives light and what the eye sees."""
    world = materials.world_of(depsgraph)
    if world is None:
        return BLACK, BLACK
    if not compat.uses_nodes(world) or world.node_tree is None:
        return Radiance(np.array(world.color)), Radiance(np.array(world.color))
    output = materials.output_in(world.node_tree, "OUTPUT_WORLD")
    if output is None:
        return BLACK, BLACK
    read = functools.partial(pictures.picture_of, parts=parts, owner="World", notices=notices)
    reader = Reader("World", notices, surroundings.readers(lambda image, _user: read(image)))
    radiance, gain = _radiance(reader, Place(output))
    shows = getattr(world, "cycles_visibility", None)
    hidden = shows is not None and not shows.camera
    light = Radiance(_seen(radiance, parts, eye=False), gain)
    return light, BLACK if hidden else Radiance(_seen(radiance, parts, eye=True), gain)


def _radiance(reader: Reader, place: Place) -> tuple[Field, float]:
    """What a world sends, and a number to multiply it by."""
    found = [
        (weight, *emitted)
        for source, weight in shaders.added(reader, place, "Surface", fields.constant(1.0))
        if (emitted := _emitted(reader, source)) is not None
    ]
    if len(found) == 1 and (known := shaders.math_of("MULTIPLY", *found[0][:2]).constant) is not None:
        return shaders.each_of("not negative", found[0][2]), max(float(known[0]), 0.0)
    total = fields.constant((0.0, 0.0, 0.0))
    for weight, strength, colour in found:
        total = shaders.each_of("sum", total, shaders.scaled(weight, shaders.scaled(strength, colour)))
    return shaders.each_of("not negative", total), 1.0


def _emitted(reader: Reader, source: Source) -> tuple[Field, Field] | None:
    """How strongly a shader emits, and in what colour."""
    node = source.place.node
    if source.socket.type != "SHADER":  # which shines as it is
        try:
            shown = converted(reader.of_source(source), source.socket.type, "RGBA")
        except NotFollowed:
            reader.say(f"its color of {node.bl_rna.name} is not shown; it is black")
            return None
        return fields.constant(1.0), shown
    if node.type in {"BACKGROUND", "EMISSION"}:
        return reader.value(source.place, "Strength"), reader.value(source.place, "Color")
    reader.say(f"its shader {node.bl_rna.name} is not shown; it is black")
    return None


def _seen(radiance: Field, parts: Parts, *, eye: bool) -> Any:
    known = radiance.constant
    if known is not None:
        return known[0]
    columns = _columns(radiance)
    looks = eye and surroundings.EYE in radiance.attributes  # else the two are one
    return parts.part(
        lambda: (np.frombuffer(radiance.digest, np.uint8),),
        ("sky", columns, looks),
        lambda _: core.module().Sky(drawn(radiance, columns, eye=looks)),
    )


def _columns(radiance: Field) -> int:
    own = max((each.rgb.shape[1] for each in _pictures(radiance)), default=0)
    return int(np.clip(own, _LEAST, _MOST))


def _pictures(field: Field, seen: set[bytes] | None = None) -> Iterator[Picture]:
    seen = set() if seen is None else seen
    if field.digest not in seen:
        seen.add(field.digest)
        yield from (setting for setting in field.settings if isinstance(setting, Picture))
        for below in field.inputs:
            yield from _pictures(below, seen)


def _as_it_is(radiance: Field) -> Picture | None:
    """The image that a radiance is, where nothing is done to it."""
    below = radiance.inputs[0] if radiance.inputs else radiance
    if (
        below.operation != "environment"
        or below.inputs[0].digest != fields.grid(surroundings.DIRECTION, "Color").digest
    ):
        return None
    picture, projection, closest = below.settings
    return picture if projection == "EQUIRECTANGULAR" and not closest and radiance.operation == "each" else None


def drawn(radiance: Field, columns: int, *, eye: bool) -> NDArray[np.float32]:
    """A field of directions as a native Sky's picture, (columns / 2, columns, 3), as the eye sees it or as it gives
    light."""
    picture = _as_it_is(radiance)
    if picture is not None and picture.rgb.shape[:2] == (columns // 2, columns):
        upright = picture.rgb[::-1]
        return linear_of(upright.astype(np.float64)).astype(np.float32) if picture.curved else upright
    rows = columns // 2
    around = 2.0 * np.pi * (0.5 - (np.arange(columns) + 0.5) / columns)
    out = np.empty((rows, columns, 3), np.float32)

    def draw(first: int) -> None:
        down = np.pi * (np.arange(first, min(first + _BAND, rows)) + 0.5) / rows
        x = np.sin(down)[:, None] * np.cos(around)
        y = np.sin(down)[:, None] * np.sin(around)
        z = np.broadcast_to(np.cos(down)[:, None], x.shape)
        values = {
            surroundings.DIRECTION: np.stack((x, y, z), axis=-1).reshape(-1, 3),
            surroundings.EYE: np.array([1.0 if eye else 0.0]),
            surroundings.TEXEL: np.array([np.pi / rows]),
        }
        (found,) = fields.evaluate((radiance,), values)
        band = out[first : first + _BAND].reshape(-1, 3)
        band[:] = np.minimum(found, 1e30)

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(draw, range(0, rows, _BAND)))
    return out


def add_light(scene: Any, world: Any, light: Radiance) -> bool:
    """Add the light of a world, background()'s, to a native scene. False if it gives none, as where a volume fills the
    world, through which in Cycles it does not shine."""
    if world is None or not light or air.has_volume(world):
        return False
    shows = getattr(world, "cycles_visibility", None)
    kinds = () if shows is None else (bool(shows.diffuse), bool(shows.glossy), bool(shows.scatter))
    if kinds and not any(kinds):
        return False
    scene.add_sky(light.shown, visibility.native(Reach(1, 1, *kinds)), light.gain)
    return True
