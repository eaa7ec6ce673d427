# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a redraw of the 3D viewport takes: EEVEE with volumetric shadows against Sfumato, on the sample's plume.

    PATH=/usr/bin:$PATH xvfb-run -a blender --window-geometry 0 0 776 497 --factory-startup --addons sfumato --python tests/blender/redraw.py

Every redraw sees a camera that has moved a little, so that nothing is kept from the last one; EEVEE takes one sample.
The rivals take turns, so that whatever else the machine does meets all of them. Prints medians and their ratios; a
software rasteriser's work is in the processor time of Blender itself.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import harness  # noqa: E402
import screen  # noqa: E402
from mathutils import Quaternion, Vector  # noqa: E402
from sfumato import log  # type: ignore[attr-defined]  # noqa: E402

ROUNDS, REDRAWS = 3, 10
EEVEE = "BLENDER_EEVEE"


def eevee() -> None:
    settings = bpy.context.scene
    try:
        settings.render.engine = EEVEE
    except TypeError:
        settings.render.engine = EEVEE + "_NEXT"
    settings.eevee.taa_samples = 1
    for option in ("use_volumetric_lights", "use_volumetric_shadows", "use_volume_custom_range"):
        if hasattr(settings.eevee, option):
            setattr(settings.eevee, option, option != "use_volume_custom_range")
    show("RENDERED", overlay=False)


def sfumato_rendered() -> None:
    bpy.context.scene.render.engine = "SFUMATO"
    show("RENDERED", overlay=False)


def sfumato_solid() -> None:
    show("SOLID", overlay=True)


def blender_solid() -> None:
    show("SOLID", overlay=False)


def show(shading: str, overlay: bool) -> None:
    bpy.context.scene.sfumato.viewport_enabled = overlay
    screen.viewport()[1].spaces.active.shading.type = shading


def redraw() -> tuple[float, float]:
    """Seconds, on the clock and of all processors, for one redraw from a camera that has just moved."""
    window, area, region = screen.viewport()
    view = area.spaces.active.region_3d
    view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.002) @ view.view_rotation
    started = time.perf_counter(), time.process_time()
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.wm.redraw_timer(type="DRAW_SWAP", iterations=1)
    return time.perf_counter() - started[0], time.process_time() - started[1]


def measure() -> Iterator[None]:
    harness.open_plume(25)
    yield
    # In a window of 776 x 497 Blender's factory layout leaves the view 640 x 360 pixels.
    bpy.context.preferences.system.use_region_overlap = False
    space = screen.viewport()[1].spaces.active
    space.show_region_toolbar, space.show_region_ui = False, False
    yield
    space = screen.prepare("SOLID")
    # The camera's view, but free to move.
    camera = bpy.context.scene.camera.matrix_world
    space.lens, space.region_3d.view_perspective = 50.0, "PERSP"
    space.region_3d.view_rotation = camera.to_quaternion()
    space.region_3d.view_distance = 9.0
    space.region_3d.view_location = camera.translation - camera.to_quaternion() @ Vector((0.0, 0.0, 9.0))
    rivals: dict[str, Callable[[], None]] = {
        "EEVEE": eevee,
        "Sfumato, Rendered": sfumato_rendered,
        "Sfumato, Solid": sfumato_solid,
        "Solid without smoke": blender_solid,
    }
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in rivals}
    for turn in range(ROUNDS + 1):
        for name, choose in rivals.items():
            choose()
            for _ in range(3):  # shaders, textures, caches
                yield
                redraw()
            if turn > 0:  # the first turn compiles
                times[name] += [redraw() for _ in range(REDRAWS)]
    region = screen.viewport()[2]
    print(f"\nA redraw of {region.width} x {region.height} pixels, the median of {ROUNDS * REDRAWS}:")
    slowest = [median(column) for column in zip(*times["EEVEE"])]
    for name, seconds in times.items():
        clock, processors = (median(column) for column in zip(*seconds))
        print(f"  {name:20} {1e3 * clock:7.1f} ms, {1e3 * processors:7.1f} ms of processors; EEVEE takes "
              f"{slowest[0] / clock:.1f} and {slowest[1] / processors:.1f} times as long")  # fmt: skip
    print(*log.notices(), sep="\n", flush=True)


harness.drive(measure())
