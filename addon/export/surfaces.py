# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of surfaces reduced to what is modelled: one diffuse part, layers of gloss above it, and holes between."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat
from . import omissions
from .materials import active_output, linked_node, materials_of, value_of

PLAIN_GREY = (0.8, 0.8, 0.8)
MOST_LAYERS = 4
LEAVES_REST, LEAVES_NOTHING = 0.5, 1.0  # to what is below a layer of gloss
SMOOTHEST = 0.1  # roughness
LAMBERT, BURLEY = (0, 0.0), 1
LUMINANCE = np.array((0.3, 0.6, 0.1))  # as Burley (2012) has it


def _black() -> NDArray[np.float64]:
    return np.zeros(3)


@dataclass
class Gloss:
    """A layer of gloss, as native Gloss has it."""

    reflectance: NDArray[np.float64]
    alpha: tuple[float, float]
    edge: float = 0.0
    index: float = 0.0
    lossless: bool = False
    below: float = 0.0
    dip: NDArray[np.float64] = field(default_factory=_black)
    beckmann: bool = False
    share: float = 1.0
    turn: float = 0.0

    @property
    def row(self) -> tuple[float, ...]:
        once = (*np.clip(self.reflectance, 0.0, 1.0), self.edge, *self.alpha, compat.masks_apart(), self.index)
        layer = (float(self.lossless), self.below, *np.clip(self.dip, 0.0, 1.0), float(self.beckmann))
        return (*once, *layer, self.share, self.turn)


@dataclass
class Surface:
    """How a material reflects, glows, and lets light straight through; of what it does, its share of the surface is taken."""

    albedo: NDArray[np.float64] = field(default_factory=_black)
    gloss: list[Gloss] = field(default_factory=list)  # from the top
    emission: NDArray[np.float64] = field(default_factory=_black)
    diffuse: tuple[int, float] = LAMBERT  # a native kind, and its roughness
    transmittance: NDArray[np.float64] = field(default_factory=_black)


def brushed(surfaces: list[Surface]) -> bool:
    """Whether gloss needs to know the direction of a surface's tangents."""
    return any(gloss.alpha[0] != gloss.alpha[1] for surface in surfaces for gloss in surface.gloss)


def rows_of_gloss(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """All layers of all surfaces, (k, n, 16); None where there are none."""
    most = max(len(surface.gloss) for surface in surfaces)
    if most == 0:
        return None
    rows = np.zeros((len(surfaces), most, 16))
    for row, surface in zip(rows, surfaces):
        for k, gloss in enumerate(surface.gloss):
            row[k] = gloss.row
    return rows


def transmittances(surfaces: list[Surface]) -> NDArray[np.float64] | None:
    """Of all surfaces, (k, 3); None where they are opaque."""
    rows = np.array([surface.transmittance for surface in surfaces])
    return rows if rows.any() else None


def diffuse_share(surface: Surface) -> float:
    """What the layers above a diffuse part that leave it nothing leave of the surface."""
    return math.prod(1.0 - layer.share for layer in surface.gloss if layer.below == LEAVES_NOTHING)


def diffuse_kinds(surfaces: list[Surface]) -> list[tuple[int, float]] | None:
    """None where all are Lambert's."""
    kinds = [surface.diffuse for surface in surfaces]
    return kinds if any(kind != LAMBERT for kind in kinds) else None


class Reader:
    """What a shader's inputs say, and what is to be said of it to the artist, under one owner's name."""

    def __init__(self, owner: str, notices: list[str]) -> None:
        self.owner, self.notices = owner, notices

    def say(self, words: str) -> None:
        self.notices.append(f"{self.owner}: {words}")

    def number(self, shader: Any, name: str, low: float = 0.0, high: float = 1.0, absent: float = 0.0) -> float:
        if name not in shader.inputs:
            return absent
        return float(np.clip(value_of(shader, name, self.owner, self.notices), low, high))

    def colour(self, shader: Any, name: str) -> NDArray[np.float64]:
        found: NDArray[np.float64] = np.maximum(value_of(shader, name, self.owner, self.notices), 0.0)
        return found

    def alpha(self, shader: Any, name: str) -> float:
        """The slope of facets of an artist's roughness; of the smoothest we show one that is still a lobe."""
        rough = self.number(shader, name)
        if rough < SMOOTHEST:
            self.say(f"its {name} of {rough:.3g} is shown as {SMOOTHEST}")
        return max(rough, SMOOTHEST) ** 2


def set_facets(gloss: Gloss, shader: Any, reader: Reader) -> None:
    """By the distribution of a shader."""
    kind = shader.distribution
    gloss.lossless, gloss.beckmann = compat.facets_are_lossless(shader), kind == "BECKMANN"
    if kind not in {"GGX", "BECKMANN"} and not gloss.lossless:
        name = shader.bl_rna.properties["distribution"].enum_items[kind].name
        reader.say(f"its gloss, {name}, is shown as GGX")


def index_of(reflectance: float) -> float:
    """The index of refraction that reflects so much of light from straight on."""
    root = math.sqrt(min(max(reflectance, 0.0), 0.99))
    return (1.0 + root) / (1.0 - root)


def reflectance_of(index: float) -> float:
    return ((index - 1.0) / (index + 1.0)) ** 2


def principled(shader: Any, reader: Reader) -> Surface:
    colour = np.clip(reader.colour(shader, "Base Color"), 0.0, 1.0)
    glow = reader.colour(shader, compat.emission_socket(shader))
    emission = glow * reader.number(shader, "Emission Strength", high=math.inf)
    alpha, anisotropy = reader.alpha(shader, "Roughness"), reader.number(shader, "Anisotropic")
    aspect = math.sqrt(1.0 - 0.9 * anisotropy)
    lobe = Gloss(_black(), (min(alpha / aspect, 1.0), alpha * aspect), edge=1.0)
    set_facets(lobe, shader, reader)
    if anisotropy > 0.0:
        lobe.turn = reader.number(shader, "Anisotropic Rotation")
    make = _layered if compat.principled_has_layers() else _of_one_gloss
    surface = make(shader, reader, colour, lobe)
    surface.emission = emission
    if emission.any() and Reader(reader.owner, []).number(shader, "Coat Weight") > 0.0:
        reader.say("its glow is as if it had no Coat")
    return _laid_beside(Surface(transmittance=np.ones(3)), surface, 1.0 - reader.number(shader, "Alpha"))


def _of_one_gloss(shader: Any, reader: Reader, colour: NDArray[np.float64], lobe: Gloss) -> Surface:
    """As before Blender 4.0."""
    metallic, plain = reader.number(shader, "Metallic"), 0.08 * reader.number(shader, "Specular")
    luminance = float(colour @ LUMINANCE)
    tint = colour / luminance if luminance > 0.0 else np.ones(3)
    tint = 1.0 + reader.number(shader, "Specular Tint") * (tint - 1.0)
    lobe.reflectance = (1.0 - metallic) * plain * tint + metallic * colour
    lobe.index = index_of(plain)
    seen = lobe.reflectance.max() > 0.0 or lobe.index > 1.0  # a black metal is seen at the edge
    rough = BURLEY, reader.number(shader, "Roughness")
    return Surface((1.0 - metallic) * colour, [lobe] if seen else [], diffuse=rough)


def _layered(shader: Any, reader: Reader, colour: NDArray[np.float64], lobe: Gloss) -> Surface:
    """As from Blender 4.0 on: coat, metal beside the rest, a dielectric layer, and what is diffuse."""
    tint, layers = reader.colour(shader, "Specular Tint"), _coat(shader, reader)
    metallic = reader.number(shader, "Metallic")
    if metallic > 0.0:
        before_edge = colour + (1.0 - colour) * (6.0 / 7.0) ** 5
        dip = before_edge * (1.0 - np.minimum(tint, 1.0))
        layers.append(replace(lobe, reflectance=colour, dip=dip, below=LEAVES_NOTHING, share=metallic))
    index = reader.number(shader, "IOR", 1e-5, 1000.0, absent=1.5)
    if index < 1.0:
        reader.say(f"its IOR of {index:.3g} is shown as {1.0 / index:.3g}")
    plain = min(2.0 * reader.number(shader, "Specular IOR Level") * reflectance_of(index), 1.0)
    if metallic < 1.0 and plain > 0.0:
        layers.append(replace(lobe, reflectance=plain * tint, index=index_of(plain), below=LEAVES_REST))
    rough = reader.number(shader, "Diffuse Roughness")
    return Surface(colour, layers, diffuse=(compat.grooves(), rough) if rough > 0.0 else LAMBERT)


def _coat(shader: Any, reader: Reader) -> list[Gloss]:
    share = reader.number(shader, "Coat Weight")
    index = max(reader.number(shader, "Coat IOR", high=1000.0), 1.0)
    if share <= 0.0 or index <= 1.0:
        return []
    tint = reader.colour(shader, "Coat Tint")
    if tint.min() < 1.0:
        reader.say(f"its Coat Tint of ({', '.join(f'{part:.3g}' for part in tint)}) is shown as white")
    alpha, plain = reader.alpha(shader, "Coat Roughness"), np.full(3, reflectance_of(index))
    return [Gloss(plain, (alpha, alpha), 1.0, index, below=LEAVES_REST, share=share)]


def glossy(shader: Any, reader: Reader) -> Surface:
    """A Glossy BSDF, which with anisotropy is a node of its own before Blender 4.0."""
    alpha = reader.alpha(shader, "Roughness")
    # Brushed across where it is positive: other slopes than those of a Principled BSDF.
    anisotropy = reader.number(shader, "Anisotropy", -0.99, 0.99)
    narrow, wide = alpha * (1.0 - abs(anisotropy)), min(alpha / (1.0 - abs(anisotropy)), 1.0)
    slopes = (narrow, wide) if anisotropy > 0.0 else (wide, narrow)
    gloss = Gloss(np.clip(reader.colour(shader, "Color"), 0.0, 1.0), slopes, below=LEAVES_NOTHING)
    if anisotropy != 0.0:
        gloss.turn = reader.number(shader, "Rotation", -math.inf, math.inf) % 1.0
    set_facets(gloss, shader, reader)
    return Surface(gloss=[gloss])


def mixed(shader: Any, reader: Reader, depth: int) -> Surface | None:
    """A Mix Shader of a constant factor as what lies beside, and so above, the rest; None where both have a diffuse
    part that the other's gloss would cover."""
    factor = linked_node(shader, 0)
    if factor is not None and factor.type != "VALUE":
        return None
    share = reader.number(shader, shader.inputs[0].name)
    first, second = (_behind(shader, k, reader, depth) for k in (1, 2))
    if first is None or second is None:
        return None
    for top, below, part in ((second, first, share), (first, second, 1.0 - share)):
        if part <= 0.0:
            return below
        if top.albedo.any() or len(top.gloss) > 1:
            continue
        return _laid_beside(top, below, part)
    if first.gloss or second.gloss or {first.diffuse, second.diffuse} != {LAMBERT}:
        return None
    both = _laid_beside(replace(second, albedo=_black()), first, share)
    return replace(both, albedo=both.albedo + share * second.albedo)


def _laid_beside(top: Surface, below: Surface, part: float) -> Surface:
    """What has, of a surface, a `part` like `top`, which has no diffuse part and at most one layer of gloss."""
    emission = part * top.emission + (1.0 - part) * below.emission
    transmittance = part * top.transmittance + (1.0 - part) * below.transmittance
    if not top.gloss and not below.gloss and below.diffuse == LAMBERT:
        return Surface((1.0 - part) * below.albedo, [], emission, LAMBERT, transmittance)
    if part <= 0.0:
        return below
    layers = [replace(layer, share=layer.share * part, below=LEAVES_NOTHING) for layer in top.gloss]
    left = part - sum(layer.share for layer in layers)
    if left > 1e-6:  # of the top, without gloss
        layers.append(Gloss(_black(), (1.0, 1.0), below=LEAVES_NOTHING, share=left / (1.0 - part + left)))
    return Surface(below.albedo, [*layers, *below.gloss], emission, below.diffuse, transmittance)


def added(shader: Any, reader: Reader, depth: int) -> Surface | None:
    """An Add Shader where one of both has no diffuse part, or both are Lambert's."""
    first, second = (_behind(shader, k, reader, depth) for k in (0, 1))
    if first is None or second is None:
        return None
    emission, transmittance = first.emission + second.emission, first.transmittance + second.transmittance
    for top, below in ((first, second), (second, first)):
        if not top.albedo.any() and len(top.gloss) < 2:
            return Surface(
                below.albedo,
                [*(replace(layer, below=0.0) for layer in top.gloss), *below.gloss],
                emission,
                below.diffuse,
                transmittance,
            )
    if first.gloss or second.gloss or {first.diffuse, second.diffuse} != {LAMBERT}:
        return None
    return Surface(first.albedo + second.albedo, [], emission, transmittance=transmittance)


def _behind(shader: Any, socket: int, reader: Reader, depth: int) -> Surface | None:
    source = linked_node(shader, socket)
    return Surface() if source is None else of_shader(source, reader, depth + 1)


def of_shader(shader: Any, reader: Reader, depth: int = 0) -> Surface | None:
    """What a shader node reflects; None where that is beyond us."""
    if shader.mute and not any(socket.type == "SHADER" for socket in shader.inputs):
        return Surface()
    omissions.of_node(shader, reader.owner, reader.notices)
    if shader.type == "BSDF_PRINCIPLED":
        return principled(shader, reader)
    if shader.type == "EMISSION":
        return Surface(emission=reader.colour(shader, "Color") * reader.number(shader, "Strength", high=math.inf))
    if shader.type == "BSDF_TRANSPARENT":
        return Surface(transmittance=reader.colour(shader, "Color"))
    if shader.type == "BSDF_DIFFUSE":
        rough = reader.number(shader, "Roughness")
        return Surface(reader.colour(shader, "Color"), diffuse=(compat.grooves(), rough) if rough > 0.0 else LAMBERT)
    if shader.type in {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}:
        return glossy(shader, reader)
    found = None
    if shader.type in {"MIX_SHADER", "ADD_SHADER"} and depth < MOST_LAYERS:
        found = (mixed if shader.type == "MIX_SHADER" else added)(shader, reader, depth)
    return found if found is not None and len(found.gloss) <= MOST_LAYERS else None


def surface_of(material: Any, owner: str, notices: list[str]) -> Surface | None:
    """What a material's surface reflects; None where it has no surface at all, as a volume's."""
    if material is None:
        return Surface(np.array(PLAIN_GREY))
    output = active_output(material)
    if output is None:
        return Surface(np.array(material.diffuse_color[:3]))
    omissions.of_node(output, owner, notices)
    shader = linked_node(output, "Surface")
    if shader is None:
        return None if output.inputs["Volume"].is_linked else Surface()
    said: list[str] = []
    surface = of_shader(shader, Reader(owner, said))
    if surface is not None:
        notices += said
        return _dimmed(surface, material, owner, notices)
    name = shader.bl_rna.name
    notices.append(f"{owner}: its shader {name} is shown as diffuse in the material's viewport color")
    return Surface(np.array(material.diffuse_color[:3]))


def _dimmed(surface: Surface, material: Any, owner: str, notices: list[str]) -> Surface:
    """What lets light through, and no more than there is."""
    through = surface.transmittance
    if through.max() > 1.0:
        shown = ", ".join(f"{part:.3g}" for part in np.minimum(through, 1.0))
        notices.append(
            f"{owner}: it makes light that passes through it brighter, which is not shown; it lets ({shown}) through"
        )
        surface = replace(surface, transmittance=np.minimum(through, 1.0))
    if through.any() and not compat.has_transparent_shadow(material):
        notices.append(f"{owner}: its Transparent Shadows, which are off, are shown as on")
    return surface


def surfaces(thing: Any, depsgraph: Any, notices: list[str]) -> list[Surface] | None:
    """One for each material slot, clear where it has only a volume; None for an object without any surface."""
    slots = materials_of(thing, depsgraph) or [None]
    found = [surface_of(material, thing.name, notices) for material in slots]
    if all(surface is None for surface in found):
        return None
    return [surface or Surface(transmittance=np.ones(3)) for surface in found]
