# SPDX-License-Identifier: GPL-3.0-or-later
"""Air that fills the world: by its own nodes beside Cycles, and by the panel."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import bpy
import harness
import numpy as np
import pictures
from harness import put, said
from sfumato import log, ops, props  # type: ignore[attr-defined]

SIZE = (48, 32)
MOST = 0.02  # of the mean square of blocks


def place(kind: str) -> Any:
    """A floor with a post on it, one lamp, and a black world: the lamp's data."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    view = bpy.context.scene
    view.world = harness.black_world()
    view.world.use_nodes = True
    view.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    for size, where, name in (
        ((30.0, 30.0, 0.2), (0.0, 0.0, -0.1), "Floor"),
        ((0.4, 0.4, 1.6), (0.8, 0.4, 0.8), "Post"),
    ):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=where, scale=size)
        bpy.context.object.name = name
        harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse").inputs[0].default_value = (0.3, 0.5, 0.4, 1.0)
    lamp = bpy.data.lights.new("Lamp", kind)
    lamp.energy = 4.0 if kind == "SUN" else 400.0
    if kind in {"POINT", "SPOT"}:
        lamp.shadow_soft_size = 0.05
    if kind == "SPOT":
        lamp.spot_size, lamp.spot_blend, lamp.energy = 1.0, 0.3, 1500.0
    thing = bpy.data.objects.new("Lamp", lamp)
    thing.location, thing.rotation_euler = (-1.2, 0.2, 2.4), (0.1, -0.75, 0.0)
    view.collection.objects.link(thing)
    view.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    view.camera.location, view.camera.rotation_euler = (0.4, -6.0, 1.6), (1.45, 0.0, 0.0)
    view.collection.objects.link(view.camera)
    view.render.resolution_percentage = 100
    return lamp


def fill(*kinds: str) -> list[Any]:
    """The world with the sum of so many volume shaders, which are the answer."""
    tree = bpy.context.scene.world.node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    shaders = [tree.nodes.new(f"ShaderNode{kind}") for kind in kinds]
    whole = shaders[0].outputs[0]
    for shader in shaders[1:]:
        added = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(whole, added.inputs[0])
        tree.links.new(shader.outputs[0], added.inputs[1])
        whole = added.outputs[0]
    tree.links.new(whole, output.inputs["Volume"])
    return shaders


def beside_cycles(case: str, samples: int = 256, size: tuple[int, int] = SIZE) -> None:
    error = pictures.error_beside_cycles(case, size, samples)
    assert error < MOST, (case, error)


def lift_lamp() -> None:
    """Out of sight. A glow is as steep as a lamp is small: where one looks into it, the filters of pixels are compared."""
    bpy.context.scene.objects["Lamp"].location.z += 0.8


def test_lamps_in_scattering_air_are_as_in_cycles() -> None:
    for kind, anisotropy in (("POINT", 0.7), ("SPOT", 0.3), ("AREA", -0.4)):
        place(kind)
        lift_lamp()
        (scatter,) = fill("VolumeScatter")
        put(scatter, Color=(0.9, 0.6, 0.3), Density=0.12, Anisotropy=anisotropy)
        beside_cycles(f"{kind.lower()}, anisotropy {anisotropy}")


def test_sums_of_volume_shaders_are_as_in_cycles() -> None:
    place("POINT")
    lift_lamp()
    scatter, absorption = fill("VolumeScatter", "VolumeAbsorption")
    put(scatter, Color=(0.8, 0.8, 0.8), Density=0.08)
    put(absorption, Color=(0.2, 0.6, 0.9), Density=0.15)
    beside_cycles("scattering and absorption")
    place("POINT")
    lift_lamp()
    (principled,) = fill("VolumePrincipled")
    put(principled, Color=(0.7, 0.4, 0.6), Absorption_Color=(0.5, 0.1, 0.3), Density=0.2, Anisotropy=0.2)
    beside_cycles("principled")


def test_air_that_glows_is_seen_as_in_cycles() -> None:
    """On a floor that reflects nothing, since it lights nothing here, which is named."""
    place("POINT").energy = 0.0
    bpy.data.objects.remove(bpy.data.objects["Post"])
    shader = bpy.data.objects["Floor"].data.materials[0].node_tree.nodes["Diffuse BSDF"]
    shader.inputs[0].default_value = (0.0, 0.0, 0.0, 1.0)
    bpy.context.scene.camera.rotation_euler = (1.1, 0.0, 0.0)
    absorption, principled = fill("VolumeAbsorption", "VolumePrincipled")
    put(absorption, Color=(0.2, 0.6, 0.9), Density=0.2)
    put(principled, Color=(0.0, 0.0, 0.0), Absorption_Color=(1.0, 1.0, 1.0), Emission_Color=(0.2, 0.5, 1.0))
    put(principled, Emission_Strength=0.01)
    beside_cycles("glowing", 16)
    assert sum("lights nothing" in line for line in said()) == 1, said()
    # Without end, what it emits over what it takes of that.
    bpy.data.objects["Floor"].hide_render = True
    sky = pictures.render(SIZE)[..., :3]
    assert np.allclose(sky, np.array((0.2, 0.5, 1.0)) * 0.01 / (0.2 * np.array((0.8, 0.4, 0.1))), rtol=1e-3)


def test_smoke_stands_in_air_as_in_cycles() -> None:
    if not pictures.cycles_shows_smoke():
        raise harness.Skip("Cycles of this Blender shows no smoke")
    place("SPOT")
    volume = bpy.data.volumes.new("Smoke")
    volume.filepath = str(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
    thing = bpy.data.objects.new("Smoke", volume)
    thing.location, thing.scale = (-0.6, -0.3, 0.2), (1.5, 1.5, 1.5)
    bpy.context.scene.collection.objects.link(thing)
    put(harness.shade(volume, "ShaderNodeVolumePrincipled", "Volume"), Density=6.0, Color=(0.7, 0.7, 0.7))
    (scatter,) = fill("VolumeScatter")
    put(scatter, Color=(0.8, 0.8, 0.8), Density=0.08)
    # Cycles goes the whole of each ray at the steps of the smoke.
    view = bpy.context.scene
    view.camera.location, view.camera.rotation_euler = (0.2, -3.5, 2.0), (1.2, 0.0, 0.0)
    view.cycles.volume_step_rate = 2.0
    beside_cycles("smoke in air", 64, (24, 24))


def test_a_sun_in_a_volume_of_the_world_is_named() -> None:
    """Cycles blacks it out; here it is as bright as without."""
    place("SUN")
    bpy.context.scene.cycles.use_denoising = False
    without = pictures.render(SIZE)[..., :3]
    assert not any("World" in line for line in said())
    (scatter,) = fill("VolumeScatter")
    put(scatter, Density=0.02)
    named = [line for line in said() if line.startswith("World: ")]
    assert len(named) == 1 and "Lamp" in named[0] and "suns" in named[0], named
    assert not pictures.render(SIZE, "CYCLES")[..., :3].any()
    seen = pictures.render(SIZE)[..., :3]
    assert seen.mean() > 0.8 * without.mean()
    place("POINT")
    put(*fill("VolumeScatter"), Density=0.02)
    assert not said(), said()


def test_a_view_layer_without_environment_has_no_volume_of_the_world() -> None:
    place("POINT")
    put(*fill("VolumeScatter"), Density=0.3)
    filled = pictures.render(SIZE)
    bpy.context.view_layer.use_sky = False
    beside_cycles("without environment", 64)
    assert np.abs(pictures.render(SIZE) - filled).max() > 0.05


def test_what_of_it_is_not_followed_is_named() -> None:
    place("POINT")
    scatter, other = fill("VolumeScatter", "VolumeScatter")
    put(scatter, Density=0.3, Anisotropy=0.6)
    put(other, Density=0.1, Anisotropy=-0.2)
    assert any("mean, 0.4" in line for line in said()), said()
    place("POINT")
    (scatter,) = fill("VolumeScatter")
    noise = scatter.id_data.nodes.new("ShaderNodeTexNoise")
    scatter.id_data.links.new(noise.outputs[0], scatter.inputs["Density"])
    assert "World: the link into 'Density' is not followed; its own value is used" in said()
    place("POINT")
    fill("BsdfDiffuse")
    assert any("Diffuse BSDF is not shown" in line for line in said()), said()
    if "phase" in bpy.types.ShaderNodeVolumeScatter.bl_rna.properties:
        place("POINT")
        fill("VolumeScatter")[0].phase = "MIE"
        assert any("phase function Mie" in line for line in said()), said()


def test_values_that_cannot_be_are_refused_or_none() -> None:
    for density in (-1.0, 0.0, float("inf"), float("nan")):
        place("POINT")
        without = pictures.render(SIZE)
        put(*fill("VolumeScatter"), Density=density)
        seen = pictures.render(SIZE)
        assert np.array_equal(seen, without), density
        assert any("left out" in line for line in said()) == (density == float("inf")), (density, said())
    for anisotropy in (1.0, -1.0):
        place("POINT")
        put(*fill("VolumeScatter"), Density=0.1, Anisotropy=anisotropy)
        assert np.isfinite(pictures.render(SIZE)).all()


def own_air(**values: Any) -> Any:
    own = props.of_air(bpy.context.scene.world)
    own.shown = True
    for name, value in values.items():
        setattr(own, name, value)
    return own


def stages() -> set[str]:
    log.took({})
    pictures.render(SIZE)
    return set(log.stages())


def test_air_is_off_by_default_and_then_costs_nothing() -> None:
    place("POINT")
    own = props.of_air(bpy.context.scene.world)
    assert not own.shown and not own.directed and own.shaft_strength == 1.0
    without = pictures.render(SIZE)
    assert "air" not in stages()
    own.visibility, own.scale_height, own.directed, own.shaft_strength = 3.0, 2.0, True, 5.0
    assert np.array_equal(pictures.render(SIZE), without)
    assert "air" not in stages()
    own.shown = True
    assert "air" in stages()
    bpy.context.scene.world = None
    assert "air" not in stages()


def test_the_panels_haze_is_that_of_a_shader() -> None:
    """Of which light takes 98 % of a contrast over the distance that one sees."""
    place("SPOT")
    density = -np.log(0.02) / 30.0
    own_air(visibility=30.0, anisotropy=0.4, color=(0.9, 0.7, 0.5))
    by_panel = pictures.render(SIZE)
    own_air().shown = False
    scatter, absorption = fill("VolumeScatter", "VolumeAbsorption")
    put(scatter, Density=density, Anisotropy=0.4, Color=(0.9, 0.7, 0.5))
    put(absorption, Density=density, Color=(0.9, 0.7, 0.5))
    by_nodes = pictures.render(SIZE)
    assert by_nodes[..., :3].mean() > 0.01
    assert np.allclose(by_panel, by_nodes, rtol=1e-4, atol=1e-6), np.abs(by_panel - by_nodes).max()
    own_air(visibility=1.0)
    assert np.array_equal(pictures.render(SIZE), by_nodes), "the world's own volume goes first"


def test_its_height_is_of_the_world() -> None:
    """So many scale heights up are as good as so much more of it; wherever the scene is."""
    place("POINT")
    height = 1.5
    own = own_air(visibility=20.0, scale_height=height)
    here = pictures.render(SIZE)
    own.visibility, own.ground = 40.0, height * float(np.log(2.0))
    assert np.allclose(pictures.render(SIZE), here, rtol=2e-3, atol=1e-5)
    own.ground = 0.0
    assert np.abs(pictures.render(SIZE) - here).max() > 1e-2
    own.visibility, own.ground = 20.0, 4096.0
    for thing in bpy.context.scene.objects:
        thing.location.z += 4096.0
    moved = pictures.render(SIZE) - here  # Blender knows places in single precision
    assert np.sqrt((moved**2).mean() / (here**2).mean()) < 2e-3


def test_directed_shafts_multiply_what_the_air_scatters_alone() -> None:
    """In pixels that are looked at once: which are refined depends on what is in them."""
    name = props.of(bpy.context.scene).quality
    with mock.patch.dict(props.QUALITIES, {name: replace(props.QUALITIES[name], edge_samples=1)}):
        directed_shafts()


def directed_shafts() -> None:
    place("SPOT")
    own = own_air(visibility=25.0)
    plain = pictures.render(SIZE)[..., :3]
    own.shaft_strength, own.shaft_color = 3.0, (1.0, 0.5, 0.0)
    assert np.array_equal(pictures.render(SIZE)[..., :3], plain), "it is off"
    own.directed = True
    directed = pictures.render(SIZE)[..., :3]
    own.shaft_strength = 0.0
    surfaces = pictures.render(SIZE)[..., :3]
    shafts = plain - surfaces
    assert shafts.max() > 0.01 and surfaces.max() > 0.01
    assert np.allclose(directed - surfaces, shafts * (3.0, 1.5, 0.0), rtol=1e-3, atol=1e-5)


def test_a_preset_is_air_that_is_shown() -> None:
    place("POINT")
    own = props.of_air(bpy.context.scene.world)
    for name, preset in ops.AIRS.items():
        own.shown = False
        assert bpy.ops.sfumato.set_air(preset=name) == {"FINISHED"}
        assert own.shown and np.isclose(own.visibility, preset.values["visibility"])
        assert "air" in stages()


def test_it_is_animated_and_saved() -> None:
    place("POINT")
    own = own_air(visibility=8.0)
    path = Path(bpy.app.tempdir) / "air.blend"
    for frame, visibility in ((1, 8.0), (5, 80.0)):
        own.visibility = visibility
        bpy.context.scene.world.keyframe_insert("sfumato.visibility", frame=frame)
    pairs = []
    for frame in (1, 5):
        bpy.context.scene.frame_set(frame)
        pairs.append(pictures.render(SIZE))
    assert np.abs(pairs[0] - pairs[1]).max() > 0.01
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    harness.enable()
    for frame, expected in zip((1, 5), pairs):
        bpy.context.scene.frame_set(frame)
        assert np.array_equal(pictures.render(SIZE), expected), frame
    # A file from before there was air.
    bpy.ops.wm.open_mainfile(filepath=str(harness.ROOT / "blend_samples" / "gallery.blend"))
    assert not props.of_air(bpy.context.scene.world).shown


harness.main()
