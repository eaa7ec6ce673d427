# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes in the file of a render, beside those of the Cycles of the same Blender."""

import subprocess
import tempfile
from pathlib import Path

import bpy
import harness
import multilayer
import numpy as np
from numpy.typing import NDArray
from sfumato import log  # type: ignore[attr-defined]

SIZE = (64, 48)
SWITCHES = ("z", "mist", "position", "normal", "object_index", "material_index")
OBJECT, MATERIAL = (
    ("Object Index.X", "Material Index.X") if bpy.app.version >= (5, 0, 0) else ("IndexOB.X", "IndexMA.X")
)
OF_ONE_SAMPLE = ("Depth.Z", OBJECT, MATERIAL, "Position.X", "Position.Y", "Position.Z")
FILTERED = ("Mist.Z", "Normal.X", "Normal.Y", "Normal.Z")


def still_life(camera: str = "PERSP") -> None:
    """A floor, a smooth ball and a turned cube of two materials, each with its number, before nothing."""
    bpy.ops.mesh.primitive_plane_add(size=6.0, location=(0.0, 0.0, -1.0))
    bpy.context.object.pass_index = 3
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.9, location=(1.8, 0.4, 0.0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.pass_index = 700
    cube = bpy.data.objects["Cube"]
    cube.pass_index = 12
    cube.rotation_euler, cube.scale = (0.3, 0.2, 0.5), (0.8, 0.8, 0.8)
    for number in (4, 5):
        material = bpy.data.materials.new("Numbered")
        material.pass_index = number
        cube.data.materials.append(material)
    for face in cube.data.polygons:
        face.material_index = 1 + face.index % 2
    scene = bpy.context.scene
    scene.camera.data.type, scene.camera.data.ortho_scale = camera, 6.5
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 5.0, 7.0
    for switch in SWITCHES:
        setattr(scene.view_layers[0], f"use_pass_{switch}", True)
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 256, 0, False, False
    scene.sfumato.quality = "FINAL"


def channel(found: multilayer.Channels, name: str) -> NDArray[np.float32]:
    return next(values for full, values in found.items() if full.endswith(f".{name}"))


def inside(values: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Pixels around which an index does not change: at an edge the last digit decides which side is seen."""
    wide = np.pad(values, 2, mode="edge")
    rows, columns = values.shape
    around = [wide[i : i + rows, j : j + columns] for i in range(5) for j in range(5)]
    return np.all([other == values for other in around], axis=0)


def test_what_surfaces_are_is_as_in_cycles() -> None:
    for camera in ("PERSP", "ORTHO"):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        still_life(camera)
        ours, theirs = multilayer.render(SIZE), multilayer.render(SIZE, "CYCLES")
        same = inside(channel(ours, OBJECT)) & inside(channel(ours, MATERIAL))
        assert same.mean() > 0.5 and len(np.unique(channel(ours, OBJECT)[same])) == 4
        assert set(np.unique(channel(ours, MATERIAL)[same])) >= {0.0, 4.0, 5.0}
        for name in OF_ONE_SAMPLE:
            mine, other = channel(ours, name)[same], channel(theirs, name)[same]
            off = np.abs(mine - other)
            print(f"  {camera} {name}: median {np.median(off):.4f}, largest {off.max():.4f}")
            if name in (OBJECT, MATERIAL):
                assert off.max() == 0.0
                continue
            # Metres. Cycles' first sample lies in the middle of the pixel, as ours.
            assert np.array_equal(mine > 1e9, other > 1e9) and off.max() < 1e-3, name
        for name in FILTERED:
            off = channel(ours, name) - channel(theirs, name)
            error = float(np.sqrt((off**2).mean()) / np.sqrt((channel(theirs, name) ** 2).mean()))
            print(f"  {camera} {name}: RMSE {error:.3%}")
            assert error < 0.03, (camera, name, error)


def test_mist_falls_off_as_in_cycles() -> None:
    still_life()
    mist = bpy.context.scene.world.mist_settings
    for mist.falloff in ("QUADRATIC", "INVERSE_QUADRATIC"):
        off = channel(multilayer.render(SIZE), "Mist.Z") - channel(multilayer.render(SIZE, "CYCLES"), "Mist.Z")
        assert np.sqrt((off**2).mean()) < 0.01, mist.falloff


def colours(found: multilayer.Channels, name: str) -> NDArray[np.float32]:
    return np.stack([channel(found, f"{name}.{letter}") for letter in "RGB"], axis=-1)


def rmse(values: NDArray[np.float32], wanted: NDArray[np.float32]) -> float:
    return float(np.sqrt(((values - wanted) ** 2).mean()))


def test_shadow_is_the_share_of_light_that_arrives() -> None:
    """As in the Cycles that last had this pass, 3.4.1's; there, too, 0 where there is nothing to light."""
    if bpy.app.version >= (4, 0, 0):
        raise harness.Skip("this Cycles has no pass of shadows")
    still_life()
    bpy.context.scene.world = None
    bpy.context.scene.view_layers[0].use_pass_shadow = True
    ours, theirs = multilayer.render(SIZE), multilayer.render(SIZE, "CYCLES")
    # The ball's terminator aside: there Cycles counts what of a lamp is below the horizon as missing, a closed form not.
    flat = inside(channel(ours, OBJECT)) & (channel(ours, OBJECT) != 700.0)
    error = rmse(colours(ours, "Shadow")[flat], colours(theirs, "Shadow")[flat])
    assert colours(ours, "Shadow")[flat].min() < 0.01 < 0.99 < colours(ours, "Shadow")[flat].max()
    assert error < 0.03, error


def test_smoke_and_its_shadow_make_the_picture_of_one_without() -> None:
    """Of another picture, too: of Cycles' without smoke, its own with smoke."""
    smoke = harness.open_plume()
    scene = bpy.context.scene
    asked = scene.view_layers[0].sfumato
    asked.smoke = asked.smoke_shadow = True
    scene.sfumato.quality, scene.render.resolution_percentage = "FINAL", 100
    whole = multilayer.render((96, 54))
    smoke.hide_render = True
    bare = multilayer.render((96, 54))
    joined = colours(bare, "Combined") * colours(whole, "Smoke Shadow") * (1.0 - channel(whole, "Smoke.A")[..., None])
    joined += colours(whole, "Smoke")
    error = rmse(joined, colours(whole, "Combined")) / float(colours(whole, "Combined").mean())
    assert error < 1e-3, error
    assert colours(bare, "Smoke").max() == 0.0 == channel(bare, "Smoke.A").max()
    assert colours(bare, "Smoke Shadow").min() == 1.0
    assert channel(whole, "Smoke.A").max() > 0.5 and colours(whole, "Smoke Shadow").min() < 0.7


def test_what_is_not_made_is_named_once() -> None:
    scene = bpy.context.scene
    layer = scene.view_layers[0]
    layer.use_pass_uv = layer.use_pass_cryptomatte_object = layer.use_pass_z = True
    layer.cycles.denoising_store_passes = True
    layer.aovs.add().name = "Wetness"
    multilayer.render((8, 8))
    said = [line for line in log.notices() if "passes are not made" in line]
    assert len(said) == 1, said
    for name in ("UV", "Cryptomatte Object", "Denoising Passes", "'Wetness'", "'ViewLayer'"):
        assert name in said[0], (name, said)
    assert "Depth" not in said[0] and "Z," not in said[0]


def test_a_file_from_the_command_line_holds_them() -> None:
    """And says how it was made."""
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "ask.py"
        script.write_text(
            "import sys; sys.path.insert(0, {!r})\n"
            "import bpy, harness, multilayer\n"
            "harness.enable() if harness.WHEEL else None\n"
            "scene = bpy.context.scene\n"
            "scene.view_layers[0].sfumato.smoke = scene.view_layers[0].use_pass_z = True\n"
            "scene.render.engine, scene.render.resolution_percentage = 'SFUMATO', 10\n"
            "scene.render.filepath = {!r}\n"
            "multilayer.ask_for_layers(scene.render)\n"
            "scene.frame_set(25)\n"
            "bpy.ops.render.render(write_still=True)\n".format(str(Path(__file__).parents[1]), f"{folder}/one.exr"),
            encoding="utf-8",
        )
        subprocess.run(harness.command(script, harness.plume_file()), check=True, timeout=120)
        found = multilayer.read(Path(folder) / "one.exr")
        assert channel(found, "Smoke.A").max() > 0.5 and channel(found, "Depth.Z").min() < 100.0
        texts = multilayer.metadata(Path(folder) / "one.exr")
        assert texts["Sfumato quality"] == "Preview" and "march" in texts["Sfumato stages"], texts


harness.main()
