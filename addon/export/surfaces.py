# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of surfaces reduced to what is modelled, shader by shader."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from .. import compat
from . import omissions
from .glass import glass, refraction
from .inputs import Shader, set_facets
from .looks import (
    ALL,
    BLACK,
    LAMBERT,
    LEAVES_NOTHING,
    MOST_LAYERS,
    NONE,
    Layer,
    Look,
    Surface,
    besides,
    in_few,
    laid_beside,
    settled,
)
from .fuzz import sheen
from .materials import active_output, materials_of
from .principled import principled, rough
from .shading import fields, places
from .shading.fields import Field
from .shading.reading import Place, Reader, Source

PLAIN_GREY = (0.8, 0.8, 0.8)


def glossy(shader: Shader) -> Look:
    """A Glossy BSDF, which with anisotropy is a node of its own before Blender 4.0."""
    alpha = shader.alpha("Roughness")
    # Brushed across where it is positive: other slopes than those of a Principled BSDF.
    anisotropy = shader.number("Anisotropy", -0.99, 0.99)
    slopes = alpha, alpha
    if not anisotropy.always(0.0):
        size = fields.of("math", anisotropy, settings=("ABSOLUTE",))
        narrow, wide = alpha * (1.0 - size), fields.minimum(alpha / (1.0 - size), 1.0)
        positive = fields.of("math", anisotropy, NONE, settings=("GREATER_THAN",))
        slopes = wide + positive * (narrow - wide), narrow + positive * (wide - narrow)
    layer = Layer(fields.minimum(shader.colour("Color"), 1.0), slopes, below=LEAVES_NOTHING)
    if not anisotropy.always(0.0):
        layer.turn = fields.of("math", shader.number("Rotation", -math.inf, math.inf), settings=("FRACT",))
    set_facets(layer, shader)
    return Look(layers=[layer], normal=shader.normal)


def mixed(shader: Shader, depth: int) -> Look | None:
    """A Mix Shader as what lies beside, and so above, the rest; where both have a diffuse part that the other's gloss would
    cover, as one between them; None where they are too different for that."""
    share = shader.number(shader.node.inputs[0].name)
    first, second = (_behind(shader, k, depth) for k in (1, 2))
    if first is None or second is None:
        return None
    for top, below, part in ((second, first, share), (first, second, 1.0 - share)):
        if part.always(0.0):
            return below
        if not top.albedo.always(0.0) or len(top.layers) > 1:
            continue
        return _with_normal(laid_beside(top, below, part), first, second, shader)
    if _both_lambertian(first, second):
        both = laid_beside(replace(second, albedo=BLACK), first, share)
        return _with_normal(replace(both, albedo=both.albedo + share * second.albedo), first, second, shader)
    blended = _blended(first, second, share)
    if blended is not None:
        shader.say("where both shaders of its Mix Shader are seen, their gloss is one between the two")
        blended = _with_normal(blended, first, second, shader)
    return blended


def _blended(first: Look, second: Look, share: Field) -> Look | None:
    """Between two looks of the same kinds of layers: of each its inputs are mixed."""

    def kind(layer: Layer) -> tuple[Any, ...]:
        return layer.edge, layer.lossless, layer.below, layer.beckmann, layer.part

    kinds = [[kind(layer) for layer in look.layers] for look in (first, second)]
    if first.diffuse != second.diffuse or any(len(set(each)) < len(each) for each in kinds):
        return None
    longer, shorter = (first, second) if len(first.layers) >= len(second.layers) else (second, first)
    order = [kind(layer) for layer in longer.layers]
    if [each for each in order if each in map(kind, shorter.layers)] != [kind(layer) for layer in shorter.layers]:
        return None

    def mix(a: Field, b: Field) -> Field:
        return a if a.digest == b.digest else a + share * (b - a)

    layers = []
    for each in longer.layers:
        a, b = (
            next((layer for layer in look.layers if kind(layer) == kind(each)), replace(each, share=NONE))
            for look in (first, second)
        )
        layers.append(
            replace(
                each,
                reflectance=mix(a.reflectance, b.reflectance),
                alpha=(mix(a.alpha[0], b.alpha[0]), mix(a.alpha[1], b.alpha[1])),
                index=mix(a.index, b.index),
                dip=mix(a.dip, b.dip),
                share=mix(a.share, b.share),
                turn=mix(a.turn, b.turn),
            )
        )
    return Look(
        mix(first.albedo, second.albedo), layers, mix(first.emission, second.emission), first.diffuse,
        mix(first.roughness, second.roughness), mix(first.transmittance, second.transmittance),
        **besides(first, second, 1.0 - share, share),
    )  # fmt: skip


def _both_lambertian(first: Look, second: Look) -> bool:
    return not first.layers and not second.layers and {first.diffuse, second.diffuse} == {LAMBERT}


def _with_normal(look: Look, first: Look, second: Look, shader: Shader) -> Look:
    """Where both have one, the first's; a glow needs none."""
    bent = [each.normal for each in (first, second) if each.normal is not None]
    if len({normal.digest for normal in bent}) > 1 or (
        len(bent) == 1 and any(each.normal is None and each.shades for each in (first, second))
    ):
        shader.say("all of its shaders have the Normal of the first that is linked")
    return replace(look, normal=bent[0] if bent else None)


def added(shader: Shader, depth: int) -> Look | None:
    """An Add Shader where one of both has no diffuse part, or both are Lambert's."""
    first, second = (_behind(shader, k, depth) for k in (0, 1))
    if first is None or second is None:
        return None
    emission, transmittance = first.emission + second.emission, first.transmittance + second.transmittance
    more = besides(first, second, ALL, ALL)
    for top, below in ((first, second), (second, first)):
        if top.albedo.always(0.0) and len(top.layers) < 2:
            layers = [*(replace(layer, below=0.0) for layer in top.layers), *below.layers]
            look = replace(below, layers=layers, emission=emission, transmittance=transmittance, **more)
            return _with_normal(look, first, second, shader)
    if not _both_lambertian(first, second):
        return None
    both = Look(first.albedo + second.albedo, [], emission, transmittance=transmittance, **more)
    return _with_normal(both, first, second, shader)


def _behind(shader: Shader, socket: int, depth: int) -> Look | None:
    source = shader.reader.source(shader.place, shader.node.inputs[socket])
    return Look() if source is None else of_shader(source, shader.reader, depth + 1)


def of_shader(source: Source, reader: Reader, depth: int = 0) -> Look | None:
    """What a shader node reflects; None where that is beyond us."""
    node = source.place.node
    if not source.socket.is_output:  # a group's or a muted node's that nothing is linked to
        return Look()
    omissions.of_node(node, reader.owner, reader.notices)
    shader = Shader(source.place, reader)
    if node.type == "BSDF_PRINCIPLED":
        return in_few(principled(shader))
    if node.type == "EMISSION":
        return Look(emission=shader.colour("Color") * shader.number("Strength", high=math.inf))
    if node.type == "BSDF_TRANSPARENT":
        return Look(transmittance=shader.colour("Color"))
    if node.type == "BSDF_DIFFUSE":
        return rough(Look(shader.colour("Color"), normal=shader.normal), shader.number("Roughness"))
    if node.type == "BSDF_TRANSLUCENT":
        return Look(translucence=fields.minimum(shader.colour("Color"), 1.0), normal=shader.normal)
    if node.type in {"BSDF_SHEEN", "BSDF_VELVET"}:
        return sheen(shader)
    if node.type in {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}:
        return glossy(shader)
    if node.type in {"BSDF_GLASS", "BSDF_REFRACTION"}:
        return (glass if node.type == "BSDF_GLASS" else refraction)(shader)
    found = None
    if node.type in {"MIX_SHADER", "ADD_SHADER"} and depth < MOST_LAYERS:
        found = (mixed if node.type == "MIX_SHADER" else added)(shader, depth)
    found = None if found is None else in_few(found)
    return found if found is not None and len(found.layers) <= MOST_LAYERS else None


def surface_of(material: Any, owner: str, notices: list[str], readers: places.Readers | None = None) -> Surface | None:
    """What a material's surface reflects; None where it has no surface at all, as a volume's. Nothing varies over it without
    `readers` of nodes."""
    if material is None:
        return Surface(np.array(PLAIN_GREY))
    output = active_output(material)
    if output is None:
        return Surface(np.array(material.diffuse_color[:3]))
    omissions.of_node(output, owner, notices)
    said: list[str] = []
    reader = Reader(owner, said, places.nowhere() if readers is None else readers)
    place = Place(output)
    source = reader.source(place, output.inputs["Surface"])
    if source is None:
        return None if output.inputs["Volume"].is_linked else Surface()
    try:
        look = of_shader(source, reader)
        surface = None if look is None else settled(_dimmed(look, material, owner, said))
    except RecursionError:
        notices.append(f"{owner}: its material has too many nodes in a row; its viewport color is shown")
        return Surface(np.array(material.diffuse_color[:3]))
    if surface is not None:
        notices += said
        return surface
    name = source.place.node.bl_rna.name
    notices.append(f"{owner}: its shader {name} is shown as diffuse in the material's viewport color")
    return Surface(np.array(material.diffuse_color[:3]))


def _dimmed(look: Look, material: Any, owner: str, notices: list[str]) -> Look:
    """What lets light through, and no more than there is."""
    through = look.transmittance.constant
    if through is not None and through.max() > 1.0:
        shown = ", ".join(f"{part:.3g}" for part in np.minimum(through[0], 1.0))
        notices.append(
            f"{owner}: it makes light that passes through it brighter, which is not shown; it lets ({shown}) through"
        )
    if not look.transmittance.always(0.0) and not compat.has_transparent_shadow(material):
        notices.append(f"{owner}: its Transparent Shadows, which are off, are shown as on")
    return look


def surfaces(
    thing: Any, depsgraph: Any, notices: list[str], readers: places.Readers | None = None
) -> list[Surface] | None:
    """One for each material slot, clear where it has only a volume; None for an object without any surface."""
    slots = materials_of(thing, depsgraph) or [None]
    found = [surface_of(material, thing.name, notices, readers) for material in slots]
    if all(surface is None for surface in found):
        return None
    return [surface or Surface(transmittance=np.ones(3)) for surface in found]
