# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene far from the world's origin is the same picture as at home. What is moved, and by how much, has no more digits
than Blender's single precision holds at 100 km, which is 8 mm."""

import bpy
import harness
import numpy as np
import pictures
from mathutils import Matrix
from numpy.typing import NDArray
from sfumato.export import scene

SIZE = (64, 40)


def arrange(by: tuple[float, float, float]) -> None:
    """Smoke, a ball and a board over a floor in a sun and a lamp, moved in the world."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    data = bpy.data.volumes.new("Smoke")
    data.filepath = str(harness.ROOT / "blend_samples" / "frames" / "fire.vdb")
    harness.shade(data, "ShaderNodeVolumePrincipled", "Volume").inputs["Density"].default_value = 2.0
    made = [bpy.data.objects.new("Smoke", data)]
    made[0].scale, made[0].location = (0.5,) * 3, (-1.5, -0.75, 0.25)
    bpy.ops.mesh.primitive_plane_add(size=16.0)
    floor = bpy.context.object
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(0.75, 0.0, 0.5))
    ball = bpy.context.object
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(1.75, 0.5, 0.5))
    board = bpy.context.object
    board.scale = (0.125, 1.0, 1.0)
    sun, lamp = bpy.data.lights.new("Sun", "SUN"), bpy.data.lights.new("Lamp", "AREA")
    sun.energy, lamp.energy, lamp.size = 2.0, 100.0, 0.5
    camera = bpy.data.cameras.new("Camera")
    made += [bpy.data.objects.new(item.name, item) for item in (sun, lamp, camera)]
    for thing in made:
        bpy.context.scene.collection.objects.link(thing)
    made[1].rotation_euler, made[2].location = (0.6, 0.5, 0.2), (-2.0, -1.0, 3.0)
    made[3].location, made[3].rotation_euler = (0.0, -6.0, 4.0), (1.0, 0.0, 0.0)
    bpy.context.scene.camera = made[3]
    bpy.context.scene.render.resolution_percentage = 100
    for thing in (*made, floor, ball, board):
        thing.location = Matrix.Translation(by) @ thing.location


def picture(by: tuple[float, float, float]) -> NDArray[np.float64]:
    arrange(by)
    return pictures.render(SIZE).astype(np.float64)


def test_pictures_are_those_at_home() -> None:
    home = picture((0.0, 0.0, 0.0))
    for by in ((10000.0, -5000.0, 250.0), (-100000.0, 100000.0, 1000.0)):
        away = picture(by)
        error = float(np.sqrt(((away - home) ** 2).mean()) / home.mean())
        print(f"  {by}: {error:.1e}")
        assert error < 1e-3, (by, error)


def test_the_origin_stays_while_things_move() -> None:
    places = np.random.default_rng(7).normal(0.0, 20.0, (9, 3))
    assert not scene.origin_of(places).any()
    assert not scene.origin_of(np.zeros((0, 3))).any()
    away = places + (10000.0, 0.0, 0.0)
    origin = scene.origin_of(away)
    assert np.abs(origin - (10000.0, 0.0, 0.0)).max() <= scene.LATTICE / 2.0
    away[0] += 1e6
    away[1] = np.nan
    assert (scene.origin_of(away) == origin).all()


harness.main()
