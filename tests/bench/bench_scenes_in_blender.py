# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py scenes that runs inside an official Blender: the plume in the light of worlds and over textures, by
Sfumato, and by Cycles without and with OpenImageDenoise.

    tests/official --script tests/bench/bench_scenes_in_blender.py 5.0.1
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import harness
import numpy as np
import worlds

sys.path.insert(0, str(Path(__file__).resolve().parent))
from bench_denoised_in_blender import FACTS, METHODS, inside, linear_exr, print_rows  # noqa: E402

PARTS = {7: 512, 8: 256}  # samples of the judge by their seed


def grey_world() -> None:
    """Beside the sun."""
    _, background = worlds.world()
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (0.5, 0.5, 0.5, 1.0), 1.0


def hdri() -> None:
    """Alone, with a bright window in it."""
    worlds.linked("ShaderNodeTexEnvironment", image=worlds.image(worlds.clouds(1024)))
    for thing in list(bpy.context.scene.objects):
        if thing.type == "LIGHT":
            bpy.data.objects.remove(thing)


def sky() -> None:
    """With its sun, alone."""
    hdri()
    node = worlds.linked("ShaderNodeTexSky", sun_elevation=0.7)
    next(each for each in node.id_data.nodes if each.type == "BACKGROUND").inputs["Strength"].default_value = 0.05


def on_floor(kind: str) -> tuple[Any, Any]:
    """A texture of the floor's map, 60 times over it, and the floor's shader."""
    material = bpy.data.objects["Floor"].active_material
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type.startswith("BSDF"))
    mapping, texture = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new(f"ShaderNodeTex{kind}")
    tree.links.new(tree.nodes.new("ShaderNodeUVMap").outputs[0], mapping.inputs["Vector"])
    mapping.inputs["Scale"].default_value = (60.0, 60.0, 60.0)
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    return texture, shader


def textured_floor() -> None:
    """Of bytes, with sRGB's curve."""
    texture, shader = on_floor("Image")
    texture.image = worlds.image(np.clip(worlds.clouds(512), 0.0, 1.0), floats=False)
    texture.id_data.links.new(texture.outputs["Color"], shader.inputs[0])


def nodes() -> None:
    """A noise through a ramp."""
    texture, shader = on_floor("Noise")
    ramp = texture.id_data.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.05, 0.1, 0.3, 1.0), (0.9, 0.5, 0.2, 1.0)
    texture.id_data.links.new(texture.outputs[0], ramp.inputs[0])
    texture.id_data.links.new(ramp.outputs[0], shader.inputs[0])


CASES: dict[str, Callable[[], None]] = {
    "plume": lambda: None,
    "grey-world": grey_world,
    "hdri": hdri,
    "sky": sky,
    "textured-floor": textured_floor,
    "nodes": nodes,
}


def main() -> None:
    for name, make in CASES.items():
        harness.open_plume(FACTS["frame"])
        make()
        linear_exr()
        cycles = bpy.context.scene.cycles
        cycles.max_bounces = cycles.volume_bounces = 0
        print_rows(name, METHODS, PARTS, inside, "in the rectangle")
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
