#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/rough_diffuse_is_coloured_once_more.sh
#
# Cycles (bpy 5.0.1 from PyPI; 4.3.2 and 5.2.2 of Debian and 4.5.15 answer alike): what a rough Diffuse BSDF sends on after
# more than one reflection has the colour of one reflection more than in the model that it follows (Portsmouth, Kutz and
# Hill, "EON", 2025): the albedo's third power, where the first of these reflections leaves its second. 4.2.23 has only
# the first reflection, 5.3.0 the model itself. Of an albedo of .8, both seen along the light at 60 degrees: .0777 in 4.2.23,
# .1044 in between, .1110 in 5.3.0.
#
# Seen, light after more than one reflection over the albedo, in that of a white surface's:
#   albedo 0.25: 0.0543, by the model 0.2173
#   albedo 0.50: 0.2272, by the model 0.4544
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
from pathlib import Path

import bpy

assert bpy.app.version == (5, 0, 1), bpy.app.version_string
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add(size=40.0)
material = bpy.data.materials.new("Floor")
material.use_nodes = True
nodes = material.node_tree.nodes
nodes.clear()
shader, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
material.node_tree.links.new(shader.outputs[0], output.inputs[0])
shader.inputs["Roughness"].default_value = 1.0
bpy.context.object.data.materials.append(material)
scene = bpy.context.scene
light, camera = bpy.data.lights.new("Sun", "SUN"), bpy.data.cameras.new("Camera")
light.energy, light.angle = math.pi, 0.0
camera.type, camera.ortho_scale = "ORTHO", 0.5
sun, scene.camera = bpy.data.objects.new("Sun", light), bpy.data.objects.new("Camera", camera)
turn = math.radians(60.0)
sun.rotation_euler.x = -turn
scene.camera.location = (0.0, -10.0 * math.sin(turn), 10.0 * math.cos(turn))
scene.camera.rotation_euler.x = turn
for thing in (sun, scene.camera):
    scene.collection.objects.link(thing)
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.max_bounces = 1, 0
scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
scene.render.resolution_x = scene.render.resolution_y = 8
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
scene.render.filepath = str(Path("floor.exr").resolve())


def over_albedo(albedo: float) -> float:
    shader.inputs["Color"].default_value = (albedo, albedo, albedo, 1.0)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    radiance = image.pixels[0]
    bpy.data.images.remove(image)
    return radiance / albedo


once = over_albedo(1e-4)
white = over_albedo(1.0) - once
lost = 1.0 - (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * math.pi))) / (1.0 + (0.5 - 2.0 / (3.0 * math.pi)))
for albedo in (0.25, 0.5):
    model = albedo * (1.0 - lost) / (1.0 - albedo * lost)
    found = (over_albedo(albedo) - once) / white
    print(f"albedo {albedo:.2f}: {found:.4f}, by the model {model:.4f}")
    assert abs(found - albedo * model) < 1e-3, (albedo, found, model)
PYTHON
