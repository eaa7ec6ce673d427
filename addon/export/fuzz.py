# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheens: what fibres and dust on a surface add at its rim."""

from __future__ import annotations

from .glass import cosine
from .inputs import Shader
from .looks import ALL, BLACK, FIBRES, LEAVES_NOTHING, VELVET, Layer, Look
from .shading import fields
from .shading.fields import Field

THINNEST = 0.15  # roughness of fibres that native lobes know


def of_fibres(shader: Shader, colour: Field, roughness: Field, name: str) -> Look:
    """As from Blender 4.0 on: native lobes send all that comes, and the colour has how much of that does."""
    known = roughness.constant
    if known is not None and float(known[0]) < THINNEST:
        shader.say(f"its {name} of {float(known[0]):.3g} is shown as {THINNEST}")
    share = fields.of("of fibres", cosine(shader), roughness)
    return Look(sheen=share * colour, sheen_kind=FIBRES, sheen_roughness=roughness)


def sheen(shader: Shader) -> Look:
    """A Velvet BSDF, or the Sheen BSDF that it is from Blender 4.0 on."""
    colour = shader.colour("Color")
    if shader.node.type == "BSDF_SHEEN" and shader.node.distribution == "MICROFIBER":
        look = of_fibres(shader, fields.minimum(colour, 1.0), shader.number("Roughness"), "Roughness")
    else:
        width = shader.number("Sigma" if shader.has("Sigma") else "Roughness")
        look = Look(sheen=colour, sheen_kind=VELVET, sheen_roughness=width)
    look.normal = shader.normal
    return look


def over(sheen: Look) -> Layer:
    """What fibres take from all that is below them."""
    red, green, blue = fields.of_parts(sheen.sheen)
    most = fields.maximum(fields.maximum(red, green), blue)
    return Layer(BLACK, (ALL, ALL), below=LEAVES_NOTHING, share=fields.minimum(most, 1.0))
