# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine on the sample: pictures, files, the render border, alpha."""

import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import bpy
import harness
import numpy as np
import pictures
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from sfumato import log  # type: ignore[attr-defined]

SMALL = (160, 90)


def pixel_of(place: Sequence[float], size: tuple[int, int]) -> tuple[int, int]:
    """Row and column in which a point in the world is seen."""
    seen = world_to_camera_view(bpy.context.scene, bpy.context.scene.camera, Vector(place))
    return int(seen.y * size[1]), int(seen.x * size[0])


def test_smoke_shows_and_throws_its_shadow() -> None:
    smoke = harness.open_plume()
    with_smoke = pictures.render(SMALL)
    smoke.hide_render = True
    without = pictures.render(SMALL)
    change = with_smoke[..., :3].sum(axis=-1) - without[..., :3].sum(axis=-1)
    middle = pixel_of(harness.middle_of(smoke), SMALL)
    assert abs(change[middle]) > 0.05, change[middle]
    # The sun's light goes through the domain's middle to the floor: there the floor must be darker than it was.
    sun = next(thing for thing in bpy.context.scene.objects if thing.type == "LIGHT")
    direction = sun.matrix_world.to_quaternion() @ Vector((0.0, 0.0, -1.0))
    darkest = change.min()
    assert darkest < -0.3 * without[..., :3].sum(axis=-1).max(), darkest
    assert direction.z < 0.0
    assert np.isfinite(with_smoke).all()


def test_the_panels_tell_the_stages_of_the_last_render() -> None:
    harness.open_plume()
    pictures.render(SMALL)
    names = ["solids", "smoke", "lights", "light maps", "light volumes", "surfaces", "march", "composite"]
    assert list(log.stages()) == names and min(log.stages().values()) > 0.0
    for light in [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(light)
    pictures.render(SMALL)
    assert list(log.stages()) == ["solids", "smoke", "surfaces", "march", "composite"]


def test_frames_differ_and_repeat() -> None:
    harness.open_plume(25)
    first, again = pictures.render(SMALL), pictures.render(SMALL)
    # Not bit for bit: Blender sums up the normals of smooth meshes in parallel, in an order that changes.
    assert np.abs(first - again).max() < 1e-6
    if not harness.MANTAFLOW_ABORTS:
        bpy.context.scene.frame_set(20)
        assert np.abs(pictures.render(SMALL) - first).max() > 0.05


def test_border_is_a_part_of_the_whole() -> None:
    harness.open_plume()
    whole = pictures.render(SMALL)
    render = bpy.context.scene.render
    render.use_border, render.use_crop_to_border = True, True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.2, 0.6
    part = pictures.render(SMALL)
    assert part.shape == (36, 80, 4), part.shape
    # Not bit for bit: which pixels count as edges is asked of neighbours, and a border cuts some away.
    difference = np.abs(part - whole[18:54, 40:120])[1:-1, 1:-1]
    assert np.sqrt((difference**2).mean()) < 0.02, np.sqrt((difference**2).mean())
    render.use_crop_to_border = False
    uncropped = pictures.render(SMALL)
    assert uncropped.shape == (90, 160, 4) and np.array_equal(uncropped[18:54, 40:120], part)
    uncropped[18:54, 40:120] = 0.0
    assert not uncropped[..., :3].any(), "outside the region there is nothing"


def test_sizes_are_whole_numbers_as_blenders_are() -> None:
    """Of sizes and shares whose product is not exact in floating point; a row too few would stay black."""
    harness.open_plume()
    render = bpy.context.scene.render
    for size, percentage in (((256, 144), 70), ((100, 100), 29), ((200, 100), 58), ((128, 72), 70)):
        render.resolution_percentage = percentage
        picture = pictures.render(size)
        assert picture.shape[:2] == tuple(side * percentage // 100 for side in reversed(size))
        assert picture[-1].any() and picture[:, -1].any() and (picture[..., 3] == 1.0).all()


def test_clip_ranges_of_any_width() -> None:
    harness.open_plume()
    camera = bpy.context.scene.camera.data
    usual = pictures.render(SMALL)
    for camera.clip_start, camera.clip_end in ((1e-3, 1e5), (0.1, 1e7)):
        assert np.abs(pictures.render(SMALL) - usual).max() < 2e-3


def test_transparent_film() -> None:
    smoke = harness.open_plume()
    for thing in list(bpy.context.scene.objects):
        if thing.type == "MESH" and thing.name != smoke.name:
            bpy.data.objects.remove(thing)
    bpy.context.scene.render.film_transparent = True
    picture = pictures.render(SMALL)
    alpha = picture[..., 3]
    assert picture[alpha == 0.0].max() < 1e-6, "the world's colour is left in pixels that show nothing"
    assert alpha.min() == 0.0 and 0.5 < alpha.max() <= 1.0, (alpha.min(), alpha.max())
    bpy.context.scene.render.film_transparent = False
    assert (pictures.render(SMALL)[..., 3] == 1.0).all()


def as_script(*options: str) -> str:
    """What Blender does for these options of its command line, for a Blender that has none."""
    values = dict(zip(options[::2], options[1::2]))
    lines = [
        "import bpy; scene = bpy.context.scene; render = scene.render",
        f"render.engine, render.filepath = {values['-E']!r}, {values['-o']!r}",
        f"render.image_settings.file_format = {values['-F']!r}",
        f"scene.frame_start, scene.frame_end = {values['-s']}, {values['-e']}",
        "bpy.ops.render.render(animation=True)",
    ]
    return "; ".join(lines)


def test_command_line_writes_frames() -> None:
    """One frame and several, in a Blender of its own."""
    with tempfile.TemporaryDirectory() as folder:
        shrink = "import bpy; bpy.context.scene.render.resolution_percentage = 25"
        still = ["-E", "SFUMATO", "-o", f"{folder}/still_####", "-F", "PNG"]
        several = ["-E", "SFUMATO", "-o", f"{folder}/several_####", "-F", "OPEN_EXR", "-s", "24", "-e", "26"]
        plume = harness.plume_file()
        for options, frames in ((still, ["-f", "25"]), (several, ["-a"])):
            if harness.WHEEL:
                one = [] if "-s" in options else ["-s", "25", "-e", "25"]
                command = harness.command(f"{shrink}; {as_script(*options, *one)}", plume)
            else:
                command = harness.command(shrink, plume) + options + frames
            subprocess.run(command, check=True, timeout=120)
        written = sorted(path.name for path in Path(folder).iterdir())
        assert written == ["several_0024.exr", "several_0025.exr", "several_0026.exr", "still_0025.png"], written
        assert pictures.read(Path(folder) / "several_0024.exr").shape == (90, 160, 4)


harness.main()
