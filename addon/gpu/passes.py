# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view is drawn with: targets that stay while their size does, and the passes over the whole of one."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from .shader import Shaders, compile_shader, plain_state
from .smoke import Smoke, smoke_shader

# Of Mesa and of Windows: there the processor does the work of the GPU.
SOFTWARE = ("llvmpipe", "softpipe", "swrast", "lavapipe", "swiftshader", "gdi generic", "basic render")


def is_software() -> bool:
    """Whether what draws is a software rasteriser."""
    import gpu

    renderer = gpu.platform.renderer_get().lower()
    return any(name in renderer for name in SOFTWARE)


def active_framebuffer() -> Any:
    import gpu

    return gpu.state.active_framebuffer_get()


class Target:
    """The pictures that the smoke pass makes for one view, and the numbers that it makes them of."""

    def __init__(self, size: tuple[int, int], overlay: bool) -> None:
        import gpu

        self.size, self.overlay = size, overlay
        self.textures = [gpu.types.GPUTexture(size, format="RGBA16F") for _ in range(2 if overlay else 1)]
        self.buffer = gpu.types.GPUFrameBuffer(color_slots=self.textures)
        self._uniforms: Any = None
        self._floats = 0

    def uniforms(self, values: np.ndarray) -> Any:
        """The uniform buffer, with these floats in it."""
        import gpu

        data = gpu.types.Buffer("FLOAT", values.size, values.ravel())
        if self._uniforms is None or self._floats != values.size:
            self._uniforms, self._floats = gpu.types.GPUUniformBuf(data), values.size
        else:
            self._uniforms.update(data)
        return self._uniforms


def draw_smoke(shaders: Shaders, target: Target, smoke: Smoke, surfaces: Any, corners: np.ndarray) -> None:
    """March through `smoke` up to `surfaces`, a texture of the target's size (Frame.surfaces)."""
    variant = (smoke.colours, smoke.media, smoke.tinted, smoke.emitting, smoke.ramped, target.overlay)
    shader = shaders.get(variant, lambda: smoke_shader(*variant))
    uniforms = target.uniforms(smoke.view(corners, target.size))
    with plain_state(), target.buffer.bind():
        shader.bind()
        shader.uniform_block("view", uniforms)
        shader.uniform_sampler("surfaces", surfaces)
        for name, held in smoke.textures.items():
            shader.uniform_sampler(name, held)
        shaders.draw_screen(shader)


@contextlib.contextmanager
def _limited_to(window: tuple[int, int, int, int] | None) -> Iterator[None]:
    """Draw into a window of the target alone. What covers the screen covers just that then, and reads the picture at the
    same pixels; Blender 3.4 has no scissors."""
    import gpu

    if window is None:
        yield
        return
    before = gpu.state.viewport_get()
    gpu.state.viewport_set(*window)
    try:
        yield
    finally:
        gpu.state.viewport_set(*before)


def composite(
    shaders: Shaders,
    picture: Any,
    blend: str,
    gain: float,
    least_alpha: float,
    window: tuple[int, int, int, int] | None = None,
) -> None:
    """Draw a texture of the target's size over what the bound target holds, or over a window of it."""
    shader = shaders.get("composite", composite_shader)
    with _blended(blend), _limited_to(window):
        shader.bind()
        shader.uniform_sampler("picture", picture)
        shader.uniform_float("gain", gain)
        shader.uniform_float("least_alpha", least_alpha)
        shaders.draw_screen(shader)


def dim_background(
    shaders: Shaders, radiance: Any, transmittance: Any, gain: float, background: tuple[float, float, float]
) -> None:
    """Multiply the bound target, that of Blender's overlays, by what the smoke leaves of the background."""
    shader = shaders.get("background", background_shader)
    with _blended("MULTIPLY"):
        shader.bind()
        shader.uniform_sampler("radiance", radiance)
        shader.uniform_sampler("transmittance", transmittance)
        shader.uniform_float("gain", gain)
        shader.uniform_float("background", background)
        shaders.draw_screen(shader)


@contextlib.contextmanager
def _blended(mode: str) -> Iterator[None]:
    import gpu

    with plain_state():
        gpu.state.blend_set(mode)
        yield


def composite_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("FLOAT", "least_alpha")
        info.sampler(0, "FLOAT_2D", "picture")
        info.fragment_out(0, "VEC4", "colour")

    return compile_shader("composite", declare, ["viewport/composite_fragment.glsl"])


def background_shader() -> Any:
    def declare(info: Any) -> None:
        info.push_constant("FLOAT", "gain")
        info.push_constant("VEC3", "background")
        info.sampler(0, "FLOAT_2D", "radiance")
        info.sampler(1, "FLOAT_2D", "transmittance")
        info.fragment_out(0, "VEC4", "colour")

    return compile_shader("background", declare, ["viewport/background_fragment.glsl"])
