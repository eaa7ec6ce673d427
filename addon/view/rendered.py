# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of the view that is being drawn, and the Rendered view, which shows nothing else.

Blender's viewport is scene-linear until its very end, where Blender applies the scene's view transform, so nothing here
knows about colour management.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy
import numpy as np

from .. import log, props
from ..export import exposure
from . import refinement
from .painter import Look, Picture, glance, painter


def look_of(context: bpy.types.Context, frame: Any, **kind: Any) -> Look:
    """The view that is being drawn, from the frame's own space. Blender has its place in single precision only: 100 km from
    the origin it is 8 mm off."""
    region, origin = context.region_data, frame.origin
    matrix = np.array(region.perspective_matrix, dtype=np.float64)
    if origin.any():
        view = np.array(region.view_matrix, dtype=np.float64)
        view[:3, 3] += view[:3, :3] @ origin
        matrix = np.array(region.window_matrix, dtype=np.float64) @ view
    size = context.region.width, context.region.height
    return Look(tuple(matrix.ravel().tolist()), size, sorting=props.of(context.scene).sorting, **kind)


def picture_of(context: bpy.types.Context, frame: Any, look: Look) -> Picture:
    """The smoke of the view that is being drawn: at once, and refined in a later redraw unless something changes."""
    view = context.region.as_pointer()
    picture = painter().picture(view, frame, look, refinement.take(view, (frame, look)))
    log.took(frame.stages)
    if not picture.refined:
        samples = props.QUALITIES[props.of(context.scene).quality].edge_samples
        if look.by_processor(frame) and look.overlay:
            trace = partial(_every_pixel, frame, look)
        elif look.lens or look.by_processor(frame):
            trace = partial(frame.render, look.exposure(), *look.size, samples)
        else:
            trace = partial(frame.surfaces, look.camera(), *look.size, look.output, samples)
        refinement.ask(view, (frame, look), trace)
    return picture


def _every_pixel(frame: Any, look: Look, _progress: refinement.Progress) -> Any:
    """Of an overlay that the processor makes: what is soft needs no more."""
    return glance(frame, look, 1)


def draw_rendered(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph, frame: Any) -> None:
    """Draw `frame`, a sfumato.Frame, as RenderEngine.view_draw should: scene-linear, Blender transforms it afterwards."""
    picture = picture_of(context, frame, look_of(context, frame, lens=lens_of(context, depsgraph)))
    transparent = depsgraph.scene_eval.render.film_transparent
    # An opaque picture needs nothing of what was there.
    blend, least_alpha = ("ALPHA_PREMULT", 0.0) if transparent else ("NONE", 1.0)
    painter().composite(picture.radiance, blend, 1.0, least_alpha, render_region(context))


def lens_of(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[tuple[str, Any], ...]:
    """Of the camera that the view looks through, as Look has it."""
    if context.region_data.view_perspective != "CAMERA":
        return ()
    space = context.space_data
    camera = space.camera if space.use_local_camera else context.scene.camera
    if camera is None or camera.type != "CAMERA":
        return ()
    return tuple(exposure.lens_of(camera.evaluated_get(depsgraph)).items())


def render_region(context: bpy.types.Context) -> tuple[int, int, int, int] | None:
    """The pixels of the view to which its render region limits it: left, bottom, width, height; None without one. Seen
    through the camera it is the scene's, in the camera's frame, else the view's own."""
    space, render = context.space_data, context.scene.render
    width, height = context.region.width, context.region.height
    if context.region_data.view_perspective != "CAMERA":
        if not space.use_render_border:
            return None
        low, high = np.zeros(2), np.array((width, height), dtype=np.float64)
        border, names = space, ("render_border_min_", "render_border_max_")
    else:
        camera = space.camera if space.use_local_camera else context.scene.camera
        if not render.use_border or camera is None:
            return None
        frame = np.ones((4, 4))
        frame[:, :3] = camera.data.view_frame(scene=context.scene)
        matrix = np.array(context.region_data.perspective_matrix) @ np.array(camera.matrix_world.normalized())
        seen = frame @ matrix.T
        corners = (seen[:, :2] / seen[:, 3:] * 0.5 + 0.5) * (width, height)
        low, high = corners.min(axis=0), corners.max(axis=0)
        border, names = render, ("border_min_", "border_max_")
    first, last = (low + (high - low) * [getattr(border, name + axis) for axis in "xy"] for name in names)
    left, bottom = (max(int(round(value)), 0) for value in first)
    right, top = (min(int(round(value)), most) for value, most in zip(last, (width, height)))
    return left, bottom, max(right - left, 0), max(top - bottom, 0)
