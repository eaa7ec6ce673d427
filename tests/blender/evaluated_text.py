# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared text as GLSL: a statement of a test's own, which no shader of the product has, for each pixel of a picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from unittest import mock

import numpy as np
from area_light_text import Picture
from sfumato.gpu import shader as gpu_shader

SIZE = 32  # pixels along the picture

MAIN = """
void main()
{
  ivec3 place = ivec3(gl_FragCoord.xy, 0);
  vec4 n0 = texelFetch(numbers, place, 0), n1 = texelFetch(numbers, place + ivec3(0, 0, 1), 0);
  STATEMENT
}
"""


def evaluated(files: Sequence[str], statement: str, numbers: np.ndarray) -> np.ndarray:
    """The `colour` (SIZE, SIZE, 4) that a statement makes of n0 and n1: numbers (SIZE, SIZE, 8)."""
    original = gpu_shader.shader_text

    def text(file: str) -> str:
        return MAIN.replace("STATEMENT", statement) if file == "main" else original(file)

    def declare(info: Any) -> None:
        info.sampler(0, "FLOAT_2D_ARRAY", "numbers")
        info.fragment_out(0, "VEC4", "colour")

    with mock.patch.object(gpu_shader, "shader_text", text):
        shader = gpu_shader.compile_shader("statement", declare, [*files, "main"])
    layers = numbers.reshape(SIZE, SIZE, 2, 4).transpose(2, 0, 1, 3)
    texture, picture = gpu_shader.texture((SIZE, SIZE), "RGBA", layers, layers=2), Picture(SIZE, SIZE)
    with gpu_shader.plain_state(), picture.buffer.bind():
        shader.bind()
        shader.uniform_sampler("numbers", texture)
        gpu_shader.Shaders().draw_screen(shader)
    return picture.read()
