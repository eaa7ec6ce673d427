# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds, which Geometry Nodes make of meshes in any Blender."""

from __future__ import annotations

from typing import Any

import bpy


def make_points_of(thing: Any, radius: float, material: bpy.types.Material | None, spread: float = 0.0) -> None:
    """Let an object's vertices be points of a radius and a material, in place of its faces; with a `spread`, instances of
    those at the corners of a cube that is so large."""
    tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    nodes, link = tree.nodes, tree.links.new
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    made, dressed = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeSetMaterial")
    made.inputs["Radius"].default_value, dressed.inputs["Material"].default_value = radius, material
    link(start.outputs[0], made.inputs[0])
    link(made.outputs[0], dressed.inputs[0])
    if spread:
        corners, instances = nodes.new("GeometryNodeMeshCube"), nodes.new("GeometryNodeInstanceOnPoints")
        corners.inputs["Size"].default_value = (spread,) * 3
        link(corners.outputs[0], instances.inputs["Points"])
        link(dressed.outputs[0], instances.inputs["Instance"])
        dressed = instances
    link(dressed.outputs[0], end.inputs[0])
    thing.modifiers.new("Points", "NODES").node_group = tree
