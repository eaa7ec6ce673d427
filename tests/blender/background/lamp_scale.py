# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps whose objects are scaled, mirrored or skewed by a parent: a floor under each as this Blender's Cycles lights it."""

from __future__ import annotations

import bpy
import harness
import pictures
from sfumato import log  # type: ignore[attr-defined]

SIZE = (24, 24)
Triple = tuple[float, float, float]
SPOT: dict[str, object] = {"shadow_soft_size": 0.0, "spot_size": 1.0, "spot_blend": 0.5}
SOFT: dict[str, object] = {"shadow_soft_size": 0.4, "spot_size": 1.0, "spot_blend": 0.3}
SQUARE: dict[str, object] = {"shape": "SQUARE", "size": 1.0}
GRID: dict[str, object] = {"spread": 0.8}
DISK: dict[str, object] = {"shape": "DISK", "size": 1.0}


def arrange(
    kind: str, settings: dict[str, object], scale: Triple, turn: Triple = (0, 0, 0), parent: Triple = (1, 1, 1)
) -> None:
    """A lamp two metres above a floor, turned, in a parent that is scaled."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse")
    light, camera = bpy.data.lights.new("Lamp", kind), bpy.data.cameras.new("Camera")
    light.energy = 100.0
    for name, value in settings.items():
        setattr(light, name, value)
    lamp, holder = bpy.data.objects.new("Lamp", light), bpy.data.objects.new("Holder", None)
    lamp.parent, holder.location, holder.scale = holder, (0.0, 0.0, 2.0), parent
    lamp.scale, lamp.rotation_euler, lamp.visible_camera = scale, turn, False
    camera.type, camera.ortho_scale = "ORTHO", 6.0
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (0.0, 0.0, 9.0)
    for thing in (lamp, holder, scene.camera):
        scene.collection.objects.link(thing)
    scene.world = None
    if hasattr(scene.cycles, "use_light_tree"):
        scene.cycles.use_light_tree = False  # it looks for the light of a skewed spot only where that of a round one is
    scene.sfumato.quality = "FINAL"
    scene.render.resolution_percentage = 100


def require(cases: dict[str, tuple[object, ...]]) -> None:
    wrong = {}
    for name, case in cases.items():
        arrange(*case)  # type: ignore[arg-type]
        error = pictures.error_beside_cycles(name, SIZE, 256, side=3)
        if error > 0.02 or log.notices():
            wrong[name] = error, log.notices()
    assert not wrong, wrong


def test_cones_of_spots_are_stretched_or_not() -> None:
    require(
        {
            "spot 1,2,1": ("SPOT", SPOT, (1, 2, 1)),
            "spot 1,1,2": ("SPOT", SPOT, (1, 1, 2)),
            "spot 2,2,2": ("SPOT", SPOT, (2, 2, 2)),
            "spot mirrored": ("SPOT", SPOT, (-1, 1.5, 1), (0.2, 0.3, 0.0)),
            "soft spot": ("SPOT", SOFT, (2, 1, 1), (0.2, 0.0, 0.4)),
            "spot skewed": ("SPOT", SPOT, (1, 1, 1), (0.5, 0.3, 0.6), (1, 2, 1)),
        }
    )


def test_points_know_no_scale() -> None:
    require({"point 2,1,1": ("POINT", {"shadow_soft_size": 0.7}, (2, 1, 1))})
    require({"point 1,1,2": ("POINT", {"shadow_soft_size": 0.7}, (1, 1, 2))})


def test_area_lights_are_scaled() -> None:
    require(
        {
            "square 2,1,1": ("AREA", SQUARE, (2, 1, 1)),
            "square 1,2,3": ("AREA", SQUARE, (1, 2, 3), (0.3, 0.2, 0.1)),
            "square with a spread": ("AREA", {**SQUARE, **GRID}, (2, 1, 1)),
            "disk 2,1,1": ("AREA", DISK, (2, 1, 1)),
            "disk skewed": ("AREA", DISK, (1, 1, 1), (0.0, 0.0, 0.6), (1, 2, 1)),
        }
    )


def test_skewed_area_lights_are_named() -> None:
    """Cycles takes a skewed rectangle for one without more ado: in 3.4.1 it shines sideways, in 4.5.15 with 1.1 times the
    power."""
    for shape, turn in ((SQUARE, (0.0, 0.0, 0.6)), (DISK, (0.5, 0.0, 0.0))):
        arrange("AREA", shape, (1, 1, 1), turn, (1, 2, 1))
        assert pictures.render(SIZE)[..., :3].any()
        assert any("Lamp" in notice and "skews" in notice for notice in log.notices()), log.notices()


harness.main()
