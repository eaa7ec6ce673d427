# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke whose material multiplies its colour by a grid (Color Attribute), beside Cycles."""

import tempfile
from pathlib import Path

import bpy
import harness
import numpy as np
import pictures

TINTED = harness.ROOT / "tests" / "goldens" / "tinted_smoke.vdb"  # two metres wide, by make_tinted_smoke.cpp
SIZE = (48, 48)


def look(middle: tuple[float, float, float], across: float) -> None:
    """From the front, in a sun from the left and above."""
    view, camera, sun = bpy.context.scene, bpy.data.cameras.new("Camera"), bpy.data.lights.new("Sun", "SUN")
    camera.type, camera.ortho_scale = "ORTHO", across
    view.camera = bpy.data.objects.new("Camera", camera)
    view.camera.location, view.camera.rotation_euler = (middle[0], middle[1] - 5.0, middle[2]), (np.pi / 2.0, 0.0, 0.0)
    sun.energy = 3.0
    lamp = bpy.data.objects.new("Sun", sun)
    lamp.rotation_euler = (0.6, -0.5, 0.0)
    for made in (view.camera, lamp):
        view.collection.objects.link(made)
    view.world = bpy.data.worlds.new("Black")  # without one, Cycles 5.0.1 shows no smoke
    view.world.color = (0.0, 0.0, 0.0)
    if view.world.node_tree is not None:
        view.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    view.render.resolution_percentage = 100
    cycles = view.cycles
    cycles.samples, cycles.seed, cycles.max_bounces, cycles.volume_bounces, cycles.volume_step_rate = 64, 1, 0, 0, 0.5
    cycles.use_adaptive_sampling = cycles.use_denoising = False


def difference(case: str) -> float:
    """Relative, of 6 x 6 pixels together, over those that Cycles has smoke in."""
    theirs, ours = (pictures.in_blocks(pictures.render(SIZE, engine), 6) for engine in ("CYCLES", "SFUMATO"))
    if theirs.max() == 0.0:
        raise harness.Skip("Cycles of this Blender shows no smoke")
    error = float(np.sqrt(np.mean((ours - theirs) ** 2)) / np.sqrt(np.mean(theirs**2)))
    print(f"  {case}: {100.0 * error:.2f} %, colours {(ours.sum(axis=(0, 1)) / theirs.sum(axis=(0, 1))).round(3)}")
    return error


def test_a_volumes_colours_are_those_of_cycles() -> None:
    """Of a grid of vectors; of one of floats, in a larger box; of one that is not there: white."""
    thing = harness.volume(TINTED)
    shader = harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume")
    shader.inputs["Color"].default_value = (0.9, 0.8, 0.7, 1.0)
    shader.inputs["Density"].default_value = 3.0
    look((1.0, 1.0, 1.0), 2.2)
    for attribute in ("tint", "grey", "absent"):
        shader.inputs["Color Attribute"].default_value = attribute
        assert difference(attribute) < 0.03, attribute


def test_a_domains_colours_are_those_of_cycles() -> None:
    if harness.MANTAFLOW_ABORTS:
        raise harness.Skip("Mantaflow aborts in this Blender")
    with tempfile.TemporaryDirectory() as folder:
        domain = harness.bake(folder, [(1.0, 0.3, 0.1), (0.1, 0.4, 1.0)])
        shader = harness.shade(domain.data, "ShaderNodeVolumePrincipled", "Volume")
        shader.inputs["Density"].default_value = 2.0
        look((0.0, 0.0, 1.2), 4.0)
        for attribute in ("color", "absent"):
            shader.inputs["Color Attribute"].default_value = attribute
            assert difference(attribute) < 0.03, attribute


harness.main()
