# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the heavy scenes, made from the sample's plume."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import bpy
from mathutils import Vector

PLUME = Path(__file__).resolve().parents[2] / "blend_samples" / "plume.blend"
STILL_FRAME = 25
SMALL, LARGE = (64, 36), (640, 360)  # pixels
PITCH = 1.0  # metres between copies


def set_size(size: tuple[int, int]) -> None:
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100


def open_empty() -> None:
    """Nothing but a camera."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    set_size(SMALL)


def open_plume(size: tuple[int, int] = SMALL) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(PLUME))
    bpy.context.scene.frame_set(STILL_FRAME)
    set_size(size)


def add_monkey(level: int, view_level: int) -> None:
    """Suzanne beside the plume, subdivided: 3936 * 4^(level - 1) triangles. In the background only a render needs them."""
    bpy.ops.mesh.primitive_monkey_add(size=1.2, location=(1.9, -1.9, 0.7))
    bpy.ops.object.shade_smooth()
    modifier = bpy.context.object.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = view_level, level


def triangles(level: int) -> Callable[[Path], None]:
    def make(_: Path) -> None:
        open_plume()
        add_monkey(level, 0)

    return make


def places(count: int) -> list[tuple[float, float]]:
    """The `count` points nearest to the origin of a square grid, but for those where the sample's own things are."""
    reach = math.ceil(math.sqrt(count / math.pi)) + 6
    grid = [(PITCH * x, PITCH * y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)]
    around = [place for place in grid if math.hypot(*place) > 3.0]
    return sorted(around, key=lambda place: (math.hypot(*place), place))[:count]


def instances(count: int) -> Callable[[Path], None]:
    """Objects that share one mesh of 968 triangles, on the floor around the plume."""

    def make(_: Path) -> None:
        open_plume()
        bpy.ops.mesh.primitive_monkey_add(size=0.5, location=(-3.0, 0.0, 0.3))
        shared = bpy.context.object.data
        bpy.data.objects.remove(bpy.context.object)
        for number, (x, y) in enumerate(places(count)):
            copy = bpy.data.objects.new(f"Copy {number}", shared)
            copy.location = (x, y, 0.3)
            copy.rotation_euler.z = 0.1 * number
            bpy.context.scene.collection.objects.link(copy)

    return make


def trail(folder: Path) -> None:
    """The diagonal trail as a Volume object, seen from the side, and a sun."""
    open_empty()
    scene = bpy.context.scene
    data = bpy.data.volumes.new("Trail")
    data.filepath = str(folder / "trail.vdb")
    material = bpy.data.materials.new("Trail")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    volume = nodes.new("ShaderNodeVolumePrincipled")
    volume.inputs["Density"].default_value = 12.0
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
    data.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Trail", data))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 10.0
    sun.rotation_euler = (0.6, 0.3, 0.0)
    scene.collection.objects.link(sun)
    scene.camera.location = (1.6, -6.5, 2.6)
    towards = Vector((1.6, 1.6, 1.6)) - scene.camera.location
    scene.camera.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()


MAKERS: dict[str, Callable[[Path], None]] = {
    "triangles-4m": triangles(6),
    "instances-2000": instances(2000),
    "instances-20000": instances(20000),
    "trail": trail,
    "plume": lambda _: open_plume(LARGE),
}
