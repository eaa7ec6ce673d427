# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke in the 3D viewport: the Rendered view of our engine, and smoke over Blender's own Solid and Material views.

The files viewport*.py are the only ones that import `gpu`, and only inside functions: there may be no GPU at all
(`blender -b`).

Both views are made the same way. One pass marches the smoke into a picture of its own, which is kept until the camera,
the size or the frame changes; handing it to Blender is then a copy. Blender's viewport is scene-linear until its very
end, where Blender applies the scene's view transform, so nothing here knows about colour management: `view_draw` draws
into that target anyway, and the overlay fetches it in PRE_VIEW, where it is bound, to draw into it in POST_VIEW, when
Blender's picture is there. (The target bound in POST_VIEW is the one for lines and text, which is not view-transformed.)
"""

from __future__ import annotations

import contextlib
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import core, log, props, scene
from .viewport_gpu import BRICK, Shaders
from .viewport_gpu import compile_shader as _compile
from .viewport_gpu import plain_state as _plain_state
from .viewport_gpu import shader_text as _shader_text
from .viewport_gpu import texture as _texture

SHADING_TYPES = ("SOLID", "MATERIAL")  # where the overlay draws

# The share of its light that a surface is taken to have from the sun, in views that are not lit by the sun alone.
SHADOW_STRENGTH = 0.8

# The optical depth at which a march stops: what lies behind adds less than 1e-5 of its radiance.
OPAQUE_DEPTH = 12.0

PICTURES_KEPT = 8  # a quad view has four


# Shaders ------------------------------------------------------------------------------------------------------------


def _smoke_shader(colours: int, overlay: bool) -> Any:
    def declare(info: Any) -> None:
        info.define("COLOURS", str(colours))
        info.define("OPAQUE_DEPTH", f"{OPAQUE_DEPTH:.1f}f")
        if overlay:
            info.define("OVERLAY", "1")
            info.fragment_out(1, "VEC4", "transmittance")
        info.fragment_out(0, "VEC4", "radiance")
        info.typedef_source(_shader_text("viewport/smoke_uniforms.glsl"))
        info.uniform_buf(0, "SmokeView", "view")
        info.sampler(0, "FLOAT_2D", "surfaces")
        info.sampler(1, "FLOAT_3D", "lit_volume")
        info.sampler(2, "FLOAT_3D", "clearance")
        info.sampler(3, "FLOAT_2D_ARRAY", "light_map")

    shared = ["camera.glsl", "opacity.glsl", "phase.glsl", "medium.glsl"]
    return _compile(
        f"{colours} colours{', overlay' if overlay else ''}", declare, shared + ["viewport/smoke_fragment.glsl"]
    )


def _composite_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("FLOAT", "least_alpha")
        info.sampler(0, "FLOAT_2D", "picture")
        info.fragment_out(0, "VEC4", "colour")

    return _compile("composite", declare, ["viewport/composite_fragment.glsl"])


def _background_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("VEC3", "background")
        info.sampler(0, "FLOAT_2D", "radiance")
        info.sampler(1, "FLOAT_2D", "transmittance")
        info.fragment_out(0, "VEC4", "colour")

    return _compile("background", declare, ["viewport/background_fragment.glsl"])


# Textures -----------------------------------------------------------------------------------------------------------


def light_map_layers(light_map: np.ndarray) -> np.ndarray:
    """(h, w, 1+2m) coefficients a0, a1, b1, ... as (layers, h, w, 4): a_2j, b_2j, a_2j+1, b_2j+1, with b_0 = 0."""
    height, width, coefficients = light_map.shape
    layers = (coefficients + 1 + 3) // 4
    pairs = np.zeros((height, width, 4 * layers), np.float32)
    pairs[..., 0] = light_map[..., 0]
    pairs[..., 2 : coefficients + 1] = light_map[..., 1:]
    return np.ascontiguousarray(pairs.reshape(height, width, layers, 4).transpose(2, 0, 1, 3))


class _Smoke:
    """The smoke of one frame on the GPU, and what the shader needs to know of it."""

    def __init__(self, frame: Any) -> None:
        self.frame = frame  # kept: its identity is the key
        # Where there is no smoke, or no light on it, one empty cell stands in: the shader has one case less.
        volume, clearance = np.zeros((1, 1, 1, 2), np.float32), np.zeros((1, 1, 1), np.float32)
        light_map = np.zeros((1, 1, 1), np.float32)
        uniforms = np.zeros((17, 4), np.float32)  # SmokeView; the rows that the camera decides stay empty
        uniforms[13, 3] = frame.step_length
        if frame.medium is not None:
            medium = frame.medium
            volume, clearance = medium.lit_volume, medium.clearance
            uniforms[6:9] = np.linalg.inv(medium.grid_to_world)[:3]
            uniforms[12] = (*medium.extinction, medium.anisotropy)
            if frame.light_map is not None:
                light_map = frame.light_map.coefficients
                direction, irradiance, _angle = frame.sun
                uniforms[9:12] = frame.light_map.world_to_map[:3]
                uniforms[13, :3] = irradiance * medium.albedo
                uniforms[14] = (*direction, SHADOW_STRENGTH)
        nz, ny, nx, channels = volume.shape
        uniforms[15] = (nx, ny, nz, 1.0 / BRICK)
        uniforms[16, 2] = (light_map.shape[2] - 1) // 2
        self.uniforms = uniforms
        self.colours = 1 if frame.medium is None or np.ptp(frame.medium.extinction) == 0.0 else 3
        if channels == 3:  # there are no textures of three floats; two leave the third channel zero
            volume = np.concatenate((volume, np.zeros((nz, ny, nx, 1), np.float32)), axis=-1)
        self.lit_volume = _texture((nx, ny, nz), "RG" if channels == 2 else "RGBA", volume)
        self.clearance = _texture(clearance.shape[::-1], "R", clearance)
        layers = light_map_layers(light_map)
        self.light_map = _texture(layers.shape[2:0:-1], "RGBA", layers, layers=layers.shape[0])

    def uniform_buffer(self, corners: np.ndarray, look: Look) -> Any:
        import gpu

        uniforms = self.uniforms.copy()
        uniforms[:6, :3] = corners
        uniforms[16, [0, 1, 3]] = (*look.size, look.solids_shade)
        return gpu.types.GPUUniformBuf(gpu.types.Buffer("FLOAT", uniforms.size, uniforms.ravel()))


# Pictures -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Look:
    """How a frame is looked at. A picture is good until this changes."""

    matrix: tuple[float, ...]  # world -> NDC, row by row
    size: tuple[int, int]  # pixels
    overlay: bool = False  # over Blender's picture, or by ourselves
    solids_shade: bool = False  # whether that picture shows the shadows of solids; else an overlay adds those too


@dataclass(frozen=True)
class Picture:
    """What the smoke pass made: radiance, and in an overlay the transmittance for what lies behind."""

    frame: Any
    look: Look
    radiance: Any
    transmittance: Any | None
    buffer: Any


class Painter:
    """Owns every GPU object of the add-on. Dropping it frees them."""

    def __init__(self) -> None:
        self._shaders = Shaders()
        self._smoke: dict[bool, _Smoke] = {}  # the overlay's, and the Rendered view's: their frames differ
        self._pictures: OrderedDict[Any, Picture] = OrderedDict()

    def picture(self, view: Any, frame: Any, look: Look) -> Picture:
        """The smoke of `frame`. `view` is any name: the picture is kept under it until something else is asked of it."""
        kept = self._pictures.pop(view, None)
        if kept is None or kept.look != look or kept.frame is not frame:
            kept = self._make_picture(frame, look)
        self._pictures[view] = kept
        while len(self._pictures) > PICTURES_KEPT:
            self._pictures.popitem(last=False)
        return kept

    def _make_picture(self, frame: Any, look: Look) -> Picture:
        import gpu

        smoke = self._smoke.get(look.overlay)
        if smoke is None or smoke.frame is not frame:
            self._smoke.pop(look.overlay, None)  # free first: two large volumes may not fit
            smoke = self._smoke[look.overlay] = _Smoke(frame)
        colours = smoke.colours
        shader = self._shaders.get((colours, look.overlay), lambda: _smoke_shader(colours, look.overlay))

        camera = core.module().Camera(np.reshape(look.matrix, (4, 4)))
        surfaces = _texture(look.size, "RGBA", frame.surfaces(camera, *look.size, lit=not look.overlay))
        targets = [gpu.types.GPUTexture(look.size, format="RGBA16F") for _ in range(2 if look.overlay else 1)]
        buffer = gpu.types.GPUFrameBuffer(color_slots=targets)
        uniforms = smoke.uniform_buffer(camera.corners, look)
        with _plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_block("view", uniforms)
            shader.uniform_sampler("surfaces", surfaces)
            shader.uniform_sampler("lit_volume", smoke.lit_volume)
            shader.uniform_sampler("clearance", smoke.clearance)
            shader.uniform_sampler("light_map", smoke.light_map)
            self._shaders.draw_screen(shader)
        return Picture(frame, look, targets[0], targets[1] if look.overlay else None, buffer)

    def composite(self, texture: Any, blend: str, gain: float, least_alpha: float) -> None:
        """Draw a texture of the target's size over what the bound target holds."""
        import gpu

        shader = self._shaders.get("composite", _composite_shader)
        with _plain_state():
            gpu.state.blend_set(blend)
            shader.bind()
            shader.uniform_sampler("picture", texture)
            shader.uniform_float("gain", gain)
            shader.uniform_float("least_alpha", least_alpha)
            self._shaders.draw_screen(shader)

    def dim_background(self, picture: Picture, gain: float, background: tuple[float, float, float]) -> None:
        """Multiply the bound target, that of Blender's overlays, by what the smoke leaves of the background."""
        import gpu

        shader = self._shaders.get("background", _background_shader)
        with _plain_state():
            gpu.state.blend_set("MULTIPLY")
            shader.bind()
            shader.uniform_sampler("radiance", picture.radiance)
            shader.uniform_sampler("transmittance", picture.transmittance)
            shader.uniform_float("gain", gain)
            shader.uniform_float("background", background)
            self._shaders.draw_screen(shader)


_painter: Painter | None = None


def painter() -> Painter:
    global _painter
    if _painter is None:
        _painter = Painter()
    return _painter


def _look(context: bpy.types.Context, **kind: bool) -> Look:
    """The view that is being drawn."""
    matrix = tuple(value for row in context.region_data.perspective_matrix for value in row)
    return Look(matrix, (context.region.width, context.region.height), **kind)


# The Rendered view --------------------------------------------------------------------------------------------------


def draw_rendered(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph, frame: Any) -> None:
    """Draw `frame`, a sfumato.Frame, as RenderEngine.view_draw should: scene-linear, Blender transforms it afterwards."""
    picture = painter().picture(context.region.as_pointer(), frame, _look(context))
    transparent = depsgraph.scene_eval.render.film_transparent
    painter().composite(picture.radiance, "ALPHA_PREMULT", 1.0, 0.0 if transparent else 1.0)


# The overlay --------------------------------------------------------------------------------------------------------


class _Overlay:
    """The draw handlers, and the frame that they show. Holds nothing of Blender's beyond one redraw."""

    def __init__(self) -> None:
        self.dirty = True
        self._frame: Any = None
        self._frame_key: tuple[Any, ...] = ()
        self._target: Any = None
        add = bpy.types.SpaceView3D.draw_handler_add
        self._handles = [add(self._before, (), "WINDOW", "PRE_VIEW"), add(self._after, (), "WINDOW", "POST_VIEW")]

    def remove(self) -> None:
        for handle in self._handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
        self._handles.clear()

    def forget(self) -> None:
        self._frame, self._frame_key, self.dirty = None, (), True

    def _before(self) -> None:
        """PRE_VIEW: the scene-linear target of Blender's picture is bound."""
        self._target = None
        with self._reporting():
            context = bpy.context
            if props.of(context.scene).viewport_enabled and context.space_data.shading.type in SHADING_TYPES:
                import gpu

                self._target = gpu.state.active_framebuffer_get()

    def _after(self) -> None:
        """POST_VIEW: Blender's picture is in that target."""
        target, self._target = self._target, None
        if target is None:
            return
        with self._reporting():
            context = bpy.context
            frame = self._current_frame(context)
            if frame is None or frame.medium is None:
                return
            shading = context.space_data.shading
            scene_lights = shading.type == "MATERIAL" and shading.use_scene_lights
            # Blender applies the exposure only in views that are lit by the scene. Our smoke always is.
            exposure = 2.0**context.scene.view_settings.exposure
            exposed = scene_lights or (shading.type == "MATERIAL" and shading.use_scene_world)
            look = _look(context, overlay=True, solids_shade=scene_lights)
            picture = painter().picture(context.region.as_pointer(), frame, look)
            with target.bind():
                painter().composite(picture.transmittance, "MULTIPLY", 1.0, 1.0)
                painter().composite(picture.radiance, "ADDITIVE_PREMULT", 1.0 if exposed else exposure, 0.0)
            painter().dim_background(picture, exposure, _background(context))

    def _current_frame(self, context: bpy.types.Context) -> Any:
        key = (context.scene.as_pointer(), context.view_layer.name, props.of(context.scene).quality)
        if self.dirty or key != self._frame_key:
            self.dirty, self._frame_key, self._frame = False, key, None  # a failure waits for the next change
            self._frame = scene.frame_of(context.evaluated_depsgraph_get(), "viewport")
        return self._frame

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


_overlay: _Overlay | None = None


@persistent  # type: ignore[misc]
def _on_update(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if _overlay is not None and any(_matters(update) for update in depsgraph.updates):
        _overlay.dirty = True


def _matters(update: bpy.types.DepsgraphUpdate) -> bool:
    """Selecting an object, for one, is an update that changes nothing that we draw."""
    changed = update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading
    return changed or not isinstance(update.id, (bpy.types.Object, bpy.types.Scene, bpy.types.Collection))


@persistent  # type: ignore[misc]
def _on_change(*_: Any) -> None:
    if _overlay is not None:
        _overlay.dirty = True


@persistent  # type: ignore[misc]
def _on_load(*_: Any) -> None:
    if _overlay is not None:
        _overlay.forget()
    log.clear()
    free()


_HANDLERS: dict[str, Callable[..., None]] = {
    "depsgraph_update_post": _on_update,
    "frame_change_post": _on_change,
    "undo_post": _on_change,
    "redo_post": _on_change,
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
    free()


def free() -> None:
    """Free every GPU object. What is drawn next makes its own again."""
    global _painter
    _painter = None
