# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/viewport.png: the sample in Solid mode, with the smoke and its shadow, as an artist sees it.

PATH=/usr/bin:$PATH xvfb-run -a -s '-screen 0 1280x720x24' blender --window-geometry 0 0 1280 720 blend_samples/plume.blend \
    --addons sfumato --python docs/screenshot.py
"""

from collections.abc import Iterator
from pathlib import Path

import bpy

OUT = Path(__file__).resolve().parent / "viewport.png"


def steps() -> Iterator[None]:
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    space = area.spaces.active
    space.shading.type = "SOLID"
    space.shading.color_type = "OBJECT"
    space.overlay.show_extras = False
    space.show_region_ui = True
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_zoom = 12.0
    space.overlay.show_relationship_lines = False
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = None
    yield
    region = next(region for region in area.regions if region.type == "UI")
    if hasattr(region, "active_panel_category"):
        try:
            region.active_panel_category = "Sfumato"
        except AttributeError:  # read-only before 4.2
            pass
    for _ in range(4):
        area.tag_redraw()
        yield
    with bpy.context.temp_override(window=window):
        bpy.ops.screen.screenshot(filepath=str(OUT))
    bpy.ops.wm.quit_blender()


RUN = steps()
bpy.app.timers.register(lambda: 1.0 if next(RUN, "end") != "end" else None, first_interval=1.0)
