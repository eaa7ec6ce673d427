# SPDX-License-Identifier: GPL-3.0-or-later
"""What shader nodes of surfaces are set to."""

from __future__ import annotations

from .. import compat
from .looks import MIRROR, SMOOTHEST, Layer
from .shading import fields, places
from .shading.fields import Field
from .shading.reading import Place, Reader


class Shader:
    """A shader node's inputs, and what is to be said of it to the artist."""

    def __init__(self, place: Place, reader: Reader) -> None:
        self.place, self.node, self.reader = place, place.node, reader
        self.say = reader.say

    def has(self, name: str) -> bool:
        return name in self.node.inputs

    def number(self, name: str, low: float = 0.0, high: float = 1.0, absent: float = 0.0) -> Field:
        if not self.has(name):
            return fields.constant(absent)
        return fields.clipped(self.reader.of_socket(self.place, self.node.inputs[name]), low, high)

    def colour(self, name: str) -> Field:
        return fields.maximum(self.reader.of_socket(self.place, self.node.inputs[name]), 0.0)

    def alpha(self, name: str) -> Field:
        """The slope of facets of an artist's roughness; of the smoothest, lamps are shown by one that is still a lobe."""
        rough = self.number(name)
        known = rough.constant
        if known is not None and float(known[0]) < SMOOTHEST:
            self.say(f"its {name} of {float(known[0]):.3g} is shown as {SMOOTHEST} where it shows lamps")
        smooth = fields.maximum(rough, MIRROR)
        return smooth * smooth

    @property
    def normal(self) -> Field | None:
        """Where an artist bends it."""
        socket = self.node.inputs.get("Normal")
        if socket is None or self.reader.source(self.place, socket) is None:
            return None
        found = self.reader.of_socket(self.place, socket, unlinked=places.normal())
        return None if found.digest == places.normal().digest else found


def set_facets(layer: Layer, shader: Shader) -> None:
    """By the distribution of a shader."""
    kind = shader.node.distribution
    layer.lossless, layer.beckmann = compat.facets_are_lossless(shader.node), kind == "BECKMANN"
    if kind not in {"GGX", "BECKMANN"} and not layer.lossless:
        name = shader.node.bl_rna.properties["distribution"].enum_items[kind].name
        shader.say(f"its gloss, {name}, is shown as GGX")


def index_of(reflectance: Field) -> Field:
    """The index of refraction that reflects so much of light from straight on."""
    root = fields.root(fields.clipped(reflectance, 0.0, 0.99))
    return (1.0 + root) / (1.0 - root)


def reflectance_of(index: Field) -> Field:
    root = (index - 1.0) / (index + 1.0)
    return root * root
