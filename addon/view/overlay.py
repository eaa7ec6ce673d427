# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke over Blender's own Solid and Material Preview views: the draw handlers, and the handlers that follow the scene.

Blender's viewport is scene-linear until its very end. `view_draw` of an engine draws into that target; the overlay
fetches it in PRE_VIEW, where it is bound, to draw into it in POST_VIEW, when Blender's picture is there. (The target
bound in POST_VIEW is the one for lines and text, which is not view-transformed.)
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import bpy
from bpy.app.handlers import persistent

from .. import log, props
from ..export import parts, scene
from ..gpu import passes
from . import own_smoke, refinement
from . import painter as painting
from .painter import painter
from .rendered import look_of, picture_of

SHADING_TYPES = ("SOLID", "MATERIAL")  # where the overlay draws


class _Overlay:
    """The draw handlers, and the frame that they show. Holds nothing of Blender's beyond one redraw."""

    def __init__(self) -> None:
        self.dirty = True
        self._frames: dict[tuple[Any, ...], Any] = {}  # of views that differ in what they show
        self._hidden: dict[tuple[int, str], set[str]] = {}  # of what Solid mode would draw, by scene and view layer
        self._target: Any = None
        add = bpy.types.SpaceView3D.draw_handler_add
        self._handles = [add(self._before, (), "WINDOW", "PRE_VIEW"), add(self._after, (), "WINDOW", "POST_VIEW")]

    def remove(self) -> None:
        for handle in self._handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
        self._handles.clear()
        for settings in bpy.data.scenes:
            for layer in settings.view_layers:
                if layer.depsgraph is not None and (hidden := self.hidden(settings, layer)):
                    own_smoke.hide(layer.depsgraph, set(), hidden)

    def forget(self) -> None:
        self._frames.clear()
        self._hidden.clear()
        self.dirty = True

    def hidden(self, settings: Any, layer: Any) -> set[str]:
        """Objects of a view layer whose smoke Solid mode must not draw."""
        return self._hidden.get((settings.as_pointer(), layer.name), set())

    def _before(self) -> None:
        """PRE_VIEW: the scene-linear target of Blender's picture is bound."""
        self._target = None
        with self._reporting():
            context = bpy.context
            if not props.of(context.scene).viewport_enabled:
                self._hide_own(context, set())
            elif context.space_data.shading.type in SHADING_TYPES:
                self._target = passes.active_framebuffer()

    def _after(self) -> None:
        """POST_VIEW: Blender's picture is in that target."""
        target, self._target = self._target, None
        if target is None:
            return
        with self._reporting():
            context = bpy.context
            frame = self._current_frame(context)
            if frame is None or not (frame.media or frame.particles or frame.air):
                return
            shading = context.space_data.shading
            scene_lights = shading.type == "MATERIAL" and shading.use_scene_lights
            # Blender applies the exposure only in views that are lit by the scene. Our smoke always is.
            exposure = 2.0**context.scene.view_settings.exposure
            exposed = scene_lights or (shading.type == "MATERIAL" and shading.use_scene_world)
            look = look_of(context, frame, overlay=True, solids_shade=scene_lights)
            picture = picture_of(context, frame, look)
            with target.bind():
                painter().composite(picture.transmittance, "MULTIPLY", 1.0, 1.0)
                painter().composite(picture.radiance, "ADDITIVE_PREMULT", 1.0 if exposed else exposure, 0.0)
            painter().dim_background(picture, exposure, _background(context))

    def _current_frame(self, context: bpy.types.Context) -> Any:
        anew, self.dirty = self.dirty, False
        if anew:
            self._frames.clear()
        space, quality = context.space_data, props.of(context.scene).quality
        shading = space.shading.type, space.shading.use_scene_world  # of which no update tells
        key = (context.scene.as_pointer(), context.view_layer.name, quality, shading, *scene.filter_of(space))
        if key not in self._frames:
            self._frames[key] = None  # a failure waits for the next change
            drawn = set() if anew else self.hidden(context.scene, context.view_layer)
            try:
                out = scene.export(context.evaluated_depsgraph_get(), parts.of_views(), space, True)
                log.replace("viewport", out.notices)
                self._frames[key] = scene.made_of(out, context.scene, parts.of_views(), "viewport")
                drawn = drawn | out.drawn
            finally:
                self._hide_own(context, drawn)
        return self._frames[key]

    def _hide_own(self, context: bpy.types.Context, names: set[str]) -> None:
        """Let Solid mode draw the smoke of all objects but these; what that changes is seen at the next redraw."""
        before = self.hidden(context.scene, context.view_layer)
        if not names and not before:
            return
        self._hidden[context.scene.as_pointer(), context.view_layer.name] = names
        if own_smoke.hide(context.evaluated_depsgraph_get(), names, before):
            # What is tagged while a view is being drawn is forgotten.
            bpy.app.timers.register(_redraw)

    @contextlib.contextmanager
    def _reporting(self) -> Iterator[None]:
        """An exception in a draw callback would come back with every redraw: say it once, in the panel."""
        try:
            yield
        except Exception as error:  # whatever it is, Blender must go on drawing
            log.replace("viewport", [f"The overlay cannot be drawn: {error or type(error).__name__}"])


def _background(context: bpy.types.Context) -> tuple[float, float, float]:
    """The viewport's background, linear; of a gradient its upper end."""
    shading = context.space_data.shading
    if shading.background_type == "VIEWPORT":
        red, green, blue = shading.background_color
    elif shading.background_type == "WORLD" and context.scene.world is not None:
        red, green, blue = context.scene.world.color
    else:
        theme = context.preferences.themes[0].view_3d.space.gradients.high_gradient
        red, green, blue = theme.from_srgb_to_scene_linear()
    return red, green, blue


def _redraw() -> None:
    """A timer's: every 3D view."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


_overlay: _Overlay | None = None


@persistent  # type: ignore[misc]
def _on_update(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    parts.note(depsgraph)
    if _overlay is not None:
        own_smoke.hide_again(depsgraph, _overlay.hidden(depsgraph.scene, depsgraph.view_layer))
    if _overlay is not None and any(_matters(update) for update in depsgraph.updates):
        _overlay.dirty = True


def _matters(update: bpy.types.DepsgraphUpdate) -> bool:
    """Selecting an object, for one, is an update that changes nothing that we draw."""
    changed = update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading
    return changed or not isinstance(update.id, (bpy.types.Object, bpy.types.Scene, bpy.types.Collection))


@persistent  # type: ignore[misc]
def _on_frame(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    parts.note(depsgraph)
    if _overlay is not None:
        own_smoke.hide_again(depsgraph, _overlay.hidden(depsgraph.scene, depsgraph.view_layer))
        _overlay.dirty = True


@persistent  # type: ignore[misc]
def _on_undo(*_: Any) -> None:
    parts.forget_owners()
    if _overlay is not None:
        _overlay.dirty = True


@persistent  # type: ignore[misc]
def _on_load(*_: Any) -> None:
    parts.free()
    if _overlay is not None:
        _overlay.forget()
    log.clear()
    free()


_HANDLERS: dict[str, Callable[..., None]] = {
    "depsgraph_update_post": _on_update,
    "frame_change_post": _on_frame,
    "undo_post": _on_undo,
    "redo_post": _on_undo,
    "load_post": _on_load,
}


def enable() -> None:
    """Add the overlay to every 3D viewport. It shows where scene.sfumato.viewport_enabled is set."""
    global _overlay
    if _overlay is not None:
        return
    _overlay = _Overlay()
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def disable() -> None:
    """Take everything back, and free what is on the GPU."""
    global _overlay
    for name, handler in _HANDLERS.items():
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
    if _overlay is not None:
        _overlay.remove()
        _overlay = None
    parts.free()
    free()


def free() -> None:
    """Free every GPU object, and stop what would make more. What is drawn next makes its own again."""
    refinement.stop()
    painting.free()
