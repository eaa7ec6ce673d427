# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds for tests and benchmarks."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray


def clouds(width: int = 256) -> NDArray[np.float32]:
    """An equirectangular picture (width / 2, width, 4) in linear colours: blue above, brown below, a bright window at
    one side, a band at the horizon, and spots, none of which is symmetric."""
    height = width // 2
    v = ((np.arange(height) + 0.5) / height)[:, None]
    u = ((np.arange(width) + 0.5) / width)[None]
    above = np.clip((v - 0.45) / 0.1, 0.0, 1.0)
    sky = np.array((0.3, 0.5, 0.9)) * (0.4 + 0.6 * v[..., None])
    ground = np.array((0.25, 0.18, 0.1)) * (1.0 + 0.0 * u[..., None])
    rgb = above[..., None] * sky + (1.0 - above[..., None]) * ground
    rgb = rgb * (1.0 + 0.4 * np.sin(6.0 * np.pi * u + 9.0 * v) * np.sin(4.0 * np.pi * v))[..., None]
    window = (abs(u - 0.3) < 0.04) & (abs(v - 0.62) < 0.05)
    rgb = np.where(window[..., None], np.array((6.0, 5.0, 4.0)), rgb)
    return np.concatenate((rgb, np.ones((height, width, 1))), axis=2).astype(np.float32)


def image(pixels: NDArray[np.float32], name: str = "Sky", *, floats: bool = True) -> bpy.types.Image:
    height, width = pixels.shape[:2]
    out = bpy.data.images.new(name, width, height, float_buffer=floats)
    out.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    out.update()
    return out


def world() -> tuple[bpy.types.NodeTree, bpy.types.Node]:
    """The nodes of the scene's, and its Background."""
    made = bpy.data.worlds.new("World")
    if hasattr(made, "use_nodes") and not made.use_nodes:
        made.use_nodes = True
    bpy.context.scene.world = made
    return made.node_tree, next(node for node in made.node_tree.nodes if node.type == "BACKGROUND")


def linked(kind: str, **settings: Any) -> bpy.types.Node:
    """A node that is the color of the world."""
    tree, background = world()
    node = tree.nodes.new(kind)
    for name, value in settings.items():
        setattr(node, name, value)
    tree.links.new(node.outputs[0], background.inputs["Color"])
    return node
