# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light's power means: a white floor under each kind, as bright as the Cycles of this very Blender makes it."""

import math
import types

import bpy
import harness
import numpy as np
import pictures
from mathutils import Vector
from sfumato import compat  # type: ignore[attr-defined]

SIZE = (16, 9)
# Kind, settings, scale. The soft ones are near and large, so that a disk that faces the floor is not a sphere.
LIGHTS: dict[str, tuple[str, dict[str, object], tuple[float, float, float]]] = {
    "point": ("POINT", {"shadow_soft_size": 0.0}, (1.0, 1.0, 1.0)),
    "soft point": ("POINT", {"shadow_soft_size": 0.8}, (2.0, 1.5, 1.0)),
    "sphere": ("POINT", {"shadow_soft_size": 0.8, "use_soft_falloff": False}, (1.0, 1.0, 1.0)),
    "spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 2.5, "spot_blend": 0.2}, (1.0, 1.0, 1.0)),
    "sun": ("SUN", {"angle": 0.0}, (1.0, 1.0, 1.0)),
    "wide sun": ("SUN", {"angle": 0.2}, (2.0, 2.0, 2.0)),
    "widest sun": ("SUN", {"angle": 1.2}, (1.0, 1.0, 1.0)),
    "rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 0.8}, (2.0, 1.5, 1.0)),
    "disk": ("AREA", {"shape": "DISK", "size": 0.9}, (1.0, 1.0, 1.0)),
    "warm point": ("POINT", {"exposure": 1.0, "use_temperature": True, "temperature": 3000.0}, (1.0, 1.0, 1.0)),
    "grid": ("AREA", {"shape": "SQUARE", "size": 0.5, "spread": 1.2}, (1.0, 1.0, 1.0)),
}


def arrange(kind: str, settings: dict[str, object], scale: tuple[float, float, float], normalize: bool) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    harness.enable()
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse")
    light = bpy.data.lights.new("Light", kind)
    light.energy = 10.0
    for name, value in settings.items():
        if hasattr(light, name):
            setattr(light, name, value)
    if not normalize:
        light.normalize = False
    scene, camera = bpy.context.scene, bpy.data.cameras.new("Camera")
    made = bpy.data.objects.new("Light", light)
    made.location, made.scale, made.visible_camera = (0.0, 0.0, 2.0), scale, False
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = Vector((0.0, 0.0, 5.0))
    for thing in (made, scene.camera):
        scene.collection.objects.link(thing)
    scene.world = None
    scene.sfumato.quality = "FINAL"
    scene.render.resolution_percentage = 100


def require(normalize: bool) -> None:
    wrong = {}
    for name, (kind, settings, scale) in LIGHTS.items():
        arrange(kind, settings, scale, normalize)
        ratio = pictures.beside_cycles(name if normalize else f"{name}, not normalised", SIZE, 400)
        if abs(ratio - 1.0) > 0.01:
            wrong[name] = ratio
    assert not wrong, wrong


def test_power_is_cycles() -> None:
    require(normalize=True)


def test_power_that_grows_with_the_light() -> None:
    if "normalize" not in bpy.types.Light.bl_rna.properties:
        raise harness.Skip("the lights of this Blender are always normalised")
    require(normalize=False)


def test_sizes() -> None:
    """Without 'Normalize' a light is as many times as bright as this: areas, and two conventions for those without."""

    def factor(kind: str, area: float = 0.0, normalize: bool = False, **settings: float) -> float:
        return compat.size_factor(types.SimpleNamespace(type=kind, normalize=normalize, **settings), area)

    assert factor("AREA", 0.6) == 0.6 and factor("AREA", 0.6, normalize=True) == 1.0
    assert np.isclose(factor("POINT", shadow_soft_size=0.5), math.pi)
    assert factor("SPOT", shadow_soft_size=0.0) == 4.0
    assert np.isclose(factor("SUN", angle=math.pi / 3.0), math.pi / 4.0)
    assert factor("SUN", angle=0.0) == 1.0


harness.main()
