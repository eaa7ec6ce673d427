# SPDX-License-Identifier: GPL-3.0-or-later
"""The text of area lights on the GPU, one light a pixel: for its test and for its cost. No drawing of the add-on uses it
yet, so what puts it together is here."""

from __future__ import annotations

import re
from typing import Any
from unittest import mock

import harness
import numpy as np
from sfumato.gpu import shader as gpu_shader

SHADERS = harness.ROOT / "shaders"


def with_needs(*names: str) -> list[str]:
    """Files of the text, each after the ones that it names under `needs`."""
    files = {path.stem: path for path in SHADERS.rglob("*.glsl")}
    order: list[str] = []

    def add(name: str) -> None:
        needs = re.search(r"^// needs: (.+)$", files[name].read_text(encoding="utf-8"), re.MULTILINE)
        for need in needs[1].split() if needs else []:
            add(need)
        file = files[name].relative_to(SHADERS).as_posix()
        if file not in order:
            order.append(file)

    for name in names:
        add(name)
    return order


FILES = with_needs("edge_integrals", "outline", "microfacet_lights")
NUMBERS = 20  # of a light, five texels: 12 of its shape, 3 of the view or the normal, 5 more

MAIN = """
void main()
{
  ivec3 place = ivec3(gl_FragCoord.xy, 0);
  vec4 n0 = texelFetch(numbers, place, 0), n1 = texelFetch(numbers, place + ivec3(0, 0, 1), 0);
  vec4 n2 = texelFetch(numbers, place + ivec3(0, 0, 2), 0), n3 = texelFetch(numbers, place + ivec3(0, 0, 3), 0);
  vec4 n4 = texelFetch(numbers, place + ivec3(0, 0, 4), 0);
  vec3 a = n0.xyz, b = vec3(n0.w, n1.xy), c = vec3(n1.zw, n2.x), d = n2.yzw, view = n3.xyz;
  vec2 alpha = vec2(n3.w, n4.x);
  vec3 axis = n4.yzw;
  vec4 sum = vec4(0.0f);
  for (int k = 0; k < repeats; ++k) {
    Reflection light;
    light.plain = 0.0f;
    light.fresnel = 0.0f;
    EVALUATE
    sum += vec4(light.plain, light.fresnel, 0.0f, 0.0f);
    a.x += 1e-3f; // so that no turn is like another
  }
  colour = sum;
}
"""


class Picture:
    """What lights are drawn to."""

    def __init__(self, width: int, height: int) -> None:
        import gpu

        self._size = width, height
        self._texture = gpu.types.GPUTexture(self._size, format="RGBA32F")  # the framebuffer does not keep it
        self.buffer = gpu.types.GPUFrameBuffer(color_slots=[self._texture])

    def read(self) -> np.ndarray:
        """(height, width, 4); waits for the GPU."""
        return self._read(*self._size)

    def read_one(self) -> np.ndarray:
        """One pixel of it: what waiting costs least with."""
        return self._read(1, 1)

    def _read(self, width: int, height: int) -> np.ndarray:
        import gpu

        out = np.empty((height, width, 4), np.float32)
        with self.buffer.bind():
            self.buffer.read_color(0, 0, width, height, 4, 0, "FLOAT", data=gpu.types.Buffer("FLOAT", out.shape, out))
        return out


class Lights:
    """Evaluates lights: numbers (height, width, NUMBERS), by a statement that sets `light` from a, b, c, d, view, alpha,
    axis, with functions of its own before it and textures that they read."""

    def __init__(self, name: str, statement: str, functions: str = "", textures: dict[str, Any] | None = None) -> None:
        self._textures = textures or {}
        self._shaders = gpu_shader.Shaders()
        original = gpu_shader.shader_text

        def declare(info: Any) -> None:
            info.push_constant("INT", "repeats")
            info.sampler(0, "FLOAT_2D_ARRAY", "numbers")
            for slot, texture in enumerate(self._textures):
                info.sampler(slot + 1, "FLOAT_2D", texture)
            info.fragment_out(0, "VEC4", "colour")

        def text(file: str) -> str:
            return functions + MAIN.replace("EVALUATE", statement) if file == "main" else original(file)

        with mock.patch.object(gpu_shader, "shader_text", text):
            self._shader = gpu_shader.compile_shader(name, declare, [*FILES, "main"])

    def upload(self, numbers: np.ndarray) -> Any:
        height, width, _ = numbers.shape
        layers = numbers.reshape(height, width, NUMBERS // 4, 4).transpose(2, 0, 1, 3)
        return gpu_shader.texture((width, height), "RGBA", layers, layers=NUMBERS // 4)

    def draw(self, numbers: Any, picture: Picture, repeats: int = 1) -> None:
        with gpu_shader.plain_state(), picture.buffer.bind():
            self._shader.bind()
            self._shader.uniform_int("repeats", repeats)
            self._shader.uniform_sampler("numbers", numbers)
            for name, texture in self._textures.items():
                self._shader.uniform_sampler(name, texture)
            self._shaders.draw_screen(self._shader)
