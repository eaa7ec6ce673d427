# SPDX-License-Identifier: GPL-3.0-or-later
"""Write room.blend: a room with a window, in the sun and the sky and what walls and floor send of them, a chrome pot and a
cup from which smoke rises.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_room.py
The smoke is frames/wisp.vdb, which make_frames.py writes.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # the materials and settings that the samples share
from make_textures import Graph  # noqa: E402

WIDE, DEEP, HIGH, THICK = 4.4, 3.8, 2.6, 0.2  # the room from its corner on, and its walls; metres
SILL, LINTEL, LEFT, RIGHT = 0.8, 2.2, 1.0, 2.6  # of the window, in the wall at x = WIDE: heights and depths


def boards() -> bpy.types.Material:
    graph = Graph("Boards")
    where = graph.node("Mapping", {"Vector": graph.node("TexCoord").outputs["Object"], "Scale": (1.0, 0.9, 1.0)})
    brick = graph.node("TexBrick", {"Vector": where.outputs[0], "Color1": (0.32, 0.17, 0.08, 1.0),
                                    "Color2": (0.22, 0.11, 0.05, 1.0), "Mortar": (0.04, 0.02, 0.01, 1.0), "Scale": 3.0,
                                    "Mortar Size": 0.006})  # fmt: skip
    grain = graph.node("TexNoise", {"Vector": where.outputs[0], "Scale": 25.0, "Detail": 3.0})
    mixed = graph.node("MixRGB", {"Color1": brick.outputs["Color"], "Color2": grain.outputs["Color"], "Fac": 0.3},
                       blend_type="MULTIPLY")  # fmt: skip
    graph.into("Base Color", mixed.outputs[0])
    graph.shader.inputs["Roughness"].default_value = 0.35
    return graph.material


def rug() -> bpy.types.Material:
    graph = Graph("Rug")
    checks = graph.node("TexChecker", {"Vector": graph.scaled("UV", 1.0), "Color1": (0.55, 0.08, 0.06, 1.0),
                                       "Color2": (0.7, 0.55, 0.35, 1.0), "Scale": 12.0})  # fmt: skip
    graph.into("Base Color", checks.outputs["Color"])
    graph.shader.inputs["Roughness"].default_value = 1.0
    graph.shader.inputs["Specular"].default_value = 0.0
    return graph.material


def plain(name: str, colour: make.Colour, roughness: float, metallic: float = 0.0) -> bpy.types.Material:
    graph = Graph(name)
    graph.shader.inputs["Base Color"].default_value = (*colour, 1.0)
    graph.shader.inputs["Roughness"].default_value = roughness
    graph.shader.inputs["Metallic"].default_value = metallic
    return graph.material


def block(name: str, low: make.Colour, high: make.Colour, material: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=[(a + b) / 2.0 for a, b in zip(low, high)])
    bpy.context.object.scale = [b - a for a, b in zip(low, high)]
    bpy.ops.object.transform_apply(location=False, rotation=False)
    make.named(name).data.materials.append(material)


def walls() -> None:
    cream, white = make.material("Cream", (0.72, 0.66, 0.55)), make.material("White", (0.8, 0.8, 0.8))
    green = make.material("Green", (0.2, 0.42, 0.25))
    block("Floor", (-THICK, -THICK, -THICK), (WIDE + THICK, DEEP + THICK, 0.0), boards())
    block("Ceiling", (-THICK, -THICK, HIGH), (WIDE + THICK, DEEP + THICK, HIGH + THICK), white)
    block("Back", (-THICK, DEEP, 0.0), (WIDE + THICK, DEEP + THICK, HIGH), cream)
    block("Front", (-THICK, -THICK, 0.0), (WIDE + THICK, 0.0, HIGH), cream)
    block("Left", (-THICK, 0.0, 0.0), (0.0, DEEP, HIGH), green)
    outside = WIDE + THICK
    block("Under Window", (WIDE, 0.0, 0.0), (outside, DEEP, SILL), cream)
    block("Over Window", (WIDE, 0.0, LINTEL), (outside, DEEP, HIGH), cream)
    block("Before Window", (WIDE, 0.0, SILL), (outside, LEFT, LINTEL), cream)
    block("Behind Window", (WIDE, RIGHT, SILL), (outside, DEEP, LINTEL), cream)
    frame = make.material("Frame", (0.75, 0.75, 0.72))
    middle = (LEFT + RIGHT) / 2.0
    block("Bar", (WIDE + 0.05, middle - 0.025, SILL), (WIDE + 0.1, middle + 0.025, LINTEL), frame)
    block("Cross Bar", (WIDE + 0.05, LEFT, 1.48), (WIDE + 0.1, RIGHT, 1.53), frame)


def things() -> None:
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(2.1, 1.9, 0.004))
    bpy.context.object.scale = (2.2, 1.6, 1.0)
    make.named("Rug").data.materials.append(rug())
    wood = plain("Wood", (0.28, 0.14, 0.06), 0.4)
    block("Table", (1.3, 2.2, 0.72), (2.9, 3.1, 0.77), wood)
    for number, (x, y) in enumerate(((1.36, 2.26), (2.78, 2.26), (1.36, 2.98), (2.78, 2.98))):
        block(f"Leg {number + 1}", (x, y, 0.0), (x + 0.06, y + 0.06, 0.72), wood)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.2, location=(1.75, 2.7, 0.97))
    bpy.ops.object.shade_smooth()
    make.named("Pot").data.materials.append(plain("Chrome", (0.9, 0.9, 0.9), 0.1, 1.0))
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=48, radius=0.09, depth=0.2, location=(2.35, 2.5, 0.87), end_fill_type="NOTHING"
    )
    bpy.ops.object.shade_smooth()
    make.named("Cup").data.materials.append(plain("China", (0.75, 0.78, 0.8), 0.25))


def smoke() -> None:
    data = bpy.data.volumes.new("Wisp")
    data.filepath = "//frames/wisp.vdb"
    made = make.smoke_material()
    made.node_tree.nodes["Principled Volume"].inputs["Density"].default_value = 60.0
    data.materials.append(made)
    wisp = make.add("Wisp", data, (2.35, 2.5, 0.78), Vector((0.0, 0.0, 0.0)))
    wisp.scale = (0.36, 0.36, 0.42)


def light_and_view() -> None:
    make.look_at(Vector((2.3, 2.6, 1.0)), Vector((0.75, 0.25, 1.55)), 24.0)
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    tree = world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sun_elevation, sky.sun_rotation = math.radians(28.0), math.radians(70.0)
    background = tree.nodes["Background"]
    background.inputs["Strength"].default_value = 0.25
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    bpy.context.scene.world = world


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    walls()
    things()
    smoke()
    light_and_view()
    make.output()
    scene = bpy.context.scene
    scene.sfumato.bounced_light = True
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 6, 4, 2
    scene.view_settings.exposure = 1.0
    scene.frame_end = 1
    scene.render.filepath = "//out/room"
    make.save("room")


if __name__ == "__main__":
    main()
