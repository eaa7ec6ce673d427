# SPDX-License-Identifier: GPL-3.0-or-later
"""Write plume_particles.blend, a particle system of 16,384 puffs of smoke; million.blend, a point cloud of 1,000,000 that
Geometry Nodes make as the file is opened; and hair.blend, a ball with hair.

Run with:  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 3 --python blend_samples/make_particles.py
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import make  # noqa: E402 # the materials and settings that all samples share

PUFFS, MILLION, HAIRS = 16_384, 1_000_000, 12_000
HEIGHT = 3.0  # metres, of both plumes
VIEW = Vector((1.4, -10.0, 5.8)), Vector((0.95, 0.0, 1.7))  # a camera, and what it looks at
SUN = Vector((0.72, 0.02, -0.53))


def begin() -> None:
    """A floor, in the sun."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=80.0)
    make.named("Floor").data.materials.append(make.material("Floor", (0.3, 0.32, 0.36)))


def end(name: str, camera: Vector, target: Vector, sun: Vector = SUN) -> None:
    """Seen by a camera that looks at a target; saved."""
    make.view_and_light()
    scene = bpy.context.scene
    bpy.data.objects["Sun"].rotation_euler = sun.to_track_quat("-Z", "Y").to_euler()
    bpy.data.objects["Sun"].data.energy = 8.0
    scene.camera.location = camera
    scene.camera.rotation_euler = (target - camera).to_track_quat("-Z", "Y").to_euler()
    make.output()
    scene.frame_start = scene.frame_end = 1
    scene.render.filepath = f"//out/{name}"
    scene.frame_set(1)
    make.save(name)


def risen(count: int) -> NDArray[np.float64]:
    """Places (n, 3) in a cone that waves of three sizes curl, the more the higher."""
    random = np.random.default_rng(1)
    height, turn = random.uniform(size=count), random.uniform(0.0, 2.0 * math.pi, count)
    far = (0.1 + 0.4 * height) * np.sqrt(random.uniform(size=count))
    places = np.stack((far * np.cos(turn), far * np.sin(turn), 0.1 + HEIGHT * height), axis=1)
    for pitch, strength in ((2.5, 0.5), (6.0, 0.25), (14.0, 0.12)):
        waves = random.normal(size=(16, 3))
        waves *= pitch * random.uniform(0.6, 1.4, (16, 1)) / np.linalg.norm(waves, axis=1, keepdims=True)
        pushes = random.normal(size=(16, 3)) * strength / 4.0
        phases = random.uniform(0.0, 2.0 * math.pi, 16)
        places += (0.2 + height[:, None]) * (np.sin(places @ waves.T + phases) @ pushes)
    return places


def plume_particles() -> None:
    """As the plume of Jansen and Bavoil's figure 1: particles that render as Halo, at the vertices of a mesh. They look as
    those of a new system do."""
    begin()
    mesh = bpy.data.meshes.new("Plume")
    mesh.from_pydata(risen(PUFFS).tolist(), [], [])
    thing = bpy.data.objects.new("Plume", mesh)
    bpy.context.scene.collection.objects.link(thing)
    settings = thing.modifiers.new("Smoke", "PARTICLE_SYSTEM").particle_system.settings
    settings.name = "Smoke"
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = PUFFS, 1.0, 1.0, 250.0
    settings.emit_from, settings.use_emit_random, settings.physics_type = "VERT", False, "NO"
    settings.particle_size, settings.size_random, settings.render_type = 0.015, 0.5, "HALO"
    end("plume_particles", *VIEW)


def million() -> None:
    """A point cloud whose places are a formula of nodes, in a material of Principled Volume."""
    begin()
    made = bpy.data.materials.new("Smoke")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    volume, output = tree.nodes.new("ShaderNodeVolumePrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    volume.inputs["Color"].default_value = (0.9, 0.9, 0.9, 1.0)
    volume.inputs["Density"].default_value = 1.5
    tree.links.new(volume.outputs[0], output.inputs["Volume"])
    thing = bpy.data.objects.new("Million", bpy.data.meshes.new("Million"))
    bpy.context.scene.collection.objects.link(thing)
    thing.modifiers.new("Points", "NODES").node_group = million_points(made)
    end("million", *VIEW)


class Nodes:
    """Geometry nodes, made and linked by what they compute."""

    def __init__(self) -> None:
        self.tree = bpy.data.node_groups.new("Million", "GeometryNodeTree")
        if hasattr(self.tree, "interface"):
            self.tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        else:
            self.tree.outputs.new("NodeSocketGeometry", "Geometry")

    def add(self, kind: str, inputs: dict[int, Any], output: int = 0, **settings: Any) -> Any:
        """An output of a new node, whose inputs are other outputs or constants."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        for index, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[index])
            else:
                node.inputs[index].default_value = value
        return node.outputs[output]

    def math(self, operation: str, *values: Any) -> Any:
        return self.add("ShaderNodeMath", dict(enumerate(values)), operation=operation)

    def random(self, low: float, high: float, seed: int) -> Any:
        return self.add("FunctionNodeRandomValue", {2: low, 3: high, 8: seed}, 1, data_type="FLOAT")


def million_points(material: bpy.types.Material) -> bpy.types.NodeTree:
    """A cone that noise of two sizes curls, the more the higher."""
    nodes = Nodes()
    height, turn = nodes.random(0.0, 1.0, 1), nodes.random(0.0, 2.0 * math.pi, 2)
    wide = nodes.math("ADD", 0.1, nodes.math("MULTIPLY", 0.5, height))
    far = nodes.math("MULTIPLY", wide, nodes.math("SQRT", nodes.random(0.0, 1.0, 3)))
    axes = [nodes.math("MULTIPLY", far, nodes.math(each, turn)) for each in ("COSINE", "SINE")]
    place = nodes.add(
        "ShaderNodeCombineXYZ",
        {0: axes[0], 1: axes[1], 2: nodes.math("ADD", 0.1, nodes.math("MULTIPLY", HEIGHT, height))},
    )
    for scale, strength in ((1.1, 2.2), (4.0, 0.7)):
        noise = nodes.add("ShaderNodeTexNoise", {0: place, 2: scale, 3: 1.0}, 1)
        push = nodes.add("ShaderNodeVectorMath", {0: noise, 1: (0.5, 0.5, 0.5)}, operation="SUBTRACT")
        amount = nodes.math("MULTIPLY", strength, nodes.math("ADD", 0.15, height))
        push = nodes.add("ShaderNodeVectorMath", {0: push, 3: amount}, operation="SCALE")
        place = nodes.add("ShaderNodeVectorMath", {0: place, 1: push}, operation="ADD")
    points = nodes.add("GeometryNodePoints", {0: MILLION, 1: place, 2: 0.02})
    dressed = nodes.add("GeometryNodeSetMaterial", {0: points, 2: material})
    end_node = nodes.tree.nodes.new("NodeGroupOutput")
    nodes.tree.links.new(dressed, end_node.inputs[0])
    return nodes.tree


def hair() -> None:
    """Hair of a particle system, which bends as it falls, in a Principled Hair of little melanin."""
    begin()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.8, location=(0.0, 0.0, 1.0))
    ball = make.named("Ball")
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(make.material("Skin", (0.12, 0.07, 0.045)))
    made = bpy.data.materials.new("Hair")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeBsdfHairPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.parametrization = "MELANIN"
    shader.inputs["Melanin"].default_value = 0.3
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    ball.data.materials.append(made)
    settings = ball.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.name = "Hair"
    settings.type, settings.count, settings.hair_step = "HAIR", HAIRS, 8
    settings.material, settings.root_radius, settings.tip_radius, settings.radius_scale = 2, 1.0, 0.3, 0.003
    settings.use_advanced_hair, settings.normal_factor, settings.tangent_factor = True, 0.07, 0.06
    settings.effector_weights.gravity = 0.03
    end("hair", Vector((0.6, -5.0, 3.2)), Vector((0.3, 0.0, 0.85)), Vector((0.5, 0.35, -0.75)))


if __name__ == "__main__":
    plume_particles()
    million()
    hair()
