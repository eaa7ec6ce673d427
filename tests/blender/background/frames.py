# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that a killed render left: with Overwrite off the broken ones are rendered again, and no other."""

import os
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import harness
from sfumato import core, log  # type: ignore[attr-defined]


@contextmanager
def animation(file_format: str) -> Iterator[Path]:
    """A folder with four rendered frames of the factory's scene."""
    with tempfile.TemporaryDirectory() as folder:
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end, scene.frame_current = 1, 4, 1
        render = scene.render
        render.engine, render.filepath = "SFUMATO", f"{folder}/frame_"
        render.resolution_x, render.resolution_y, render.resolution_percentage = 48, 32, 100
        render.image_settings.file_format = file_format
        bpy.ops.render.render(animation=True)
        render.use_overwrite = False
        yield Path(folder)


def cut(path: Path, share: float) -> None:
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])


def test_broken_frames_are_rendered_again() -> None:
    for file_format, suffix in (("PNG", "png"), ("OPEN_EXR", "exr"), ("JPEG", "jpg")):
        with animation(file_format) as folder:
            first, second, third, fourth = (folder / f"frame_000{number}.{suffix}" for number in (1, 2, 3, 4))
            cut(second, 0.0)
            cut(third, 0.6)
            fourth.unlink()
            whole = first.read_bytes()
            os.utime(first, (1e9, 1e9))
            bpy.ops.render.render(animation=True)
            assert first.stat().st_mtime == 1e9 and first.read_bytes() == whole, "a readable frame stays as it was"
            assert all(path.exists() for path in (second, third, fourth))
            for path in (second, third):
                assert core.module().unreadable_picture(str(path)) is None
                assert path.with_name(path.name + ".unreadable").exists()
                assert any(path.name in line for line in log.notices()), log.notices()
            assert not first.with_name(first.name + ".unreadable").exists()
            bpy.ops.render.render(animation=True)
            assert not log.notices() or not any("frame_" in line for line in log.notices()), "said once"


def test_placeholders_stay() -> None:
    with animation("PNG") as folder:
        bpy.context.scene.render.use_placeholder = True
        placeholder = folder / "frame_0003.png"
        cut(placeholder, 0.0)
        bpy.ops.render.render(animation=True)
        assert placeholder.stat().st_size == 0
        assert any("frame_0003.png" in line and "placeholder" in line for line in log.notices()), log.notices()


def test_nothing_is_looked_at_where_all_is_overwritten() -> None:
    with animation("PNG") as folder:
        bpy.context.scene.render.use_overwrite = True
        cut(folder / "frame_0002.png", 0.0)
        bpy.ops.render.render()  # a still touches no file
        assert (folder / "frame_0002.png").stat().st_size == 0
        bpy.ops.render.render(animation=True)
        assert core.module().unreadable_picture(str(folder / "frame_0002.png")) is None
        assert not list(folder.glob("*.unreadable"))


def test_a_frame_of_the_command_line_is_looked_at() -> None:
    """`-f` takes frames beyond the scene's range."""
    if harness.WHEEL:
        raise harness.Skip("Blender as a module has no command line")
    with animation("PNG") as folder:
        bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/scene.blend")
        empty = folder / "frame_0012.png"
        empty.touch()
        start = harness.command("import bpy", folder / "scene.blend")
        done = subprocess.run([*start, "-f", "10..12"], check=True, timeout=120, capture_output=True, text=True)
        assert core.module().unreadable_picture(str(empty)) is None, done.stdout
        assert empty.with_name("frame_0012.png.unreadable").exists()
        assert (folder / "frame_0011.png").exists() and "frame_0012.png.unreadable" in done.stdout


harness.main()
