#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/environment_images_between_texels.sh
#
# What Cycles (bpy 4.5.15 and 5.0.1 from PyPI) shows of an Environment Texture between the centres of its texels:
#   - halfway from white to black an image of floats has .5, but one of bytes whose Color Space is sRGB has .214: it is
#     interpolated as it is stored, and its curve taken off afterwards. So an HDRI that was saved as a PNG lights a scene
#     less than the light of its texels adds up to, the more the coarser it is;
#   - the picture repeats upwards, too: the zenith has half of the bottom row, as far as half a row reaches, so a sky of few
#     rows has a spot of its ground straight above.
#
# Seen, in both:
#   halfway, floats and bytes: 0.500 0.214
#   zenith over a white bottom row: 0.490
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/between.py" <<'PYTHON'
import bpy
import numpy as np


def seen(pixels, floats, rotation):
    """What a camera of next to no angle sees of a picture (rows from the bottom up, columns)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    height, width = pixels.shape
    image = bpy.data.images.new("Sky", width, height, float_buffer=floats)
    rgba = np.repeat(pixels[..., None], 4, axis=2).astype(np.float32)
    rgba[..., 3] = 1.0
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    tree = scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 1.0
    camera = bpy.data.cameras.new("Camera")
    camera.angle = 0.01
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.rotation_euler = rotation
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 8, 8
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = f"{bpy.app.tempdir}seen.exr"
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(render.filepath)
    return float(np.array(picture.pixels[:]).reshape(-1, 4)[:, 0].mean())


halves = np.array([[1.0, 1.0, 0.0, 0.0]] * 2)
along_x = (np.pi / 2.0, 0.0, -np.pi / 2.0)  # the middle of the picture
floats, encoded = (seen(halves, kind, along_x) for kind in (True, False))
rows = np.zeros((8, 16))
rows[0] = 1.0
zenith = seen(rows, True, (np.pi, 0.0, 0.0))
print(f"{bpy.app.version_string}: {floats:.3f} {encoded:.3f}, {zenith:.3f}")
assert abs(floats - 0.5) < 0.01
assert abs(encoded - 0.214) < 0.01
assert abs(zenith - 0.5) < 0.01
PYTHON
for version in 4.5.15 5.0.1; do
    python3.11 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "bpy==$version" 'numpy<2'
    "$folder/$version/bin/python" "$folder/between.py"
done
