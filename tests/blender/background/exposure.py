# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth of field and motion blur beside Cycles: a lens of each kind, cameras and objects that move, the shutter."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bmesh
import bpy
import harness
import numpy as np
import pictures
from numpy.typing import NDArray

SIZE = (96, 64)
SAMPLES = 256


def sphere(name: str, place: tuple[float, float, float], colour: tuple[float, float, float]) -> Any:
    mesh = bpy.data.meshes.new(name)
    made = bmesh.new()
    bmesh.ops.create_uvsphere(made, u_segments=32, v_segments=16, radius=0.6)
    for face in made.faces:
        face.smooth = True
    made.to_mesh(mesh)
    made.free()
    harness.shade(mesh, "ShaderNodeBsdfDiffuse").inputs["Color"].default_value = (*colour, 1.0)
    thing = bpy.data.objects.new(name, mesh)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def arrange() -> Any:
    """Three balls in a row on a floor, in a sun; returns the camera."""
    harness.enable()
    harness.black_world()
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    floor = bpy.data.meshes.new("Floor")
    floor.from_pydata([(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0)], [], [(0, 1, 2, 3)])
    harness.shade(floor, "ShaderNodeBsdfDiffuse")
    scene.collection.objects.link(bpy.data.objects.new("Floor", floor))
    sphere("Near", (-1.2, -2.0, 0.6), (0.8, 0.1, 0.1))
    sphere("Ball", (0.0, 0.0, 0.6), (0.1, 0.7, 0.2))
    sphere("Far", (1.4, 3.0, 0.6), (0.2, 0.3, 0.9))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.1
    light = bpy.data.objects.new("Sun", sun)
    light.rotation_euler = (0.6, 0.3, 0.0)
    scene.collection.objects.link(light)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -8.0, 2.0), (math.radians(80.0), 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.frame_set(2)
    scene.sfumato.quality = "PREVIEW"
    cycles = scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = 0
    return camera


def beside_cycles() -> tuple[float, NDArray[np.float32]]:
    """Our error against Cycles, with its noise taken off, as a share of its picture; and our picture."""
    cycles = bpy.context.scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = SAMPLES, False, False
    seen = pictures.render(SIZE, "SFUMATO")
    renders = []
    for cycles.seed in (1, 2):
        renders.append(pictures.render(SIZE, "CYCLES")[..., :3].astype(np.float64))
    judge = (renders[0] + renders[1]) / 2.0
    noise = np.mean((renders[0] - renders[1]) ** 2) / 4.0
    square = np.mean((seen[..., :3] - judge) ** 2) - noise
    return float(np.sqrt(max(square, 0.0) / np.mean(judge**2))), seen


def focused(camera: Any, **field: Any) -> None:
    settings = camera.data.dof
    settings.use_dof, settings.focus_distance, settings.aperture_fstop = True, 8.0, 0.12
    for name, value in field.items():
        setattr(settings, name, value)


def moves(thing: Any, path: str, values: list[Any]) -> None:
    """A value in the frames 1, 2 and 3, and straight between them."""
    for frame, value in enumerate(values, 1):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)
    bpy.context.scene.frame_set(2)


def lens(camera: Any) -> None:
    focused(camera)


def blades(camera: Any) -> None:
    focused(camera, aperture_blades=3, aperture_rotation=0.4, aperture_ratio=2.0)


def orthographic(camera: Any) -> None:
    camera.location.z, camera.rotation_euler.x = 6.0, math.radians(55.0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 6.0
    focused(camera, aperture_fstop=0.8, focus_distance=9.0)


def focus_object(camera: Any) -> None:
    focused(camera, focus_distance=1.0, focus_object=bpy.data.objects["Far"])


def flying(camera: Any) -> None:
    open_shutter()
    moves(camera, "location", [(-0.4, -8.0, 2.0), (0.0, -8.0, 2.0), (0.4, -8.0, 2.2)])
    moves(camera, "rotation_euler", [(1.4, 0.0, -0.03), (1.4, 0.0, 0.0), (1.38, 0.05, 0.06)])


def rolling(_camera: Any) -> None:
    open_shutter()
    ball = bpy.data.objects["Ball"]
    ball.scale = (1.0, 0.5, 1.5)
    moves(ball, "location", [(-1.0, 0.0, 0.6), (0.0, 0.0, 0.6), (0.8, 0.4, 0.9)])
    moves(ball, "rotation_euler", [(0.0, -0.8, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)])


def growing(_camera: Any) -> None:
    open_shutter()
    ball = bpy.data.objects["Ball"]
    ball.shape_key_add(name="Basis")
    key = ball.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 2.5
    moves(key, "value", [0.0, 0.5, 1.0])


def half_open(camera: Any) -> None:
    rolling(camera)
    points = bpy.context.scene.render.motion_blur_shutter_curve.curves[0].points
    points[0].location = (0.0, 0.0)


def from_the_start(camera: Any) -> None:
    rolling(camera)
    render = bpy.context.scene.render
    owner = render if hasattr(render, "motion_blur_position") else bpy.context.scene.cycles
    owner.motion_blur_position = "START"


def open_shutter() -> None:
    render = bpy.context.scene.render
    render.use_motion_blur, render.motion_blur_shutter = True, 0.8


def check(blur: Callable[[Any], None], most: float, least: float) -> None:
    """That we blur as Cycles does, within `most`, and that it makes a difference of at least `least`."""
    camera = arrange()
    sharp = pictures.render(SIZE, "SFUMATO")
    blur(camera)
    error, seen = beside_cycles()
    apart = float(np.sqrt(np.mean((seen - sharp)[..., :3] ** 2) / np.mean(seen[..., :3] ** 2)))
    print(f"{blur.__name__}: {100 * error:.2f} % off Cycles, {100 * apart:.1f} % off without blur")
    assert apart > least, apart
    assert error < most, error


def test_a_lens() -> None:
    check(lens, 0.03, 0.06)


def test_an_aperture_with_corners() -> None:
    check(blades, 0.03, 0.04)


def test_a_lens_of_an_orthographic_camera() -> None:
    check(orthographic, 0.03, 0.03)


def test_a_lens_that_follows_an_object() -> None:
    check(focus_object, 0.03, 0.05)


def test_a_camera_that_moves_and_turns() -> None:
    check(flying, 0.03, 0.06)


def test_an_object_that_moves_and_turns() -> None:
    check(rolling, 0.03, 0.06)


def test_an_object_that_changes_its_shape() -> None:
    check(growing, 0.03, 0.03)


def test_a_shutter_that_opens_slowly() -> None:
    check(half_open, 0.03, 0.06)


def test_a_shutter_that_opens_with_the_frame() -> None:
    check(from_the_start, 0.03, 0.06)


def test_what_is_not_to_be_blurred_is_not() -> None:
    """By the layer, by an object, and for a moment that is short: and the frame is what it was afterwards."""
    camera = arrange()
    sharp = pictures.render(SIZE, "SFUMATO")
    rolling(camera)
    scene = bpy.context.scene
    blurred = pictures.render(SIZE, "SFUMATO")
    assert scene.frame_current_final == 2.0
    standing = bpy.data.objects["Ball"]
    standing.animation_data_clear()
    standing.location, standing.rotation_euler, standing.scale = (0.0, 0.0, 0.6), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    assert np.array_equal(pictures.render(SIZE, "SFUMATO"), sharp)
    rolling(camera)
    assert np.abs(pictures.render(SIZE, "SFUMATO") - blurred).max() < 1e-4
    still = stands_still(standing)
    standing.cycles.use_motion_blur = False
    assert np.abs(pictures.render(SIZE, "SFUMATO") - still).max() < 1e-5
    standing.cycles.use_motion_blur = True
    bpy.context.view_layer.use_motion_blur = False
    assert np.abs(pictures.render(SIZE, "SFUMATO") - still).max() < 1e-5
    bpy.context.view_layer.use_motion_blur = True


def stands_still(_thing: Any) -> NDArray[np.float32]:
    render = bpy.context.scene.render
    render.use_motion_blur = False
    picture = pictures.render(SIZE, "SFUMATO")
    render.use_motion_blur = True
    return picture


harness.main()
