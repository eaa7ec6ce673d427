# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose material has a volume, beside Cycles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import harness
import pictures
from harness import put, said
from sfumato.export import scene

SIZE = (48, 32)
MOST = 0.02  # of the mean square of blocks


def cube() -> None:
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.05))


def monkey() -> None:
    bpy.ops.mesh.primitive_monkey_add(size=2.4, location=(0.0, 0.0, 1.1), rotation=(0.0, 0.0, 0.4))


def place(kind: str, shape: Callable[[], None], *shaders: str) -> tuple[Any, list[Any]]:
    """What is filled by the sum of volume shaders, over a floor with a post in it, one lamp, and a black world: the object
    and the shaders."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    view = bpy.context.scene
    view.world = harness.black_world()
    for size, where, name in (
        ((30.0, 30.0, 0.2), (0.0, 0.0, -0.1), "Floor"),
        ((0.3, 0.3, 1.6), (0.5, 0.2, 0.8), "Post"),
    ):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=where, scale=size)
        bpy.context.object.name = name
        harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse").inputs[0].default_value = (0.3, 0.5, 0.4, 1.0)
    lamp = bpy.data.lights.new("Lamp", kind)
    lamp.energy = 4.0 if kind == "SUN" else 400.0
    if kind in {"POINT", "SPOT"}:
        lamp.shadow_soft_size = 0.02
    if kind == "SPOT":
        lamp.spot_size, lamp.spot_blend, lamp.energy = 0.8, 0.3, 2500.0
    light = bpy.data.objects.new("Lamp", lamp)
    light.location, light.rotation_euler = (-1.6, -0.4, 3.6), (0.15, -0.55, 0.0)
    view.collection.objects.link(light)
    view.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    view.camera.location, view.camera.rotation_euler = (0.6, -6.0, 2.2), (1.4, 0.0, 0.1)
    view.collection.objects.link(view.camera)
    view.render.resolution_percentage = 100
    shape()
    thing = bpy.context.object
    thing.name = "Fog"
    found = [harness.shade(thing.data, f"ShaderNode{shaders[0]}", "Volume")]
    tree = thing.data.materials[0].node_tree
    output = tree.get_output_node("ALL")
    for name in shaders[1:]:
        added, other = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new(f"ShaderNode{name}")
        tree.links.new(output.inputs["Volume"].links[0].from_socket, added.inputs[0])
        tree.links.new(other.outputs[0], added.inputs[1])
        tree.links.new(added.outputs[0], output.inputs["Volume"])
        found.append(other)
    return thing, found


def beside_cycles(case: str, samples: int = 256) -> None:
    error = pictures.error_beside_cycles(case, SIZE, samples)
    assert error < MOST, (case, error)


def test_a_cube_in_a_sun_is_as_in_cycles() -> None:
    _, (scatter,) = place("SUN", cube, "VolumeScatter")
    put(scatter, Density=0.7)
    beside_cycles("cube, sun")
    put(scatter, Color=(0.9, 0.5, 0.2), Anisotropy=0.5, Density=1.5)
    beside_cycles("cube, sun, coloured and anisotropic")
    assert said() == [], said()


def test_spots_and_points_are_as_in_cycles() -> None:
    _, (scatter,) = place("SPOT", cube, "VolumeScatter")
    put(scatter, Density=0.6)
    beside_cycles("cube, spot outside", 512)
    bpy.data.objects["Lamp"].location = (-0.5, -0.3, 1.8)
    bpy.data.lights["Lamp"].energy = 400.0
    # The lamp itself is out of sight: its glow is finer than these pixels.
    bpy.context.scene.camera.rotation_euler = (1.2, 0.0, 0.1)
    beside_cycles("cube, spot inside", 512)


def test_the_eye_in_it_sees_as_in_cycles() -> None:
    _, (scatter,) = place("SUN", cube, "VolumeScatter")
    put(scatter, Density=0.5)
    bpy.context.scene.camera.location, bpy.context.scene.camera.rotation_euler = (0.0, -0.8, 1.4), (1.4, 0.0, 0.0)
    beside_cycles("eye in the cube")


def test_what_absorbs_and_glows_is_as_in_cycles() -> None:
    _, (absorption, emission) = place("SUN", cube, "VolumeAbsorption", "Emission")
    put(absorption, Density=0.8, Color=(0.9, 0.4, 0.2))
    put(emission, Strength=0.0)
    beside_cycles("absorption")
    put(emission, Strength=0.2, Color=(0.2, 0.5, 1.0))
    assert said() == ["Fog: its volume glows, but lights nothing else"], said()
    for name in ("Floor", "Post"):  # which in Cycles it lights
        material = bpy.data.objects[name].data.materials[0]
        material.node_tree.nodes["Diffuse BSDF"].inputs[0].default_value = (0.0, 0.0, 0.0, 1.0)
    beside_cycles("absorption and emission")
    _, (principled,) = place("SUN", cube, "VolumePrincipled")
    put(principled, Density=0.8, Color=(0.3, 0.6, 0.9), Absorption_Color=(0.1, 0.2, 0.3))
    beside_cycles("principled")


def test_a_shape_with_hollows_is_as_in_cycles() -> None:
    _, (scatter,) = place("SUN", monkey, "VolumeScatter")
    put(scatter, Density=1.0)
    beside_cycles("monkey, sun")
    (notice,) = said()
    assert notice.startswith("Fog: its mesh is open at "), notice


def test_instances_modifiers_and_surfaces_are_followed() -> None:
    thing, (scatter,) = place("SUN", cube, "VolumeScatter")
    put(scatter, Density=1.0)
    thing.scale = (0.5, 0.4, 0.3)
    thing.modifiers.new("Subdivision", "SUBSURF").levels = 2
    thing.modifiers["Subdivision"].render_levels = 2
    other = thing.copy()
    other.location, other.scale = (-0.9, 0.4, 0.6), (-0.4, 0.4, 0.5)
    bpy.context.scene.collection.objects.link(other)
    beside_cycles("two of one mesh, subdivided")
    tree = thing.data.materials[0].node_tree
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    clear.inputs["Color"].default_value = (0.5, 0.8, 0.9, 1.0)
    tree.links.new(clear.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    beside_cycles("with a surface, too")


def test_faces_that_only_a_volume_has_are_clear_beside_others() -> None:
    thing, (scatter,) = place("SUN", cube, "VolumeScatter")
    put(scatter, Density=0.7)
    lid = bpy.data.materials.new("Lid")
    lid.use_nodes = True
    tree = lid.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs[0].default_value = (0.7, 0.2, 0.1, 1.0)
    tree.links.new(diffuse.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    thing.data.materials.append(lid)
    for face in thing.data.polygons:
        face.material_index = int(face.normal.x > 0.9 or face.normal.z < -0.9)
    beside_cycles("a wall and a floor with a surface")
    assert said() == [], said()


def test_what_is_not_followed_is_named() -> None:
    thing, (scatter,) = place("SUN", cube, "VolumeScatter")
    put(scatter, Density=0.4)
    tree = thing.data.materials[0].node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], scatter.inputs["Density"])
    assert said() == ["Fog: the link into 'Density' is not followed; its own value is used"], said()
    tree.nodes.remove(noise)
    thing.data.flip_normals()
    assert said() == [
        "Fog: its normals point inwards, so Cycles fills what is around it; here its inside is filled"
    ], said()
    harness.shade(thing.data, "ShaderNodeVolumeAbsorption", "Volume")
    assert "Fog: 2 of its materials have a volume; the first fills all of it" in said(), said()
    put(scatter, Density=0.0)
    thing.data.materials.pop(index=1)
    assert said() == [], said()


def test_what_has_no_volume_is_as_before() -> None:
    place("SUN", cube, "VolumeScatter")
    bpy.data.objects.remove(bpy.data.objects["Fog"])
    found = scene.export(bpy.context.evaluated_depsgraph_get())
    frame = scene.made_of(found, bpy.context.scene, scene.Parts())
    assert not frame.air and "fog" not in frame.stages, frame.stages


harness.main()
