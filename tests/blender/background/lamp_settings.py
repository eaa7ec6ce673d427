# SPDX-License-Identifier: GPL-3.0-or-later
"""What else artists set on lamps: nodes, mirrored axes, switches. As in the Cycles of this Blender, or named."""

import bpy
import harness
import pictures
from sfumato import log  # type: ignore[attr-defined]

SIZE = (24, 24)


def arrange(kind: str, energy: float = 40.0) -> bpy.types.Object:
    """A lamp above a diffuse floor in an empty scene, seen from above beside it; gives back the lamp."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    harness.shade(mesh, "ShaderNodeBsdfDiffuse")
    camera, light = bpy.data.cameras.new("Camera"), bpy.data.lights.new("Lamp", kind)
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    light.energy = energy
    made = [bpy.data.objects.new(data.name, data) for data in (mesh, camera, light)]
    for thing in made:
        scene.collection.objects.link(thing)
    made[1].location, made[2].location = (1.0, 0.0, 5.0), (0.0, 0.0, 2.0)
    scene.camera = made[1]
    scene.render.resolution_percentage = 100
    return made[2]


def emission_of(lamp: bpy.types.Object) -> bpy.types.ShaderNode:
    """The emission among the nodes of a lamp."""
    lamp.data.use_nodes = True
    nodes, links = lamp.data.node_tree.nodes, lamp.data.node_tree.links
    nodes.clear()
    shader, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputLight")
    links.new(shader.outputs[0], output.inputs[0])
    return shader


def test_nodes_of_one_strength_and_colour_are_followed() -> None:
    for kind in ("POINT", "AREA", "SUN"):
        lamp = arrange(kind, 4.0 if kind == "SUN" else 40.0)
        shader = emission_of(lamp)
        shader.inputs["Strength"].default_value = 0.25
        shader.inputs["Color"].default_value = (0.5, 1.0, 1.0, 1.0)
        ratio = pictures.beside_cycles(f"lamp-nodes-{kind.lower()}", SIZE, 128)
        assert abs(ratio - 1.0) < 0.01 and not log.notices(), (kind, ratio, log.notices())


def test_a_value_that_is_linked_is_followed() -> None:
    lamp = arrange("POINT")
    shader, tree = emission_of(lamp), lamp.data.node_tree
    value, colour = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("ShaderNodeRGB")
    value.outputs[0].default_value, colour.outputs[0].default_value = 0.25, (0.5, 1.0, 1.0, 1.0)
    tree.links.new(value.outputs[0], shader.inputs["Strength"])
    tree.links.new(colour.outputs[0], shader.inputs["Color"])
    ratio = pictures.beside_cycles("lamp-nodes-linked", SIZE, 128)
    assert abs(ratio - 1.0) < 0.01 and not log.notices(), (ratio, log.notices())


def test_other_nodes_are_named() -> None:
    lamp = arrange("POINT")
    shader, tree = emission_of(lamp), lamp.data.node_tree
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    tree.links.new(falloff.outputs["Linear"], shader.inputs["Strength"])
    pictures.render(SIZE)
    assert any("Lamp" in notice and "Strength" in notice for notice in log.notices()), log.notices()


def test_a_mirrored_area_light_shines_along_its_own_axis() -> None:
    for scale in ((-1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (1.0, -1.0, 1.0), (-1.0, 1.0, -1.0)):
        lamp = arrange("AREA")
        lamp.scale = scale
        if scale[2] > 0.0:
            ratio = pictures.beside_cycles("mirrored", SIZE, 128)
            assert abs(ratio - 1.0) < 0.01, (scale, ratio)
        else:
            assert not pictures.render(SIZE)[..., :3].any(), (scale, "it shines upwards")


def test_switches_that_are_not_followed_are_named() -> None:
    lamp = arrange("POINT", -40.0)
    pictures.render(SIZE)
    assert any("takes light away" in notice for notice in log.notices()), log.notices()


harness.main()
