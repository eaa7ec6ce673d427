# SPDX-License-Identifier: GPL-3.0-or-later
"""Every kind of lamp on a floor, without anything in its way, against Cycles.

Measured with Blender 3.4 and 500 to 1000 samples a pixel, the worst lamp of each floor, Cycles' own noise (in brackets)
not taken off: diffuse 0.6 % (0.5), roughness 0.1 2.5 % (1.0), 0.3 0.6 % (0.5), 0.6 0.5 % (0.2), 1.0 0.6 % (0.5).
"""

import math

import bpy
import harness
import numpy as np
import pictures
from mathutils import Vector
from numpy.typing import NDArray

SIZE = (64, 36)
SHAPES = {"SQUARE": (1.0, 1.0), "RECTANGLE": (1.6, 0.6), "DISK": (1.0, 1.0), "ELLIPSE": (1.6, 0.6)}
LAMPS = [(shape, spread) for shape in SHAPES for spread in (180.0, 60.0)] + [("POINT", 180.0), ("SPOT", 180.0)]
AIM = Vector((0.0, -1.0, 0.0))  # where the camera sees the lamp reflected


def floor(roughness: float | None) -> None:
    """A floor of GGX, or without a roughness a diffuse one."""
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    material = bpy.data.materials.new("Floor")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse" if roughness is None else "ShaderNodeBsdfGlossy")
    if roughness is not None:
        shader.distribution = "GGX"
        shader.inputs["Roughness"].default_value = roughness
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def lamp(kind: str, spread: float) -> bpy.types.Object:
    light = bpy.data.lights.new("Lamp", "AREA" if kind in SHAPES else kind)
    light.energy = 300.0
    if kind in SHAPES:
        light.shape = kind
        light.size, light.size_y = SHAPES[kind]
        light.spread = math.radians(spread)
    else:
        light.shadow_soft_size = 0.3
    if kind == "SPOT":
        light.spot_size, light.spot_blend = math.radians(60.0), 0.3
    return add(light, (0.2, 2.0, 2.0))


def add(data: bpy.types.ID, location: tuple[float, float, float]) -> bpy.types.Object:
    """An object that looks at AIM."""
    made = bpy.data.objects.new(data.name, data)
    made.location = location
    made.rotation_euler = (AIM - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)
    return made


def arrange(kind: str, spread: float, roughness: float | None, lens: float) -> bpy.types.Object:
    """A scene with nothing but a floor and a lamp, which is given back."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="sfumato")
    floor(roughness)
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.lens = lens
    scene.camera = add(camera, (0.0, -4.0, 2.0))
    scene.world = None  # a new one is made of nodes from Blender 5.0 on, and lights the scene in grey
    scene.sfumato.quality = "FINAL"
    scene.render.resolution_percentage = 100
    return lamp(kind, spread)


def difference(samples: int) -> float:
    """Of the scene as both engines show it: root mean square over mean."""
    ours = pictures.render(SIZE)[..., 0]
    cycles = bpy.context.scene.cycles
    cycles.max_bounces, cycles.samples, cycles.seed = 0, samples, 1
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    theirs: NDArray[np.float32] = pictures.render(SIZE, "CYCLES")[..., 0]
    return float(np.sqrt(((ours - theirs) ** 2).mean()) / theirs.mean())


def require(roughness: float | None, lens: float, samples: int, most: float) -> None:
    if bpy.app.version >= (4, 0, 0):
        raise harness.Skip("measured against the Cycles of Blender 3.4 only")
    found = {}
    for kind, spread in LAMPS:
        arrange(kind, spread, roughness, lens)
        found[f"{kind} {spread:g}"] = difference(samples)
    print({name: f"{100.0 * error:.2f} %" for name, error in found.items()})
    assert max(found.values()) <= most, found


def test_diffuse_floor() -> None:
    require(None, 50.0, 300, 0.01)


# The closer look is filled by the lamp's reflection: what Cycles' noise is there counts for less.
def test_roughness_0_1() -> None:
    require(0.1, 130.0, 500, 0.03)


def test_roughness_0_3() -> None:
    require(0.3, 130.0, 100, 0.03)


def test_roughness_0_6() -> None:
    require(0.6, 50.0, 300, 0.01)


def test_roughness_1() -> None:
    require(1.0, 50.0, 300, 0.015)


def test_scaled_lamp() -> None:
    if bpy.app.version >= (4, 0, 0):
        raise harness.Skip("measured against the Cycles of Blender 3.4 only")
    for roughness, most in ((None, 0.01), (0.6, 0.03)):
        arrange("ELLIPSE", 180.0, roughness, 50.0).scale = (1.5, 0.7, 2.0)
        assert difference(300) <= most, roughness


def test_emitting_rectangle() -> None:
    """It lights a floor as it does in Cycles, and is seen as bright as it is.

    Where its own plane cuts the floor in view, as with rotation (0.7, 0.3, 0.2), we are 4.6 % off and 3 % brighter.
    Why is not known; area lamps in that place, of both directions, agree with Cycles to 0.2 %.
    """
    arrange("POINT", 180.0, None, 50.0).data.energy = 0.0
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(0.2, 2.0, 2.0), rotation=(-0.7, 0.0, 0.0))
    plane = bpy.context.object
    plane.scale = (1.4, 0.8, 1.0)
    material = bpy.data.materials.new("Glow")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (0.5, 0.5, 0.5, 1.0), 30.0
    tree.links.new(shader.outputs["Emission"], output.inputs["Surface"])
    plane.data.materials.append(material)
    found = difference(300)
    assert found <= 0.01, found
    camera = bpy.context.scene.camera
    camera.rotation_euler = (plane.location - camera.location).to_track_quat("-Z", "Y").to_euler()
    middle = pictures.render(SIZE)[SIZE[1] // 2, SIZE[0] // 2, :3]
    assert np.allclose(middle, 15.0, rtol=1e-4), middle


harness.main()
