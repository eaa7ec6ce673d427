# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's nodes of values and colours, read into fields. What is not followed is named, and the value that the input
that it is linked to has itself is used."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any


from ... import compat
from . import fields
from .blending import OF_COLOURS
from .fields import Field
from .mathematics import OF_NUMBERS


class NotFollowed(Exception):
    """A node of a kind, or in a mode, of which no field can be made."""


@dataclass(frozen=True)
class Place:
    """A node, and the group nodes that it is in, from the outermost on."""

    node: Any
    groups: tuple[Any, ...] = ()

    def input(self, identifier: str) -> Any | None:
        """An input by its identifier, which other than its name is the same in all versions."""
        return next((socket for socket in self.node.inputs if socket.identifier == identifier), None)


@dataclass(frozen=True)
class Source:
    """What is linked to an input: a node's output; or a group's or a muted node's input that nothing is linked to."""

    place: Place
    socket: Any


@dataclass
class Reader:
    """Reads the nodes of one material of `owner`, each of their outputs once."""

    owner: str
    notices: list[str]
    more: Mapping[str, Callable[[Reader, Place, Any], Field]] = field(default_factory=dict)  # by the type of a node
    _known: dict[tuple[int, ...], Field] = field(default_factory=dict)
    _open: set[tuple[int, ...]] = field(default_factory=set)

    def value(self, place: Place, identifier: str) -> Field:
        """What an input is in space: a number or a colour, by what kind of input it is."""
        socket = place.input(identifier)
        if socket is None:
            raise ValueError(f"{place.node.bl_rna.name} has no input '{identifier}'")
        return self.of_socket(place, socket)

    def of_socket(self, place: Place, socket: Any, unlinked: Field | None = None) -> Field:
        """What an input is in space; `unlinked` where nothing is linked to it, or else its own value."""
        source = self.source(place, socket)
        if source is None:
            return own_value(socket) if unlinked is None else unlinked
        if not source.socket.is_output and unlinked is not None and source.socket.hide_value:
            return unlinked
        if not source.socket.is_output:
            if source.place.node.mute:
                nothing = converted(fields.constant(0.0), "VALUE", socket.type)
                return own_value(socket) if compat.muted_links_are_dropped() else nothing
            return converted(own_value(source.socket), source.socket.type, socket.type)
        try:
            return converted(self.of_source(source), source.socket.type, socket.type)
        except NotFollowed:
            self._name(place, socket, source.place.node)
            return own_value(socket) if unlinked is None else unlinked

    def of_source(self, source: Source) -> Field:
        """What a node's output is in space. Raises NotFollowed, also for one that asks for itself."""
        key = _key(source.place, source.socket)
        if key in self._open:
            raise NotFollowed
        if key not in self._known:
            self._open.add(key)
            try:
                self._known[key] = self._output(source)
            finally:
                self._open.discard(key)
        return self._known[key]

    def source(self, place: Place, socket: Any) -> Source | None:
        """What is behind an input, through reroutes, groups and muted nodes; None where nothing is linked."""
        first, seen = socket, set[tuple[int, ...]]()
        while True:
            key = _key(place, socket)
            link = next((link for link in socket.links if _holds(link)), None)
            if link is None or key in seen:
                handed = link is None and socket != first and hasattr(socket, "default_value")
                return Source(place, socket) if handed and (place.node.mute or place.node.type in _GROUPS) else None
            seen.add(key)
            found = self._through(replace(place, node=link.from_node), link.from_socket)
            if not isinstance(found, tuple):
                return found
            place, socket = found

    def _through(self, place: Place, output: Any) -> tuple[Place, Any] | Source | None:
        """The input that an output hands on, or the output; None where a muted node hands on nothing."""
        node = place.node
        if node.type == "REROUTE":
            return place, node.inputs[0]
        if node.mute:
            inner = next((link.from_socket for link in node.internal_links if link.to_socket == output), None)
            return None if inner is None else (place, inner)
        if node.type == "GROUP_INPUT" and place.groups:
            outer = Place(place.groups[-1], place.groups[:-1])
            socket = outer.input(output.identifier)
            return None if socket is None else (outer, socket)
        if node.type == "GROUP" and node.node_tree is not None:
            ends = [end for end in node.node_tree.nodes if end.type == "GROUP_OUTPUT" and end.is_active_output]
            inner_place = Place(ends[0], (*place.groups, node)) if ends else None
            socket = inner_place.input(output.identifier) if inner_place is not None else None
            return None if inner_place is None or socket is None else (inner_place, socket)
        return Source(place, output)

    def _output(self, source: Source) -> Field:
        kind = source.place.node.type
        read = self.more.get(kind, _READ.get(kind))
        if read is None:
            raise NotFollowed
        return read(self, source.place, source.socket)

    def say(self, what: str) -> None:
        said = f"{self.owner}: {what}"
        if said not in self.notices:
            self.notices.append(said)

    def _name(self, place: Place, socket: Any, source: Any) -> None:
        """One that goes deeper is told from the shader's own by the node that it goes into."""
        own = place.node.type in _SHADERS or place.node.type.startswith("BSDF_")
        into = f"'{socket.name}'" if own else f"{place.node.bl_rna.name}'s '{socket.name}'"
        if own or not hasattr(socket, "default_value") or socket.hide_value:
            self.say(f"the link into {into} is not followed; its own value is used")
        else:
            self.say(
                f"the link from {source.bl_rna.name} into {into} is not followed; its own value, {_shown(socket)}, is used"
            )


def _key(place: Place, socket: Any) -> tuple[int, ...]:
    return (*(group.as_pointer() for group in place.groups), socket.as_pointer())


# Whose inputs are an owner's own.
_SHADERS = set(
    "PRINCIPLED_VOLUME VOLUME_SCATTER VOLUME_ABSORPTION VOLUME_COEFFICIENTS EMISSION BACKGROUND MIX_SHADER".split()
)
# Whose inputs hand on their own values where nothing is linked to them.
_GROUPS = {"GROUP", "GROUP_OUTPUT"}


def _shown(socket: Any) -> str:
    value = socket.default_value
    return f"{value:.3g}" if isinstance(value, (int, float)) else f"({', '.join(f'{part:.3g}' for part in value[:3])})"


def _holds(link: Any) -> bool:
    return link.is_valid and not link.is_muted and link.from_socket.enabled and link.to_socket.enabled


def own_value(socket: Any) -> Field:
    """The number, colour or vector that an input is where nothing is linked to it."""
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, (bool, int, float)):
        return fields.constant(float(value))
    if isinstance(value, str):
        raise NotFollowed
    return fields.constant([float(part) for part in value[:3]])


_NUMBERS = {"VALUE", "INT", "BOOLEAN"}


def converted(value: Field, kind: str, wanted: str) -> Field:
    """As a link between sockets of two kinds does."""
    if (kind in _NUMBERS) == (wanted in _NUMBERS):
        return value
    if wanted in _NUMBERS:
        return fields.of("grey" if kind == "RGBA" else "mean", value)
    return fields.of("spread", value)


def _inputs(reader: Reader, place: Place) -> Iterator[Field]:
    """Those that a node's mode leaves it."""
    return (reader.of_socket(place, socket) for socket in place.node.inputs if socket.enabled)


def _attribute(_: Reader, place: Place, output: Any) -> Field:
    if place.node.attribute_type != "GEOMETRY":
        raise NotFollowed
    of = {"Fac": "Fac", "Alpha": "Alpha"}.get(output.identifier, "Color")
    return fields.grid(place.node.attribute_name, of)


def _volume_info(_: Reader, __: Place, output: Any) -> Field:
    return fields.grid(output.identifier.lower(), "Color" if output.identifier == "Color" else "Fac")


def _constant(_: Reader, __: Place, output: Any) -> Field:
    return own_value(output)


def _ramp(reader: Reader, place: Place, output: Any) -> Field:
    which = "ramp's alpha" if output.identifier == "Alpha" else "ramp's colour"
    return fields.of(which, reader.value(place, "Fac"), settings=stops_of(place.node))


def stops_of(node: Any) -> tuple[Any, ...]:
    """What ramps.py takes of a ColorRamp: how it goes on from stop to stop, and these."""
    ramp = node.color_ramp
    stops = tuple((stop.position, tuple(stop.color)) for stop in ramp.elements)
    return ramp.interpolation, ramp.color_mode, ramp.hue_interpolation, stops


def _math(reader: Reader, place: Place, _: Any) -> Field:
    if place.node.operation not in OF_NUMBERS:
        raise NotFollowed
    found = fields.of("math", *_inputs(reader, place), settings=(place.node.operation,))
    return _within_one(found) if place.node.use_clamp else found


def _within_one(value: Field) -> Field:
    return fields.of("clamp", value, fields.constant(0.0), fields.constant(1.0))


def _map_range(reader: Reader, place: Place, _: Any) -> Field:
    node = place.node
    clamp = node.clamp and node.interpolation_type in {"LINEAR", "STEPPED"}
    return fields.of("map range", *_inputs(reader, place), settings=(node.interpolation_type, clamp))


def _clamp(reader: Reader, place: Place, _: Any) -> Field:
    how = "clamp between" if place.node.clamp_type == "RANGE" else "clamp"
    return fields.of(how, *_inputs(reader, place))


def _mix(reader: Reader, place: Place, output: Any) -> Field:
    node = place.node
    if node.data_type not in {"FLOAT", "VECTOR", "RGBA"} or not output.enabled:
        raise NotFollowed
    factor, a, b = _inputs(reader, place)
    factor = _within_one(factor) if node.clamp_factor else factor
    if node.data_type == "RGBA":
        return _blended(node.blend_type, node.clamp_result, factor, a, b)
    if node.data_type == "VECTOR" and node.factor_mode == "UNIFORM":
        factor = fields.of("spread", factor)
    return fields.of("mix", factor, a, b)


def _mix_colours(reader: Reader, place: Place, _: Any) -> Field:
    factor, a, b = _inputs(reader, place)
    return _blended(place.node.blend_type, place.node.use_clamp, _within_one(factor), a, b)


def _blended(mode: str, clamp: bool, factor: Field, a: Field, b: Field) -> Field:
    if mode not in OF_COLOURS:
        raise NotFollowed
    found = fields.of("blend", factor, a, b, settings=(mode,))
    return _within_one(found) if clamp else found


def _separate(reader: Reader, place: Place, output: Any) -> Field:
    part = [socket.identifier for socket in place.node.outputs].index(output.identifier)
    return fields.of("part", *_inputs(reader, place), settings=(_mode(place.node), part))


def _combine(reader: Reader, place: Place, _: Any) -> Field:
    return fields.of("combine", *_inputs(reader, place), settings=(_mode(place.node),))


def _mode(node: Any) -> str:
    return "HSV" if node.type.endswith("HSV") else getattr(node, "mode", "RGB")


def _operation(name: str) -> Callable[[Reader, Place, Any], Field]:
    return lambda reader, place, _: fields.of(name, *_inputs(reader, place))


_READ: dict[str, Callable[[Reader, Place, Any], Field]] = {
    "ATTRIBUTE": _attribute,
    "VOLUME_INFO": _volume_info,
    "VALUE": _constant,
    "RGB": _constant,
    "VALTORGB": _ramp,
    "MATH": _math,
    "MAP_RANGE": _map_range,
    "CLAMP": _clamp,
    "MIX": _mix,
    "MIX_RGB": _mix_colours,
    "SEPARATE_COLOR": _separate,
    "SEPRGB": _separate,
    "SEPHSV": _separate,
    "SEPXYZ": _separate,
    "COMBINE_COLOR": _combine,
    "COMBRGB": _combine,
    "COMBHSV": _combine,
    "COMBXYZ": _combine,
    "INVERT": _operation("invert"),
    "GAMMA": _operation("gamma"),
    "BRIGHTCONTRAST": _operation("brightness"),
    "HUE_SAT": _operation("hue and saturation"),
    "RGBTOBW": _operation("grey"),
    "BLACKBODY": _operation("black body"),
}
