# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/joined.png, a scene of textures: Cycles without its smoke, the same with ours in the compositor, and
Cycles with smoke and all.

PATH=/usr/bin:$PATH blender -b blend_samples/plume.blend --addons sfumato --python docs/joined.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))

from side_by_side import shown  # noqa: E402

SAMPLES, CROP = 32, (slice(0, 264), slice(48, 368))


def checks() -> bpy.types.Material:
    material = bpy.data.materials.new("Checks")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    texture = nodes.new("ShaderNodeTexChecker")
    texture.inputs["Scale"].default_value = 40.0
    texture.inputs["Color1"].default_value = (0.24, 0.1, 0.04, 1.0)
    texture.inputs["Color2"].default_value = (0.05, 0.06, 0.1, 1.0)
    material.node_tree.links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def main() -> None:
    scene = bpy.context.scene
    scene.frame_set(25)
    scene.render.engine, scene.sfumato.quality = "CYCLES", "FINAL"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 480, 270, 100
    floor = scene.objects["Floor"].data.materials
    floor.clear()
    floor.append(checks())
    smoke = scene.objects["Smoke Domain"]
    whole = shown("CYCLES", SAMPLES)[CROP]
    smoke.hide_render = True
    bare = shown("CYCLES", SAMPLES)[CROP]
    smoke.hide_render = False
    bpy.ops.sfumato.add_smoke()
    joined = shown("CYCLES", SAMPLES)[CROP]
    gap = np.ones((bare.shape[0], 6, 4), dtype=np.float32)
    row = np.concatenate([bare, gap, joined, gap, whole], axis=1)
    image = bpy.data.images.new("row", row.shape[1], row.shape[0])
    image.pixels.foreach_set(row.ravel())
    image.filepath_raw, image.file_format = str(DOCS / "joined.png"), "PNG"
    image.save()


if __name__ == "__main__":
    main()
