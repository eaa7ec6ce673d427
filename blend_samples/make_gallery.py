# SPDX-License-Identifier: GPL-3.0-or-later
"""Write gallery.blend: lamps of every shape and meshes that shine, over balls and plates from mirror-like to dull, with
smoke before one lamp.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_gallery.py
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
import make  # noqa: E402 # the materials and settings that both samples share

ROUGHNESS = (0.1, 0.25, 0.4, 0.6, 1.0)
PLATES = (0.1, 0.2, 0.3, 0.45)
COPPER, GOLD, STEEL = (0.93, 0.5, 0.36), (0.95, 0.72, 0.35), (0.1, 0.1, 0.105)
VARNISH = (0.05, 0.16, 0.3)
FOCUS = Vector((0.0, 0.2, 0.35))
CAMERA = Vector((0.0, -6.4, 2.9))
LAMPS = Vector((0.0, 4.2, 3.6))


def glossy(name: str, colour: make.Colour, roughness: float, metal: bool, brushed: float = 0.0) -> bpy.types.Material:
    """Metal, or a coloured dielectric; `brushed` is the anisotropy."""
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*colour, 1.0)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Metallic"].default_value = float(metal)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Anisotropic"].default_value = brushed
    return made


def ball(name: str, x: float, y: float, made: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.3, location=(x, y, 0.3))
    make.named(name).data.materials.append(made)
    bpy.ops.object.shade_smooth()


def things() -> None:
    bpy.ops.mesh.primitive_plane_add(size=80.0)
    make.named("Floor").data.materials.append(glossy("Floor", (0.16, 0.16, 0.17), 0.45, metal=False))
    for i, roughness in enumerate(ROUGHNESS):
        x = -1.6 + 0.8 * i
        ball(f"Metal {roughness:g}", x, 0.1, glossy(f"Copper {roughness:g}", COPPER, roughness, metal=True))
        ball(f"Varnish {roughness:g}", x, -0.9, glossy(f"Varnish {roughness:g}", VARNISH, roughness, metal=False))
    ball("Brushed", 2.4, -0.4, glossy("Brushed", GOLD, 0.4, metal=True, brushed=0.8))
    ball("Chalk", -2.4, 0.1, make.material("Chalk", (0.7, 0.66, 0.6)))
    # Each plate mirrors the lamps into the camera, as those of Veach and Guibas (1995) do.
    for i, roughness in enumerate(PLATES):
        place = Vector((0.0, 1.0 + 0.5 * i, 0.14 + 0.3 * i))
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, scale=(4.6, 0.42, 0.03))
        plate = make.named(f"Plate {roughness:g}")
        normal = (CAMERA - place).normalized() + (LAMPS - place).normalized()
        plate.rotation_euler = (math.atan2(-normal.y, normal.z), 0.0, 0.0)
        plate.data.materials.append(glossy(f"Steel {roughness:g}", STEEL, roughness, metal=True))


def lamp(name: str, shape: str, x: float, size: tuple[float, float], watts: float, colour: make.Colour) -> None:
    light = bpy.data.lights.new(name, "AREA")
    light.shape, light.energy, light.color = shape, watts, colour
    light.size, light.size_y = size
    place = Vector((x, LAMPS.y, LAMPS.z))
    make.add(name, light, place, (FOCUS - place).to_track_quat("-Z", "Y").to_euler())


def lamps() -> None:
    lamp("Square", "SQUARE", -2.3, (0.55, 0.55), 40.0, (1.0, 0.75, 0.5))
    lamp("Rectangle", "RECTANGLE", -0.8, (0.3, 1.1), 40.0, (0.55, 1.0, 0.6))
    lamp("Disk", "DISK", 0.75, (0.7, 0.7), 40.0, (1.0, 0.5, 0.55))
    lamp("Ellipse", "ELLIPSE", 2.3, (1.1, 0.45), 40.0, (0.5, 0.7, 1.0))
    sphere = bpy.data.lights.new("Sphere", "POINT")
    sphere.energy, sphere.shadow_soft_size = 160.0, 0.25
    make.add("Sphere", sphere, (-3.4, -2.8, 2.6), Vector((0.0, 0.0, 0.0)))


def glowing(name: str, colour: make.Colour, strength: float) -> None:
    """The active object shines."""
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*colour, 1.0)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["Specular"].default_value = 0.0
    shader.inputs["Emission"].default_value = (*colour, 1.0)
    shader.inputs["Emission Strength"].default_value = strength
    make.named(name).data.materials.append(made)


def meshes_that_shine() -> None:
    """A cube among the balls, and a triangle on its edge."""
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(1.2, -1.62, 0.1), rotation=(0.0, 0.0, 0.5))
    glowing("Ember", (1.0, 0.3, 0.08), 5.0)
    place, turn = (-1.25, -1.62, 0.1), (math.radians(80.0), 0.0, -0.5)
    bpy.ops.mesh.primitive_circle_add(vertices=3, radius=0.2, fill_type="NGON", location=place, rotation=turn)
    glowing("Sign", (0.1, 0.9, 0.7), 4.0)


def smoke() -> None:
    """A thread that drifts across the light of the sphere."""
    data = bpy.data.volumes.new("Wisp")
    data.filepath = "//frames/wisp.vdb"
    made = make.smoke_material()
    made.node_tree.nodes["Principled Volume"].inputs["Density"].default_value = 20.0
    data.materials.append(made)
    wisp = make.add("Wisp", data, (-2.35, -1.3, 0.0), Vector((0.0, 0.0, 0.6)))
    wisp.scale = (0.75, 0.75, 0.75)


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things()
    lamps()
    meshes_that_shine()
    smoke()
    make.look_at(FOCUS, CAMERA, 40.0)
    make.output()
    bpy.context.scene.frame_end = 1
    bpy.context.scene.render.filepath = "//out/gallery"
    make.save("gallery")


if __name__ == "__main__":
    main()
