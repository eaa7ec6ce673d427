# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that a render which was killed left unreadable: with Overwrite off, Blender takes them for rendered."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import core, log, props

ASIDE = ".unreadable"  # what a broken file's name gets

# Files that were read whole, by path, with their size and time: they need not be read again.
_whole: dict[str, tuple[int, int]] = {}


def frames_of(scene: Any) -> Iterator[int]:
    """The frames that a render of an animation takes: the scene's range, and in batch those of `-f`."""
    asked = dict.fromkeys(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
    if bpy.app.background:
        for option, value in zip(sys.argv, sys.argv[1:]):
            if option in {"-f", "--render-frame"}:
                for first, last in re.findall(r"(?:^|,)(\d+)(?:\.\.(\d+))?", value):
                    asked.update(dict.fromkeys(range(int(first), int(last or first) + 1)))
    yield from asked


def files_of(scene: Any) -> Iterator[str]:
    """The files that these frames are written to."""
    render = scene.render
    apart = render.use_multiview and render.image_settings.views_format == "INDIVIDUAL"
    views = [view.name for view in render.views if view.use] if apart else [""]
    for frame in frames_of(scene):
        for view in views:
            yield bpy.path.abspath(render.frame_path(frame=frame, view=view))


def unreadable(path: str) -> str | None:
    """Why a file that is there cannot be read whole, or None."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    known = status.st_size, status.st_mtime_ns
    if _whole.get(path) == known:
        return None
    why: str | None = core.module().unreadable_picture(path)
    if why is None:
        _whole[path] = known
    return why


def look_for_broken(scene: Any) -> list[str]:
    """Move unreadable frames aside, so that they are rendered; what is said of each. With placeholders they stay: each of
    them may be what another task is at work on."""
    render = scene.render
    if render.use_overwrite or render.is_movie_format:
        return []
    said = []
    for path in files_of(scene):
        why = unreadable(path)
        if why is None:
            continue
        if render.use_placeholder:
            said.append(f"{why}; it stays, as another task's placeholder may. If none is at work on it, delete it")
            continue
        try:
            os.replace(path, path + ASIDE)
        except OSError as error:
            said.append(f"{why}, and it cannot be moved aside: {error.strerror}. Delete it to have the frame rendered")
            continue
        said.append(f"{why}; its name is '{os.path.basename(path)}{ASIDE}' now, and an animation renders it again")
    return said


@persistent  # type: ignore[misc]
def _before_a_render(scene: Any, *_: Any) -> None:
    if scene.render.engine != "SFUMATO" and props.of(scene).smoke_scene is None:
        return
    try:
        log.replace("frames", look_for_broken(scene))
    except core.Missing as error:
        log.replace("frames", [str(error)])


def register() -> None:
    bpy.app.handlers.render_init.append(_before_a_render)


def unregister() -> None:
    if _before_a_render in bpy.app.handlers.render_init:
        bpy.app.handlers.render_init.remove(_before_a_render)
