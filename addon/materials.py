# SPDX-License-Identifier: GPL-3.0-or-later
"""Node materials reduced to what is modelled: diffuse colours, cross-sections of smoke, a plain background."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import compat

COLOUR_SOCKETS = {"BSDF_DIFFUSE": "Color", "BSDF_PRINCIPLED": "Base Color"}
# What a Principled BSDF may be besides diffuse; two of these are one, by the names of before and after 4.0.
BEYOND_DIFFUSE = ("Metallic", "Transmission", "Transmission Weight")
PLAIN_GREY = (0.8, 0.8, 0.8)


def active_output(material: Any) -> Any | None:
    """The output node that renders, or None."""
    if material is None or not compat.uses_nodes(material) or material.node_tree is None:
        return None
    return material.node_tree.get_output_node("ALL") or material.node_tree.get_output_node("CYCLES")


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
    """The constant of an input; a link is noted and its default used."""
    socket = node.inputs[name]
    if socket.is_linked:
        notices.append(f"{owner}: the link into '{name}' is not followed yet; its own value is used")
    value = socket.default_value
    return value if isinstance(value, (int, float, str)) else np.array(value[:3], dtype=np.float64)


def surface_colour(material: Any, owner: str, notices: list[str]) -> NDArray[np.float64] | None:
    """The diffuse colour of a material; None where it has no surface at all, as a volume's."""
    if material is None:
        return np.array(PLAIN_GREY)
    output = active_output(material)
    if output is None:
        return np.array(material.diffuse_color[:3])
    shader = linked_node(output, "Surface")
    if shader is None:
        return None if output.inputs["Volume"].is_linked else np.zeros(3)
    name = COLOUR_SOCKETS.get(shader.type)
    if name is None:
        notices.append(
            f"{owner}: the shader {shader.type.lower()} is shown as diffuse in the material's viewport colour"
        )
        return np.array(material.diffuse_color[:3])
    for other in BEYOND_DIFFUSE:
        if other in shader.inputs and value_of(shader, other, owner, []) > 0.0:
            notices.append(f"{owner}: '{other}' of {material.name} is not shown yet; it is drawn as diffuse")
    colour: NDArray[np.float64] = value_of(shader, name, owner, notices)
    return colour


def albedos(thing: Any, notices: list[str]) -> NDArray[np.float64] | None:
    """One diffuse colour for each material slot, (slots, 3); None for an object without any surface."""
    slots = [slot.material for slot in thing.material_slots] or [None]
    colours = [surface_colour(material, thing.name, notices) for material in slots]
    if all(colour is None for colour in colours):
        return None
    return np.clip([np.zeros(3) if colour is None else colour for colour in colours], 0.0, 1.0)


def cross_sections(thing: Any, notices: list[str]) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Scattering and absorption per metre and unit density, and anisotropy: as Cycles reads a Principled Volume."""
    for slot in thing.material_slots:
        output = active_output(slot.material)
        node = linked_node(output, "Volume") if output is not None else None
        if node is None:
            continue
        if node.type != "PRINCIPLED_VOLUME":
            notices.append(f"{thing.name}: its volume shader is {node.type.lower()}; only Principled Volume is shown")
            continue
        name = thing.name
        attribute = value_of(node, "Density Attribute", name, notices)
        if attribute != "density":
            notices.append(f"{name}: Density Attribute is '{attribute}'; only 'density' is shown")
        if value_of(node, "Emission Strength", name, []) > 0.0 or value_of(node, "Blackbody Intensity", name, []) > 0.0:
            notices.append(f"{name}: its emission is not shown yet")
        density = max(0.0, value_of(node, "Density", name, notices))
        colour = np.maximum(value_of(node, "Color", name, notices), 0.0)
        tint = np.maximum(value_of(node, "Absorption Color", name, notices), 0.0)
        absorption = density * np.maximum(1.0 - colour, 0.0) * np.maximum(1.0 - np.sqrt(tint), 0.0)
        anisotropy = float(np.clip(value_of(node, "Anisotropy", name, notices), -0.999, 0.999))
        return density * colour, absorption, anisotropy
    notices.append(f"{thing.name}: no Principled Volume in its material; shown as white smoke of density 1")
    return np.ones(3), np.zeros(3), 0.0


def background(scene: Any, notices: list[str]) -> NDArray[np.float64]:
    """The radiance of the world where it is one colour."""
    world = scene.world
    if world is None:
        return np.zeros(3)
    if not compat.uses_nodes(world) or world.node_tree is None:
        return np.array(world.color)
    for node in world.node_tree.nodes:
        if node.type == "OUTPUT_WORLD" and node.is_active_output:
            shader = linked_node(node, "Surface")
            if shader is None:
                return np.zeros(3)
            if shader.type == "BACKGROUND":
                colour = value_of(shader, "Color", "World", notices)
                strength = value_of(shader, "Strength", "World", notices)
                radiance: NDArray[np.float64] = np.maximum(colour * strength, 0.0)
                if radiance.any():
                    notices.append("World: shown as a backdrop; it lights nothing yet")
                return radiance
            notices.append(f"World: the shader {shader.type.lower()} is not shown")
    return np.zeros(3)
