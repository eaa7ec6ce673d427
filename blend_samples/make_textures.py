# SPDX-License-Identifier: GPL-3.0-or-later
"""Write textures.blend: a brick wall, a tiled floor, rusty metal, a normal-mapped ball, leaves cut out by their alpha, and
smoke, in a sun and a lamp.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_textures.py
The smoke is frames/wisp.vdb, which make_frames.py writes.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # the materials and settings that the samples share

FOCUS, CAMERA = Vector((0.0, 0.2, 0.55)), Vector((0.6, -4.6, 2.1))


class Graph:
    """The nodes of a new material around its Principled BSDF."""

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.shader = self.tree.nodes["Principled BSDF"]

    def node(self, kind: str, inputs: dict[Any, Any] | None = None, **settings: Any) -> Any:
        made = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(made, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, made.inputs[name])
            else:
                made.inputs[name].default_value = value
        return made

    def into(self, name: str, output: Any) -> None:
        self.tree.links.new(output, self.shader.inputs[name])

    def ramp(self, output: Any, *stops: tuple[float, tuple[float, float, float]]) -> Any:
        node = self.node("ValToRGB", {"Fac": output})
        while len(node.color_ramp.elements) < len(stops):
            node.color_ramp.elements.new(0.5)
        for element, (position, colour) in zip(node.color_ramp.elements, stops):
            element.position, element.color = position, (*colour, 1.0)
        return node.outputs["Color"]

    def scaled(self, which: str, scale: float) -> Any:
        places = self.node("TexCoord").outputs[which]
        return self.node("Mapping", {"Vector": places, "Scale": (scale, scale, scale)}).outputs[0]


def image(name: str, rgba: np.ndarray) -> bpy.types.Image:
    """Of bytes, packed into the file."""
    height, width = rgba.shape[:2]
    made = bpy.data.images.new(name, width, height, alpha=True)
    made.pixels.foreach_set(np.ascontiguousarray(rgba, np.float32).ravel())
    made.update()
    made.pack()
    return made


def tiles() -> bpy.types.Material:
    graph = Graph("Tiles")
    v, u = np.mgrid[0:128, 0:128] / 128.0
    joint = (np.minimum(u % 0.5, v % 0.5) < 0.02)[..., None]
    shade = np.where(((u < 0.5) == (v < 0.5))[..., None], (0.75, 0.7, 0.6), (0.25, 0.3, 0.35))
    veins = 0.08 * np.sin(40.0 * u + 12.0 * np.sin(9.0 * v))[..., None]
    rgb = np.where(joint, 0.12, np.clip(shade + veins, 0.0, 1.0))
    texture = graph.node("TexImage", {"Vector": graph.scaled("UV", 12.0)})
    texture.image = image("Tiles", np.concatenate((rgb, np.ones((128, 128, 1))), axis=2))
    graph.into("Base Color", texture.outputs["Color"])
    noise = graph.node("TexNoise", {"Vector": graph.scaled("Object", 1.5), "Detail": 3.0})
    graph.into("Roughness", graph.ramp(noise.outputs[0], (0.35, (0.25, 0.25, 0.25)), (0.65, (0.6, 0.6, 0.6))))
    return graph.material


def bricks() -> bpy.types.Material:
    graph = Graph("Bricks")
    where = graph.scaled("UV", 6.0)
    brick = graph.node("TexBrick", {"Vector": where, "Color1": (0.45, 0.13, 0.07, 1.0), "Color2": (0.3, 0.1, 0.08, 1.0),
                                    "Mortar": (0.5, 0.48, 0.44, 1.0), "Scale": 3.0})  # fmt: skip
    grain = graph.node("TexNoise", {"Vector": where, "Scale": 30.0, "Detail": 4.0})
    mixed = graph.node("MixRGB", {"Color1": brick.outputs["Color"], "Color2": grain.outputs["Color"], "Fac": 0.25},
                       blend_type="MULTIPLY")  # fmt: skip
    graph.into("Base Color", mixed.outputs[0])
    height = graph.node("Math", {0: 1.0}, operation="SUBTRACT")
    graph.tree.links.new(brick.outputs["Fac"], height.inputs[1])
    bump = graph.node("Bump", {"Height": height.outputs[0], "Distance": 0.03})
    graph.into("Normal", bump.outputs[0])
    graph.shader.inputs["Roughness"].default_value = 0.9
    return graph.material


def rust() -> bpy.types.Material:
    graph = Graph("Rust")
    noise = graph.node("TexNoise", {"Vector": graph.scaled("Object", 1.0), "Scale": 2.5, "Detail": 6.0})
    graph.into("Base Color", graph.ramp(noise.outputs[0], (0.45, (0.75, 0.72, 0.68)), (0.55, (0.35, 0.12, 0.04))))
    graph.into("Metallic", graph.ramp(noise.outputs[0], (0.47, (1.0, 1.0, 1.0)), (0.53, (0.0, 0.0, 0.0))))
    graph.into("Roughness", graph.ramp(noise.outputs[0], (0.45, (0.25, 0.25, 0.25)), (0.55, (0.9, 0.9, 0.9))))
    return graph.material


def hammered() -> bpy.types.Material:
    graph = Graph("Hammered")
    cells = graph.node("TexVoronoi", {"Vector": graph.scaled("Object", 1.0), "Scale": 9.0}, feature="SMOOTH_F1")
    graph.into("Normal", graph.node("Bump", {"Height": cells.outputs["Distance"], "Distance": 0.05}).outputs[0])
    graph.shader.inputs["Base Color"].default_value = (0.9, 0.6, 0.25, 1.0)
    graph.shader.inputs["Metallic"].default_value = 1.0
    graph.shader.inputs["Roughness"].default_value = 0.3
    return graph.material


def leaf() -> bpy.types.Material:
    graph = Graph("Leaf")
    v, u = np.mgrid[0:128, 0:128] / 64.0 - 1.0
    inside = (np.abs(u) < 0.55 * np.sqrt(np.clip(1.0 - v * v, 0.0, 1.0)) * (0.8 + 0.2 * np.cos(18.0 * v)))[..., None]
    vein = (np.minimum(np.abs(u), np.abs((np.abs(u) + v) % 0.35 - 0.17)) < 0.02)[..., None]
    rgb = np.where(vein, (0.45, 0.6, 0.25), (0.16, 0.38, 0.08)) + 0.0 * inside
    texture = graph.node("TexImage", extension="CLIP")
    texture.image = image("Leaf", np.concatenate((rgb, inside * 1.0), axis=2))
    graph.into("Base Color", texture.outputs["Color"])
    graph.into("Alpha", texture.outputs["Alpha"])
    return graph.material


def things() -> None:
    bpy.ops.mesh.primitive_plane_add(size=12.0)
    make.named("Floor").data.materials.append(tiles())
    bpy.ops.mesh.primitive_plane_add(size=6.0, location=(0.0, 1.6, 0.0), rotation=(math.radians(90.0), 0.0, 0.0))
    make.named("Wall").data.materials.append(bricks())
    bpy.ops.mesh.primitive_monkey_add(size=1.1, location=(-1.05, 0.1, 0.52), rotation=(-0.35, 0.0, 0.35))
    bpy.ops.object.shade_smooth()
    monkey = make.named("Monkey")
    monkey.modifiers.new("Fine", "SUBSURF").render_levels = 2
    monkey.modifiers["Fine"].levels = 2
    monkey.data.materials.append(rust())
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.38, location=(1.25, -0.35, 0.38))
    bpy.ops.object.shade_smooth()
    make.named("Ball").data.materials.append(hammered())
    green = leaf()
    for number in range(9):
        turn = 2.4 * number
        place = (1.25 + 0.32 * math.cos(turn), 0.75 + 0.22 * math.sin(turn), 0.75 + 0.09 * number)
        bpy.ops.mesh.primitive_plane_add(size=0.5, location=place, rotation=(0.9 + 0.1 * number, 0.4, turn))
        make.named(f"Leaf {number + 1}").data.materials.append(green)


def smoke() -> None:
    data = bpy.data.volumes.new("Wisp")
    data.filepath = "//frames/wisp.vdb"
    made = make.smoke_material()
    made.node_tree.nodes["Principled Volume"].inputs["Density"].default_value = 25.0
    data.materials.append(made)
    wisp = make.add("Wisp", data, (-0.75, -0.9, 0.0), Vector((0.0, 0.0, 0.0)))  # its middle is at 1.5 times its scale
    wisp.scale = (0.6, 0.6, 0.6)


def light_and_view() -> None:
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 3.0, math.radians(1.0), (1.0, 0.93, 0.82)
    make.add("Sun", sun, (0.0, 0.0, 4.0), Vector((math.radians(42.0), math.radians(-30.0), 0.0)))
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size, lamp.color = 70.0, 0.6, (0.7, 0.82, 1.0)
    place = Vector((2.2, -1.8, 2.6))
    make.add("Lamp", lamp, place, (FOCUS - place).to_track_quat("-Z", "Y").to_euler())
    make.look_at(FOCUS, CAMERA, 42.0)


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things()
    smoke()
    light_and_view()
    make.output()
    bpy.context.scene.frame_end = 1
    bpy.context.scene.render.filepath = "//out/textures"
    make.save("textures")


if __name__ == "__main__":
    main()
