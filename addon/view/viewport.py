# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke in the 3D viewport: the Rendered view of our engine, and smoke over Blender's own Solid and Material views.

`gpu` is imported inside functions only: there may be no GPU at all (`blender -b`).

Both views are made the same way. One pass marches the smoke into a picture of its own, which is kept until the camera,
the size or the frame changes; handing it to Blender is then a copy. At rest it is made once more, of surfaces that are
sampled as finely as F12's (refinement.py). Blender's viewport is scene-linear until its very
end, where Blender applies the scene's view transform, so nothing here knows about colour management: `view_draw` draws
into that target anyway, and the overlay fetches it in PRE_VIEW, where it is bound, to draw into it in POST_VIEW, when
Blender's picture is there. (The target bound in POST_VIEW is the one for lines and text, which is not view-transformed.)
"""

from __future__ import annotations

import contextlib
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent

from .. import core, log, props
from ..export import parts, scene
from ..export.scene import MOST_LIGHTS, MOST_MEDIA
from ..gpu.shader import BRICK, Shaders, compile_shader, plain_state, shader_text, texture
from . import refinement

SHADING_TYPES = ("SOLID", "MATERIAL")  # where the overlay draws

# The share of its light that a surface is taken to have from the lights, in views that are not lit by them alone.
SHADOW_STRENGTH = 0.8

# The optical depth at which a march stops: what lies behind adds less than 1e-5 of its radiance.
OPAQUE_DEPTH = 12.0

# smoke_textures.glsl
MEDIUM_TEXTURES = ("density", "light", "clearance")

PICTURES_KEPT = 8  # a quad view has four


# Shaders ------------------------------------------------------------------------------------------------------------


def _smoke_shader(colours: int, media: int, overlay: bool) -> Any:
    def declare(info: Any) -> None:
        info.define("COLOURS", str(colours))
        info.define("MEDIA", str(media))
        info.define("OPAQUE_DEPTH", f"{OPAQUE_DEPTH:.1f}f")
        if overlay:
            info.define("OVERLAY", "1")
            info.fragment_out(1, "VEC4", "transmittance")
        info.fragment_out(0, "VEC4", "radiance")
        info.typedef_source(shader_text("viewport/smoke_uniforms.glsl"))
        info.uniform_buf(0, "SmokeView", "view")
        info.sampler(0, "FLOAT_2D", "surfaces")
        for medium in range(media):
            for slot, name in enumerate(MEDIUM_TEXTURES):
                info.sampler(1 + len(MEDIUM_TEXTURES) * medium + slot, "FLOAT_3D", f"{name}_{medium}")

    files = ["camera.glsl", "rays/opacity.glsl", "media/phase.glsl", "lights/light.glsl", "media/medium.glsl"]
    textures = shader_text("viewport/smoke_textures.glsl")
    accessors = [textures.replace("NUMBER", str(medium)) for medium in range(media)]
    accessors += [_by_medium(*function, media) for function in MEDIUM_FUNCTIONS]
    name = f"{colours} colours, {media} media{', overlay' if overlay else ''}"
    return compile_shader(name, declare, files + ["viewport/smoke_fragment.glsl"], generated="".join(accessors))


# The functions of smoke_textures.glsl.
MEDIUM_FUNCTIONS = (
    ("float", "clearance_at", "ivec3 brick", "brick"),
    ("float", "density_at", "vec3 place", "place"),
    ("vec4", "light_at", "vec3 place, float light, float lights, float cells", "place, light, lights, cells"),
)


def _by_medium(kind: str, name: str, parameters: str, arguments: str, media: int) -> str:
    """A GLSL function that hands a call on to that of the medium whose number comes first."""
    cases = [f"if (medium == {m}) {{ return {name}_{m}({arguments}); }}" for m in range(1, media)]
    return f"{kind} {name}(int medium, {parameters})\n{{ {' '.join(cases)} return {name}_0({arguments}); }}\n"


def _composite_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("FLOAT", "least_alpha")
        info.sampler(0, "FLOAT_2D", "picture")
        info.fragment_out(0, "VEC4", "colour")

    return compile_shader("composite", declare, ["viewport/composite_fragment.glsl"])


def _background_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("VEC3", "background")
        info.sampler(0, "FLOAT_2D", "radiance")
        info.sampler(1, "FLOAT_2D", "transmittance")
        info.fragment_out(0, "VEC4", "colour")

    return compile_shader("background", declare, ["viewport/background_fragment.glsl"])


# Textures -----------------------------------------------------------------------------------------------------------


class _Smoke:
    """The smoke of one frame on the GPU, and what the shader needs to know of it."""

    def __init__(self, frame: Any) -> None:
        self.frame = frame  # kept: its identity is the key
        media = frame.media[:MOST_MEDIA]
        lights = np.asarray(frame.lights)[:MOST_LIGHTS]
        self.lights = len(lights)
        self.textures: dict[str, Any] = {}
        self.colours = 3 if any(np.ptp(medium.extinction) > 0.0 for medium in frame.media) else 1
        self.media = max(1, len(media))
        self.uniforms = np.zeros((7 + 3 * MOST_LIGHTS + 6 * MOST_MEDIA, 4), np.float32)  # SmokeView
        self.uniforms[7 : 7 + 3 * self.lights] = lights.reshape(-1, 4)
        first = 7 + 3 * MOST_LIGHTS
        for number, medium in enumerate(media):
            rows = self.uniforms[first + 6 * number : first + 6 * number + 6]
            density, light = medium.density, medium.light[: self.lights]
            rows[:3] = np.linalg.inv(medium.grid_to_world)[:3]
            rows[3] = (*density.shape[::-1], 1.0 / BRICK)
            rows[4] = (*medium.extinction, frame.step_length)
            rows[5] = (*medium.scattering, medium.anisotropy)
            depth, height, width = density.shape
            self._add(number, texture((width, height, depth), "R", density), light, medium.clearance)
        if not media:
            # Where there is no smoke one empty cell stands in: the shader has one case less.
            self.uniforms[first : first + 6] = [
                (1, 0, 0, 0),
                (0, 1, 0, 0),
                (0, 0, 1, 0),
                (1, 1, 1, 1),
                (0, 0, 0, 1),
                (0,) * 4,
            ]
            nothing = np.zeros((1, 1, 1), np.float32)
            self._add(0, texture((1, 1, 1), "R", nothing), np.zeros((0, 1, 1, 1, 2), np.float32), nothing)

    def _add(self, number: int, density: Any, light: np.ndarray, clearance: np.ndarray) -> None:
        _, depth, height, width, channels = light.shape
        if not len(light):
            light = np.zeros((1, depth, height, width, channels), np.float32)
        size = (width, height, depth * light.shape[0])
        self.textures[f"density_{number}"] = density
        self.textures[f"light_{number}"] = texture(size, "RG" if channels == 2 else "RGBA", light)
        self.textures[f"clearance_{number}"] = texture(clearance.shape[::-1], "R", clearance)

    def uniform_buffer(self, corners: np.ndarray, look: Look) -> Any:
        import gpu

        uniforms = self.uniforms.copy()
        uniforms[:6, :3] = corners
        uniforms[6] = (*look.size, self.lights, SHADOW_STRENGTH)
        return gpu.types.GPUUniformBuf(gpu.types.Buffer("FLOAT", uniforms.size, uniforms.ravel()))


# Pictures -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Look:
    """How a frame is looked at. A picture is good until this changes."""

    matrix: tuple[float, ...]  # world -> NDC, row by row
    size: tuple[int, int]  # pixels
    overlay: bool = False  # over Blender's picture, or by ourselves
    solids_shade: bool = False  # whether that picture shows the shadows of solids; else an overlay adds those too

    @property
    def output(self) -> str:
        """What is asked of Frame.surfaces."""
        if not self.overlay:
            return "radiance"
        return "smoke_shadow" if self.solids_shade else "all_shadows"

    def camera(self) -> Any:
        return core.module().Camera(np.reshape(self.matrix, (4, 4)))


@dataclass(frozen=True)
class Picture:
    """What the smoke pass made: radiance, and in an overlay the transmittance for what lies behind."""

    frame: Any
    look: Look
    refined: bool  # made of surfaces that are sampled as F12's
    radiance: Any
    transmittance: Any | None
    buffer: Any


class Painter:
    """Owns every GPU object of the add-on. Dropping it frees them."""

    def __init__(self) -> None:
        self._shaders = Shaders()
        self._smoke: dict[bool, _Smoke] = {}  # the overlay's, and the Rendered view's: their frames differ
        self._pictures: OrderedDict[Any, Picture] = OrderedDict()

    def picture(self, view: Any, frame: Any, look: Look, refined: Any = None) -> Picture:
        """The smoke of `frame`. `view` is any name: the picture is kept under it until something else is asked of it,
        or there are `refined` surfaces to make it of."""
        kept = self._pictures.pop(view, None)
        if refined is not None or kept is None or kept.look != look or kept.frame is not frame:
            kept = self._make_picture(frame, look, refined)
        self._pictures[view] = kept
        while len(self._pictures) > PICTURES_KEPT:
            self._pictures.popitem(last=False)
        return kept

    def _make_picture(self, frame: Any, look: Look, refined: Any) -> Picture:
        import gpu

        smoke = self._smoke.get(look.overlay)
        if smoke is None or smoke.frame is not frame:
            self._smoke.pop(look.overlay, None)  # free first: two large volumes may not fit
            smoke = self._smoke[look.overlay] = _Smoke(frame)
        variant = (smoke.colours, smoke.media, look.overlay)
        shader = self._shaders.get(variant, lambda: _smoke_shader(*variant))

        camera = look.camera()
        traced = frame.surfaces(camera, *look.size, output=look.output) if refined is None else refined
        surfaces = texture(look.size, "RGBA", traced)
        targets = [gpu.types.GPUTexture(look.size, format="RGBA16F") for _ in range(2 if look.overlay else 1)]
        buffer = gpu.types.GPUFrameBuffer(color_slots=targets)
        uniforms = smoke.uniform_buffer(camera.corners, look)
        with plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_block("view", uniforms)
            shader.uniform_sampler("surfaces", surfaces)
            for name, held in smoke.textures.items():
                shader.uniform_sampler(name, held)
            self._shaders.draw_screen(shader)
        return Picture(frame, look, refined is not None, targets[0], targets[1] if look.overlay else None, buffer)

    def composite(self, picture: Any, blend: str, gain: float, least_alpha: float) -> None:
        """Draw a texture of the target's size over what the bound target holds."""
        import gpu

        shader = self._shaders.get("composite", _composite_shader)
        with plain_state():
            gpu.state.blend_set(blend)
            shader.bind()
            shader.uniform_sampler("picture", picture)
            shader.uniform_float("gain", gain)
            shader.uniform_float("least_alpha", least_alpha)
            self._shaders.draw_screen(shader)

    def dim_background(self, picture: Picture, gain: float, background: tuple[float, float, float]) -> None:
        """Multiply the bound target, that of Blender's overlays, by what the smoke leaves of the background."""
        import gpu

        shader = self._shaders.get("background", _background_shader)
        with plain_state():
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


def _picture(context: bpy.types.Context, frame: Any, look: Look) -> Picture:
    """The smoke of the view that is being drawn: at once, and refined in a later redraw unless something changes."""
    view = context.region.as_pointer()
    picture = painter().picture(view, frame, look, refinement.take(view, (frame, look)))
    if not picture.refined:
        samples = props.QUALITIES[props.of(context.scene).quality].edge_samples
        trace = partial(frame.surfaces, look.camera(), *look.size, look.output, samples)
        refinement.ask(view, (frame, look), trace)
    return picture


# The Rendered view --------------------------------------------------------------------------------------------------


def draw_rendered(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph, frame: Any) -> None:
    """Draw `frame`, a sfumato.Frame, as RenderEngine.view_draw should: scene-linear, Blender transforms it afterwards."""
    picture = _picture(context, frame, _look(context))
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
            if frame is None or not frame.media:
                return
            shading = context.space_data.shading
            scene_lights = shading.type == "MATERIAL" and shading.use_scene_lights
            # Blender applies the exposure only in views that are lit by the scene. Our smoke always is.
            exposure = 2.0**context.scene.view_settings.exposure
            exposed = scene_lights or (shading.type == "MATERIAL" and shading.use_scene_world)
            look = _look(context, overlay=True, solids_shade=scene_lights)
            picture = _picture(context, frame, look)
            with target.bind():
                painter().composite(picture.transmittance, "MULTIPLY", 1.0, 1.0)
                painter().composite(picture.radiance, "ADDITIVE_PREMULT", 1.0 if exposed else exposure, 0.0)
            painter().dim_background(picture, exposure, _background(context))

    def _current_frame(self, context: bpy.types.Context) -> Any:
        key = (context.scene.as_pointer(), context.view_layer.name, props.of(context.scene).quality)
        if self.dirty or key != self._frame_key:
            self.dirty, self._frame_key, self._frame = False, key, None  # a failure waits for the next change
            self._frame = scene.frame_of(context.evaluated_depsgraph_get(), "viewport", parts.of_views())
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
    parts.note(depsgraph)
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
    global _painter
    refinement.stop()
    _painter = None
