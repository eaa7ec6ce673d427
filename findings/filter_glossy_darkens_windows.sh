#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/filter_glossy_darkens_windows.sh
#
# Cycles (bpy 5.0.1 from PyPI): Filter Glossy, which every new scene has at 1, is known to blur what glass throws. Behind a
# flat pane of clear, smooth glass, wide enough that nothing could come past it, there is nothing to blur; yet it takes a
# quarter of a large lamp's light straight below the pane, and half of it where the pane is tilted. The caustics are on,
# nothing is clamped, and bounces are enough.
#
# Seen, the light on a floor below a pane of index 1.5, over that without the pane (Fresnel leaves .92 straight on):
#   tilt  0: .956 without the filter, .719 with it
#   tilt 30: .942, .658
#   tilt 60: .832, .402
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/env"
"$folder/env/bin/pip" install --quiet 'bpy==5.0.1' 'numpy<2'
cd "$folder"
"$folder/env/bin/python" - <<'PYTHON'
import math

import bpy
import numpy as np

assert bpy.app.version == (5, 0, 1), bpy.app.version_string
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
assert scene.cycles.blur_glossy == 1.0, scene.cycles.blur_glossy


def shaded(kind, **inputs):
    material = bpy.data.materials.new(kind)
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    for name, value in inputs.items():
        shader.inputs[name].default_value = value
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def add(data, place):
    thing = bpy.data.objects.new(data.name, data)
    thing.location = place
    scene.collection.objects.link(thing)
    return thing


bpy.ops.mesh.primitive_plane_add(size=20.0)
shaded("ShaderNodeBsdfDiffuse")
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 2.0))
pane = bpy.context.object
pane.scale = (6.0, 6.0, 0.02)
shaded("ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.5)
lamp = bpy.data.lights.new("Lamp", "AREA")
lamp.size, lamp.energy = 2.0, 1000.0
add(lamp, (0.0, 0.0, 6.0))
camera = bpy.data.cameras.new("Camera")
camera.type, camera.ortho_scale = "ORTHO", 0.6
scene.camera = add(camera, (0.0, 0.0, 0.5))  # below the pane
scene.world = bpy.data.worlds.new("World")
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
scene.render.engine = "CYCLES"
scene.render.resolution_x = scene.render.resolution_y = 24
scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", f"{bpy.app.tempdir}floor.exr"
cycles = scene.cycles
cycles.samples, cycles.seed, cycles.max_bounces = 1024, 1, 12
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.sample_clamp_indirect = 0.0
assert cycles.caustics_refractive


def light():
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    mean = float(np.array(image.pixels[:]).reshape(-1, 4)[:, 0].mean())
    bpy.data.images.remove(image)
    return mean


for tilt, sharp, filtered in ((0, 0.956, 0.719), (30, 0.942, 0.658), (60, 0.832, 0.402)):
    pane.rotation_euler = (math.radians(tilt), 0.0, 0.0)
    pane.hide_render = True
    alone = light()
    pane.hide_render = False
    found = []
    for cycles.blur_glossy in (0.0, 1.0):
        found.append(light() / alone)
    print(f"tilt {tilt}: {found[0]:.3f} without the filter, {found[1]:.3f} with it")
    assert abs(found[0] - sharp) < 0.02 and abs(found[1] - filtered) < 0.02, (tilt, found)
PYTHON
