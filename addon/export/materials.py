# SPDX-License-Identifier: GPL-3.0-or-later
"""Node materials reduced to what is modelled: diffuse colours, cross-sections of smoke, a plain background."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat

# What a Principled BSDF may be besides what is shown; sockets have other names from Blender 4.0 on.
BEYOND = ("Transmission", "Transmission Weight", "Subsurface", "Subsurface Weight", "Sheen", "Sheen Weight", "Clearcoat",
          "Coat Weight")  # fmt: skip
PLAIN_GREY = (0.8, 0.8, 0.8)


def active_output(material: Any) -> Any | None:
    """The output node that renders, or None."""
    if material is None or not compat.uses_nodes(material) or material.node_tree is None:
        return None
    return material.node_tree.get_output_node("ALL") or material.node_tree.get_output_node("CYCLES")


def output_in(tree: Any, kind: str) -> Any | None:
    """The active output among the nodes of a light or a world, or None."""
    return next((node for node in tree.nodes if node.type == kind and node.is_active_output), None)


def linked_node(node: Any, socket: str) -> Any | None:
    """The node behind an input, reroutes followed, or None."""
    links = node.inputs[socket].links
    while links:
        source = links[0].from_node
        if source.type != "REROUTE":
            return source
        links = source.inputs[0].links
    return None


def value_of(node: Any, name: str, owner: str, notices: list[str]) -> Any:
    """The constant of an input, or of the node of one colour or value that is linked to it; of any other link it is noted
    that the input's own value is used."""
    socket = node.inputs[name]
    value = socket.default_value
    source = linked_node(node, name)
    if source is not None and not source.mute and source.type in {"VALUE", "RGB"}:
        constant = source.outputs[0].default_value
        if source.type == "RGB" and not isinstance(value, (int, float, str)):
            value = constant
        elif source.type == "VALUE":
            value = float(constant) if isinstance(value, (int, float)) else (float(constant),) * 3
        else:
            source = socket  # a colour for a number
    if source is not None and source.type not in {"VALUE", "RGB"}:
        notices.append(f"{owner}: the link into '{name}' is not followed yet; its own value is used")
    return value if isinstance(value, (int, float, str)) else np.array(value[:3], dtype=np.float64)


@dataclass
class Surface:
    """How a material reflects: diffusely, and as native Gloss."""

    albedo: NDArray[np.float64]
    reflectance: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    edge: float = 0.0
    index: float = 0.0
    alpha: tuple[float, float] = (0.0, 0.0)
    emission: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    diffuse_roughness: float = -1.0  # Lambert's
    lossless: bool = False
    cover: float = 0.0

    @property
    def gloss(self) -> tuple[float, ...]:
        once = (*np.clip(self.reflectance, 0.0, 1.0), self.edge, *self.alpha, compat.masks_apart(), self.index)
        return (*once, float(self.lossless), self.cover)


def alphas(roughness: float, anisotropy: float = 0.0) -> tuple[float, float]:
    """GGX's slopes as Cycles takes them; below a roughness of 0.1 we show what 0.1 looks like."""
    alpha = max(min(roughness, 1.0), 0.1) ** 2
    aspect = float(np.sqrt(1.0 - 0.9 * np.clip(anisotropy, 0.0, 1.0)))
    return min(alpha / aspect, 1.0), alpha * aspect


def index_of(reflectance: float) -> float:
    """The index of refraction that reflects so much of light from straight on."""
    root = math.sqrt(min(max(reflectance, 0.0), 0.99))
    return (1.0 + root) / (1.0 - root)


def principled(shader: Any, owner: str, notices: list[str]) -> Surface:
    """Base colour, metallic, roughness, specular and anisotropy of a Principled BSDF."""
    colour = np.clip(value_of(shader, "Base Color", owner, notices), 0.0, 1.0)
    metallic = float(np.clip(value_of(shader, "Metallic", owner, notices), 0.0, 1.0))
    plain = compat.reflectance(shader)
    if shader.inputs["Roughness"].is_linked or shader.inputs["Anisotropic"].is_linked:
        notices.append(f"{owner}: links into 'Roughness' and 'Anisotropic' are not followed yet")
    for name in BEYOND:
        if name in shader.inputs and value_of(shader, name, owner, []) > 0.0:
            notices.append(f"{owner}: '{name}' is not shown yet")
    reflectance = (1.0 - metallic) * plain + metallic * colour
    glow = value_of(shader, compat.emission_socket(shader), owner, notices)
    emission = np.maximum(glow * value_of(shader, "Emission Strength", owner, notices), 0.0)
    # One curve has to do for both layers: of those that differ, that of the one which there is more of.
    curved = metallic <= 0.5 or compat.metals_have_an_index()
    index = index_of(plain) if curved else 0.0
    rough = compat.diffuse_roughness(shader)
    surface = Surface((1.0 - metallic) * colour, reflectance, 1.0, index, emission=emission, diffuse_roughness=rough)
    if reflectance.max() <= 0.0 and surface.index == 1.0:  # not even at the edge, as a black metal does
        return Surface(surface.albedo, emission=emission, diffuse_roughness=rough)
    anisotropy = value_of(shader, "Anisotropic", owner, [])
    if anisotropy > 0.0 and value_of(shader, "Anisotropic Rotation", owner, []) > 0.0:
        notices.append(f"{owner}: 'Anisotropic Rotation' is not followed yet")
    surface.alpha = alphas(value_of(shader, "Roughness", owner, []), anisotropy)
    surface.lossless = compat.facets_are_lossless(shader)
    surface.cover = index_of(plain) if compat.gloss_covers() else 0.0
    return surface


def surface_of(material: Any, owner: str, notices: list[str]) -> Surface | None:
    """What a material's surface reflects; None where it has no surface at all, as a volume's."""
    if material is None:
        return Surface(np.array(PLAIN_GREY))
    output = active_output(material)
    if output is None:
        return Surface(np.array(material.diffuse_color[:3]))
    shader = linked_node(output, "Surface")
    if shader is None:
        return None if output.inputs["Volume"].is_linked else Surface(np.zeros(3))
    if shader.type == "BSDF_PRINCIPLED":
        return principled(shader, owner, notices)
    if shader.type == "EMISSION":
        radiance = value_of(shader, "Color", owner, notices) * value_of(shader, "Strength", owner, notices)
        return Surface(np.zeros(3), emission=np.maximum(radiance, 0.0))
    if shader.type == "BSDF_DIFFUSE":
        return Surface(value_of(shader, "Color", owner, notices))
    if shader.type in {"BSDF_GLOSSY", "BSDF_ANISOTROPIC"}:
        if shader.distribution not in {"GGX", "MULTI_GGX"}:
            notices.append(f"{owner}: its gloss is {shader.distribution.lower()}; it is shown as GGX")
        roughness = value_of(shader, "Roughness", owner, notices)
        anisotropy = shader.inputs.get("Anisotropy")
        twist = 0.0 if anisotropy is None else float(anisotropy.default_value)
        gloss = Surface(np.zeros(3), value_of(shader, "Color", owner, notices), alpha=alphas(roughness, twist))
        gloss.lossless = compat.facets_are_lossless(shader)
        return gloss
    notices.append(f"{owner}: the shader {shader.type.lower()} is shown as diffuse in the material's viewport colour")
    return Surface(np.array(material.diffuse_color[:3]))


def surfaces(thing: Any, notices: list[str]) -> list[Surface] | None:
    """One for each material slot; None for an object without any surface."""
    slots = [slot.material for slot in thing.material_slots] or [None]
    found = [surface_of(material, thing.name, notices) for material in slots]
    if all(surface is None for surface in found):
        return None
    return [surface or Surface(np.zeros(3)) for surface in found]


@dataclass
class Smoke:
    """What a material makes of smoke, per metre and unit density, the grid that it takes for its density, and the one, if
    any, by whose colours it multiplies what is scattered."""

    scattering: NDArray[np.float64]
    absorption: NDArray[np.float64]
    anisotropy: float = 0.0
    attribute: str = "density"
    tint: str = ""

    @property
    def extinction(self) -> NDArray[np.float64]:
        return self.scattering + self.absorption

    def divided_by(self, length: float) -> Smoke:
        return replace(self, scattering=self.scattering / length, absorption=self.absorption / length)


def smoke_of(thing: Any, notices: list[str]) -> Smoke | None:
    """How an object's smoke looks, as Cycles reads a Principled Volume; None where Cycles shows nothing."""
    found = [slot.material for slot in thing.material_slots if slot.material is not None]
    if thing.type == "VOLUME":
        if not found:
            return Smoke(np.full(3, 0.5), np.full(3, 0.5))  # a Principled Volume as it comes
        found = found[:1]
    for material in found:
        output = active_output(material)
        node = linked_node(output, "Volume") if output is not None else None
        if node is None or node.mute:
            continue
        if node.type == "PRINCIPLED_VOLUME":
            return _principled_smoke(node, thing.name, notices)
        notices.append(f"{thing.name}: its volume shader is {node.type.lower()}; only Principled Volume is shown")
        return _WHITE
    if thing.type == "VOLUME":
        return None
    notices.append(f"{thing.name}: no Principled Volume in its material; shown as white smoke of density 1")
    return _WHITE


_WHITE = Smoke(np.ones(3), np.zeros(3))


def _principled_smoke(node: Any, name: str, notices: list[str]) -> Smoke:
    attribute = value_of(node, "Density Attribute", name, notices)
    if value_of(node, "Emission Strength", name, []) > 0.0 or value_of(node, "Blackbody Intensity", name, []) > 0.0:
        notices.append(f"{name}: its emission is not shown yet")
    density = max(0.0, value_of(node, "Density", name, notices))
    colour = np.maximum(value_of(node, "Color", name, notices), 0.0)
    absorbed = np.maximum(value_of(node, "Absorption Color", name, notices), 0.0)
    absorption = density * np.maximum(1.0 - colour, 0.0) * np.maximum(1.0 - np.sqrt(absorbed), 0.0)
    tint = value_of(node, "Color Attribute", name, notices)
    if tint and (absorbed.any() or colour.max() > 1.0):
        which = "Absorption Color" if absorbed.any() else "Color above 1"
        notices.append(
            f"{name}: its {which} beside a Color Attribute; the smoke lets through what it would without that attribute"
        )
    anisotropy = float(np.clip(value_of(node, "Anisotropy", name, notices), -0.999, 0.999))
    return Smoke(density * colour, absorption, anisotropy, attribute, tint)


def background(scene: Any, notices: list[str]) -> NDArray[np.float64]:
    """The radiance of the world where it is one colour."""
    world = scene.world
    if world is None:
        return np.zeros(3)
    if not compat.uses_nodes(world) or world.node_tree is None:
        return np.array(world.color)
    output = output_in(world.node_tree, "OUTPUT_WORLD")
    shader = None if output is None else linked_node(output, "Surface")
    if shader is None:
        return np.zeros(3)
    if shader.type != "BACKGROUND":
        notices.append(f"World: the shader {shader.type.lower()} is not shown")
        return np.zeros(3)
    colour = value_of(shader, "Color", "World", notices)
    strength = value_of(shader, "Strength", "World", notices)
    radiance: NDArray[np.float64] = np.maximum(colour * strength, 0.0)
    if radiance.any():
        notices.append("World: shown as a backdrop; it lights nothing yet")
    return radiance
