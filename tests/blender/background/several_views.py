# SPDX-License-Identifier: GPL-3.0-or-later
"""One render of several pictures: the eyes of a stereo camera, several cameras, view layers, and scenes in the sequencer."""

import tempfile
from pathlib import Path

import bpy
import harness
import multilayer
import numpy as np
import pictures
from numpy.typing import NDArray

SIZE = (64, 36)
Image = NDArray[np.float32]


def prepare() -> bpy.types.Object:
    """The factory's cube in black, before Cycles and us."""
    scene = bpy.context.scene
    scene.world = None
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 256, 0, False, False
    scene.sfumato.quality = "FINAL"
    return scene.camera


def views(engine: str, suffixes: tuple[str, ...]) -> list[Image]:
    """The picture of each view."""
    render = bpy.context.scene.render
    render.engine = engine
    render.resolution_x, render.resolution_y, render.resolution_percentage = *SIZE, 100
    images = render.image_settings
    images.file_format, images.color_mode, images.color_depth = "OPEN_EXR", "RGBA", "32"
    images.exr_codec, images.views_format = "ZIP", "INDIVIDUAL"
    with tempfile.TemporaryDirectory() as folder:
        render.filepath = f"{folder}/frame.exr"
        bpy.ops.render.render(write_still=True)
        # bpy.data.images takes such a scene's files for those of views, and finds no pixels.
        found = [multilayer.read(Path(folder) / f"frame{suffix}.exr") for suffix in suffixes]
        return [np.stack([channels[letter] for letter in "RGBA"], axis=-1) for channels in found]


def error(values: Image, wanted: Image) -> float:
    """Relative RMSE of blocks of 4 x 4 pixels, where anything is."""
    first, second = (pictures.in_blocks(picture, 4) for picture in (values, wanted))
    there = second.sum(axis=-1) > 0.0
    return float(np.sqrt(((first - second)[there] ** 2).mean()) / second[there].mean())


def compare(suffixes: tuple[str, ...], case: str) -> list[Image]:
    ours, theirs = views("SFUMATO", suffixes), views("CYCLES", suffixes)
    for mine, other, suffix in zip(ours, theirs, suffixes):
        print(f"  {case} {suffix}: {error(mine, other):.2%}")
        assert error(mine, other) < 0.03, (case, suffix)
    assert error(ours[0], ours[1]) > 0.1, "no two views are the same"
    return ours


def test_both_eyes_are_as_in_cycles() -> None:
    camera = prepare().data
    bpy.context.scene.render.use_multiview = True
    camera.stereo.interocular_distance, camera.stereo.convergence_distance = 0.8, 6.0
    camera.shift_x = 0.1
    for camera.stereo.convergence_mode in ("OFFAXIS", "PARALLEL", "TOE"):
        compare(("_L", "_R"), camera.stereo.convergence_mode)
    camera.type, camera.ortho_scale, camera.stereo.convergence_mode = "ORTHO", 6.0, "OFFAXIS"
    compare(("_L", "_R"), "ORTHO")


def test_views_of_several_cameras() -> None:
    scene = bpy.context.scene
    camera = prepare()
    scene.render.use_multiview, scene.render.views_format = True, "MULTIVIEW"
    camera.name = "Rig_L"
    other = camera.copy()
    other.data = camera.data.copy()
    other.name, other.data.lens, other.location.x = "Rig_R", 35.0, camera.location.x + 1.5
    scene.collection.objects.link(other)
    left, right = compare(("_L", "_R"), "MULTIVIEW")
    scene.render.use_multiview = False
    assert np.abs(pictures.render(SIZE) - left).max() < 1e-5
    scene.camera = other
    assert np.abs(pictures.render(SIZE) - right).max() < 1e-5


def test_each_view_layer_has_its_own_objects() -> None:
    prepare()
    scene = bpy.context.scene
    ball = bpy.data.collections.new("Ball")
    scene.collection.children.link(ball)
    bpy.ops.mesh.primitive_uv_sphere_add(location=(1.0, -1.5, 0.5))
    thing = bpy.context.object
    for home in thing.users_collection:
        home.objects.unlink(thing)
    ball.objects.link(thing)
    thing.pass_index = 7
    without = scene.view_layers.new("Without")
    without.layer_collection.children["Ball"].exclude = True
    for layer in scene.view_layers:
        layer.use_pass_object_index = True
    found = multilayer.render(SIZE)
    index = "Object Index.X" if bpy.app.version >= (5, 0, 0) else "IndexOB.X"
    assert (found[f"ViewLayer.{index}"] == 7).any() and not (found[f"Without.{index}"] == 7).any()
    for layer in ("ViewLayer", "Without"):
        assert found[f"{layer}.Combined.R"].max() > 0.1, layer


def test_a_strip_of_a_scene_has_the_strips_camera() -> None:
    camera = prepare()
    scene = bpy.context.scene
    other = camera.copy()
    other.location.z += 2.0
    scene.collection.objects.link(other)
    scene.render.engine = "SFUMATO"
    scene.camera = other
    wanted = pictures.render(SIZE)
    scene.camera = camera
    usual = pictures.render(SIZE)
    edit = bpy.data.scenes.new("Edit")
    edit.sequence_editor_create()
    editor = edit.sequence_editor
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strip = strips.new_scene("Shot", scene, 1, 1)
    strip.scene_camera = other
    edit.render.engine = "SFUMATO"
    edit.render.resolution_percentage = 100
    edit.view_settings.view_transform = scene.view_settings.view_transform = "Raw"
    edit.sequencer_colorspace_settings.name = "Linear" if bpy.app.version < (4, 0, 0) else "Linear Rec.709"
    images = edit.render.image_settings
    images.file_format, images.color_mode, images.color_depth = "OPEN_EXR", "RGBA", "32"
    edit.render.resolution_x, edit.render.resolution_y = SIZE
    with tempfile.TemporaryDirectory() as folder:
        edit.render.filepath = f"{folder}/frame.exr"
        bpy.ops.render.render(write_still=True, scene="Edit")
        found = pictures.read(Path(folder) / "frame.exr")
    assert error(found, wanted) < 0.01 < error(found, usual), (error(found, wanted), error(found, usual))


harness.main()
