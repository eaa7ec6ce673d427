# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' pixel filter: the picture across a straight edge, beside that of the same Blender's Cycles."""

import bpy
import harness
import numpy as np
import pictures

SIZE = (24, 8)


def edge() -> None:
    """White to the left of the middle, black to the right."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(-10.0, 0.0, 0.0))
    glow = harness.shade(bpy.context.object.data, "ShaderNodeEmission")
    glow.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location.z = 5.0
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 24.0
    scene.collection.objects.link(scene.camera)
    scene.sfumato.quality = "FINAL"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 1024, 0, False, False


def test_the_edge_is_as_wide_as_in_cycles() -> None:
    edge()
    cycles = bpy.context.scene.cycles
    profiles = {}
    for shape, width in (
        ("BLACKMAN_HARRIS", 1.5),
        ("BLACKMAN_HARRIS", 0.2),
        ("BLACKMAN_HARRIS", 4.0),
        ("GAUSSIAN", 1.5),
        ("GAUSSIAN", 3.0),
        ("BOX", 1.5),
    ):
        cycles.pixel_filter_type, cycles.filter_width = shape, width
        ours, theirs = (pictures.render(SIZE, engine)[..., 0].mean(axis=0) for engine in ("SFUMATO", "CYCLES"))
        profiles[shape, width] = ours
        print(f"  {shape} {width}: {np.round(ours[9:15], 3)} beside {np.round(theirs[9:15], 3)}", flush=True)
        assert np.abs(ours - theirs).max() < 0.015, (shape, width, np.abs(ours - theirs).max())
        assert (np.diff(ours) < 1e-3).all(), "the edge falls evenly"
    assert abs(profiles["BLACKMAN_HARRIS", 1.5][12] - 0.119) < 0.015
    assert profiles["BLACKMAN_HARRIS", 4.0][13] > 0.08 > profiles["BLACKMAN_HARRIS", 0.2][12]


harness.main()
