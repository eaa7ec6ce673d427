# SPDX-License-Identifier: GPL-3.0-or-later
"""300 overlapping puffs, and their shadow, beside the Cycles of this Blender, which is given the same density in a file:
it has no soft particles."""

from __future__ import annotations

from typing import Any

import bpy
import harness
import numpy as np
import pictures
import points
from mathutils import Vector
from numpy.typing import NDArray
from sfumato import compat, log  # type: ignore[attr-defined]

DENSITY = harness.ROOT / "tests" / "goldens" / "puffs.vdb"  # by make_puffs.cpp
CELL, BALL, RADII = 0.02, 0.7, (0.12, 0.2)  # metres, as there
SIZE, SHADOW_SIZE = (48, 48), (96, 96)  # pixels: across one a shadow must not fade much, which is seen at its middle
Image = NDArray[np.float64]


def middles() -> NDArray[np.float64]:
    """Of the puffs, (300, 3), of the two radii in turn."""
    steps = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
    places = 2.0 * ((np.arange(1000)[:, None] + 0.5) * steps % 1.0) - 1.0
    inside: NDArray[np.float64] = places[np.linalg.norm(places, axis=1) < 1.0][:300]
    return BALL * inside


def smoky(data: Any, density: float, anisotropy: float) -> None:
    shader = harness.shade(data, "ShaderNodeVolumePrincipled", "Volume")
    shader.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
    shader.inputs["Density"].default_value = density
    shader.inputs["Anisotropy"].default_value = anisotropy


def scene_of(density: float, anisotropy: float) -> tuple[list[Any], Any]:
    """Puffs above where a floor is going to be, the clouds of both radii; and the object that is the same to Cycles."""
    file = harness.volume(DENSITY)
    if not pictures.cycles_shows_smoke():
        raise harness.Skip("Cycles of this Blender shows no smoke")
    file = harness.volume(DENSITY)
    harness.enable()
    scene = bpy.context.scene
    # To OpenVDB a value is that of a point of its lattice.
    file.location = (-CELL * compat.sample_place(),) * 3
    smoky(file.data, density, anisotropy)
    clouds = []
    for number, radius in enumerate(RADII):
        mesh = bpy.data.meshes.new("Puffs")
        mesh.from_pydata(middles()[number::2].tolist(), [], [])
        thing = bpy.data.objects.new(f"Puffs {radius}", mesh)
        scene.collection.objects.link(thing)
        smoky(mesh, density, anisotropy)
        points.make_points_of(thing, radius, mesh.materials[0])
        clouds.append(thing)
    sun, camera = bpy.data.lights.new("Sun", "SUN"), bpy.data.cameras.new("Camera")
    sun.energy, sun.angle = 3.0, 0.0
    camera.type, camera.ortho_scale = "ORTHO", 2.2
    for data, turned in ((sun, (0.5, 0.7, 0.0)), (camera, (1.0, 0.0, 0.0))):
        thing = bpy.data.objects.new(data.name, data)
        thing.rotation_euler = turned
        scene.collection.objects.link(thing)
        if data is camera:
            scene.camera = thing
            thing.location = (0.0, -5.0 * np.sin(1.0), 5.0 * np.cos(1.0))
    scene.world = harness.black_world()
    scene.render.resolution_percentage = 100
    cycles = scene.cycles
    cycles.max_bounces, cycles.volume_bounces, cycles.volume_step_rate, cycles.samples = 0, 0, 0.3, 128
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    return clouds, file


def render(clouds: list[Any], file: Any, engine: str, seed: int = 0, size: tuple[int, int] = SIZE) -> Image:
    for thing in clouds:
        thing.hide_render = engine == "CYCLES"
    file.hide_render = engine != "CYCLES"
    bpy.context.scene.cycles.seed = seed
    return pictures.in_blocks(pictures.render(size, engine), size[0] // 24)


def difference(case: str, ours: Image, pair: list[Image], where: NDArray[np.bool_]) -> float:
    """Relative, over blocks, without the noise of Cycles' two pictures."""
    first, second = pair
    theirs, noise = ((first + second) / 2.0)[where], float(((first - second)[where] ** 2).mean()) / 4.0
    whole = float(np.sqrt((theirs**2).mean()))
    error = float(np.sqrt(max(((ours[where] - theirs) ** 2).mean() - noise, 0.0))) / whole
    print(
        f"  {case}: {error:.2%}, noise {np.sqrt(noise) / whole:.2%}, means {ours[where].mean() / theirs.mean():.4f}, "
        f"{where.mean():.0%} of the picture",
        flush=True,
    )
    return error


def test_puffs_are_as_cycles_has_their_density() -> None:
    for density, anisotropy in ((2.0, 0.0), (12.0, 0.0), (6.0, 0.6)):
        clouds, file = scene_of(density, anisotropy)
        ours = render(clouds, file, "SFUMATO")
        assert not log.notices(), log.notices()
        theirs = [render(clouds, file, "CYCLES", seed) for seed in (1, 2)]
        lit = theirs[0].max(axis=-1) > 1e-3
        assert 0.2 < lit.mean() < 0.8
        assert difference(f"puffs of {density:g}, anisotropy {anisotropy:g}", ours, theirs, lit) < 0.05, density


def test_their_shadow_is_as_in_cycles() -> None:
    for density in (2.0, 12.0):
        clouds, file = scene_of(density, 0.0)
        bpy.ops.mesh.primitive_plane_add(size=40.0, location=(0.0, 0.0, -1.0))
        harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse")
        for thing in (*clouds, file):
            thing.visible_camera = False
        scene = bpy.context.scene
        scene.camera.location += Vector((-0.84, 0.71, -1.0))  # to where the sun throws it
        scene.camera.data.ortho_scale, scene.cycles.samples = 2.8, 32
        ours = render(clouds, file, "SFUMATO", size=SHADOW_SIZE)
        theirs = [render(clouds, file, "CYCLES", seed, SHADOW_SIZE) for seed in (1, 2)]
        file.visible_shadow = False
        lit = render(clouds, file, "CYCLES", 1, SHADOW_SIZE)
        shade = (theirs[0] < 0.98 * lit).all(axis=-1)
        assert 0.2 < shade.mean() < 0.8, shade.mean()
        assert difference(f"shadow of puffs of {density:g}", ours, theirs, shade) < 0.03, density


harness.main()
