# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes, and what is read of them besides surfaces and volumes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat


def active_output(material: Any) -> Any | None:
    """The output node that renders, or None."""
    if material is None or not compat.uses_nodes(material) or material.node_tree is None:
        return None
    return material.node_tree.get_output_node("ALL") or material.node_tree.get_output_node("CYCLES")


def output_in(tree: Any, kind: str) -> Any | None:
    """The active output among the nodes of a light or a world, or None."""
    return next((node for node in tree.nodes if node.type == kind and node.is_active_output), None)


def input_of(node: Any, name: str) -> Any:
    """An input by its name; also one that its node does not use as it is set, which 4.2 to 5.0 hide from such a search.

    Raises KeyError where there is none.
    """
    found = node.inputs.get(name) or next((socket for socket in node.inputs if socket.name == name), None)
    if found is None:
        raise KeyError(name)
    return found


def linked_node(node: Any, socket: str | int) -> Any | None:
    """The node behind an input, by its name or place, reroutes followed, or None."""
    links = (input_of(node, socket) if isinstance(socket, str) else node.inputs[socket]).links
    while links:
        source = links[0].from_node
        if source.type != "REROUTE":
            return source
        links = source.inputs[0].links
    return None


def value_of(node: Any, name: str, owner: str, notices: list[str]) -> Any:
    """The constant of an input, or of the node of one colour or value that is linked to it; of any other link it is noted
    that the input's own value is used."""
    socket = input_of(node, name)
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
        notices.append(f"{owner}: the link into '{name}' is not followed; its own value is used")
    return value if isinstance(value, (int, float, str)) else np.array(value[:3], dtype=np.float64)


def materials_of(thing: Any, depsgraph: Any) -> list[Any]:
    """Those of an object's slots; or in each of them, or for want of slots, the one that the view layer overrides all by."""
    override = depsgraph.view_layer_eval.material_override
    slots = [slot.material for slot in thing.material_slots]
    return slots if override is None else [override] * max(len(slots), 1)


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


def world_of(depsgraph: Any) -> Any | None:
    """The scene's, or the view layer's own, which it may have since 4.3."""
    return getattr(depsgraph.view_layer_eval, "world_override", None) or depsgraph.scene_eval.world
