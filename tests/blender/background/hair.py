# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair of particle systems, and hair curves, beside Cycles in light that nothing passes on."""

from __future__ import annotations

from typing import Any

import bpy
import harness
import numpy as np
import pictures
from mathutils import Vector
from numpy.typing import NDArray
from sfumato.export import parts
from sfumato.export import scene as export

SIZE = (96, 96)


def add(data: Any, location: tuple[float, float, float]) -> Any:
    """An object that looks at the origin."""
    made = bpy.data.objects.new(data.name, data)
    made.location = location
    made.rotation_euler = (-Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)
    return made


def hair_material(**values: object) -> Any:
    """A Principled Hair BSDF of Chiang's model; `values` are its inputs, spaces as underlines, and its properties."""
    material = bpy.data.materials.new("Hair")
    material.use_nodes = True
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeBsdfHairPrincipled")
    inputs: dict[str, object] = {"parametrization": "MELANIN", "model": "CHIANG"}
    inputs.update(values)
    for name, value in inputs.items():
        if name.replace("_", " ") in shader.inputs:
            shader.inputs[name.replace("_", " ")].default_value = value
        elif hasattr(shader, name):
            setattr(shader, name, value)
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def stage(shadows: bool = True) -> None:
    """A sun beside a camera that looks at the origin."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    harness.enable()
    scene = bpy.context.scene
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle, light.use_shadow = 3.0, 0.0, shadows
    if hasattr(light.cycles, "cast_shadow"):
        light.cycles.cast_shadow = shadows
    add(light, (-2.0, -3.0, 4.0))
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 50.0
    scene.camera = add(camera, (0.0, -4.0, 1.5))
    scene.world = None
    scene.render.film_transparent, scene.render.resolution_percentage = True, 100
    scene.sfumato.quality = "FINAL"
    cycles = scene.cycles
    cycles.max_bounces, cycles.transparent_max_bounces = 0, 128
    cycles.use_adaptive_sampling = cycles.use_denoising = False


def ball(count: int, material: Any) -> Any:
    """A ball of hair; its emitter is not seen."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, segments=32, ring_count=16)
    made = bpy.context.object
    made.data.materials.append(material)
    settings = made.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.hair_length, settings.hair_step = "HAIR", count, 0.4, 4
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.2, 0.012
    settings.display_step = settings.render_step = 3
    settings.brownian_factor = 0.03  # another one in each session
    made.show_instancer_for_render = made.show_instancer_for_viewport = False
    return made


def both(samples: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Ours, and two of Cycles, whose random numbers differ."""
    cycles = bpy.context.scene.cycles
    cycles.samples = samples
    ours = pictures.render(SIZE).astype(np.float64)
    first, second = (pictures.render(SIZE, "CYCLES").astype(np.float64) for cycles.seed in (1, 2))
    return ours, first, second


def error(case: str, where: NDArray[np.bool_], *three: NDArray[np.float64]) -> float:
    """Root mean square over the pixels `where`, noise taken off, over that of Cycles' own."""
    ours, first, second = (each[where][:, :3] for each in three)
    theirs = (first + second) / 2.0
    noise = float(((first - second) ** 2).mean()) / 4.0
    whole = float(np.sqrt((theirs**2).mean()))
    found = float(np.sqrt(max(((ours - theirs) ** 2).mean() - noise, 0.0))) / whole
    words = f"error {found:.2%}, noise {np.sqrt(noise) / whole:.2%}, means {ours.mean() / theirs.mean():.4f}"
    print(f"  {case}: {words}", flush=True)
    return found


def exported() -> list[str]:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return [notice for notice in export.export(depsgraph).notices if "air" in notice]


def test_a_ball_of_hair_and_its_shadow() -> None:
    """The targets are 5 % and 3 %. Measured in 3.4.1 4.5 to 4.8 % and 3.0 to 3.1 %, in 4.5.15 4.4 % and 3.1 %: Blender
    lays other hairs in each session."""
    stage()
    made = ball(2000, hair_material(Melanin=0.8))
    bpy.ops.mesh.primitive_plane_add(size=8.0, location=(0.0, 0.0, -0.9))
    floor = bpy.context.object
    harness.shade(floor.data, "ShaderNodeBsdfDiffuse")  # without a material it is another in Cycles 5.2.2: 5 % darker
    assert not exported()
    three = both(512)
    floor.hide_render = True
    covered = pictures.render(SIZE, "CYCLES")[..., 3] > 0.02
    floor.hide_render, made.hide_render = False, True
    bare = pictures.render(SIZE).astype(np.float64)[..., 0]
    lost = bare - three[1][..., 0] > 0.05 * bare
    hair = error("hair", covered, *three)
    shadow = error("its shadow", lost & ~covered & (bare > 0.0), *three)
    assert hair <= 0.05, hair
    assert shadow <= 0.035, shadow


def test_shades_as_chiang_does() -> None:
    """Without shadows, where every hair counts: the means are the model's, within what few samples know of glints (3.4.1
    within 2 %, 4.5.15 4 %)."""
    cases: dict[str, dict[str, object]] = {
        "tilted": {"Melanin": 0.8, "Offset": 0.2},
        "redder, coated, varied": {"Melanin": 0.6, "Melanin_Redness": 0.7, "Coat": 0.5, "Random_Color": 0.8},
        "absorption": {"parametrization": "ABSORPTION", "Absorption_Coefficient": (0.2, 0.9, 1.5), "IOR": 1.4},
        "colour": {"parametrization": "COLOR", "Color": (0.05, 0.1, 0.4, 1.0), "Radial_Roughness": 0.6},
    }
    wrong = []
    for case, values in cases.items():
        stage(shadows=False)
        ball(300, hair_material(**values))
        assert not exported()
        ours, first, second = both(256)
        theirs = (first + second) / 2.0
        ratio = ours[..., :3].sum(axis=(0, 1)) / theirs[..., :3].sum(axis=(0, 1))
        covers = ours[..., 3].sum() / theirs[..., 3].sum()
        print(f"  {case}: {ratio}, alpha {covers:.4f}", flush=True)
        if np.abs(ratio - 1.0).max() > 0.05 or abs(covers - 1.0) > 0.015:
            wrong.append((case, ratio, covers))
    assert not wrong, wrong


def curves(radius: float | None, poly: bool) -> Any:
    """Four rows of bent hairs."""
    data = bpy.data.hair_curves.new("Curves")
    count, keys = 40, 4
    data.add_curves([keys] * count)
    x = np.linspace(-1.0, 1.0, count)[:, None]
    places = np.zeros((count, keys, 3), dtype=np.float32)
    places[..., 0] = x + np.array((0.0, 0.3, -0.3, 0.0))
    places[..., 2] = np.linspace(-0.6, 0.6, keys)
    data.points.foreach_set("position", places.reshape(-1))
    if radius is not None:
        attribute = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
        attribute.data.foreach_set("value", np.full(count * keys, radius, dtype=np.float32))
    if poly:
        kind = data.attributes.get("curve_type") or data.attributes.new("curve_type", "INT8", "CURVE")
        kind.data.foreach_set("value", np.ones(count, dtype=np.int8))
    data.materials.append(hair_material(Melanin=0.8))
    thing = bpy.data.objects.new("Curves", data)
    thing.scale = (1.0, 1.0, 1.0)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def test_hair_curves_are_as_wide_as_cycles_has_them() -> None:
    if not hasattr(getattr(bpy.types, "Curves", None), "add_curves"):
        raise harness.Skip("no script makes hair curves in this Blender")
    for radius, poly in ((0.01, False), (None, False), (0.01, True)):
        stage(shadows=False)
        curves(radius, poly)
        ours, first, second = both(64)
        theirs = (first + second) / 2.0
        covers, apart = ours[..., 3].sum() / theirs[..., 3].sum(), np.abs(ours - theirs)[..., 3].mean()
        words = f"alpha {covers:.4f}, apart {apart / theirs[..., 3].mean():.2%}"
        print(f"  curves of radius {radius}, poly {poly}: {words}", flush=True)
        assert abs(covers - 1.0) < 0.02 and apart < 0.05 * theirs[..., 3].mean(), words


def test_what_is_shown_otherwise_is_named_once() -> None:
    stage()
    made = ball(20, hair_material(Melanin=0.8))
    for way in ("ABSORPTION", "COLOR", "MELANIN"):  # of which each has inputs of its own
        made.data.materials[0].node_tree.nodes["Principled Hair BSDF"].parametrization = way
        assert not exported(), (way, exported())
    if hasattr(bpy.types.ShaderNodeBsdfHairPrincipled, "model"):
        made.data.materials[0].node_tree.nodes["Principled Hair BSDF"].model = "HUANG"
        assert len(exported()) == 1 and "Huang" in exported()[0], exported()
    made.data.materials[0] = bpy.data.materials.new("Plain")
    made.scale = (1.0, 1.0, 2.0)
    said = exported()
    assert len(said) == 2 and any("Kajiya" in line for line in said) and any("uneven" in line for line in said), said
    made.scale = (1.0, 1.0, 0.0)
    said = exported()
    assert len(said) == 1 and "leaves its hair no place" in said[0], said
    made.modifiers[0].show_viewport = False
    assert not exported()


def test_a_view_layer_may_leave_hair_out() -> None:
    stage()
    ball(20, hair_material(Melanin=0.8))
    for shown in (True, False):
        bpy.context.view_layer.use_strand = shown
        out = export.export(bpy.context.evaluated_depsgraph_get())
        assert export.made_of(out, bpy.context.scene, parts.Parts()).sorted == shown


harness.main()
