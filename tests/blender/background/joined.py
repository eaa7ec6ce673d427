# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke laid over the picture of another engine, by nodes that an operator makes, beside Cycles with smoke and all."""

import math

import bpy
import harness
import numpy as np
import pictures
from numpy.typing import NDArray

SIZE = (128, 72)


def textured_plume() -> bpy.types.Object:
    """The sample, on a floor of checks and beside a cube of noise."""
    smoke = harness.open_plume()
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100
    scene.sfumato.quality = "FINAL"
    for thing in scene.objects:
        if thing.type != "MESH" or thing == smoke:
            continue
        checks = bpy.data.materials.new("Checks")
        checks.use_nodes = True
        nodes = checks.node_tree.nodes
        texture = nodes.new("ShaderNodeTexChecker")
        texture.inputs["Scale"].default_value = 7.0
        texture.inputs["Color1"].default_value, texture.inputs["Color2"].default_value = (0.9, 0.3, 0.1, 1), (
            0.1,
            0.2,
            0.4,
            1,
        )
        checks.node_tree.links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
        nodes["Principled BSDF"].inputs["Roughness"].default_value = 1.0
        thing.data.materials.clear()
        thing.data.materials.append(checks)
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.volume_bounces = 48, 0, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    return smoke


def in_cycles() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Blocks of the mean of two renders, and the squares of their noise."""
    renders = []
    for bpy.context.scene.cycles.seed in (1, 2):
        renders.append(pictures.in_blocks(pictures.render(SIZE, "CYCLES"), 8))
    return (renders[0] + renders[1]) / 2.0, (renders[0] - renders[1]) ** 2 / 4.0


def tree_of(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    return scene.compositing_node_group if hasattr(scene, "compositing_node_group") else scene.node_tree


def state() -> list[str]:
    """All that the operator may change, but for places of nodes."""
    scene = bpy.context.scene
    nodes = [f"{node.name} {node.mute}" for node in tree_of(scene).nodes]
    links = [f"{link.from_node.name} {link.from_socket.name} {link.to_node.name} {link.to_socket.identifier}"
             for link in tree_of(scene).links]  # fmt: skip
    homes = [f"{thing.name} {[home.name for home in thing.users_collection]}" for thing in bpy.data.objects]
    return (
        sorted(nodes)
        + sorted(links)
        + sorted(homes)
        + [f"{each.name} {each.render.engine}" for each in bpy.data.scenes]
    )


def test_cycles_with_our_smoke_is_cycles() -> None:
    smoke = textured_plume()
    scene = bpy.context.scene
    theirs, their_noise = in_cycles()
    smoke.hide_render = True
    bare = pictures.in_blocks(pictures.render(SIZE, "CYCLES"), 8)
    smoke.hide_render = False
    mean = float(theirs.mean())
    changed = np.abs(bare - theirs).sum(axis=-1) > 0.05 * mean
    if not changed.any():
        raise harness.Skip("the Cycles of this Blender shows no smoke")
    assert bpy.ops.sfumato.add_smoke() == {"FINISHED"}
    other = scene.sfumato.smoke_scene
    assert other is not None and other.render.engine == "SFUMATO" and scene.render.engine == "CYCLES"
    ours, our_noise = in_cycles()
    square = (ours - theirs) ** 2 - their_noise - our_noise
    whole, there = (math.sqrt(max(float(part.mean()), 0.0)) for part in (square, square[changed]))
    without = math.sqrt(float(((bare - theirs)[changed] ** 2).mean()))
    there_mean = float(theirs[changed].mean())
    print(f"  whole {whole / mean:.2%}; where smoke changes it, {changed.mean():.0%}: {there / there_mean:.2%}")
    assert changed.mean() > 0.2 and without > 0.3 * there_mean, "it is much smoke"
    assert whole < 0.02 * mean and there < 0.03 * there_mean


def test_nodes_of_the_artist_stay_and_come_after() -> None:
    smoke = textured_plume()
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    else:
        scene.use_nodes = True
    tree = tree_of(scene)
    for node in list(tree.nodes):
        tree.nodes.remove(node)
    layers, blur, viewer = (tree.nodes.new(f"CompositorNode{kind}") for kind in ("RLayers", "Blur", "Viewer"))
    blur.name = "Mine"
    tree.links.new(layers.outputs["Image"], blur.inputs["Image"])
    tree.links.new(blur.outputs["Image"], viewer.inputs["Image"])
    before = {node.name for node in tree.nodes}
    assert bpy.ops.sfumato.add_smoke() == {"FINISHED"}
    assert before < {node.name for node in tree.nodes}
    assert tree.nodes["Mine"].inputs["Image"].links[0].from_node.name == "Sfumato Smoke Over"
    once = state()
    assert bpy.ops.sfumato.add_smoke() == {"FINISHED"}
    assert state() == once, "the second time changes nothing"
    collections = len(bpy.data.collections)
    tree.nodes.remove(tree.nodes["Sfumato Smoke"])
    assert bpy.ops.sfumato.add_smoke() == {"FINISHED"}
    leads_to = {link.to_node.name for socket in tree.nodes["Sfumato Smoke"].outputs for link in socket.links}
    assert leads_to == {"Sfumato Smoke Shadow", "Sfumato Smoke Over"}, "a node that was deleted alone is linked again"
    assert len(bpy.data.collections) == collections
    # What is new goes along: an object, another camera.
    cube = bpy.data.objects.new("New", bpy.data.meshes.new("New"))
    scene.collection.objects.link(cube)
    scene.camera = scene.camera.copy()
    scene.collection.objects.link(scene.camera)
    assert bpy.ops.sfumato.add_smoke() == {"FINISHED"}
    other = scene.sfumato.smoke_scene
    assert "New" in other.objects and other.camera == scene.camera
    assert smoke.name in other.view_layers[0].objects and smoke.name not in scene.view_layers[0].objects


def test_it_can_be_undone() -> None:
    textured_plume()
    bpy.context.scene.render.engine = "CYCLES"
    bpy.ops.ed.undo_push(message="before")
    scenes = [scene.name for scene in bpy.data.scenes]
    assert bpy.ops.sfumato.add_smoke("EXEC_DEFAULT", True) == {"FINISHED"}
    assert len(bpy.data.scenes) == len(scenes) + 1
    bpy.ops.ed.undo()
    assert [scene.name for scene in bpy.data.scenes] == scenes
    assert "Smoke Domain" in bpy.context.view_layer.objects


def test_says_what_it_cannot_do() -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    assert bpy.ops.sfumato.add_smoke() == {"CANCELLED"}, "there is no smoke"
    harness.open_plume()
    bpy.context.scene.render.engine = "SFUMATO"
    assert bpy.ops.sfumato.add_smoke() == {"CANCELLED"}, "it is our scene"


harness.main()
