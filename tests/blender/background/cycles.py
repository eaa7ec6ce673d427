# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole pictures against the Cycles of this very Blender: the plume, and a scene of default materials.

Errors are root mean squares over means, with Cycles' own noise taken off: from two renders whose random numbers differ.
"""

import math

import bpy
import harness
import numpy as np
import pictures
from numpy.typing import NDArray

SIZE = (160, 90)


def in_cycles(samples: int) -> tuple[NDArray[np.float64], float]:
    """The mean of two renders with light that is scattered once, and the mean square of its noise."""
    scene = bpy.context.scene
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.volume_bounces = samples, 0, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    renders = []
    for cycles.seed in (1, 2):
        renders.append(pictures.render(SIZE, "CYCLES")[..., :3].astype(np.float64))
    first, second = renders
    return (first + second) / 2.0, float(((first - second) ** 2).mean()) / 4.0


def difference(samples: int) -> float:
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100
    scene.sfumato.quality = "FINAL"
    scene.cycles.max_bounces = 0  # of ours, too
    ours = pictures.render(SIZE)[..., :3].astype(np.float64)
    theirs, noise = in_cycles(samples)
    whole, mean = float(((ours - theirs) ** 2).mean()), float(theirs.mean())
    error = math.sqrt(max(whole - noise, 0.0)) / mean
    print(
        f"  error {error:.2%}, with the noise {math.sqrt(whole) / mean:.2%}; means {ours.mean() / mean:.4f}", flush=True
    )
    return error


def shows_smoke() -> bool:
    """Whether Cycles was built with what it needs for Volume objects: by a ray through the middle of one."""
    smoke = harness.open_plume()
    for thing in list(bpy.context.scene.objects):
        if thing not in (smoke, bpy.context.scene.camera) and thing.type != "LIGHT":
            bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.cycles.samples, scene.render.film_transparent, scene.render.resolution_percentage = 4, True, 100
    return bool(pictures.render((32, 18), "CYCLES")[..., 3].max() > 0.1)


def test_the_plume_is_cycles() -> None:
    if not shows_smoke():
        raise harness.Skip("the Cycles of this Blender shows no smoke")
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    harness.open_plume()
    assert difference(64) <= 0.02


def default(name: str, **inputs: object) -> bpy.types.Material:
    """A Principled BSDF as a new material has it; `inputs` with spaces as underlines."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    for socket, value in inputs.items():
        material.node_tree.nodes["Principled BSDF"].inputs[socket.replace("_", " ")].default_value = value
    return material


def test_default_materials_are_cycles() -> None:
    """The factory's cube and lamp, with a floor, a ball and a metal one, in a sun too."""
    scene = bpy.context.scene
    bpy.data.objects["Cube"].scale = (0.8, 0.8, 0.8)
    bpy.ops.mesh.primitive_plane_add(size=14.0, location=(0.0, 0.0, -0.8))
    bpy.context.object.data.materials.append(default("Floor"))
    for place, material in (
        ((2.2, 0.0, 0.0), default("Red", Base_Color=(0.8, 0.1, 0.05, 1.0), Roughness=0.3)),
        ((-0.6, 2.4, 0.0), default("Metal", Base_Color=(0.9, 0.6, 0.3, 1.0), Metallic=1.0)),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8, location=place)
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(material)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (0.7, 0.3, 0.0)
    sun.data.energy = 2.0
    scene.collection.objects.link(sun)
    scene.world = None
    assert difference(128) <= 0.02


harness.main()
