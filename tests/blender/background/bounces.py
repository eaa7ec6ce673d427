# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces in each other's light and in mirrors, beside Cycles with as many bounces."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bmesh
import bpy
import harness
import pictures

SIZE = (160, 96)


Look = Callable[[Any], None]  # gives a mesh a material


def matt(*colour: float) -> Look:
    def shade(data: Any) -> None:
        harness.shade(data, "ShaderNodeBsdfDiffuse").inputs["Color"].default_value = (*colour, 1.0)

    return shade


def metal(roughness: float) -> Look:
    def shade(data: Any) -> None:
        shader = harness.shade(
            data, "ShaderNodeBsdfAnisotropic" if bpy.app.version >= (4, 0) else "ShaderNodeBsdfGlossy"
        )
        shader.distribution = "GGX"
        shader.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1.0)
        shader.inputs["Roughness"].default_value = roughness

    return shade


def glowing(strength: float) -> Look:
    def shade(data: Any) -> None:
        harness.shade(data, "ShaderNodeEmission").inputs["Strength"].default_value = strength

    return shade


def add_cube(name: str, at: tuple[float, ...], size: tuple[float, ...], look: Look) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=at)
    bpy.context.object.scale = size
    bpy.context.object.name = name
    look(bpy.context.object.data)


def add_ball(at: tuple[float, float, float], look: Look, radius: float = 0.6) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=at, segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    look(bpy.context.object.data)


def open_room(lamp: bool = True) -> None:
    """A closed room with a red wall and a block, in the light of a lamp under its ceiling."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    harness.enable()
    scene = bpy.context.scene
    scene.world = harness.black_world()
    add_cube("Room", (0.0, 0.0, 1.5), (4.0, 4.0, 3.0), matt(0.8, 0.8, 0.8))
    add_cube("Wall", (-1.98, 0.0, 1.5), (0.02, 3.9, 2.9), matt(0.8, 0.1, 0.1))
    add_cube("Block", (0.7, 0.8, 0.5), (0.8, 0.8, 1.0), matt(0.7, 0.7, 0.7))
    if lamp:
        light = bpy.data.lights.new("Lamp", "AREA")
        light.size, light.energy = 0.6, 60.0
        thing = bpy.data.objects.new("Lamp", light)
        thing.location = (0.0, 0.0, 2.9)
        scene.collection.objects.link(thing)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = 20.0
    camera.location, camera.rotation_euler = (0.0, -1.9, 1.4), (math.pi / 2.0, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_percentage = 100


def error(case: str, bounces: int, samples: int = 192) -> float:
    return pictures.error_beside_cycles(case, SIZE, samples, bounces=bounces)


def test_a_closed_room_is_lit_by_its_walls() -> None:
    open_room()
    bpy.context.scene.sfumato.bounced_light = True
    assert error("room, 4 bounces", 4) < 0.02
    assert error("room, 1 bounce", 1) < 0.02
    bpy.context.scene.sfumato.bounced_light = False
    assert error("room, not asked for", 4, 16) > 0.5


def test_bounces_are_as_many_as_light_paths_have() -> None:
    open_room()
    bpy.context.scene.sfumato.bounced_light = True
    assert error("room, none", 0, 64) < 0.03


def test_metal_shows_the_room() -> None:
    for roughness, most in ((0.15, 0.03), (0.5, 0.03)):
        open_room()
        bpy.context.scene.sfumato.bounced_light = True
        add_ball((-0.5, 0.4, 0.6), metal(roughness))
        assert error(f"a ball of roughness {roughness}", 4) < most
        bpy.context.scene.sfumato.reflections = False
        assert error("as if alone", 4, 16) > 1.5 * most


def test_what_glows_all_over_lights_a_room() -> None:
    open_room(lamp=False)
    add_ball((-0.5, 0.4, 2.0), glowing(10.0), 0.5)
    bpy.context.scene.sfumato.bounced_light = True
    assert error("a glowing ball", 3) < 0.04
    assert not any("emits" in line for line in harness.said()), harness.said()
    bpy.context.scene.sfumato.bounced_light = False
    pictures.render(SIZE)
    assert any("lights nothing" in line and "Bounced Light" in line for line in harness.said()), harness.said()


def test_a_lamp_of_few_faces_counts_once() -> None:
    open_room(lamp=False)
    add_cube("Tile", (0.0, 0.0, 2.7), (0.6, 0.6, 0.02), glowing(20.0))
    bpy.context.scene.sfumato.bounced_light = True
    assert error("a glowing tile", 3) < 0.035


def test_the_world_lights_a_room_through_its_open_side() -> None:
    open_room(lamp=False)
    room = bpy.data.objects["Room"].data
    mesh = bmesh.new()
    mesh.from_mesh(room)
    bmesh.ops.delete(mesh, geom=[face for face in mesh.faces if face.normal.y < -0.5], context="FACES")
    mesh.to_mesh(room)
    world = bpy.context.scene.world
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.8, 0.9, 1.0, 1.0)
    background.inputs["Strength"].default_value = 1.0
    bpy.context.scene.sfumato.bounced_light = True
    assert error("a room without a wall", 3) < 0.04


def test_what_it_leaves_out_is_named() -> None:
    open_room()
    add_ball((-0.5, 0.4, 0.6), metal(0.1))
    assert not any("What mirrors shows" in line for line in harness.said()), harness.said()
    bpy.ops.mesh.primitive_plane_add(size=0.5, location=(0.0, 0.0, 1.0))
    harness.shade(bpy.context.object.data, "ShaderNodeBsdfTransparent").inputs["Color"].default_value = (0.5,) * 3 + (
        1.0,
    )
    assert "What mirrors shows surfaces and smoke, but not what lets light through" in harness.said(), harness.said()
    thing = harness.volume(harness.ROOT / "blend_samples" / "frames" / "fire.vdb")
    harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume")
    assert not any("Bounced Light" in line for line in harness.said()), harness.said()
    bpy.context.scene.sfumato.bounced_light = True
    assert "Bounced Light does not reach smoke, which lamps and the world light" in harness.said(), harness.said()


if __name__ == "__main__":
    harness.main()
