# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke pass: its shader, and the smoke of a frame as textures."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..limits import MOST_LIGHTS, MOST_MEDIA
from .shader import BRICK, compile_shader, shader_text, texture

# The share of its light that a surface is taken to have from the lights, in views that are not lit by them alone.
SHADOW_STRENGTH = 0.8

# smoke_textures.glsl
MEDIUM_TEXTURES = ("density", "light", "clearance")

EMISSION_ROWS = 128  # smoke_uniforms.glsl

# What media under transfer functions are marched by.
RAMP_FILES = ("media/preintegration.glsl", "media/ramp.glsl", "media/ramped_march.glsl")


def smoke_shader(colours: int, media: int, tinted: bool, emitting: bool, ramped: bool, overlay: bool) -> Any:
    def declare(info: Any) -> None:
        if ramped:
            info.define("RAMPED", "1")
            info.sampler(1 + len(MEDIUM_TEXTURES) * media, "FLOAT_2D", "ramps")
        if tinted:
            info.define("TINTED", "1")
        if emitting:
            info.define("EMITTING", "1")
        info.define("COLOURS", str(colours))
        info.define("MEDIA", str(media))
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

    files = [
        "camera.glsl",
        "lights/light.glsl",
        "media/phase.glsl",
        "media/medium.glsl",
        "viewport/smoke_media.glsl",
        "media/march.glsl",
        *(RAMP_FILES if ramped else ()),
        "viewport/smoke_fragment.glsl",
    ]
    textures = shader_text("viewport/smoke_textures.glsl")
    accessors = [textures.replace("NUMBER", str(medium)) for medium in range(media)]
    accessors += [_by_medium(*function, media) for function in MEDIUM_FUNCTIONS]
    if tinted:
        accessors.append(_by_medium("vec3", "tint_at", "vec3 place", "place", media))
    if emitting:
        accessors.append(_by_medium("float", "glow_at", "vec3 place", "place", media))
    flags = {"tinted": tinted, "emitting": emitting, "ramped": ramped, "overlay": overlay}
    name = ", ".join([f"{colours} colours, {media} media", *(flag for flag, is_on in flags.items() if is_on)])
    return compile_shader(name, declare, files, generated="".join(accessors))


# The functions of smoke_textures.glsl.
MEDIUM_FUNCTIONS = (
    ("float", "clearance_of_brick", "ivec3 brick", "brick"),
    ("float", "density_at", "vec3 place", "place"),
    ("vec4", "light_in_volume", "vec3 place, float light, float lights, float cells", "place, light, lights, cells"),
)


def _by_medium(kind: str, name: str, parameters: str, arguments: str, media: int) -> str:
    """A GLSL function that hands a call on to that of the medium whose number comes first."""
    cases = [f"if (medium == {m}) {{ return {name}_{m}({arguments}); }}" for m in range(1, media)]
    return f"{kind} {name}(int medium, {parameters})\n{{ {' '.join(cases)} return {name}_0({arguments}); }}\n"


def _glow_cells(glow: np.ndarray | None, cells: np.ndarray) -> np.ndarray:
    """What glows, as the texture of the densities has it."""
    out: np.ndarray = np.zeros_like(cells)
    if glow is not None:
        (out[..., 3] if cells.ndim == 4 else out)[...] = glow
    return out


class Smoke:
    """The smoke of one frame on the GPU, and what the shader needs to know of it."""

    def __init__(self, frame: Any) -> None:
        self.frame = frame  # kept: its identity is the key
        media = frame.media[:MOST_MEDIA]
        lights = np.asarray(frame.lights)[:MOST_LIGHTS]
        self.lights = len(lights)
        self.textures: dict[str, Any] = {}
        self.colours = 1 if frame.grey else 3
        self.media = max(1, len(media))
        tints = [medium.tint for medium in media]
        self.tinted = any(tint is not None for tint in tints)
        self.emitting = any(len(medium.emission) for medium in media)
        ramps = [medium.ramp for medium in media]
        self.ramped = any(map(len, ramps))
        first = 7 + 3 * MOST_LIGHTS
        rows_of_ramps = first + 6 * MOST_MEDIA
        rows_of_emission = rows_of_ramps + (MOST_MEDIA if self.ramped else 0)
        size = rows_of_emission + (EMISSION_ROWS * MOST_MEDIA if self.emitting else 0)
        self.uniforms = np.zeros((size, 4), np.float32)  # SmokeView
        self.uniforms[7 : 7 + 3 * self.lights] = lights.reshape(-1, 4)
        for number, (medium, tint) in enumerate(zip(media, tints)):
            rows = self.uniforms[first + 6 * number : first + 6 * number + 6]
            density, light = medium.density, medium.light[: self.lights]
            rows[:3] = np.linalg.inv(medium.grid_to_world)[:3]
            rows[3] = (*density.shape[::-1], 1.0 / BRICK)
            rows[4] = (*medium.extinction, frame.step_length)
            rows[5] = (*medium.scattering, medium.anisotropy)
            depth, height, width = density.shape
            cells = density
            if self.tinted:
                colour = density[..., None].repeat(3, axis=3) if tint is None else tint
                cells = np.concatenate((colour, density[..., None]), axis=3)
            if self.emitting:
                cells = np.concatenate((cells, _glow_cells(medium.glow, cells)))
                emission = medium.emission
                table = self.uniforms[rows_of_emission + EMISSION_ROWS * number :][: len(emission)]
                table[:, :3] = emission
                table[:1, 3] = len(emission) - 1
            shape = (width, height, len(cells))
            self._add(number, texture(shape, "RGBA" if self.tinted else "R", cells), light, medium.clearance)
        if self.ramped:
            self._add_ramps(ramps, rows_of_ramps)
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

    def _add_ramps(self, ramps: list[np.ndarray], first: int) -> None:
        """The parts of media under transfer functions: a row of texels each."""
        rows = np.zeros((len(ramps), max(ramp.shape[0] * ramp.shape[1] for ramp in ramps), 4), np.float32)
        for number, ramp in enumerate(ramps):
            rows[number, : ramp.shape[0] * ramp.shape[1], :3] = ramp.reshape(-1, 3)
            self.uniforms[first + number, 0] = len(ramp)  # 0: steps are not split
        self.textures["ramps"] = texture((rows.shape[1], rows.shape[0]), "RGBA", rows)

    def view(self, corners: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        """SmokeView for a camera, by sfumato.Camera.corners, and a picture of `size`."""
        uniforms = self.uniforms.copy()
        uniforms[:6, :3] = corners
        uniforms[6] = (*size, self.lights, SHADOW_STRENGTH)
        return uniforms
