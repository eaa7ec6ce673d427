# SPDX-License-Identifier: GPL-3.0-or-later
"""The lights of `bench.py lights`, each in the place of the plume's sun. Runs inside Blender."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import bpy
from mathutils import Vector

RESOLUTION = (320, 180)
FRAME = 25

Point = tuple[float, float, float]

LEFT: Point = (-3.2, -1.0, 3.0)
RIGHT: Point = (2.5, -2.0, 3.0)
SMOKE: Point = (0.0, 0.0, 1.2)


class Lamp(NamedTuple):
    kind: str
    settings: dict[str, Any]
    place: Point = LEFT


def sun(degrees: float) -> Lamp:
    """Of the sample's strength and direction."""
    return Lamp("SUN", {"energy": 24.0, "angle": math.radians(degrees)}, (-4.0, 0.0, 4.15))


CASES: dict[str, list[Lamp]] = {
    "sun": [sun(0.526)],
    "sun-10": [sun(10.0)],
    "point": [Lamp("POINT", {"energy": 2500.0, "shadow_soft_size": 0.0})],
    "sphere": [Lamp("POINT", {"energy": 2500.0, "shadow_soft_size": 0.3})],
    "spot": [Lamp("SPOT", {"energy": 4000.0, "shadow_soft_size": 0.0, "spot_size": 0.7, "spot_blend": 0.3})],
    "square": [Lamp("AREA", {"energy": 1500.0, "shape": "SQUARE", "size": 1.2})],
    "ellipse": [
        Lamp(
            "AREA",
            {"energy": 1500.0, "shape": "ELLIPSE", "size": 1.6, "size_y": 0.6, "spread": math.radians(80.0)},
        )
    ],
    "two": [
        Lamp("POINT", {"energy": 1500.0, "shadow_soft_size": 0.0, "color": (1.0, 0.5, 0.2)}),
        Lamp(
            "SPOT",
            {
                "energy": 2500.0,
                "shadow_soft_size": 0.1,
                "spot_size": 0.9,
                "spot_blend": 0.3,
                "color": (0.3, 0.5, 1.0),
            },
            RIGHT,
        ),
    ],
}


def small_picture() -> None:
    """What golden and rivals share."""
    scene = bpy.context.scene
    scene.frame_set(FRAME)
    scene.render.resolution_x, scene.render.resolution_y = RESOLUTION
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR"
    settings.color_mode = "RGB"
    settings.color_depth = "32"


def put_lights(case: str) -> None:
    """Make `case` the only light of the scene."""
    for thing in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(thing)
    for lamp in CASES[case]:
        light = bpy.data.lights.new(case, lamp.kind)
        for name, value in lamp.settings.items():
            setattr(light, name, value)
        thing = bpy.data.objects.new(case, light)
        thing.location = lamp.place
        thing.rotation_euler = (Vector(SMOKE) - Vector(lamp.place)).to_track_quat("-Z", "Y").to_euler()
        bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.update()
