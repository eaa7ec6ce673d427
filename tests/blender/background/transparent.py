# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent meshes beside the Cycles of this very Blender, in light that nothing passes on.

An error is the root mean square over the blocks of pixels that the transparent ones change, over their brightness, with
Cycles' own noise taken off: from two renders whose random numbers differ.
"""

import math
from collections.abc import Callable

import bpy
import harness
import multilayer
import numpy as np
import pictures
from numpy.typing import NDArray
from sfumato import core, log  # type: ignore[attr-defined]
from sfumato.export import parts
from sfumato.export import scene as export

SIZE = (64, 48)
SIDE = 4  # of a block, pixels
CYAN, RED = (0.2, 0.7, 0.8, 1.0), (0.9, 0.3, 0.2, 1.0)


def link(name: str, data: bpy.types.ID | None, place: tuple[float, float, float]) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def quad(name: str, half: float) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)])
    return mesh


def pane(
    place: tuple[float, float, float], turn: float = 90.0, half: float = 0.5, **inputs: object
) -> bpy.types.Object:
    """A square of a Principled BSDF, upright and facing the camera unless it is turned otherwise, about x."""
    thing = link("Pane", quad("Pane", half), place)
    thing.rotation_euler = (math.radians(turn), 0.0, 0.0)
    shader = harness.shade(thing.data, "ShaderNodeBsdfPrincipled")
    values: dict[str, object] = {"Roughness": 0.6, "Alpha": 0.5, **inputs}
    for name, value in values.items():
        name = name.replace("_", " ")
        name = "Emission Color" if name == "Emission" and name not in shader.inputs else name
        shader.inputs[name].default_value = value
    return thing


def mix(thing: bpy.types.Object, other: str, share: float, **inputs: object) -> None:
    """Of the share of a thing's surface, another shader in the place of its own."""
    tree = thing.data.materials[0].node_tree
    output = tree.get_output_node("ALL")
    own = output.inputs["Surface"].links[0].from_socket
    both, second = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new(other)
    both.inputs[0].default_value = share
    for name, value in inputs.items():
        second.inputs[name].default_value = value
    tree.links.new(own, both.inputs[1])
    tree.links.new(second.outputs[0], both.inputs[2])
    tree.links.new(both.outputs[0], output.inputs["Surface"])


def stage(smoke: bool = False, lamp: str = "POINT") -> None:
    """A floor and a lamp, looked at from the side and a little from above."""
    if smoke:
        cloud = harness.volume(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
        harness.shade(cloud.data, "ShaderNodeVolumePrincipled", "Volume").inputs["Density"].default_value = 8.0
        bounds = np.array(cloud.bound_box) if cloud.data.grids.load() else np.zeros((8, 3))
        size = (bounds.max(axis=0) - bounds.min(axis=0)).max()
        cloud.scale = (1.4 / size,) * 3
        cloud.location = (*(-1.4 / size * bounds.mean(axis=0))[:2], 0.75 - 1.4 / size * bounds.mean(axis=0)[2])
    else:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    scene.world = harness.black_world()
    floor = link("Floor", quad("Floor", 4.0), (0.0, 0.0, 0.0))
    harness.shade(floor.data, "ShaderNodeBsdfDiffuse").inputs["Color"].default_value = (0.8, 0.7, 0.6, 1.0)
    light = bpy.data.lights.new("Lamp", lamp)
    light.energy = {"POINT": 300.0, "SUN": 3.0, "AREA": 200.0}[lamp]
    if lamp == "SUN":
        light.angle = 0.05
    else:
        setattr(light, "shadow_soft_size" if lamp == "POINT" else "size", 0.3)
    link("Lamp", light, (0.8, -1.5, 3.0)).rotation_euler = (0.45, 0.25, 0.0)
    data = bpy.data.cameras.new("Camera")
    scene.camera = link("Camera", data, (0.0, -5.0, 2.2))
    scene.camera.rotation_euler = (math.radians(73.0), 0.0, 0.0)
    data.angle = 0.6
    scene.render.resolution_percentage = 100
    scene.sfumato.quality = "FINAL"
    scene.cycles.transparent_max_bounces = 64


def three_alphas() -> None:
    stage()
    for x, alpha in ((-0.8, 0.3), (0.0, 0.5), (0.8, 0.9)):
        pane((x, 0.0, 0.5), half=0.35, Alpha=alpha, Base_Color=CYAN)


def coloured() -> None:
    stage(lamp="SUN")
    mix(pane((0.0, 0.0, 0.6), 60.0, 0.6, Alpha=1.0), "ShaderNodeBsdfTransparent", 0.6, Color=RED)
    mix(pane((0.9, 0.3, 0.6), 90.0, 0.4, Alpha=0.8), "ShaderNodeBsdfTransparent", 0.3, Color=CYAN)


def crossing() -> None:
    stage()
    pane((0.0, 0.0, 0.7), 60.0, 0.6, Alpha=0.4, Base_Color=RED)
    pane((0.0, 0.0, 0.7), 120.0, 0.6, Alpha=0.6, Base_Color=CYAN)


def around_smoke() -> None:
    stage(smoke=True)
    for y, x in ((-0.9, -0.4), (0.0, 0.1), (0.9, 0.5)):
        pane((x, y, 0.7), 90.0, 0.45, Alpha=0.5, Base_Color=RED if y < 0 else CYAN)


def shading_smoke() -> None:
    stage(smoke=True, lamp="SUN")
    bpy.data.objects.remove(bpy.data.objects["Floor"])  # whose shadows are brighter
    pane((0.3, -0.5, 1.9), 0.0, 0.5, Alpha=0.7)
    mix(pane((-0.5, -0.4, 1.7), 10.0, 0.3, Alpha=1.0), "ShaderNodeBsdfTransparent", 0.9, Color=RED)


def shading_the_floor() -> None:
    stage(lamp="AREA")
    pane((0.0, 0.2, 1.0), 0.0, 0.5, Alpha=0.5)
    mix(pane((0.2, 0.4, 0.6), 15.0, 0.4, Alpha=1.0), "ShaderNodeBsdfTransparent", 0.8, Color=CYAN)


def glossy() -> None:
    stage(lamp="AREA")
    pane((0.0, 0.4, 0.6), 62.0, 0.6, Alpha=0.5, Base_Color=RED, Metallic=0.5, Roughness=0.3)


def glowing() -> None:
    stage()
    pane((0.0, 0.6, 0.6), 90.0, 0.4, Alpha=0.7, Emission=CYAN, Emission_Strength=1.0, Base_Color=RED)
    pane((0.2, 0.0, 0.6), 90.0, 0.4, Alpha=0.5, Base_Color=CYAN)
    mix(pane((-0.7, 0.2, 0.5), 90.0, 0.3, Alpha=1.0), "ShaderNodeEmission", 0.5, Color=RED, Strength=1.5)


def instanced() -> None:
    stage()
    first = pane((-0.7, 0.0, 0.5), 80.0, 0.4, Alpha=0.4, Base_Color=CYAN)
    for x, y, scale in ((0.1, 0.2, (-1.0, 1.0, 1.0)), (0.6, 0.5, (1.0, 0.7, -1.0))):
        copy = first.copy()
        copy.location, copy.scale = (x, y, 0.6), scale
        bpy.context.scene.collection.objects.link(copy)


def many() -> None:
    stage()
    for number in range(12):
        pane((0.05 * number, -0.6 + 0.1 * number, 0.6), 85.0, 0.4, Alpha=0.15, Base_Color=RED if number % 2 else CYAN)


CASES: dict[str, tuple[Callable[[], None], float, int]] = {
    "alpha .3, .5, .9": (three_alphas, 0.03, 64),
    "coloured": (coloured, 0.03, 64),
    "crossing": (crossing, 0.03, 64),
    "before, in and behind smoke": (around_smoke, 0.03, 96),
    "shadow in smoke": (shading_smoke, 0.03, 96),
    "shadow on the floor": (shading_the_floor, 0.03, 96),
    "glossy": (glossy, 0.03, 96),
    "glowing": (glowing, 0.03, 64),
    "copies": (instanced, 0.03, 64),
    "twelve": (many, 0.03, 64),
}
SMOKY = {around_smoke, shading_smoke}


def blocks(picture: NDArray[np.float32]) -> NDArray[np.float64]:
    return pictures.in_blocks(picture, SIDE)


def error(samples: int) -> tuple[float, float, float]:
    """Over what the panes change: the error, the noise, and the mean over Cycles'."""
    scene = bpy.context.scene
    scene.cycles.max_bounces = scene.cycles.volume_bounces = 0
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    ours = blocks(pictures.render(SIZE))
    first, second = (blocks(pictures.render(SIZE, "CYCLES")) for scene.cycles.seed in (1, 2))
    theirs = (first + second) / 2.0
    for thing in scene.objects:
        thing.hide_render = thing.name.startswith("Pane")
    without, theirs_without = blocks(pictures.render(SIZE)), blocks(pictures.render(SIZE, "CYCLES"))
    # What only Cycles' changes is one of ours that is not there.
    change = np.maximum(abs(ours - without), abs(theirs - theirs_without))
    concerned = change.max(axis=-1) > 0.05 * float(theirs.mean())
    assert concerned.sum() > 10
    noise = float(((first - second)[concerned] ** 2).mean()) / 4.0
    whole = float(np.sqrt((theirs[concerned] ** 2).mean()))
    wrong = max(float(((ours - theirs)[concerned] ** 2).mean()) - noise, 0.0)
    return math.sqrt(wrong) / whole, math.sqrt(noise) / whole, ours[concerned].mean() / theirs[concerned].mean()


def test_transparent_meshes_are_cycles() -> None:
    smoke = pictures.cycles_shows_smoke()
    wrong = []
    for name, (make, most, samples) in CASES.items():
        if make in SMOKY and not smoke:
            continue
        make()
        log.replace("test", [])
        found, noise, means = error(samples)
        print(f"  {name}: {found:.2%}, noise {noise:.2%}, means {means:.4f}", flush=True)
        if found > most:
            wrong.append(f"{name}: {found:.2%}")
    assert not wrong, wrong


def said() -> list[str]:
    return list(export.export(bpy.context.evaluated_depsgraph_get()).notices)


def test_a_transparency_that_is_not_followed_is_named() -> None:
    stage()
    thing = pane((0.0, 0.0, 0.6))
    tree = thing.data.materials[0].node_tree
    before = said()
    unknown = tree.nodes.new("ShaderNodeAmbientOcclusion")
    tree.links.new(unknown.outputs[1], tree.nodes["Principled BSDF"].inputs["Alpha"])
    new = [line for line in said() if line not in before]
    assert len(new) == 1 and new[0].startswith("Pane: ") and "'Alpha'" in new[0], new


def test_what_brightens_is_named() -> None:
    stage()
    before = said()
    thing = pane((0.0, 0.0, 0.6), Alpha=1.0)
    mix(thing, "ShaderNodeBsdfTransparent", 1.0, Color=(2.0, 0.5, 1.0, 1.0))
    new = [line for line in said() if line not in before]
    assert len(new) == 1 and "(1, 0.5, 1)" in new[0], new


def test_what_is_held_out_whole_is_named() -> None:
    stage()
    thing = pane((0.0, 0.0, 0.6))
    before = said()
    for flag, word in (("is_holdout", "Holdout"), ("is_shadow_catcher", "Shadow Catcher")):
        setattr(thing, flag, True)
        new = [line for line in said() if line not in before]
        assert len(new) == 1 and new[0] == f"Pane: it lets light through, but is a {word} as if it did not", new
        setattr(thing, flag, False)


def test_passes_tell_of_what_is_as_opaque_as_the_view_layer_asks() -> None:
    """The depth of the pane, or of what lies behind it. Where a pane is not opaque enough, Cycles' first sample decides
    by chance whether it goes on to what is: there the farthest of some pixels counts."""
    for alpha, threshold, near in ((0.6, 0.5, True), (0.3, 0.0, True), (0.3, 0.5, False)):
        stage()
        pane((0.0, 0.0, 0.6), half=2.0, Alpha=alpha)
        scene, layer = bpy.context.scene, bpy.context.scene.view_layers[0]
        layer.use_pass_z = layer.use_pass_mist = True
        layer.pass_alpha_threshold = threshold
        scene.world.mist_settings.start, scene.world.mist_settings.depth = 2.0, 8.0
        scene.cycles.samples, scene.cycles.use_denoising = 256, False
        (depth, mist), (their_depth, their_mist) = (_depth_and_mist(engine) for engine in ("SFUMATO", "CYCLES"))
        print(f"  {alpha}, {threshold}: {depth:.3f} and {their_depth:.3f} m, mist {mist:.4f} and {their_mist:.4f}")
        assert (depth < 6.0) == near and abs(depth - their_depth) < 0.01 and abs(mist - their_mist) < 0.005


def _depth_and_mist(engine: str) -> tuple[float, float]:
    """In the middle of the picture, of some pixels in a row: the largest, and the mean."""
    layers = multilayer.render(SIZE, engine)
    depth, mist = (next(v for name, v in layers.items() if name.endswith(end)) for end in (".Depth.Z", ".Mist.Z"))
    row, columns = SIZE[1] // 2, slice(SIZE[0] // 4, 3 * SIZE[0] // 4)
    return float(depth[row, columns].max()), float(mist[row, columns].mean())


def test_a_pane_over_blenders_picture_shades_by_what_it_takes() -> None:
    """As the overlay of a view has it, from below the pane."""
    below = core.module().Camera(np.diag([1.0, 1.0, -2.0, 1.0]))
    shadow = {}
    for alpha in (0.5, 1.0):
        stage(lamp="SUN")
        pane((0.0, 0.0, 0.8), 0.0, 2.0, Alpha=alpha)
        out = export.export(bpy.context.evaluated_depsgraph_get(), smoke_alone=True)
        frame = export.made_of(out, bpy.context.scene, parts.Parts())
        assert not frame.particles
        shadow[alpha] = frame.surfaces(below, 8, 8, output="all_shadows")[3:5, 3:5, :3].mean()
    assert shadow[1.0] > 0.5 and abs(shadow[0.5] / shadow[1.0] - 0.5) < 1e-3, shadow


if __name__ == "__main__":
    harness.main()
