# SPDX-License-Identifier: GPL-3.0-or-later
"""What glass lets straight through: of light from any side what its surface does not reflect at that angle.

As it is a function of the direction of the light, a field says it, and camera rays and light rays ask the same pattern.
"""

from __future__ import annotations

from .. import compat
from .inputs import Shader, reflectance_of, set_facets
from .looks import LEAVES_NOTHING, NONE, WHITE, Layer, Look
from .shading import fields, places
from .shading.fields import Field

CLEAREST = 0.05  # roughness: what is seen through less of it is hardly blurred


def cosine(shader: Shader) -> Field:
    """Of the angle between the light, or the look, and the normal."""
    zero, scale = fields.constant((0.0, 0.0, 0.0)), fields.constant(1.0)
    at = shader.normal or places.normal()
    product = fields.of(
        "vector math", at, fields.grid(places.INCOMING, "Color"), zero, scale, settings=("DOT_PRODUCT",)
    )
    return fields.of("math", product, settings=("ABSOLUTE",))


def reflected(shader: Shader, index: Field) -> Field:
    """By a dielectric's surface. From inside it is the same: a ray that goes straight through has the angle outside, and
    one that is bent reflects as much on both sides of its way."""
    return fields.of("fresnel", index, shader.normal or places.normal(), fields.grid(places.INCOMING, "Color"), NONE)


def reflected_at(cosine_there: Field, index: Field) -> Field:
    """The same, by the cosine of the angle."""
    along = fields.constant((0.0, 0.0, 1.0))
    return fields.of("fresnel", index, fields.colour(NONE, NONE, cosine_there), along, NONE)


def reflected_tinted(shader: Shader, index: Field, tint: Field) -> Field:
    """In a colour straight on, and white at the edge."""
    share = reflected(shader, index)
    if tint.always(1.0):
        return share
    plain = fields.minimum(reflectance_of(index), 0.99)
    rise = (share - plain) / (1.0 - plain)
    straight_on = fields.minimum(plain * tint, 1.0)
    return straight_on + rise * (1.0 - straight_on)


def say_straight(shader: Shader, roughness: Field, index: Field | None) -> None:
    """What is not shown of light on its way through."""
    known = roughness.constant
    if known is None:
        shader.say("what is seen through its glass is sharp, whatever its Roughness")
    elif float(known[0]) > CLEAREST:
        shader.say(f"what is seen through its glass is sharp, in spite of its Roughness of {float(known[0]):.3g}")
    if index is None or not index.always(1.0):
        shader.say("its glass does not bend light")


def _index(shader: Shader) -> Field:
    return shader.number("IOR", 1e-5, 1000.0, absent=1.45)


def _roughness(shader: Shader) -> Field:
    return NONE if shader.node.distribution == "SHARP" else shader.number("Roughness")


def glass(shader: Shader) -> Look:
    """A Glass BSDF, whose colour is that of what it reflects and of what it lets through."""
    colour, index = fields.minimum(shader.colour("Color"), 1.0), _index(shader)
    share = reflected(shader, index)
    alpha = shader.alpha("Roughness")
    layer = Layer(colour, (alpha, alpha), below=LEAVES_NOTHING, share=share)
    known = index.constant
    if compat.principled_has_layers() and colour.always(1.0) and known is not None and float(known[0]) > 1.0:
        # By the angle to each facet; as the colour at the edge is white, a layer can have that.
        layer = Layer(reflectance_of(index), (alpha, alpha), 1.0, index, below=LEAVES_NOTHING)
    set_facets(layer, shader)
    say_straight(shader, _roughness(shader), index)
    layers = [] if index.always(1.0) else [layer]
    return Look(layers=layers, transmittance=colour * (1.0 - share), normal=shader.normal, glass=True)


def refraction(shader: Shader) -> Look:
    """A Refraction BSDF, which reflects nothing."""
    say_straight(shader, _roughness(shader), _index(shader))
    return Look(transmittance=fields.minimum(shader.colour("Color"), 1.0), glass=True)


def transmitted(shader: Shader, index: Field, tint: Field, colour: Field) -> Field:
    """What a Principled BSDF lets through where all of it is glass: of the colour that is its Base Color, since 4.0 after
    two surfaces."""
    through = fields.root(colour) if compat.principled_has_layers() else colour
    say_straight(shader, shader.number("Roughness"), index)
    return through * (WHITE - reflected_tinted(shader, index, tint))
