#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/volumes_need_a_world.sh
#
# Cycles (bpy 5.0.1 from PyPI; 5.3.0 answers alike): in a scene without a World, a Volume object is not rendered at all,
# by either kind of ray marching (`volume_biased` on or off), and nothing says so; a mesh with the same shader is. With
# any World, a black one too, it is there. 4.5.15 shows it in both cases.
#
# Seen, alpha in the middle of a fog sphere:
#   Volume object, without a world: 0.00
#   Volume object, with a new world: 1.00
#   cube, without a world: 1.00
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/env"
"$folder/env/bin/pip" install --quiet 'bpy==5.0.1' 'numpy<2'
cd "$folder"
"$folder/env/bin/python" - <<'PYTHON'
import sys
from pathlib import Path

import bpy
import numpy as np

# Blender's own OpenVDB, which the wheel brings but does not show.
sys.path.append(str(Path(bpy.utils.resource_path("LOCAL"), "python", "lib", "python3.11", "site-packages")))
import openvdb

assert bpy.app.version == (5, 0, 1), bpy.app.version_string
grid = openvdb.FloatGrid()
steps = np.arange(-8, 9)
distance = np.sqrt(sum(axis.astype(float) ** 2 for axis in np.meshgrid(steps, steps, steps)))
grid.copyFromArray((distance < 8.0).astype(np.float32), ijk=(-8, -8, -8))
grid.transform, grid.name = openvdb.createLinearTransform(voxelSize=0.125), "density"
openvdb.write("fog.vdb", grids=[grid])


def alpha(volume, world):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    if volume:
        data = bpy.data.volumes.new("Fog")
        data.filepath = "fog.vdb"
        scene.collection.objects.link(bpy.data.objects.new("Fog", data))
    else:
        bpy.ops.mesh.primitive_cube_add()
        data = bpy.context.object.data
    material = bpy.data.materials.new("Fog")
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, output = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Density"].default_value = 4.0
    material.node_tree.links.new(shader.outputs[0], output.inputs["Volume"])
    data.materials.append(material)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 0.5
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location.z = 10.0
    scene.collection.objects.link(scene.camera)
    scene.world = bpy.data.worlds.new("World") if world else None
    render = scene.render
    render.engine, render.film_transparent = "CYCLES", True
    render.resolution_x = render.resolution_y = 16
    render.image_settings.file_format, render.filepath = "OPEN_EXR", bpy.app.tempdir + "fog.exr"
    scene.cycles.samples, scene.cycles.use_denoising = 32, False
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    return float(np.mean(np.array(image.pixels[:])[3::4]))


without, with_one, cube = alpha(True, False), alpha(True, True), alpha(False, False)
print(f"Volume object, without a world: {without:.2f}")
print(f"Volume object, with a new world: {with_one:.2f}")
print(f"cube, without a world: {cube:.2f}")
assert without == 0.0 and with_one > 0.9 and cube > 0.9
PYTHON
