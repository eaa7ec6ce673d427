# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on surfaces as fields: nodes that are followed in materials of surfaces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import fields, surroundings, textures_of_nodes
from .fields import Field
from .reading import NotFollowed, Place, Reader

Readers = dict[str, Callable[[Reader, Place, Any], Field]]
Pictures = Callable[[Any, Any, bool], Any]  # of an image, its user and whether its alpha is asked for: texels

# What a field of a surface is evaluated for. Beside these a mesh's channels: "uv NAME", "tangent NAME", and of attributes
# "attribute NAME"; "" is the active one.
POSITION, OWN, NORMAL, FACE, INCOMING, BACK = "position", "own", "normal", "face", "incoming", "back"
GENERATED = "generated"
COLUMNS = ("to world x", "to world y", "to world z")  # of the matrix of vectors
# Of an object's place in the scene.
LOCATION, OBJECT_COLOUR, OBJECT_ALPHA, OBJECT_INDEX, RANDOM = "location", "colour", "alpha", "object index", "random"
UV, TANGENT, ATTRIBUTE = "uv ", "tangent ", "attribute "


def normal() -> Field:
    return fields.grid(NORMAL, "Color")


def _refused(_: Reader, __: Place, ___: Any) -> Field:
    raise NotFollowed


def nowhere() -> Readers:
    """Where nothing may vary: of hair and particles."""
    return {"ATTRIBUTE": _refused, "VOLUME_INFO": _refused}


def readers(texels_of: Pictures) -> Readers:
    """By the type of a node."""

    def image(reader: Reader, place: Place, output: Any) -> Field:
        node = place.node
        alpha = next(socket for socket in node.outputs if socket.identifier == "Alpha")
        texels = texels_of(node.image, node.image_user, alpha.is_linked)
        how = "cubic" if node.interpolation in {"Cubic", "Smart"} else node.interpolation.lower()
        settings = texels, how, node.extension.lower()
        what = "image's alpha" if output.identifier == "Alpha" else "image's colour"
        at = _vector(reader, place, fields.grid(UV, "Color"))
        if node.projection != "BOX":
            return fields.of(what, _projected(node, at), settings=settings)
        sides = [fields.of("side of a box", at, _own_normal(), settings=(axis,)) for axis in range(3)]
        weights = fields.of_parts(fields.of("sides of a box", _own_normal(), settings=(float(node.projection_blend),)))
        x, y, z = (weight * fields.of(what, side, settings=settings) for weight, side in zip(weights, sides))
        return x + y + z

    return {**_READ, "TEX_IMAGE": image}


def _projected(node: Any, at: Field) -> Field:
    """On a flat picture, or on one around a sphere or a tube."""
    return at if node.projection == "FLAT" else fields.of("wrapped", at, settings=(node.projection == "SPHERE",))


def _vector(reader: Reader, place: Place, unlinked: Field) -> Field:
    socket = place.input("Vector")
    return reader.of_socket(place, socket, unlinked=unlinked)


def _matrix(matrix: Any) -> tuple[float, ...]:
    return tuple(float(value) for row in list(matrix)[:3] for value in row)


def _own_normal() -> Field:
    columns = [fields.of("vector math", normal(), fields.grid(column, "Color"), *[fields.constant((0.0, 0.0, 0.0))],
                         fields.constant(1.0), settings=("DOT_PRODUCT",)) for column in COLUMNS]  # fmt: skip
    return fields.of("unit", fields.colour(*columns))


def _coordinates(_: Reader, place: Place, output: Any) -> Field:
    kind, thing = output.identifier, place.node.object
    if place.node.from_instancer:
        raise NotFollowed
    if kind == "Generated":
        return fields.grid(GENERATED, "Color")
    if kind == "UV":
        return fields.grid(UV, "Color")
    if kind == "Normal":
        return _own_normal()
    if kind == "Object" and thing is None:
        return fields.grid(OWN, "Color")
    if kind == "Object":
        return fields.of(
            "moved", fields.grid(POSITION, "Color"), settings=(_matrix(thing.matrix_world.inverted_safe()),)
        )
    if kind == "Reflection":
        return fields.of("mirrored", fields.grid(INCOMING, "Color"), normal())
    raise NotFollowed


def _geometry(_: Reader, __: Place, output: Any) -> Field:
    kind = output.identifier
    if kind == "Backfacing":
        return fields.grid(BACK, "Fac")
    found = {"Position": POSITION, "Normal": NORMAL, "True Normal": FACE, "Incoming": INCOMING}.get(kind)
    if found is None:
        raise NotFollowed
    return fields.grid(found, "Color")


def _uv_map(_: Reader, place: Place, __: Any) -> Field:
    if place.node.from_instancer:
        raise NotFollowed
    return fields.grid(UV + place.node.uv_map, "Color")


def _attribute(_: Reader, place: Place, output: Any) -> Field:
    node = place.node
    if node.attribute_type != "GEOMETRY" or not node.attribute_name:
        raise NotFollowed
    of = {"Fac": "Fac", "Alpha": "Alpha"}.get(output.identifier, "Color")
    return fields.grid(ATTRIBUTE + node.attribute_name, of)


def _vertex_colour(_: Reader, place: Place, output: Any) -> Field:
    of = "Alpha" if output.identifier == "Alpha" else "Color"
    return fields.grid(ATTRIBUTE + place.node.layer_name, of)


def _object_info(_: Reader, __: Place, output: Any) -> Field:
    numbers = {"Object Index": OBJECT_INDEX, "Random": RANDOM, "Alpha": OBJECT_ALPHA}
    colours = {"Location": LOCATION, "Color": OBJECT_COLOUR}
    if output.identifier in numbers:
        return fields.grid(numbers[output.identifier], "Fac")
    if output.identifier in colours:
        return fields.grid(colours[output.identifier], "Color")
    raise NotFollowed


def _fresnel(reader: Reader, place: Place, _: Any) -> Field:
    at = reader.of_socket(place, place.node.inputs["Normal"], unlinked=normal())
    index = reader.of_socket(place, place.node.inputs["IOR"])
    return fields.of("fresnel", index, at, fields.grid(INCOMING, "Color"), fields.grid(BACK, "Fac"))


def _layer_weight(reader: Reader, place: Place, output: Any) -> Field:
    at = reader.of_socket(place, place.node.inputs["Normal"], unlinked=normal())
    blend = reader.of_socket(place, place.node.inputs["Blend"])
    if output.identifier == "Fresnel":
        index = fields.of("layer's index", blend)
        return fields.of("fresnel", index, at, fields.grid(INCOMING, "Color"), fields.grid(BACK, "Fac"))
    return fields.of("facing", blend, at, fields.grid(INCOMING, "Color"))


def _normal_map(reader: Reader, place: Place, _: Any) -> Field:
    node = place.node
    colour, strength = (reader.of_socket(place, node.inputs[name]) for name in ("Color", "Strength"))
    columns = [fields.grid(column, "Color") for column in COLUMNS]
    if node.space == "TANGENT":
        tangent = fields.grid(TANGENT + node.uv_map, "Color")
        sign = fields.grid(TANGENT + node.uv_map, "Alpha")
        own, back = _own_normal(), fields.grid(BACK, "Fac")
        return fields.of("normal map", colour, strength, normal(), own, tangent, sign, back, *columns)
    if node.space in {"OBJECT", "WORLD"}:
        return fields.of(
            "normal of colour", colour, strength, normal(), fields.grid(BACK, "Fac"), *columns, settings=(node.space,)
        )
    raise NotFollowed


def _bump(reader: Reader, place: Place, _: Any) -> Field:
    node = place.node
    strength, distance = (reader.of_socket(place, node.inputs[name]) for name in ("Strength", "Distance"))
    socket = node.inputs["Height"]
    if reader.source(place, socket) is None:
        return reader.of_socket(place, node.inputs["Normal"], unlinked=normal())
    height = reader.of_socket(place, socket)
    at = reader.of_socket(place, node.inputs["Normal"], unlinked=normal())
    sense = -1.0 if node.invert else 1.0
    return fields.of("bump", height, strength, sense * distance, at, fields.grid(POSITION, "Color"))


_READ: Readers = {
    "TEX_COORD": _coordinates,
    "NEW_GEOMETRY": _geometry,
    "UVMAP": _uv_map,
    "ATTRIBUTE": _attribute,
    "VERTEX_COLOR": _vertex_colour,
    "OBJECT_INFO": _object_info,
    "VOLUME_INFO": _refused,
    "FRESNEL": _fresnel,
    "LAYER_WEIGHT": _layer_weight,
    **textures_of_nodes.readers(lambda _, __: fields.grid(GENERATED, "Color")),
    "NORMAL_MAP": _normal_map,
    "BUMP": _bump,
    "MAPPING": surroundings.mapping,
    "VECT_MATH": surroundings.vector_math,
}
