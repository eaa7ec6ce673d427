# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py particles that runs inside Blender: a picture of a plume by both engines, in turns.

    blender -b FILE --addons sfumato --python tests/bench/bench_particles_in_blender.py -- SECONDS.json

To Cycles a particle is an icosphere of 20 triangles, one mesh in as many places, with a surface that lets nine tenths
through. What is in the file does not matter.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import particle_plume  # noqa: E402
import progress  # noqa: E402

TURNS = 3


def material() -> bpy.types.Material:
    """Opaque by a tenth, whichever particle: what it shows is not what is measured."""
    made = bpy.data.materials.new("puff")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    mix, clear, dull = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "BsdfTransparent", "BsdfDiffuse"))
    mix.inputs[0].default_value = 0.1
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(dull.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return made


def fill_scene() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=1, radius=1.0)
    ball = bpy.context.object
    ball.data.materials.append(material())
    points, radius, _ = particle_plume.plume()
    # A triangle a particle, whose size is that of its copy.
    corners = np.array([(0.0, 1.0, 0.0), (-math.sqrt(0.75), -0.5, 0.0), (math.sqrt(0.75), -0.5, 0.0)])
    area = 0.75 * math.sqrt(3.0)  # of that triangle; Blender scales a copy by the root of the face's area
    vertices = (points[:, None] + corners * (radius / math.sqrt(area))[:, None, None]).reshape(-1, 3)
    mesh = bpy.data.meshes.new("plume")
    mesh.from_pydata(vertices.tolist(), [], np.arange(len(vertices)).reshape(-1, 3).tolist())
    parent = bpy.data.objects.new("plume", mesh)
    bpy.context.collection.objects.link(parent)
    parent.instance_type = "FACES"
    parent.use_instance_faces_scale = True
    parent.show_instancer_for_render = False
    ball.parent = parent
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler = (math.radians(30.0), math.radians(-15.0), 0.0)
    bpy.context.collection.objects.link(sun)
    lens = bpy.data.cameras.new("camera")
    lens.angle = math.radians(40.0)
    eye = bpy.data.objects.new("camera", lens)
    eye.location = (0.0, -2.2, 0.9)
    eye.rotation_euler = (math.atan2(2.2, 0.4), 0.0, 0.0)
    bpy.context.collection.objects.link(eye)
    scene = bpy.context.scene
    scene.camera = eye
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 640, 360, 100
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.transparent_max_bounces = 128


def cycles() -> float:
    start = time.perf_counter()
    bpy.ops.render.render()
    return time.perf_counter() - start


def main(answer: Path) -> None:
    native = importlib.import_module("sfumato._native.sfumato")
    sys.modules["sfumato"] = native  # by the name that it has outside of Blender
    from bench_particles import PICTURE, camera

    fill_scene()
    arrays = particle_plume.plume()

    def ours() -> float:
        start = time.perf_counter()
        scene = native.Scene()
        scene.add_particles(*arrays)
        scene.add_sun(particle_plume.SUN, (4.0, 4.0, 4.0))
        native.Frame(scene).render(camera(*PICTURE), *PICTURE, edge_samples=1)
        return time.perf_counter() - start

    best = {"cycles-1": math.inf, "sfumato-beside": math.inf}
    for turn in range(TURNS):
        progress.step(f"16k-512, both engines, turn {turn + 1}")
        best["cycles-1"] = min(best["cycles-1"], cycles())
        best["sfumato-beside"] = min(best["sfumato-beside"], ours())
    answer.write_text(json.dumps(best), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
