# SPDX-License-Identifier: GPL-3.0-or-later
"""Write fog.blend: a spot in a box of fog, the commonest of volumes, and a wheel before it that throws shafts.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_fog.py
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # what the samples share

LAMP, FOCUS = Vector((-2.4, 2.2, 3.0)), Vector((0.7, -0.1, 0.0))


def fog() -> None:
    """A box whose material has a volume alone. It goes into the floor: one that ends on it Cycles would count twice there."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 1.0, 1.7), scale=(7.0, 5.0, 3.6))
    box = make.named("Fog")
    made = bpy.data.materials.new("Fog")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    scatter, output = nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeOutputMaterial")
    scatter.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1.0)
    scatter.inputs["Density"].default_value = 0.12
    scatter.inputs["Anisotropy"].default_value = 0.3
    made.node_tree.links.new(scatter.outputs["Volume"], output.inputs["Volume"])
    box.data.materials.append(made)
    box.display_type = "WIRE"


def things() -> None:
    """A floor, a wheel of six spokes across the light, and what stands in it."""
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    make.named("Floor").data.materials.append(make.material("Floor", (0.2, 0.2, 0.22)))
    iron = make.material("Iron", (0.1, 0.1, 0.11))
    towards = FOCUS - LAMP
    turn = towards.to_track_quat("-Z", "Y").to_euler()
    place = LAMP + 0.32 * towards
    bpy.ops.mesh.primitive_torus_add(
        location=place, rotation=turn, major_radius=0.62, minor_radius=0.05, major_segments=64, minor_segments=16
    )
    make.named("Rim").data.materials.append(iron)
    for spoke in range(3):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=turn)
        bar = make.named("Spoke")
        bar.data.materials.append(iron)
        bar.scale = (1.24, 0.2, 0.05)
        bar.rotation_euler.rotate_axis("Z", math.pi * spoke / 3.0)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.42, location=(0.75, -0.15, 0.42))
    make.named("Ball").data.materials.append(make.material("Ball", (0.5, 0.16, 0.1)))
    bpy.ops.object.shade_smooth()


def lights() -> None:
    spot = bpy.data.lights.new("Spot", "SPOT")
    spot.energy, spot.shadow_soft_size, spot.color = 2500.0, 0.02, (1.0, 0.93, 0.82)
    spot.spot_size, spot.spot_blend = math.radians(46.0), 0.1
    make.add("Spot", spot, LAMP, (FOCUS - LAMP).to_track_quat("-Z", "Y").to_euler())


def view() -> None:
    make.look_at(Vector((-0.3, 0.9, 1.2)), Vector((1.2, -6.6, 1.5)), 32.0)
    scene = bpy.context.scene
    scene.view_settings.view_transform = "Filmic"
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 640, 400, 100
    render.image_settings.file_format = "PNG"
    render.filepath = "//out/fog"
    render.engine = "CYCLES"
    # What Sfumato computes: light that nothing passes on.
    scene.cycles.max_bounces = scene.cycles.volume_bounces = 0
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples = 256


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    fog()
    things()
    lights()
    view()
    make.save("fog")


if __name__ == "__main__":
    main()
