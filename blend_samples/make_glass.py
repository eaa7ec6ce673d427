# SPDX-License-Identifier: GPL-3.0-or-later
"""Write glass.blend: panes and a ring that let light through, through each other and through smoke, in a sun and a lamp.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_glass.py
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

FOCUS, CAMERA = Vector((0.05, 0.0, 0.5)), Vector((0.5, -4.4, 2.6))
AMBER, ROSE, TEAL = (0.95, 0.55, 0.15), (0.9, 0.25, 0.35), (0.15, 0.6, 0.65)


def glossy(name: str, colour: make.Colour, roughness: float) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*colour, 1.0)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return made


def film(name: str, colour: make.Colour, alpha: float) -> bpy.types.Material:
    """By the Alpha of a Principled BSDF: it lets all colours through alike."""
    made = glossy(name, colour, 0.5)
    made.node_tree.nodes["Principled BSDF"].inputs["Alpha"].default_value = alpha
    return made


def stained(name: str, colour: make.Colour, share: float) -> bpy.types.Material:
    """By a Transparent BSDF, which has a colour, mixed with some gloss."""
    made = glossy(name, (0.6, 0.6, 0.6), 0.25)
    made.diffuse_color = (*colour, 1.0)
    tree = made.node_tree
    clear, both = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeMixShader")
    clear.inputs["Color"].default_value = (*colour, 1.0)
    both.inputs["Fac"].default_value = share
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], both.inputs[1])
    tree.links.new(clear.outputs[0], both.inputs[2])
    tree.links.new(both.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return made


def pane(
    name: str, place: tuple[float, float, float], turn: tuple[float, float, float], made: bpy.types.Material
) -> None:
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=place, rotation=[math.radians(angle) for angle in turn])
    make.named(name).data.materials.append(made)


def things() -> None:
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    make.named("Floor").data.materials.append(make.material("Floor", (0.55, 0.52, 0.48)))
    # Two that cross each other, and a third through both.
    pane("Amber", (-0.75, 0.1, 0.55), (78.0, 0.0, 35.0), stained("Amber", AMBER, 0.75))
    pane("Teal", (-0.75, 0.1, 0.55), (78.0, 0.0, -35.0), stained("Teal", TEAL, 0.75))
    pane("Film", (-0.75, 0.1, 0.5), (25.0, 0.0, 0.0), film("Film", (0.8, 0.8, 0.85), 0.35))
    # Before the smoke, in it, and behind it.
    for number, y in enumerate((-0.45, 0.0, 0.45)):
        pane(
            f"Rose {number + 1}",
            (0.7 + 0.12 * number, y, 0.55),
            (90.0, 0.0, 8.0),
            film(f"Rose {number + 1}", ROSE, 0.3),
        )
    bpy.ops.mesh.primitive_torus_add(
        location=(0.75, 0.0, 0.55), rotation=(1.2, 0.3, 0.0), major_radius=0.42, minor_radius=0.07
    )
    make.named("Ring").data.materials.append(stained("Ring", (0.55, 0.75, 0.95), 0.8))
    bpy.ops.object.shade_smooth()


def smoke() -> None:
    data = bpy.data.volumes.new("Wisp")
    data.filepath = "//frames/wisp.vdb"
    made = make.smoke_material()
    made.node_tree.nodes["Principled Volume"].inputs["Density"].default_value = 30.0
    data.materials.append(made)
    wisp = make.add("Wisp", data, (-0.06, -0.81, 0.0), Vector((0.0, 0.0, 0.0)))  # its middle is at 1.5 times its scale
    wisp.scale = (0.55, 0.55, 0.55)


def light_and_view() -> None:
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle, sun.color = 3.0, math.radians(1.0), (1.0, 0.93, 0.82)
    make.add("Sun", sun, (0.0, 0.0, 4.0), Vector((math.radians(38.0), math.radians(-34.0), 0.0)))
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size, lamp.color = 60.0, 0.4, (0.7, 0.82, 1.0)
    place = Vector((1.9, 1.6, 2.2))
    make.add("Lamp", lamp, place, (FOCUS - place).to_track_quat("-Z", "Y").to_euler())
    make.look_at(FOCUS, CAMERA, 50.0)


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things()
    smoke()
    light_and_view()
    make.output()
    bpy.context.scene.frame_end = 1
    bpy.context.scene.render.filepath = "//out/glass"
    make.save("glass")


if __name__ == "__main__":
    main()
