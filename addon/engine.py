# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12, `blender -b -E SFUMATO`, and the Rendered viewport."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import compat, core, log, passes, props
from .export import exposure, materials, parts, scene
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

    def update_render_passes(self, scene: Any, renderlayer: Any) -> None:
        passes.register_passes(self, scene, renderlayer)

    def render(self, depsgraph: Any) -> None:
        settings = depsgraph.scene
        layer = depsgraph.view_layer
        if self.camera_override is None and settings.camera is None:
            self.report({"ERROR"}, "The scene has no camera: add one, or make one active")
            return
        shutter = exposure.shutter_of(depsgraph)
        now = settings.frame_current, settings.frame_subframe
        try:
            self.render_while_open(depsgraph, shutter)
        finally:
            if shutter is not None:
                self.frame_set(*now)

    def render_while_open(self, depsgraph: Any, shutter: exposure.Shutter | None) -> None:
        settings = depsgraph.scene
        layer = depsgraph.view_layer
        try:
            # A farm sees an error, and a status of 1, rather than a picture that lacks its smoke.
            whole = bpy.app.background and props.of(settings).missing_is_error
            cameras = self.cameras(settings)
            seen, motion = self.while_open(depsgraph, cameras, shutter)
            frame = scene.frame_of(
                depsgraph, "render", parts.of_render(settings), whole, camera=self.camera_override, motion=motion
            )
            log.replace("passes", passes.notices(layer))
            views: list[passes.Images] = []
            for view in self.get_result().views:
                self.active_view_set(view.name)
                images = self.images_of(frame, depsgraph, cameras[view.name], seen[view.name], shutter)
                if images is None:
                    return
                views.append(images)
        except (core.Missing, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return
        log.took(frame.stages)
        height, width = views[0]["Combined"].shape[:2]
        for each in passes.asked_for(layer):
            self.add_pass(each.name, len(each.channels), each.channels, layer=layer.name)
        result = self.begin_result(0, 0, width, height, layer=layer.name)
        compat.set_pixels(result.layers[0], views)
        self.end_result(result)
        written = self.get_result()
        for name, value in log.metadata(props.of(settings).quality).items():
            written.stamp_data_add_field(name, value)

    def cameras(self, settings: Any) -> dict[str, Any]:
        """By the views of the picture. In a strip of a scene, or for one of several views, it is another camera than the
        scene's; and at another time that may be another one, too."""
        found = {}
        for view in self.get_result().views:
            self.active_view_set(view.name)
            found[view.name] = self.camera_override or settings.camera
        return found

    def while_open(
        self, depsgraph: Any, cameras: dict[str, Any], shutter: exposure.Shutter | None
    ) -> tuple[dict[str, list[exposure.View]], exposure.Motion | None]:
        """Where cameras are while the shutter is open, by the views of the picture, and what else moves then. The scene is
        at the shutter's middle afterwards."""
        settings = depsgraph.scene
        window, _ = border_of(settings.render, image_size(settings.render))

        def views() -> dict[str, exposure.View]:
            found = {}
            for name, camera in cameras.items():
                self.active_view_set(name)
                now = camera.evaluated_get(depsgraph)
                projection = projection_of(now, self.camera_shift_x(now), settings.render, depsgraph)
                place = np.array(self.camera_model_matrix(now), dtype=np.float64)
                found[name] = exposure.View(place, window @ projection)
            return found

        if shutter is None:
            return {name: [view] for name, view in views().items()}, None
        count = max((exposure.steps_of(thing) for thing in depsgraph.objects), default=0)
        times = exposure.over_times(
            self.frame_set, shutter, max(count, 1), lambda: (views(), exposure.moment_of(depsgraph))
        )
        seen = {}
        for name, camera in cameras.items():
            all_views = [found[name] for found, _ in times]
            moves = exposure.steps_of(camera) > 0
            seen[name] = all_views if moves else all_views[len(times) // 2 : len(times) // 2 + 1]
        return seen, exposure.Motion([moment for _, moment in times]) if count > 0 else None

    def images_of(
        self, frame: Any, depsgraph: Any, camera: Any, views: list[exposure.View], shutter: exposure.Shutter | None
    ) -> passes.Images | None:
        """The pixels of all passes of one of the picture's views, or None where the artist stopped it."""
        settings = depsgraph.scene
        camera = camera.evaluated_get(depsgraph)
        _, extent = border_of(settings.render, image_size(settings.render))
        middle = views[len(views) // 2].place.copy()
        middle[:3, 3] -= frame.origin
        view = np.linalg.inv(middle)
        wanted = passes.asked_for(depsgraph.view_layer)
        images: passes.Images | None = frame.passes(
            exposure.of(views, exposure.lens_of(camera), frame.origin, shutter),
            *extent,
            list({each.image for each in wanted}),
            edge_samples=props.QUALITIES[props.of(settings).quality].edge_samples,
            progress=self.go_on,
            mist=passes.mist_of(materials.world_of(depsgraph)),
            least_alpha=depsgraph.view_layer.pass_alpha_threshold,
            **passes.eye_of(camera, view),
            **filter_of(settings),
        )
        if images is None:
            return None
        return passes.pixels_of(wanted, images, view, frame.origin)

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


def filter_of(scene: Any) -> dict[str, Any]:
    """Cycles' pixel filter; where there is no Cycles, its default shape and the width of Blender's own setting."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return {"filter_width": min(max(scene.render.filter_size, 0.01), 10.0)}
    return {"filter": cycles.pixel_filter_type.lower(), "filter_width": cycles.filter_width}


def projection_of(camera: Any, shift_x: float, render: Any, depsgraph: Any) -> NDArray[np.float64]:
    """A camera's space to clip space, where a stereo view shifts the picture by `shift_x` rather than by its own shift."""
    width, height = image_size(render)
    aspect = render.pixel_aspect_x, render.pixel_aspect_y
    matrix = camera.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=aspect[0], scale_y=aspect[1])
    projection = np.array(matrix, dtype=np.float64)
    sides = width * aspect[0], height * aspect[1]
    fits = {"HORIZONTAL": sides[0], "VERTICAL": sides[1]}.get(camera.data.sensor_fit, max(sides))
    # Shifts count in the side that the sensor fits, clip space in half the width.
    moved = 2.0 * (shift_x - camera.data.shift_x) * fits / sides[0]
    projection[0] -= moved * projection[3]
    return projection


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
