# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes in the file of a render, beside those of the Cycles of the same Blender."""

import subprocess
import tempfile
from pathlib import Path

import bpy
import harness
import multilayer
import numpy as np
import pictures
from numpy.typing import NDArray
from sfumato import log  # type: ignore[attr-defined]

SIZE = (64, 48)
SWITCHES = ("z", "mist", "position", "normal", "object_index", "material_index")
OF_ONE_SAMPLE = ("Depth.Z", "IndexOB.X", "IndexMA.X", "Position.X", "Position.Y", "Position.Z")
FILTERED = ("Mist.Z", "Normal.X", "Normal.Y", "Normal.Z")


def still_life(camera: str = "PERSP") -> None:
    """A floor, a smooth ball and a turned cube of two materials, each with its number, before nothing."""
    bpy.ops.mesh.primitive_plane_add(size=6.0, location=(0.0, 0.0, -1.0))
    bpy.context.object.pass_index = 3
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.9, location=(1.8, 0.4, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.pass_index = 700
    cube = bpy.data.objects["Cube"]
    cube.pass_index = 12
    cube.rotation_euler, cube.scale = (0.3, 0.2, 0.5), (0.8, 0.8, 0.8)
    for number in (4, 5):
        material = bpy.data.materials.new("Numbered")
        material.pass_index = number
        cube.data.materials.append(material)
    for face in cube.data.polygons:
        face.material_index = 1 + face.index % 2
    scene = bpy.context.scene
    scene.camera.data.type, scene.camera.data.ortho_scale = camera, 6.5
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 5.0, 7.0
    for switch in SWITCHES:
        setattr(scene.view_layers[0], f"use_pass_{switch}", True)
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 256, 0, False, False
    scene.sfumato.quality = "FINAL"


def channel(found: multilayer.Channels, name: str) -> NDArray[np.float32]:
    return next(values for full, values in found.items() if full.endswith(f".{name}"))


def inside(values: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Pixels around which an index does not change: Cycles' first sample lies up to 1.5 pixels from the middle."""
    wide = np.pad(values, 2, mode="edge")
    rows, columns = values.shape
    around = [wide[i : i + rows, j : j + columns] for i in range(5) for j in range(5)]
    return np.all([other == values for other in around], axis=0)


def test_what_surfaces_are_is_as_in_cycles() -> None:
    for camera in ("PERSP", "ORTHO"):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        still_life(camera)
        ours, theirs = multilayer.render(SIZE), multilayer.render(SIZE, "CYCLES")
        same = inside(channel(ours, "IndexOB.X")) & inside(channel(ours, "IndexMA.X"))
        assert same.mean() > 0.5 and len(np.unique(channel(ours, "IndexOB.X")[same])) == 4
        assert set(np.unique(channel(ours, "IndexMA.X")[same])) >= {0.0, 4.0, 5.0}
        for name in OF_ONE_SAMPLE:
            mine, other = channel(ours, name)[same], channel(theirs, name)[same]
            off = np.abs(mine - other)
            print(f"  {camera} {name}: median {np.median(off):.4f}, largest {off.max():.4f}")
            if name.startswith("Index"):
                assert off.max() == 0.0
                continue
            # From the middle of a pixel to Cycles' sample a surface here may run a few centimetres, further on the floor.
            assert np.median(off) < 0.03 and np.array_equal(mine > 1e9, other > 1e9), name
        for name in FILTERED:
            off = channel(ours, name) - channel(theirs, name)
            error = float(np.sqrt((off**2).mean()) / np.sqrt((channel(theirs, name) ** 2).mean()))
            print(f"  {camera} {name}: RMSE {error:.3%}")
            assert error < 0.03, (camera, name, error)


def test_mist_falls_off_as_in_cycles() -> None:
    still_life()
    mist = bpy.context.scene.world.mist_settings
    for mist.falloff in ("QUADRATIC", "INVERSE_QUADRATIC"):
        off = channel(multilayer.render(SIZE), "Mist.Z") - channel(multilayer.render(SIZE, "CYCLES"), "Mist.Z")
        assert np.sqrt((off**2).mean()) < 0.01, mist.falloff


harness.main()
