# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12, `blender -b -E SFUMATO`, and the Rendered viewport."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import compat, core, log, props
from .export import parts, scene
from .view import rendered


class SfumatoEngine(bpy.types.RenderEngine):
    bl_idname = "SFUMATO"
    bl_label = "Sfumato"
    bl_use_preview = False
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True  # Material Preview stays Blender's own, with the smoke over it: else both draw it
    # Made by view_update, drawn by view_draw; None where there is nothing to draw.
    view_frame: Any = None
    view_filter: tuple[Any, ...] = ()

    def render(self, depsgraph: Any) -> None:
        settings = depsgraph.scene
        size = image_size(settings.render)
        try:
            camera = camera_of(settings, depsgraph)
            if camera is None:
                self.report({"ERROR"}, "The scene has no camera: add one, or make one active")
                return
            # A farm sees an error, and a status of 1, rather than a picture that lacks its smoke.
            whole = bpy.app.background and props.of(settings).missing_is_error
            frame = scene.frame_of(depsgraph, "render", parts.of_render(settings), whole)
            window, extent = border_of(settings.render, size)
            image = frame.render(
                core.module().Camera(window @ camera),
                *extent,
                edge_samples=props.QUALITIES[props.of(settings).quality].edge_samples,
                progress=self.go_on,
            )
        except (core.Missing, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return
        log.took(frame.stages)
        if image is None:
            return
        if not settings.render.film_transparent:
            image[..., 3] = 1.0
        result = self.begin_result(0, 0, *extent, layer=depsgraph.view_layer.name)
        compat.set_pixels(result.layers[0], image)
        self.end_result(result)

    def view_update(self, context: Any, depsgraph: Any) -> None:
        self.view_frame, self.view_filter = None, scene.filter_of(context.space_data)
        try:
            self.view_frame = scene.frame_of(depsgraph, "view", parts.of_views(), space=context.space_data)
        except (core.Missing, ValueError, RuntimeError) as error:
            log.replace("view", [str(error)])

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        if self.view_filter != scene.filter_of(context.space_data):  # of which no update tells
            self.view_update(context, depsgraph)
        if self.view_frame is None:
            return
        try:
            rendered.draw_rendered(context, depsgraph, self.view_frame)
        except Exception as error:  # anything raised here would come back with every redraw
            self.view_frame = None
            log.replace("view", [f"The view cannot be drawn: {type(error).__name__}: {error}"])

    def go_on(self, done: float) -> bool:
        self.update_progress(done)
        return not self.test_break()


def image_size(render: Any) -> tuple[int, int]:
    """Pixels of the whole picture."""
    width, height = (side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))
    return max(1, width), max(1, height)


def camera_of(settings: Any, depsgraph: Any) -> NDArray[np.float64] | None:
    """World to clip space for the scene's camera, or None without one."""
    if settings.camera is None:
        return None
    camera = settings.camera.evaluated_get(depsgraph)
    width, height = image_size(settings.render)
    aspect = settings.render.pixel_aspect_x, settings.render.pixel_aspect_y
    projection = camera.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=aspect[0], scale_y=aspect[1])
    view = camera.matrix_world.normalized().inverted()
    return np.array(projection, dtype=np.float64) @ np.array(view, dtype=np.float64)


def border_of(render: Any, size: tuple[int, int]) -> tuple[NDArray[np.float64], tuple[int, int]]:
    """The render region: a zoom of clip space onto it, and its size in pixels. Blender puts a result that begins at
    (0, 0) into the region by itself, cropped or not."""
    window = np.eye(4)
    if not render.use_border:
        return window, size
    extent = []
    for axis, (pixels, first, last) in enumerate(
        zip(size, (render.border_min_x, render.border_min_y), (render.border_max_x, render.border_max_y))
    ):
        # In single precision, as Blender counts them: a pixel more or less would shear the picture.
        low = min(int(np.float32(first) * np.float32(pixels)), pixels - 1)
        high = max(int(np.float32(last) * np.float32(pixels)), low + 1)
        window[axis, axis] = pixels / (high - low)
        window[axis, 3] = window[axis, axis] * (1.0 - (low + high) / pixels)
        extent.append(high - low)
    return window, (extent[0], extent[1])
