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
from .materials import active_output, materials_of
from .shading import fields, places
from .shading.fields import Field
from .shading.reading import Place, Reader, Source

PLAIN_GREY = (0.8, 0.8, 0.8)
MOST_LAYERS = 4
LEAVES_REST, LEAVES_NOTHING = 0.5, 1.0  # to what is below a layer of gloss
SMOOTHEST = 0.1  # roughness that lamps know
MIRROR = 0.01  # what surfaces are mirrored with
LAMBERT, BURLEY = 0, 1  # native kinds of what is diffuse
LUMINANCE = np.array((0.3, 0.6, 0.1))  # as Burley (2012) has it

_BLACK = fields.constant((0.0, 0.0, 0.0))
_WHITE = fields.constant((1.0, 1.0, 1.0))
_NONE = fields.constant(0.0)
_ALL = fields.constant(1.0)


@dataclass
class Layer:
    """A layer of gloss, as native Gloss has it."""

    reflectance: Field
    alpha: tuple[Field, Field]
    edge: float = 0.0
    index: Field = _NONE
    lossless: bool = False
    below: float = 0.0
    dip: Field = _BLACK
    beckmann: bool = False
    share: Field = _ALL
    turn: Field = _NONE


@dataclass
class Look:
    """How a material reflects, glows, and lets light straight through; of what it does, its share of the surface is taken.
    Any of it may differ from place to place."""

    albedo: Field = _BLACK
    layers: list[Layer] = field(default_factory=list)  # from the top
    emission: Field = _BLACK
    diffuse: int = LAMBERT
    roughness: Field = _NONE  # of what is diffuse
    transmittance: Field = _BLACK
    normal: Field | None = None


def _usual_black() -> NDArray[np.float64]:
    return np.zeros(3)


@dataclass
class Gloss:
    """What is usual of a layer of gloss."""

    reflectance: NDArray[np.float64]
    alpha: tuple[float, float]
    row: tuple[float, ...] = ()  # of native Gloss


# The slots of native patterns.
_ALBEDO, _EMISSION, _TRANSMITTANCE, _ROUGHNESS, _NORMAL, _FIRST_LAYER, _OF_LAYER = 0, 3, 6, 9, 10, 13, 11
_REFLECTANCE, _DIP, _ALPHA, _INDEX, _SHARE, _TURN = 0, 3, 6, 8, 9, 10


@dataclass
class Surface:
    """What is usual of a look; and by their slots in native patterns, the numbers that vary over the surface."""

    albedo: NDArray[np.float64] = field(default_factory=_usual_black)
    gloss: list[Gloss] = field(default_factory=list)  # from the top
    emission: NDArray[np.float64] = field(default_factory=_usual_black)
    diffuse: tuple[int, float] = (LAMBERT, 0.0)  # a native kind, and its roughness
    transmittance: NDArray[np.float64] = field(default_factory=_usual_black)
    varying: dict[int, Field] = field(default_factory=dict)

    @property
    def glows(self) -> bool:
        return bool(self.emission.any()) or _EMISSION in self.varying

    @property
    def lets_through(self) -> bool:
        return bool(self.transmittance.any()) or _TRANSMITTANCE in self.varying

    @property
    def brushed(self) -> bool:
        """Whether gloss needs to know the direction of the surface's tangents."""
        if any(gloss.alpha[0] != gloss.alpha[1] for gloss in self.gloss):
            return True
        firsts = (_FIRST_LAYER + k * _OF_LAYER + _ALPHA for k in range(len(self.gloss)))
        slopes = [[self.varying.get(first + axis) for axis in (0, 1)] for first in firsts]
        return any((a and a.digest) != (b and b.digest) for a, b in slopes)


def _settled(look: Look) -> Surface:
    out = Surface()

    def number(slot: int, value: Field, low: float, high: float) -> float:
        value = fields.clipped(value, low, high)
        if value.constant is None:
            out.varying[slot] = value
        return float(fields.usual(value)[0])

    def colour(slot: int, value: Field, high: float = 1.0) -> NDArray[np.float64]:
        value = fields.clipped(value, 0.0, high)
        if value.constant is None:
            out.varying |= {slot + k: part for k, part in enumerate(fields.of_parts(value))}
        return np.broadcast_to(fields.usual(value)[0], 3).copy()

    out.albedo = colour(_ALBEDO, look.albedo)
    out.emission = colour(_EMISSION, look.emission, 1e30)
    out.transmittance = colour(_TRANSMITTANCE, look.transmittance)
    out.diffuse = look.diffuse, number(_ROUGHNESS, look.roughness, 0.0, 1.0)
    for k, layer in enumerate(look.layers):
        first = _FIRST_LAYER + k * _OF_LAYER
        reflectance = colour(first + _REFLECTANCE, layer.reflectance)
        dip = colour(first + _DIP, layer.dip)
        alpha = tuple(number(first + _ALPHA + i, each, 1e-6, 1.0) for i, each in enumerate(layer.alpha))
        index = number(first + _INDEX, layer.index, 0.0, 1000.0)
        share, turn = number(first + _SHARE, layer.share, 0.0, 1.0), number(first + _TURN, layer.turn, 0.0, 1.0)
        once = (*reflectance, layer.edge, *alpha, compat.masks_apart(), index)
        rest = (float(layer.lossless), layer.below, *dip, float(layer.beckmann), share, turn)
        out.gloss.append(Gloss(reflectance, (alpha[0], alpha[1]), (*once, *rest)))
    if look.normal is not None:
        out.varying |= {_NORMAL + k: part for k, part in enumerate(fields.of_parts(look.normal))}
    return out


def brushed(surfaces: list[Surface]) -> bool:
    return any(surface.brushed for surface in surfaces)


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
    below, share = 9, 14
    return math.prod(1.0 - layer.row[share] for layer in surface.gloss if layer.row[below] == LEAVES_NOTHING)


def diffuse_kinds(surfaces: list[Surface]) -> list[tuple[int, float]] | None:
    """None where all are Lambert's."""
    kinds = [surface.diffuse for surface in surfaces]
    return kinds if any(kind != LAMBERT for kind, _ in kinds) else None


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


def principled(shader: Shader) -> Look:
    colour = fields.minimum(shader.colour("Base Color"), 1.0)
    glow = shader.colour(compat.emission_socket(shader.node))
    emission = glow * shader.number("Emission Strength", high=math.inf)
    alpha, anisotropy = shader.alpha("Roughness"), shader.number("Anisotropic")
    slopes = alpha, alpha
    if not anisotropy.always(0.0):
        aspect = fields.root(1.0 - 0.9 * anisotropy)
        slopes = fields.minimum(alpha / aspect, 1.0), alpha * aspect
    lobe = Layer(_BLACK, slopes, edge=1.0)
    set_facets(lobe, shader)
    if not anisotropy.always(0.0):
        lobe.turn = shader.number("Anisotropic Rotation")
    make = _layered if compat.principled_has_layers() else _of_one_gloss
    look = make(shader, colour, lobe)
    look.emission, look.normal = emission, shader.normal
    if not emission.always(0.0) and not shader.number("Coat Weight").always(0.0):
        shader.say("its glow is as if it had no Coat")
    return _laid_beside(Look(transmittance=_WHITE), look, 1.0 - shader.number("Alpha", absent=1.0))


def _of_one_gloss(shader: Shader, colour: Field, lobe: Layer) -> Look:
    """As before Blender 4.0."""
    metallic, plain = shader.number("Metallic"), 0.08 * shader.number("Specular")
    luminance = fields.of("weighted", colour, settings=(tuple(LUMINANCE),))
    of_colour = fields.of("over or one", colour, luminance)
    tint = 1.0 + shader.number("Specular Tint") * (of_colour - 1.0)
    lobe.reflectance = (1.0 - metallic) * (plain * tint) + metallic * colour
    lobe.index = index_of(plain)
    seen = not lobe.reflectance.always(0.0) or not lobe.index.always(1.0)  # a black metal is seen at the edge
    return Look((1.0 - metallic) * colour, [lobe] if seen else [], diffuse=BURLEY, roughness=shader.number("Roughness"))


def _layered(shader: Shader, colour: Field, lobe: Layer) -> Look:
    """As from Blender 4.0 on: coat, metal beside the rest, a dielectric layer, and what is diffuse."""
    tint, layers = shader.colour("Specular Tint"), _coat(shader)
    metallic = shader.number("Metallic")
    if not metallic.always(0.0):
        before_edge = colour + (1.0 - colour) * (6.0 / 7.0) ** 5
        dip = before_edge * (1.0 - fields.minimum(tint, 1.0))
        layers.append(replace(lobe, reflectance=colour, dip=dip, below=LEAVES_NOTHING, share=metallic))
    index = shader.number("IOR", 1e-5, 1000.0, absent=1.5)
    known = index.constant
    if known is not None and float(known[0]) < 1.0:
        shader.say(f"its IOR of {float(known[0]):.3g} is shown as {1.0 / float(known[0]):.3g}")
    plain = fields.minimum(2.0 * shader.number("Specular IOR Level") * reflectance_of(index), 1.0)
    if not metallic.always(1.0) and not plain.always(0.0):
        layers.append(replace(lobe, reflectance=plain * tint, index=index_of(plain), below=LEAVES_REST))
    return _rough(Look(colour, layers), shader.number("Diffuse Roughness"))


def _rough(look: Look, roughness: Field) -> Look:
    return look if roughness.always(0.0) else replace(look, diffuse=compat.grooves(), roughness=roughness)


def _coat(shader: Shader) -> list[Layer]:
    share = shader.number("Coat Weight")
    index = fields.maximum(shader.number("Coat IOR", high=1000.0), 1.0)
    if share.always(0.0) or index.always(1.0):
        return []
    tint = shader.colour("Coat Tint").constant
    if tint is None:
        shader.say("its Coat Tint is shown as white")
    elif tint.min() < 1.0:
        shader.say(f"its Coat Tint of ({', '.join(f'{part:.3g}' for part in tint[0])}) is shown as white")
    alpha, plain = shader.alpha("Coat Roughness"), fields.of("spread", reflectance_of(index))
    return [Layer(plain, (alpha, alpha), 1.0, index, below=LEAVES_REST, share=share)]


def glossy(shader: Shader) -> Look:
    """A Glossy BSDF, which with anisotropy is a node of its own before Blender 4.0."""
    alpha = shader.alpha("Roughness")
    # Brushed across where it is positive: other slopes than those of a Principled BSDF.
    anisotropy = shader.number("Anisotropy", -0.99, 0.99)
    slopes = alpha, alpha
    if not anisotropy.always(0.0):
        size = fields.of("math", anisotropy, settings=("ABSOLUTE",))
        narrow, wide = alpha * (1.0 - size), fields.minimum(alpha / (1.0 - size), 1.0)
        positive = fields.of("math", anisotropy, _NONE, settings=("GREATER_THAN",))
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
        return _with_normal(_laid_beside(top, below, part), first, second, shader)
    if _both_lambertian(first, second):
        both = _laid_beside(replace(second, albedo=_BLACK), first, share)
        return _with_normal(replace(both, albedo=both.albedo + share * second.albedo), first, second, shader)
    blended = _blended(first, second, share)
    if blended is not None:
        shader.say("where both shaders of its Mix Shader are seen, their gloss is one between the two")
        blended = _with_normal(blended, first, second, shader)
    return blended


def _blended(first: Look, second: Look, share: Field) -> Look | None:
    """Between two looks of the same kinds of layers: of each its inputs are mixed."""

    def kind(layer: Layer) -> tuple[Any, ...]:
        return layer.edge, layer.lossless, layer.below, layer.beckmann

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
            next((layer for layer in look.layers if kind(layer) == kind(each)), replace(each, share=_NONE))
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
    )  # fmt: skip


def _both_lambertian(first: Look, second: Look) -> bool:
    return not first.layers and not second.layers and {first.diffuse, second.diffuse} == {LAMBERT}


def _with_normal(look: Look, first: Look, second: Look, shader: Shader) -> Look:
    """Where both have one, the first's; a glow needs none."""
    bent = [each.normal for each in (first, second) if each.normal is not None]
    if len({normal.digest for normal in bent}) > 1 or (
        len(bent) == 1
        and any(each.normal is None and (each.layers or not each.albedo.always(0.0)) for each in (first, second))
    ):
        shader.say("all of its shaders have the Normal of the first that is linked")
    return replace(look, normal=bent[0] if bent else None)


def _laid_beside(top: Look, below: Look, part: Field) -> Look:
    """What has, of a surface, a `part` like `top`, which has no diffuse part and at most one layer of gloss."""
    if part.always(0.0):
        return below
    rest = 1.0 - part
    emission = part * top.emission + rest * below.emission
    transmittance = part * top.transmittance + rest * below.transmittance
    normal = below.normal or top.normal
    if not top.layers and not below.layers and below.diffuse == LAMBERT:
        return Look(rest * below.albedo, [], emission, transmittance=transmittance, normal=normal)
    layers = [replace(layer, share=layer.share * part, below=LEAVES_NOTHING) for layer in top.layers]
    left = part
    for layer in layers:
        left = left - layer.share
    known = left.constant
    if known is None or float(known[0]) > 1e-6:  # of the top, without gloss
        share = left / fields.maximum(1.0 - part + left, 1e-6)
        layers.append(Layer(_BLACK, (_ALL, _ALL), below=LEAVES_NOTHING, share=share))
    return Look(below.albedo, [*layers, *below.layers], emission, below.diffuse, below.roughness, transmittance, normal)


def added(shader: Shader, depth: int) -> Look | None:
    """An Add Shader where one of both has no diffuse part, or both are Lambert's."""
    first, second = (_behind(shader, k, depth) for k in (0, 1))
    if first is None or second is None:
        return None
    emission, transmittance = first.emission + second.emission, first.transmittance + second.transmittance
    for top, below in ((first, second), (second, first)):
        if top.albedo.always(0.0) and len(top.layers) < 2:
            layers = [*(replace(layer, below=0.0) for layer in top.layers), *below.layers]
            look = replace(below, layers=layers, emission=emission, transmittance=transmittance)
            return _with_normal(look, first, second, shader)
    if not _both_lambertian(first, second):
        return None
    both = Look(first.albedo + second.albedo, [], emission, transmittance=transmittance)
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
        return principled(shader)
    if node.type == "EMISSION":
        return Look(emission=shader.colour("Color") * shader.number("Strength", high=math.inf))
    if node.type == "BSDF_TRANSPARENT":
        return Look(transmittance=shader.colour("Color"))
    if node.type == "BSDF_DIFFUSE":
        return _rough(Look(shader.colour("Color"), normal=shader.normal), shader.number("Roughness"))
    if node.type in {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}:
        return glossy(shader)
    found = None
    if node.type in {"MIX_SHADER", "ADD_SHADER"} and depth < MOST_LAYERS:
        found = (mixed if node.type == "MIX_SHADER" else added)(shader, depth)
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
        surface = None if look is None else _settled(_dimmed(look, material, owner, said))
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
