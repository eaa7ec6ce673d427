# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of `bench.py heavy` that looks at a Rendered view of 640 x 360 pixels: one case, in a process of its own.

    xvfb-run -a blender --window-geometry 0 0 776 497 --factory-startup --addons sfumato --python heavy_views.py
        -- CASE METHOD FOLDER

Leaves CASE-METHOD.json and CASE-METHOD.npy in FOLDER: the last picture, or for a lamp that is dragged the refined
surfaces. The method `fresh` drags nothing: it opens the view on the lamp's last place. Times are of all processors.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import statistics
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray
from mathutils import Quaternion, Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
import heavy_scenes  # noqa: E402
from peak_memory import peak_bytes  # noqa: E402

Steps = Iterator[float]
Image = NDArray[np.float32]

LEVELS = {"lamp-drag": 6, "lamp-drag-15k": 2}  # of the monkey's subdivision
DRAGS = 3  # of one degree
REDRAWS = 60
FRAMES, ROUNDS = range(1, 29), 4
POLL, LONGEST = 0.02, 600.0  # seconds


def refinement_module() -> Any:
    """The add-on's part that refines a view at rest; its place differs by commit."""
    for name in ("sfumato.view.refinement", "sfumato.refinement"):
        if importlib.util.find_spec(name.rpartition(".")[0]) and importlib.util.find_spec(name):
            return importlib.import_module(name)
    raise ImportError("this build of sfumato has no module `refinement`")


class Watch:
    """What the view is given to show, and when."""

    def __init__(self) -> None:
        self.module = refinement_module()
        self.surfaces: Any = None  # refined, of the last change
        self.draws = 0
        self.drawn_at = 0.0  # processor time
        original = self.module.take

        def take(*arguments: Any) -> Any:
            found = original(*arguments)
            if found is not None:
                self.surfaces = np.array(found)
            return found

        self.module.take = take
        bpy.types.SpaceView3D.draw_handler_add(self.count, (), "WINDOW", "POST_VIEW")

    def count(self) -> None:
        self.draws += 1
        self.drawn_at = time.process_time()

    def refined(self) -> Steps:
        """Wait until a picture of refined surfaces is on the screen."""
        self.surfaces = None
        deadline = time.monotonic() + LONGEST
        while self.surfaces is None or self.module.busy():
            if time.monotonic() > deadline:
                raise TimeoutError(f"the view is not refined after {LONGEST:.0f} s")
            yield POLL


def viewport() -> tuple[Any, Any, Any]:
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area, next(region for region in area.regions if region.type == "WINDOW")


def look() -> Steps:
    """A Rendered view of the scene as the sample's camera sees it, free to move, without lines and buttons."""
    yield 0.2  # a file that was just opened has no regions yet
    system = bpy.context.preferences.system
    system.use_region_overlap, system.viewport_aa = False, "OFF"
    bpy.context.scene.render.engine = "SFUMATO"
    space = viewport()[1].spaces.active
    space.show_region_toolbar, space.show_region_ui = False, False
    space.overlay.show_overlays = False
    space.shading.type = "RENDERED"
    turned = Quaternion((1.0, 0.0, 0.0), 1.138)
    space.lens, space.region_3d.view_perspective = 50.0, "PERSP"
    space.region_3d.view_rotation, space.region_3d.view_distance = turned, 9.0
    space.region_3d.view_location = Vector((1.25, -8.2, 5.2)) - turned @ Vector((0.0, 0.0, 9.0))
    yield 0.2


def redraw() -> None:
    window, area, region = viewport()
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.wm.redraw_timer(type="DRAW_SWAP", iterations=1)


def turn_sun() -> None:
    bpy.data.objects["Sun"].rotation_euler.y += math.radians(1.0)


def lamp_drag(case: str, method: str, watch: Watch, answer: dict[str, Any]) -> Steps:
    """From the change to the picture of refined surfaces, Blender's own evaluation included."""
    heavy_scenes.add_monkey(LEVELS[case], LEVELS[case])
    if method == "fresh":
        for _ in range(DRAGS):
            turn_sun()
    yield from watch.refined()
    runs = []
    for _ in range(0 if method == "fresh" else DRAGS):
        yield 0.5  # whatever is still to be done after the last one
        start = time.process_time()
        turn_sun()
        yield from watch.refined()
        runs.append(watch.drawn_at - start)
    answer["seconds"] = statistics.median(runs) if runs else None
    answer["picture"] = watch.surfaces


def camera_drag(answer: dict[str, Any]) -> Steps:
    runs = []
    for number in range(REDRAWS + 5):  # shaders, textures, caches
        view = viewport()[1].spaces.active.region_3d
        view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.002) @ view.view_rotation
        start = time.process_time()
        redraw()
        runs.append(time.process_time() - start)
    answer["seconds"] = statistics.median(runs[5:])
    answer["picture"] = picture()
    yield POLL


def playback(answer: dict[str, Any]) -> Steps:
    """As fast as it goes, a redraw for each frame; the first round warms up."""
    rounds = []
    for _ in range(ROUNDS):
        start = time.process_time()
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            redraw()
        rounds.append((time.process_time() - start) / len(FRAMES))
        yield POLL
    answer["seconds"] = statistics.median(rounds[1:])
    answer["picture"] = picture()


def picture() -> Image:
    """What one more redraw shows, before Blender's view transform: (height, width, 4)."""
    import gpu

    targets: list[Any] = []
    seen: list[Image] = []

    def before() -> None:
        targets.append(gpu.state.active_framebuffer_get())

    def after() -> None:
        width, height = bpy.context.region.width, bpy.context.region.height
        pixels = np.empty((height, width, 4), np.float32)
        buffer = gpu.types.Buffer("FLOAT", pixels.shape, pixels)
        target = targets.pop()
        with target.bind():
            target.read_color(0, 0, width, height, 4, 0, "FLOAT", data=buffer)
        seen.append(pixels)

    space = bpy.types.SpaceView3D
    handles = [
        space.draw_handler_add(before, (), "WINDOW", "PRE_VIEW"),
        space.draw_handler_add(after, (), "WINDOW", "POST_VIEW"),
    ]
    redraw()
    for handle in handles:
        space.draw_handler_remove(handle, "WINDOW")
    return seen[-1]


def measure(case: str, method: str, folder: Path) -> Steps:
    watch = Watch()
    heavy_scenes.open_empty()
    yield from look()
    yield from watch.refined()
    before = peak_bytes()
    heavy_scenes.open_plume()
    yield from look()
    answer: dict[str, Any] = {"again": None, "error": None}
    if case in LEVELS:
        yield from lamp_drag(case, method, watch, answer)
    else:
        yield from watch.refined()
        yield from {"camera-drag": camera_drag, "playback": playback}[case](answer)
    answer["bytes"] = peak_bytes() - before
    region = viewport()[2]
    if (region.width, region.height) != heavy_scenes.LARGE:
        raise RuntimeError(f"the view is {region.width} x {region.height}, but must be {heavy_scenes.LARGE}")
    np.save(folder / f"{case}-{method}.npy", answer.pop("picture"))
    (folder / f"{case}-{method}.json").write_text(json.dumps(answer), encoding="utf-8")


def drive(steps: Steps) -> None:
    """Go on at Blender's timer, and leave with a status that says whether it went well."""

    def tick() -> float:
        try:
            return next(steps)
        except StopIteration:
            status = 0
        except Exception:  # whatever happens, Blender must not stay open
            traceback.print_exc()
            status = 3
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)

    bpy.app.timers.register(tick, first_interval=0.5, persistent=True)


if __name__ == "__main__":
    case_argument, method_argument, folder_argument = sys.argv[sys.argv.index("--") + 1 :]
    drive(measure(case_argument, method_argument, Path(folder_argument)))
