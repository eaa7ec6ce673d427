# SPDX-License-Identifier: GPL-3.0-or-later
"""What solids and smoke hide of a lamp, where a point sees but a part of it: because of its spread, or in a smooth surface.
As the Cycles of this Blender has it."""

import math

import bpy
import harness
import numpy as np
import pictures
from mathutils import Vector

SIZE = (80, 48)
CAMERA, TARGET = Vector((0.7, -5.0, 3.6)), Vector((0.0, 0.0, 0.3))


def arrange(shape: str, size: tuple[float, float], spread: float, watts: float = 300.0) -> bpy.types.Scene:
    """A lamp four metres above a white floor; `spread` in degrees."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [], [(0, 1, 2, 3)])
    harness.shade(mesh, "ShaderNodeBsdfDiffuse")
    light, camera = bpy.data.lights.new("Lamp", "AREA"), bpy.data.cameras.new("Camera")
    light.shape, light.energy, light.spread = shape, watts, math.radians(spread)
    light.size, light.size_y = size
    for data, place, angles in (
        (mesh, (0, 0, 0), (0, 0, 0)),
        (light, (0, 0, 4), (0, 0, 0.3)),
        (camera, CAMERA, (TARGET - CAMERA).to_track_quat("-Z", "Y").to_euler()),
    ):
        thing = bpy.data.objects.new(data.name, data)
        thing.location, thing.rotation_euler = place, angles
        scene.collection.objects.link(thing)
    scene.camera = bpy.data.objects["Camera"]
    scene.render.resolution_percentage = 100
    return scene


def test_what_a_box_hides() -> None:
    wrong = {}
    for shape, size, spread in (
        ("RECTANGLE", (1.0, 1.0), 20.0),
        ("RECTANGLE", (1.6, 0.8), 10.0),
        ("ELLIPSE", (1.6, 1.0), 20.0),
        ("ELLIPSE", (1.0, 1.0), 40.0),
    ):
        arrange(shape, size, spread)
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.5))
        harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse")
        bpy.context.object.data.materials[0].node_tree.nodes[0].inputs[0].default_value = (0.6, 0.3, 0.2, 1.0)
        error = pictures.error_beside_cycles(f"box-{shape.lower()}-{spread:g}", SIZE, 256)
        if error > 0.03:
            wrong[shape, spread] = error
    assert not wrong, wrong


def test_what_smoke_hides_and_how_it_is_lit() -> None:
    if not pictures.cycles_shows_smoke():
        raise harness.Skip("the Cycles of this Blender shows no smoke")
    wrong = {}
    for shape, spread in (("RECTANGLE", 12.0), ("RECTANGLE", 25.0), ("ELLIPSE", 40.0)):
        scene = arrange(shape, (1.0, 1.0), spread)
        data = bpy.data.volumes.new("Smoke")
        data.filepath = str(harness.ROOT / "blend_samples" / "frames" / "fire.vdb")
        harness.shade(data, "ShaderNodeVolumePrincipled", "Volume").inputs["Density"].default_value = 3.0
        thing = bpy.data.objects.new("Smoke", data)
        scene.collection.objects.link(thing)
        bpy.context.view_layer.update()
        corners = np.array([tuple(c) for c in thing.bound_box])
        scale = 1.6 / float((corners.max(0) - corners.min(0)).max())
        thing.scale = (scale,) * 3
        thing.location = -scale * (corners.min(0) + corners.max(0)) / 2.0 + np.array((0.0, 0.0, 1.2))
        error = pictures.error_beside_cycles(f"smoke-{shape.lower()}-{spread:g}", SIZE, 64)
        if error > 0.03:
            wrong[shape, spread] = error
    assert not wrong, wrong


def test_what_a_board_hides_of_a_mirrored_lamp() -> None:
    """Its rim is straight: each pixel of it asks for the part of the lamp that it mirrors."""
    scene = arrange("RECTANGLE", (0.6, 0.6), 180.0, 40.0)
    floor, lamp = bpy.data.objects["Floor"], bpy.data.objects["Lamp"]
    floor.data.materials.clear()
    shader = harness.shade(floor.data, "ShaderNodeBsdfGlossy")
    shader.distribution, shader.inputs["Roughness"].default_value = "GGX", 0.1
    lamp.location = (0.0, 3.5, 3.0)
    lamp.rotation_euler = (Vector((0.0, 0.0, 0.0)) - lamp.location).to_track_quat("-Z", "Y").to_euler()
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.6, 0.25))
    board = bpy.context.object
    board.scale = (3.0, 0.05, 0.5)
    harness.shade(board.data, "ShaderNodeBsdfDiffuse")
    scene.camera.location = (0.0, -4.0, 3.0)
    scene.camera.rotation_euler = (Vector((0.0, 0.1, 0.0)) - scene.camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.camera.data.lens = 120.0
    error = pictures.error_beside_cycles("board-mirrored", SIZE, 512, side=1)
    assert error <= 0.03, error


harness.main()
