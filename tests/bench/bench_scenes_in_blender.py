# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py scenes that runs inside an official Blender: the plume in the light of worlds, over textures, behind
what lets light through and beside chrome, a closed room, and samples; by Sfumato, and by Cycles without and with
OpenImageDenoise.

    SFUMATO_BENCH_CASES=chrome,room tests/official --script tests/bench/bench_scenes_in_blender.py 5.0.1
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import harness
import numpy as np
import worlds
from mathutils import Vector

sys.path[:0] = [str(Path(__file__).resolve().parent), str(harness.ROOT / "tests" / "blender" / "background")]
import bounces  # noqa: E402
import glass  # noqa: E402
from bench_denoised import CASES as WANTED  # noqa: E402
from bench_denoised_in_blender import FACTS, SAMPLES, Crop, inside, linear_exr, print_rows  # noqa: E402

METHODS = ["sfumato", *(f"cycles-{n}{end}" for end in ("", "-denoised") for n in SAMPLES)]
PARTS = {7: 512, 8: 256}  # samples of the judge by their seed
SIZE = (320, 180)


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


def before_smoke(name: str, half: float, away: float, aside: float) -> Any:
    """A square that faces the camera, with that share of the way to the smoke behind it; and so far to the right."""
    smoke = harness.middle_of(bpy.data.objects["Smoke Domain"])
    eye = bpy.context.scene.camera.matrix_world
    place = smoke + away * (eye.translation - smoke) + aside * (eye.to_3x3() @ Vector((1.0, 0.0, 0.0)))
    thing = glass.link(name, glass.box(name, half, half, 0.0), tuple(place))
    thing.rotation_euler = eye.to_euler()
    return thing


def alpha() -> None:
    """Seven cards with holes, one behind the other, which throw shadows."""
    v, u = np.mgrid[0:128, 0:128] / 64.0 - 1.0
    holes = np.clip(4.0 * np.sin(7.0 * u + 2.0 * v) * np.sin(6.0 * v - u) + 0.5, 0.0, 1.0) * (u * u + v * v < 0.9)
    pixels = np.stack((0.2 + 0.1 * u, 0.5 + 0.2 * v, 0.15 + 0.0 * u, holes), axis=2).astype(np.float32)
    made = worlds.image(pixels, "Holes", floats=False)
    for number in range(7):
        card = before_smoke(f"Card {number + 1}", 0.45, 0.2 + 0.05 * number, 0.35 * (number - 3))
        card.data.uv_layers.new()
        shader = harness.shade(card.data, "ShaderNodeBsdfDiffuse")
        tree = shader.id_data
        texture, mixed, clear = (
            tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "MixShader", "BsdfTransparent")
        )
        texture.image = made
        tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
        for place, output in enumerate((texture.outputs["Alpha"], clear.outputs[0], shader.outputs[0])):
            tree.links.new(output, mixed.inputs[place])
        tree.links.new(mixed.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def glass_pane() -> None:
    """Flat and amber, and without a shadow, which Cycles finds by chance alone."""
    pane = before_smoke("Pane", 0.9, 0.4, 0.0)
    pane.visible_shadow = False
    harness.put(harness.shade(pane.data, glass.GLASS), Color=glass.AMBER, Roughness=0.0, IOR=1.02)
    cycles = bpy.context.scene.cycles
    cycles.max_bounces = cycles.transmission_bounces = 8
    cycles.diffuse_bounces = cycles.glossy_bounces = 0
    cycles.blur_glossy = 0.0


def chrome() -> None:
    """A ball beside the smoke, which shows it, the floor and the block."""
    bounces.add_ball((-0.75, -1.3, 0.6), bounces.metal(0.1))
    cycles = bpy.context.scene.cycles
    cycles.max_bounces, cycles.glossy_bounces, cycles.diffuse_bounces = 2, 1, 0


def closed_room() -> None:
    bounces.open_room()
    bpy.context.scene.sfumato.bounced_light = True
    cycles = bpy.context.scene.cycles
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 5, 4, 4


def sample(name: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(harness.ROOT / "blend_samples" / f"{name}.blend"))


@dataclass(frozen=True)
class Case:
    make: Callable[[], None]  # opens a scene
    crop: Crop = inside
    where: str = "in the rectangle"


def plume(change: Callable[[], None] = lambda: None) -> Case:
    """In light that nothing passes on, but where `change` says so."""

    def make() -> None:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)  # whose names are free
        harness.open_plume(FACTS["frame"])
        bpy.context.scene.cycles.max_bounces = 0
        change()

    return Case(make)


def whole(make: Callable[[], None]) -> Case:
    return Case(make, lambda image: image, "of the picture")


CASES: dict[str, Case] = {
    "plume": plume(),
    "grey-world": plume(grey_world),
    "sky": plume(sky),
    "hdri": plume(hdri),
    "textured-floor": plume(textured_floor),
    "nodes": plume(nodes),
    "alpha": plume(alpha),
    "glass-pane": plume(glass_pane),
    "chrome": plume(chrome),
    "closed-room": whole(closed_room),
    "room": whole(functools.partial(sample, "room")),
    "street": whole(functools.partial(sample, "street")),
}


def main() -> None:
    for name in os.environ.get(WANTED, "").split(",") if os.environ.get(WANTED) else CASES:
        case = CASES[name]
        case.make()
        linear_exr()
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = SIZE
        scene.render.resolution_percentage = 100
        scene.cycles.volume_bounces = 0
        scene.cycles.use_adaptive_sampling, scene.cycles.sample_clamp_indirect = False, 0.0
        print_rows(name, METHODS, PARTS, case.crop, case.where)
    bpy.ops.wm.read_factory_settings(use_empty=True)


if __name__ == "__main__":
    main()
