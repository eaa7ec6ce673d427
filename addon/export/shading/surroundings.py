# SPDX-License-Identifier: GPL-3.0-or-later
"""What surrounds a scene as fields of the direction: nodes that are followed in worlds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import fields, textures_of_nodes
from .directions import OF_VECTORS
from .fields import Field
from .reading import NotFollowed, Place, Reader
from .skies import Atmosphere

# What a field of a world is evaluated for: directions, unit vectors from the eye; whether it is the eye that looks, 1, or
# light that comes, 0; and how far directions are from each other, in radians.
DIRECTION, EYE, TEXEL = "direction", "eye", "texel"

Pictures = Callable[[Any, Any], Any]  # of an image and its user: a Picture


def readers(picture_of: Pictures) -> dict[str, Callable[[Reader, Place, Any], Field]]:
    """By the type of a node."""

    def environment(reader: Reader, place: Place, _: Any) -> Field:
        node = place.node
        if node.interpolation in {"Cubic", "Smart"}:
            reader.say(f"{node.bl_rna.name}'s Interpolation {node.interpolation} is shown as Linear")
        settings = picture_of(node.image, node.image_user), node.projection, node.interpolation == "Closest"
        return fields.of("environment", _vector(reader, place), settings=settings)

    return {**_READ, "TEX_ENVIRONMENT": environment}


def _direction() -> Field:
    return fields.grid(DIRECTION, "Color")


def _vector(reader: Reader, place: Place) -> Field:
    """A texture's own: where nothing is linked, the direction."""
    socket = place.input("Vector")
    linked = socket is not None and reader.source(place, socket) is not None
    return reader.of_socket(place, socket) if linked else _direction()


def _coordinates(_: Reader, place: Place, output: Any) -> Field:
    if output.identifier == "Normal":
        return fields.of("opposite", _direction())
    if output.identifier == "Generated" or (output.identifier == "Object" and place.node.object is None):
        return _direction()
    raise NotFollowed


def _geometry(_: Reader, __: Place, output: Any) -> Field:
    if output.identifier == "Position":
        return _direction()
    if output.identifier in {"Normal", "True Normal", "Incoming"}:
        return fields.of("opposite", _direction())
    raise NotFollowed


def mapping(reader: Reader, place: Place, _: Any) -> Field:
    inputs = [reader.of_socket(place, place.node.inputs["Vector"])]
    unit = {"Location": (0.0, 0.0, 0.0), "Rotation": (0.0, 0.0, 0.0), "Scale": (1.0, 1.0, 1.0)}
    for name, absent in unit.items():
        socket = place.node.inputs[name]
        inputs.append(reader.of_socket(place, socket) if socket.enabled else fields.constant(absent))
    return fields.of("mapping", *inputs, settings=(place.node.vector_type,))


def vector_math(reader: Reader, place: Place, _: Any) -> Field:
    node = place.node
    if node.operation not in OF_VECTORS:
        raise NotFollowed
    inputs = [reader.of_socket(place, socket) for socket in node.inputs]
    return fields.of("vector math", *inputs, settings=(node.operation,))


def _sky(reader: Reader, place: Place, _: Any) -> Field:
    atmosphere = Atmosphere.of(place.node)
    if atmosphere is None:
        raise NotFollowed
    for said in Atmosphere.told(place.node):
        reader.say(said)
    return fields.of("sky", _vector(reader, place), fields.grid(TEXEL, "Fac"), settings=(atmosphere,))


def _light_path(_: Reader, __: Place, output: Any) -> Field:
    """Of light that comes, all of it is taken for what lights diffuse surfaces."""
    if output.identifier == "Is Camera Ray":
        return fields.grid(EYE, "Fac")
    raise NotFollowed


_READ: dict[str, Callable[[Reader, Place, Any], Field]] = {
    "TEX_COORD": _coordinates,
    "NEW_GEOMETRY": _geometry,
    "MAPPING": mapping,
    "VECT_MATH": vector_math,
    **textures_of_nodes.readers(lambda _, __: _direction()),
    "TEX_SKY": _sky,
    "LIGHT_PATH": _light_path,
}
