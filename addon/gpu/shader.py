# SPDX-License-Identifier: GPL-3.0-or-later
"""What every drawing on the GPU needs: shaders put together from files, textures from arrays, a plain state.

The files of this folder are the only ones that import `gpu`, and only inside functions: there may be no GPU at all
(`blender -b`).
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

BRICK = 4  # cells along the edge of a brick of LitMedium.clearance


class ShaderError(RuntimeError):
    """A shader did not compile; Blender has printed the compiler's log on the standard error."""


def shader_text(name: str) -> str:
    addon = Path(__file__).resolve().parents[1]
    folder = addon / "shaders" if (addon / "shaders").is_dir() else addon.parent / "shaders"
    return (folder / name).read_text(encoding="utf-8")


def compile_shader(
    name: str,
    declare: Callable[[Any], None],
    fragment: list[str],
    vertex: list[str] | None = None,
    generated: str = "",
) -> Any:
    """Compile a shader put together from files; the last of each list has main(), and what is generated comes before the
    first file of the fragment shader. `declare` states what it reads and writes. Without `vertex` it draws the screen
    triangle, whose attribute need not be declared."""
    import gpu

    info = gpu.types.GPUShaderCreateInfo()
    if vertex is None:
        vertex = ["viewport/screen_vertex.glsl"]
        info.vertex_in(0, "VEC2", "corner")
    declare(info)
    prelude = "#define pick(condition, a, b) ((condition) ? (a) : (b))\n#define any_lane(condition) (condition)\n"
    prelude += "#define reciprocal(x) (1.0f / (x))\n#define lowest_lane(x) (x)\n"
    info.vertex_source(prelude + "".join(shader_text(file) for file in vertex))
    info.fragment_source(prelude + generated + "".join(shader_text(file) for file in fragment))
    try:
        return gpu.shader.create_from_info(info)
    except Exception as error:  # gpu raises the bare class
        raise ShaderError(f"shaders/{fragment[-1]} ({name}): {error}") from error


class Shaders:
    """Compiled when they are first asked for. Dropping this frees them."""

    def __init__(self) -> None:
        self._compiled: dict[Any, Any] = {}
        self._failures: dict[Any, str] = {}
        self._triangle: Any = None

    def get(self, key: Any, make: Callable[[], Any]) -> Any:
        """The shader under any name; `make` compiles it."""
        if key in self._failures:
            raise ShaderError(self._failures[key])
        if key not in self._compiled:
            try:
                self._compiled[key] = make()
            except ShaderError as error:
                self._failures[key] = str(error)  # so that the compiler's log is printed once
                raise
        return self._compiled[key]

    def draw_screen(self, shader: Any) -> None:
        """Draw one triangle that covers the target."""
        from gpu_extras.batch import batch_for_shader

        if self._triangle is None:
            self._triangle = batch_for_shader(shader, "TRIS", {"corner": [(-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0)]})
        self._triangle.draw(shader)


def texture(size: tuple[int, ...], channels: str, data: np.ndarray, layers: int = 0) -> Any:
    import gpu

    flat = np.ascontiguousarray(data, dtype=np.float32).ravel()
    buffer = gpu.types.Buffer("FLOAT", flat.size, flat)
    return gpu.types.GPUTexture(size, layers=layers, format=f"{channels}32F", data=buffer)


@contextlib.contextmanager
def plain_state() -> Iterator[None]:
    """No depth test, no blending; whatever was set comes back."""
    import gpu

    blend, depth_test, depth_mask = gpu.state.blend_get(), gpu.state.depth_test_get(), gpu.state.depth_mask_get()
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    gpu.state.depth_mask_set(False)
    try:
        yield
    finally:
        gpu.state.blend_set(blend)
        gpu.state.depth_test_set(depth_test)
        gpu.state.depth_mask_set(depth_mask)
