# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material makes of a sun: a floor, seen from an angle, as bright as the Cycles of this very Blender makes it.

Each case is there for something that Cycles does differently in another version (addon/compat.py).
"""

import math

import bpy
import harness
import pictures

SIZE = (8, 8)
GREY, COPPER = (0.8, 0.8, 0.8, 1.0), (0.9, 0.5, 0.3, 1.0)
# Shader, its inputs, the sun's angle to the normal, and the eye's on the other side; negative on the same side.
Case = tuple[str, dict[str, object], float, float]
PRINCIPLED, GLOSSY = "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfGlossy"
CASES: dict[str, Case] = {
    "diffuse": ("ShaderNodeBsdfDiffuse", {"Color": GREY}, 30.0, -60.0),
    "default, from above": (PRINCIPLED, {}, 30.0, -10.0),
    "default, from 60 degrees": (PRINCIPLED, {}, 30.0, -60.0),
    "default, mirrored": (PRINCIPLED, {}, 40.0, 40.0),
    "default, grazing": (PRINCIPLED, {}, 78.0, 78.0),
    "smooth, from 75 degrees": (PRINCIPLED, {"Roughness": 0.2}, 30.0, -75.0),
    "rough, from 80 degrees": (PRINCIPLED, {"Roughness": 1.0}, 80.0, -80.0),
    "index 2": (PRINCIPLED, {"IOR": 2.0}, 40.0, 40.0),
    "no specular": (PRINCIPLED, {"Specular": 0.0, "Specular IOR Level": 0.0, "Roughness": 1.0}, 70.0, -70.0),
    "much specular": (PRINCIPLED, {"Specular": 1.0, "Specular IOR Level": 1.0}, 40.0, 40.0),
    "metal": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 1.0}, 40.0, 40.0),
    "metal, grazing": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 1.0, "Roughness": 0.3}, 78.0, 78.0),
    "rough metal": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 1.0, "Roughness": 1.0}, 40.0, -40.0),
    "rough metal, grazing": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 1.0, "Roughness": 1.0}, 75.0, -75.0),
    "glossy": (GLOSSY, {"Color": COPPER, "Roughness": 0.5}, 40.0, 40.0),
    "rough glossy": (GLOSSY, {"Color": COPPER, "Roughness": 1.0}, 75.0, -75.0),
    "glow": (PRINCIPLED, {"Emission": GREY, "Emission Color": GREY, "Emission Strength": 2.0}, 30.0, -10.0),
}


def arrange(shader: str, inputs: dict[str, object], sun_angle: float, eye_angle: float) -> None:
    """Of inputs that have other names in other versions, those that are there are set."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    harness.enable()
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    node = harness.shade(bpy.context.object.data, shader)
    for name, value in inputs.items():
        if name in node.inputs:
            node.inputs[name].default_value = value
    light, camera = bpy.data.lights.new("Sun", "SUN"), bpy.data.cameras.new("Camera")
    light.energy, light.angle = math.pi, 0.0
    camera.type, camera.ortho_scale = "ORTHO", 0.5
    scene = bpy.context.scene
    sun, scene.camera = bpy.data.objects.new("Sun", light), bpy.data.objects.new("Camera", camera)
    sun.rotation_euler = (-math.radians(sun_angle), 0.0, 0.0)
    turn = math.radians(eye_angle)
    scene.camera.location = (0.0, -10.0 * math.sin(turn), 10.0 * math.cos(turn))
    scene.camera.rotation_euler = (turn, 0.0, 0.0)
    for thing in (sun, scene.camera):
        scene.collection.objects.link(thing)
    scene.world = None
    scene.sfumato.quality = "FINAL"
    scene.render.resolution_percentage = 100


def test_a_material_is_cycles() -> None:
    wrong = {}
    for name, case in CASES.items():
        arrange(*case)
        ratio = pictures.beside_cycles(name, SIZE, 16)
        if abs(ratio - 1.0) > 0.01:
            wrong[name] = ratio
    assert not wrong, wrong


harness.main()
