# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds beside the Cycles of this very Blender: what the eye sees of them, and the light that they give."""

import math
import unittest.mock
from collections.abc import Callable
from typing import Any

import bpy
import harness
import numpy as np
import pictures
from sfumato import core  # type: ignore[attr-defined]
from sfumato.export import parts
from sfumato.export import scene as export
from sfumato.export import world as exported
from worlds import clouds, image, linked, world

SIZE = (64, 48)


def turned(node: bpy.types.Node, vector_type: str = "POINT", **inputs: tuple[float, ...]) -> None:
    """Map the direction that a node takes."""
    tree = node.id_data
    mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.vector_type = vector_type
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    for name, value in inputs.items():
        mapping.inputs[name].default_value = value
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])


def hdri() -> None:
    linked("ShaderNodeTexEnvironment", image=image(clouds()))


def turned_hdri() -> None:
    turned(linked("ShaderNodeTexEnvironment", image=image(clouds(512))), Rotation=(0.3, -0.5, 1.9))


def squeezed_hdri() -> None:
    node = linked("ShaderNodeTexEnvironment", image=image(clouds(512)))
    turned(node, "TEXTURE", Rotation=(0.3, 0.5, 1.9), Scale=(1.0, 2.0, 0.7), Location=(0.1, 0.2, -0.1))


def bytes_of_srgb() -> None:
    linked("ShaderNodeTexEnvironment", image=image(np.clip(clouds(), 0.0, 1.0), floats=False))


def mirror_ball() -> None:
    linked("ShaderNodeTexEnvironment", image=image(clouds(512)), projection="MIRROR_BALL")


def gradient() -> None:
    node = linked("ShaderNodeTexGradient", gradient_type="EASING")
    turned(node, Rotation=(0.0, math.radians(-70.0), 0.4), Location=(0.5, 0.0, 0.0))
    background = next(each for each in node.id_data.nodes if each.type == "BACKGROUND")
    ramp = node.id_data.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color = (0.6, 0.3, 0.1, 1.0)
    ramp.color_ramp.elements[1].color = (0.1, 0.3, 0.9, 1.0)
    node.id_data.links.new(node.outputs["Fac"], ramp.inputs[0])
    node.id_data.links.new(ramp.outputs["Color"], background.inputs["Color"])


def sunny() -> None:
    """A Sky Texture as it comes, by the model of this Blender, with its sun."""
    node = linked("ShaderNodeTexSky", sun_elevation=0.7, sun_rotation=0.8)
    background = next(each for each in node.id_data.nodes if each.type == "BACKGROUND")
    background.inputs["Strength"].default_value = 0.05


def mixed() -> None:
    """Half an image and half a color, by the height."""
    tree, background = world()
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image(clouds())
    tree.links.new(node.outputs[0], background.inputs["Color"])
    other, both = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeMixShader")
    other.inputs["Color"].default_value = (0.2, 0.6, 0.3, 1.0)
    other.inputs["Strength"].default_value = 1.5
    parts, coordinates = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], parts.inputs[0])
    tree.links.new(parts.outputs["Z"], both.inputs[0])
    tree.links.new(background.outputs[0], both.inputs[1])
    tree.links.new(other.outputs[0], both.inputs[2])
    output = next(each for each in tree.nodes if each.type == "OUTPUT_WORLD")
    tree.links.new(both.outputs[0], output.inputs["Surface"])


def seen_by_the_eye_alone() -> None:
    """The usual way to have another backdrop than light."""
    mixed()
    tree = bpy.context.scene.world.node_tree
    both = next(each for each in tree.nodes if each.type == "MIX_SHADER")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], both.inputs[0])


SEEN: dict[str, Callable[[], None]] = {
    "image": hdri,
    "image, turned": turned_hdri,
    "image, squeezed": squeezed_hdri,
    "image of bytes": bytes_of_srgb,
    "mirror ball": mirror_ball,
    "gradient": gradient,
    "mixture": mixed,
    "seen by the eye alone": seen_by_the_eye_alone,
}


def empty(*, keep: bool = False) -> bpy.types.Scene:
    if not keep:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        harness.enable()
    scene = bpy.context.scene
    data = bpy.data.cameras.new("Camera")
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(scene.camera)
    scene.camera.location = (0.0, -5.0, 1.6)
    scene.camera.rotation_euler = (math.radians(80.0), 0.0, 0.0)
    data.angle = 0.7
    scene.render.resolution_percentage = 100
    scene.sfumato.quality = "FINAL"
    return scene


def test_the_eye_sees_what_cycles_shows() -> None:
    for name, make in SEEN.items():
        scene = empty()
        make()
        scene.camera.data.angle = 2.2
        for turn in ((1.9, 0.0, 2.8), (0.9, 0.3, -1.2)):
            scene.camera.rotation_euler = turn
            error = pictures.error_beside_cycles(f"{name} {turn[2]}", SIZE, 64, 1)
            assert error < 0.015, (name, turn, error)


def solids() -> None:
    """A floor, a wall, a matt ball, a rough metal one and a glossy one."""

    def ball(x: float, **inputs: Any) -> None:
        bpy.ops.mesh.primitive_uv_sphere_add(location=(x, 0.0, 0.5), radius=0.5, segments=48, ring_count=24)
        bpy.ops.object.shade_smooth()
        harness.put(harness.shade(bpy.context.object.data, "ShaderNodeBsdfPrincipled"), **inputs)

    bpy.ops.mesh.primitive_plane_add(size=30.0)
    harness.put(harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse"), Color=(0.6, 0.6, 0.6))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 1.2, 0.6))
    bpy.context.object.scale = (3.2, 0.1, 1.2)
    harness.put(harness.shade(bpy.context.object.data, "ShaderNodeBsdfDiffuse"), Color=(0.7, 0.5, 0.4))
    harness.put(harness.shade(bpy.data.objects["Plane"].data, "ShaderNodeBsdfDiffuse"), Color=(0.6, 0.6, 0.6))
    ball(-1.2, Base_Color=(0.8, 0.8, 0.8), Roughness=1.0)
    ball(0.0, Base_Color=(0.9, 0.8, 0.6), Metallic=1.0, Roughness=0.5)
    ball(1.2, Base_Color=(0.2, 0.1, 0.1), Roughness=0.3)


def cloud(anisotropy: float) -> None:
    thing = harness.volume(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
    harness.put(harness.shade(thing.data, "ShaderNodeVolumePrincipled", "Volume"), Density=8.0, Anisotropy=anisotropy)
    thing.data.grids.load()
    bounds = np.array(thing.bound_box)
    size = (bounds.max(axis=0) - bounds.min(axis=0)).max()
    thing.scale = (1.6 / size,) * 3
    thing.location = (*(-1.6 / size * bounds.mean(axis=0))[:2], 0.85 - 1.6 / size * bounds.mean(axis=0)[2])


def test_solids_in_its_light() -> None:
    for name, make in (("image", hdri), ("gradient", gradient), ("sky", sunny)):
        empty()
        make()
        solids()
        error = pictures.error_beside_cycles(f"solids, {name}", SIZE, 256)
        assert error < 0.025, (name, error)


def test_smoke_in_its_light() -> None:
    """Of what is scattered forwards each eighth of the world has one direction, whatever its colors are."""
    if not pictures.cycles_shows_smoke():
        raise harness.Skip("this Cycles shows no smoke")
    for name, make, anisotropy, most in (
        ("image", hdri, 0.0, 0.035),
        ("image, forwards", hdri, 0.3, 0.04),
        ("gradient", gradient, 0.0, 0.035),
        ("gradient, forwards", gradient, 0.3, 0.08),
        ("sky", sunny, 0.0, 0.04),
    ):
        cloud(anisotropy)
        empty(keep=True).render.film_transparent = True  # else the backdrop is most of the picture
        make()
        bpy.context.scene.camera.location = (0.0, -4.0, 1.0)
        error = pictures.error_beside_cycles(f"smoke, {name}", SIZE, 512)
        assert error < most, (name, error)


def test_an_image_that_is_not_there_is_magenta_and_named() -> None:
    empty()
    missing = bpy.data.images.new("Missing", 8, 8)
    missing.source, missing.filepath = "FILE", "//not_there.exr"
    linked("ShaderNodeTexEnvironment", image=missing)
    assert any("Missing cannot be read" in said and "not_there.exr" in said for said in harness.said()), harness.said()
    seen = pictures.render((8, 8))[..., :3]
    np.testing.assert_allclose(seen, np.broadcast_to((1.0, 0.0, 1.0), seen.shape), atol=1e-6)


def test_pixels_that_are_no_light_are_black_and_named() -> None:
    empty()
    pixels = clouds()
    pixels[40:60, 30:50, 0] = np.nan
    pixels[:20, :, 1] = -1.0
    linked("ShaderNodeTexEnvironment", image=image(pixels))
    assert any("not finite, or are negative" in said for said in harness.said()), harness.said()
    assert not any("opaque" in said for said in harness.said()), harness.said()
    pixels[3, 4, 3] = 0.5
    linked("ShaderNodeTexEnvironment", image=image(pixels, "Clear"))
    bpy.data.images["Clear"].alpha_mode = "STRAIGHT"
    assert any("image Clear is not opaque" in said for said in harness.said()), harness.said()
    assert np.isfinite(pictures.render((16, 16))).all()


def test_what_brushed_metal_mirrors_is_named() -> None:
    empty()
    hdri()
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    shader = harness.shade(bpy.context.object.data, "ShaderNodeBsdfPrincipled")
    harness.put(shader, Metallic=1.0, Roughness=0.4)
    assert not any("anisotropic" in said for said in harness.said()), harness.said()
    harness.put(shader, Anisotropic=0.8)
    assert any("Plane: what its anisotropic gloss mirrors" in said for said in harness.said()), harness.said()


def test_dragging_its_strength_draws_nothing_anew() -> None:
    empty()
    hdri()
    solids()
    background = next(each for each in bpy.context.scene.world.node_tree.nodes if each.type == "BACKGROUND")
    before = pictures.render((16, 12))[..., :3]
    with unittest.mock.patch.object(exported, "drawn", wraps=exported.drawn) as drawn:
        kept = parts.Parts(told=True)
        for strength in (1.0, 2.0, 3.0):
            background.inputs["Strength"].default_value = strength
            export.export(bpy.context.evaluated_depsgraph_get(), kept)
    assert drawn.call_count == 1, drawn.call_count
    np.testing.assert_allclose(pictures.render((16, 12))[..., :3], 3.0 * before, rtol=2e-3, atol=1e-4)


def test_an_image_that_changes_is_read_again() -> None:
    empty()
    node = linked("ShaderNodeTexEnvironment", image=image(np.full((8, 16, 4), 0.25, np.float32)))
    made = node.image
    kept = parts.Parts(told=True)

    def seen() -> float:
        out = export.export(bpy.context.evaluated_depsgraph_get(), kept)
        frame = core.module().Frame(out.scene)
        return float(frame.render(core.module().Camera(np.eye(4)), 2, 2)[0, 0, 0])

    assert abs(seen() - 0.25) < 1e-3
    made.pixels.foreach_set(np.full(8 * 16 * 4, 0.5, np.float32))
    made.update()
    assert abs(seen() - 0.5) < 1e-3
    made.source, made.generated_type = "GENERATED", "BLANK"
    made.generated_color = (0.9, 0.9, 0.9, 1.0)
    assert made.pixels[0] > 0.6 and abs(seen() - made.pixels[0]) < 1e-3, (made.pixels[0], seen())


def test_without_an_environment_a_layer_is_dark() -> None:
    scene = empty()
    hdri()
    solids()
    bpy.context.view_layer.use_sky = False
    assert not pictures.render((16, 16))[..., :3].any()
    bpy.context.view_layer.use_sky = True
    assert pictures.render((16, 16))[..., :3].all()
    scene.world.cycles_visibility.camera = False
    assert not pictures.render((16, 16))[-2:, :, :3].any()
    scene.cycles.use_denoising, scene.cycles.samples = False, 4
    np.testing.assert_allclose(pictures.render((16, 16))[-2:], pictures.render((16, 16), "CYCLES")[-2:], atol=1e-6)
    scene.world.cycles_visibility.diffuse = scene.world.cycles_visibility.glossy = False
    ground = pictures.render((16, 16))[:4, :, :3]
    assert not ground.any()


def test_a_world_is_drawn_once() -> None:
    """Not again while nothing of it changes."""
    empty()
    hdri()
    with unittest.mock.patch.object(exported, "drawn", wraps=exported.drawn) as drawn:
        kept = parts.Parts(told=True)
        for _ in range(3):
            export.export(bpy.context.evaluated_depsgraph_get(), kept)
    assert drawn.call_count == 1, drawn.call_count


harness.main()
