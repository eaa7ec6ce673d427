#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/volume_shaders_added.sh
#
# Cycles before 4.5 (bpy 4.2.23 from PyPI; Debian's 3.4.1 answers alike) adds and mixes the shaders of a volume wrongly;
# 4.5.15 is right:
#   - two Volume Scatter, added, scatter twice the light of one with the sum of their densities: each one's phase function
#     is taken for the light of all;
#   - a Mix Shader shares out what volumes scatter and absorb, but not what they emit;
#   - where what a volume scatters and what it absorbs have different colours, and its density differs from place to place,
#     its light is some 6 % less than by each channel alone; in a volume of one density it is right.
#
# Seen, 4.2.23 / 4.5.15:
#   two added, times one of the sum: 2.00 / 1.00
#   a quarter of an emission of 1: 1.00 / 0.25
#   coloured, times channel by channel: 0.94 / 1.00
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/added.py" <<'PYTHON'
import sys

import bpy
import numpy as np


def stage(build):
    """The mean of the picture of a cube that is filled with what `build` makes of a node tree."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    material = bpy.data.materials.new("Volume")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(build(tree), output.inputs["Volume"])
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 0.5
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location.z = 5.0
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 10.0
    lamp = bpy.data.objects.new("Sun", sun)
    lamp.rotation_euler.x = 1.0
    for thing in (scene.camera, lamp):
        scene.collection.objects.link(thing)
    scene.world = bpy.data.worlds.new("Black")
    scene.world.color = (0.0, 0.0, 0.0)
    render, cycles = scene.render, scene.cycles
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 16, 16
    cycles.samples, cycles.max_bounces, cycles.volume_bounces, cycles.volume_step_rate = 256, 0, 0, 0.5
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = f"{bpy.app.tempdir}picture.exr"
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(render.filepath)
    return np.array(picture.pixels[:]).reshape(-1, 4)[:, :3].mean(axis=0)


def node(tree, kind, **values):
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in values.items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, made.inputs[name])
        else:
            made.inputs[name].default_value = value
    return made


def both(tree, kind, one, other):
    made = tree.nodes.new(f"ShaderNode{kind}")
    for shader, socket in zip((one, other), [socket for socket in made.inputs if socket.type == "SHADER"]):
        tree.links.new(shader.outputs[0], socket)
    return made


def added(tree, count):
    scatter = [node(tree, "VolumeScatter", Density=0.05 / count) for _ in range(count)]
    return (scatter[0] if count == 1 else both(tree, "AddShader", *scatter)).outputs[0]


def mixed(tree):
    made = both(tree, "MixShader", node(tree, "Emission"), node(tree, "VolumeAbsorption", Density=0.0))
    made.inputs[0].default_value = 0.75
    return made.outputs[0]


def coloured(tree, absorption, scattering):
    """Coefficients of up to 4, in a ball."""
    ball = node(tree, "TexGradient", Vector=node(tree, "TexCoord").outputs["Object"])
    ball.gradient_type = "SPHERICAL"
    dense = node(tree, "Math")
    dense.operation = "MULTIPLY"
    tree.links.new(ball.outputs["Fac"], dense.inputs[0])
    dense.inputs[1].default_value = 4.0
    colours = [(*(1.0 - np.array(absorption) / 4.0), 1.0), (*(np.array(scattering) / 4.0), 1.0)]
    shaders = [
        node(tree, kind, Color=colour, Density=dense.outputs[0])
        for kind, colour in zip(("VolumeAbsorption", "VolumeScatter"), colours)
    ]
    return both(tree, "AddShader", *shaders).outputs[0]


twice = stage(lambda tree: added(tree, 2)).mean() / stage(lambda tree: added(tree, 1)).mean()
quarter = stage(mixed).mean() / 2.0  # metres
absorption, scattering = (0.4, 2.4, 3.6), (0.9, 1.8, 2.7)
apart = [stage(lambda t, c=c: coloured(t, [absorption[c]] * 3, [scattering[c]] * 3))[c] for c in range(3)]
together = (stage(lambda tree: coloured(tree, absorption, scattering)) / apart).mean()
print(f"{bpy.app.version_string}: {twice:.2f}, {quarter:.2f}, {together:.2f}")
old = bpy.app.version < (4, 5)
assert abs(twice - (2.0 if old else 1.0)) < 0.02
assert abs(quarter - (1.0 if old else 0.25)) < 0.01
assert together < 0.96 if old else abs(together - 1.0) < 0.01
PYTHON
for version in 4.2.23 4.5.15; do
    python3.11 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "bpy==$version" 'numpy<2'
    "$folder/$version/bin/python" "$folder/added.py"
done
