# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of the view that is being drawn, and the Rendered view, which shows nothing else.

Blender's viewport is scene-linear until its very end, where Blender applies the scene's view transform, so nothing here
knows about colour management.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy

from .. import log, props
from . import refinement
from .painter import Look, Picture, painter


def look_of(context: bpy.types.Context, **kind: bool) -> Look:
    """The view that is being drawn."""
    matrix = tuple(value for row in context.region_data.perspective_matrix for value in row)
    return Look(matrix, (context.region.width, context.region.height), **kind)


def picture_of(context: bpy.types.Context, frame: Any, look: Look) -> Picture:
    """The smoke of the view that is being drawn: at once, and refined in a later redraw unless something changes."""
    view = context.region.as_pointer()
    picture = painter().picture(view, frame, look, refinement.take(view, (frame, look)))
    log.took(frame.stages)
    if not picture.refined:
        samples = props.QUALITIES[props.of(context.scene).quality].edge_samples
        trace = partial(frame.surfaces, look.camera(), *look.size, look.output, samples)
        refinement.ask(view, (frame, look), trace)
    return picture


def draw_rendered(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph, frame: Any) -> None:
    """Draw `frame`, a sfumato.Frame, as RenderEngine.view_draw should: scene-linear, Blender transforms it afterwards."""
    picture = picture_of(context, frame, look_of(context))
    transparent = depsgraph.scene_eval.render.film_transparent
    # An opaque picture needs nothing of what was there.
    blend, least_alpha = ("ALPHA_PREMULT", 0.0) if transparent else ("NONE", 1.0)
    painter().composite(picture.radiance, blend, 1.0, least_alpha)
