# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled BSDF's parts as layers of gloss, what is diffuse, and what is let through."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .. import compat
from .fuzz import of_fibres, over
from .glass import cosine, reflected, reflected_at, transmitted
from .inputs import Shader, index_of, reflectance_of, set_facets
from .looks import (
    ALL,
    BLACK,
    BURLEY,
    CLEARCOAT,
    LEAVES_NOTHING,
    LEAVES_REST,
    NONE,
    SMOOTHEST,
    WHITE,
    Layer,
    Look,
    besides,
    laid_beside,
)
from .shading import fields, places
from .shading.fields import Field

LUMINANCE = np.array((0.3, 0.6, 0.1))  # as Burley (2012) has it
OF_SHEEN = np.array((0.2126, 0.7152, 0.0722))  # as Cycles has it there


def principled(shader: Shader) -> Look:
    colour = fields.minimum(shader.colour("Base Color"), 1.0)
    glow = shader.colour(compat.emission_socket(shader.node))
    emission = glow * shader.number("Emission Strength", high=math.inf)
    alpha, anisotropy = shader.alpha("Roughness"), shader.number("Anisotropic")
    slopes = alpha, alpha
    if not anisotropy.always(0.0):
        aspect = fields.root(1.0 - 0.9 * anisotropy)
        slopes = fields.minimum(alpha / aspect, 1.0), alpha * aspect
    lobe = Layer(BLACK, slopes, edge=1.0)
    set_facets(lobe, shader)
    if not anisotropy.always(0.0):
        lobe.turn = shader.number("Anisotropic Rotation")
    make = _layered if compat.principled_has_layers() else _of_one_gloss
    look = make(shader, colour, emission, lobe)
    look.normal = shader.normal
    return laid_beside(Look(transmittance=WHITE), look, 1.0 - shader.number("Alpha", absent=1.0))


def _of_one_gloss(shader: Shader, colour: Field, emission: Field, lobe: Layer) -> Look:
    """As before Blender 4.0."""
    metallic, plain = shader.number("Metallic"), 0.08 * shader.number("Specular")
    luminance = fields.of("weighted", colour, settings=(tuple(LUMINANCE),))
    of_colour = fields.of("over or one", colour, luminance)
    tint = shader.number("Specular Tint")
    in_tint = 1.0 + tint * (of_colour - 1.0)
    lobe.reflectance = (1.0 - metallic) * (plain * in_tint) + metallic * colour
    lobe.index = index_of(plain)
    seen = not lobe.reflectance.always(0.0) or not lobe.index.always(1.0)  # a black metal is seen at the edge
    look = Look((1.0 - metallic) * colour, [lobe] if seen else [], emission, BURLEY, shader.number("Roughness"))
    look.layers += _clearcoat(shader)
    transmission = shader.number("Transmission")
    fibres = (1.0 - metallic) * (1.0 - transmission)
    weight = shader.number("Sheen")
    if not weight.always(0.0):
        of_sheen = fields.of("over or one", colour, fields.of("weighted", colour, settings=(tuple(OF_SHEEN),)))
        look.sheen = fibres * weight * (1.0 + shader.number("Sheen Tint") * (of_sheen - WHITE))
    if transmission.always(0.0) or metallic.always(1.0):
        return look
    clear = (1.0 - metallic) * transmission
    index = _index(shader, 1.45)
    edge = replace(lobe, reflectance=1.0 + tint * (colour - WHITE), index=fields.maximum(index, 1.0))
    edge.share = clear * reflected(shader, index)
    edge.part = "glass"
    lobe.share = 1.0 - clear
    kept = [layer for layer in look.layers if layer is not lobe or not clear.always(1.0)]
    look.layers = [*kept, *([] if index.always(1.0) else [edge])]
    look.albedo = (1.0 - transmission) * look.albedo
    look.glass, look.transmittance = True, clear * transmitted(shader, index, NONE + 1.0, colour)
    return look


# Gauss's nodes in [0, 1], and their weights.
_NODES, _WEIGHTS = (0.11270166538, 0.5, 0.88729833462), (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def _clearcoat(shader: Shader) -> list[Layer]:
    """Before Blender 4.0 a quarter of a varnish of index 1.5, which takes nothing from what is below it. The slopes of its
    facets, Burley's (2012) GTR with an exponent of 1, are those of GGX with all alphas from its own to 1, each decade as
    often: (1 - a^2) / t = int_{a^2}^1 du / (u cos^2 + sin^2)^2, with t = a^2 cos^2 + sin^2. Of these a few stand for all.
    They mask each other as those of an alpha of 1/4 do; light is taken to come from as low as the eye is."""
    weight = 0.25 * shader.number("Clearcoat")
    if weight.always(0.0):
        return []
    rough = fields.maximum(shader.number("Clearcoat Roughness"), 1e-3)
    known = rough.constant
    if known is not None and float(known[0]) ** _NODES[-1] < SMOOTHEST:
        shader.say(f"the sharpest of its Clearcoat of Roughness {float(known[0]):.3g} is shown as of {SMOOTHEST}")
    alpha, plain = rough * rough, fields.constant((0.04, 0.04, 0.04))
    whole = _reach(shader, fields.constant(0.25))
    layers = []
    for number, (node, share) in enumerate(zip(_NODES, _WEIGHTS)):
        slope = fields.of("math", alpha, fields.constant(node), settings=("POWER",))
        slope = fields.maximum(slope, SMOOTHEST * SMOOTHEST)
        masked = _reach(shader, slope) / whole
        name = f"{CLEARCOAT} {number}"
        layers.append(
            Layer(plain, (slope, slope), 1.0, fields.constant(1.5), share=share * weight * masked * masked, part=name)
        )
    return layers


def _reach(shader: Shader, alpha: Field) -> Field:
    """Twice the cosine to the eye over the share that facets of GGX leave unmasked (Smith 1967)."""
    seen = cosine(shader)
    square = seen * seen
    return seen + fields.root(square + alpha * alpha * (1.0 - square))


def _layered(shader: Shader, colour: Field, emission: Field, lobe: Layer) -> Look:
    """As from Blender 4.0 on: coat, metal beside the rest, glass beside the rest of that, a dielectric layer, and what is
    diffuse."""
    tint, layers = shader.colour("Specular Tint"), _coat(shader)
    through = _through_coat(shader) if layers else ALL
    metallic, clear = shader.number("Metallic"), shader.number("Transmission Weight")
    fibres = _fibres(shader)
    covered = NONE if fibres is None else over(fibres).share
    if fibres is not None:
        layers.insert(0, over(fibres))
    if not metallic.always(0.0):
        before_edge = colour + (1.0 - colour) * (6.0 / 7.0) ** 5
        dip = before_edge * (1.0 - fields.minimum(tint, 1.0))
        metal = replace(lobe, reflectance=through * colour, dip=through * dip, below=LEAVES_NOTHING, share=metallic)
        layers.append(metal)
    index = _index(shader, 1.5)
    known = index.constant
    if known is not None and float(known[0]) < 1.0:
        shader.say(f"its IOR of {float(known[0]):.3g} is shown as {1.0 / float(known[0]):.3g}")
    look = Look(through * colour, layers, (1.0 - covered) * emission)
    if fibres is not None:
        look = replace(look, **besides(look, fibres, ALL, ALL))
    if not clear.always(0.0) and not metallic.always(1.0):
        straight_on = fields.minimum(through * (reflectance_of(index) * tint), 1.0)
        edge = fields.maximum(index, 1.0 / fields.maximum(index, 1e-5))
        layers.append(
            replace(lobe, reflectance=straight_on, index=edge, below=LEAVES_NOTHING, share=clear, part="glass")
        )
        beside_metal = (1.0 - covered) * (1.0 - metallic) * clear
        look.glass, look.transmittance = True, beside_metal * transmitted(shader, index, tint, colour)
        if clear.always(1.0):
            look.albedo = BLACK
    if not shader.number("Coat Weight").always(0.0):
        left = _left_by_coat(shader) * through
        look.emission, look.transmittance = left * look.emission, left * look.transmittance
    plain = fields.minimum(2.0 * shader.number("Specular IOR Level") * reflectance_of(index), 1.0)
    if not metallic.always(1.0) and not clear.always(1.0) and not plain.always(0.0):
        straight_on = through * (plain * tint)
        layers.append(replace(lobe, reflectance=straight_on, index=index_of(plain), below=LEAVES_REST))
    return rough(look, shader.number("Diffuse Roughness"))


def _fibres(shader: Shader) -> Look | None:
    weight = shader.number("Sheen Weight")
    if weight.always(0.0):
        return None
    colour = weight * fields.minimum(shader.colour("Sheen Tint"), 1.0)
    return of_fibres(shader, colour, shader.number("Sheen Roughness"), "Sheen Roughness")


def _index(shader: Shader, absent: float) -> Field:
    return shader.number("IOR", 1e-5, 1000.0, absent=absent)


def rough(look: Look, roughness: Field) -> Look:
    return look if roughness.always(0.0) else replace(look, diffuse=compat.grooves(), roughness=roughness)


def _coat_index(shader: Shader) -> Field:
    return fields.maximum(shader.number("Coat IOR", high=1000.0), 1.0)


def _coat(shader: Shader) -> list[Layer]:
    share, index = shader.number("Coat Weight"), _coat_index(shader)
    if share.always(0.0) or index.always(1.0):
        return []
    alpha, plain = shader.alpha("Coat Roughness"), fields.of("spread", reflectance_of(index))
    return [Layer(plain, (alpha, alpha), 1.0, index, below=LEAVES_REST, share=share)]


def _cosine_at_coat(shader: Shader) -> Field:
    """Cycles has the coat on both sides of each face: what is seen from inside glass is seen at the angle of the bent ray."""
    index, seen = _index(shader, 1.5), cosine(shader)
    bent = fields.root(1.0 - (1.0 - seen * seen) / (index * index))
    return seen + fields.grid(places.BACK, "Fac") * (bent - seen)


def _left_by_coat(shader: Shader) -> Field:
    """To what is no reflection below it, which native layers dim by themselves."""
    return 1.0 - shader.number("Coat Weight") * reflected_at(_cosine_at_coat(shader), _coat_index(shader))


def _through_coat(shader: Shader) -> Field:
    """In the tint of the coat, which is what passes it straight on; aside light has a longer way there, as the ray that is
    bent into it (Cycles, kernel/svm/closure.h, 4.0)."""
    tint = fields.minimum(shader.colour("Coat Tint"), 1.0)
    if tint.always(1.0):
        return ALL
    seen, index = _cosine_at_coat(shader), _coat_index(shader)
    way = 1.0 / fields.root(1.0 - (1.0 - seen * seen) / (index * index))
    left = fields.colour(*(fields.of("math", part, way, settings=("POWER",)) for part in fields.of_parts(tint)))
    return 1.0 + shader.number("Coat Weight") * (left - 1.0)
