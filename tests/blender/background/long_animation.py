# SPDX-License-Identifier: GPL-3.0-or-later
"""250 frames of the plume in one Blender: the last is the first, on one thread or two, and memory does not grow."""

import math
from pathlib import Path

import bpy
import harness
import numpy as np
import pictures
from mathutils import Matrix
from numpy.typing import NDArray

FRAMES, SMOKE = 250, range(20, 30)
SIZE = (48, 27)


def at(number: int, camera: Matrix) -> None:
    """Smoke that repeats every ten frames, and a camera that goes round it once."""
    scene = bpy.context.scene
    scene.frame_set(SMOKE[number % len(SMOKE)])
    scene.camera.matrix_world = Matrix.Rotation(2.0 * math.pi * (number % FRAMES) / FRAMES, 4, "Z") @ camera


def resident_bytes() -> int:
    """Of this process, now."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096


def seen(number: int, camera: Matrix) -> NDArray[np.float32]:
    at(number, camera)
    return pictures.render(SIZE)


def test_two_hundred_and_fifty_frames_neither_drift_nor_grow() -> None:
    harness.open_plume(25)
    settings = bpy.context.scene.render
    settings.resolution_percentage, settings.engine = 100, "SFUMATO"
    settings.resolution_x, settings.resolution_y = SIZE
    settings.use_persistent_data = True
    camera = bpy.context.scene.camera.matrix_world.copy()
    first = seen(0, camera)
    used = []
    for number in range(1, FRAMES):
        at(number, camera)
        bpy.ops.render.render()
        used.append(resident_bytes())
    grown = max(used[150:]) - max(used[50:150])
    again = seen(FRAMES, camera)
    print(f"  grown by {grown / 1e6:.1f} MB in the last hundred frames")
    assert np.abs(again - first).max() <= 1e-6, float(np.abs(again - first).max())
    assert np.abs(seen(60, camera) - first).max() > 0.01
    assert grown < 8e6, grown


def test_equal_scenes_give_equal_pixels_on_one_thread_and_on_two() -> None:
    harness.open_plume(25)
    settings = bpy.context.scene.render
    settings.resolution_percentage, settings.threads_mode = 100, "FIXED"
    made = []
    for settings.threads in (1, 2, 1):
        made.append(pictures.render(SIZE))
    assert max(float(np.abs(other - made[0]).max()) for other in made[1:]) <= 1e-6


harness.main()
