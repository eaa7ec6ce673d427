# SPDX-License-Identifier: GPL-3.0-or-later
"""Fourier opacity maps (Jansen and Bavoil 2010) built on the GPU, from particles or from a density in a 3D texture.

A map is what light_map_layers of viewport.py uploads: a 2D array texture of four floats a texel, whose layer j holds
a_2j, b_2j, a_2j+1, b_2j+1, with b_0 = 0. Blender 3.4 has no compute shaders, so maps are drawn, several layers at a time:
into pictures, which are then copied, because from Blender 4.3 on a framebuffer writes to only one layer of a texture.

The paper blends half floats. Half floats stall: additions that are small beside the sum are lost, and 20,000 layers of
opacity 2e-4 keep a transmittance of .6 instead of .02. So maps have single floats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .viewport_gpu import BRICK, compile_shader, plain_state, screen_triangle

Doubles = NDArray[np.float64]

FORMAT = "RGBA32F"
TARGETS = 6  # colour targets of one framebuffer in Blender 3.4
MOST_COEFFICIENTS = 63  # as on the CPU

# A puff is widened to this many texels: then the sum over texels of what it adds is within 4 % of its integral wherever
# it stands between them. (At one texel it is within 20 %.)
LEAST_RADIUS = 1.5

# Along the light a puff is a slab with the variance of its own density, radius^2 / 7; half its width, in radii.
SLAB = math.sqrt(3.0 / 7.0)


class LightMaps:
    """Builds light maps. Owns its shaders; dropping it frees them, but not the maps that it gave away."""

    def __init__(self) -> None:
        self._shaders: dict[str, Any] = {}
        self._triangle: Any = None

    def splat(
        self,
        points: ArrayLike,
        radius: ArrayLike,
        alpha: ArrayLike,
        world_to_map: ArrayLike,
        size: tuple[int, int],
        coefficients: int,
        thick: bool = True,
    ) -> Any:
        """The light map of particles, in any order: a GPUTexture of `size` (width, height).

        points (n, 3), metres; radius () or (n,), metres; alpha () or (n,) in [0, 1], the opacity through a particle's
        middle, where 1 is taken to be 1 - 2^-20; world_to_map (4, 4), whose first three rows are perpendicular, as in
        sfumato.LightMap; coefficients 1, 3, ..., 63. A particle is a puff whose density falls off as 1 - (r / radius)^2,
        taken for a slab along the light (shaders/viewport/splat_*.glsl), or without `thick` as flat as the paper's. What is outside the map is
        left out. The map holds optical depth. Raises ValueError for anything unusable.
        """
        count = _coefficients(coefficients)
        width, height = _size(size)
        to_map = _affine(world_to_map, "world_to_map")
        metre = np.linalg.norm(to_map[:3, :3], axis=1)  # of the map, along its axes
        rows = to_map[:3, :3] / metre[:, None]
        if np.abs(rows @ rows.T - np.eye(3)).max() > 1e-3:
            raise ValueError("world_to_map is not a sun's: its first three rows must be perpendicular")
        batch = self._particles(points, radius, alpha, to_map, metre, thick)

        def declare(info: Any, layers: int) -> None:
            import gpu

            info.define("LEAST_RADIUS", f"{LEAST_RADIUS}f")
            info.vertex_in(0, "VEC4", "puff")
            info.vertex_in(1, "VEC3", "shape")
            info.push_constant("VEC3", "metre")
            info.push_constant("VEC2", "texels")
            info.push_constant("FLOAT", "slab")
            between = gpu.types.GPUStageInterfaceInfo("splat")
            between.flat("VEC4", "footprint")
            for layer in range(layers):
                between.flat("VEC4", f"weight{layer}")
            info.vertex_out(between)

        fragment = ["viewport/splat_fragment.glsl"]
        vertex = ["opacity.glsl", "viewport/light_map_layers.glsl", "viewport/splat_vertex.glsl"]

        def draw(shader: Any, buffer: Any) -> None:
            import gpu

            buffer.clear(color=(0.0, 0.0, 0.0, 0.0))
            if batch is None:
                return
            gpu.state.blend_set("ADDITIVE_PREMULT")  # adds all four; ADDITIVE weighs three of them by the fourth
            shader.uniform_float("metre", metre)
            shader.uniform_float("texels", (width, height))
            shader.uniform_float("slab", SLAB if thick else 0.0)
            batch.draw(shader)

        light_map = _new_map(width, height, count)
        self._in_passes(light_map, count, "splat", declare, fragment, vertex, draw)
        return light_map

    def march(
        self,
        density: Any,
        clearance: Any,
        grid_to_world: ArrayLike,
        world_to_map: ArrayLike,
        size: tuple[int, int],
        coefficients: int,
        slices: int | None = None,
    ) -> Any:
        """The light map of a density: a GPUTexture of `size` (width, height).

        density, a 3D texture with the density in red, and clearance, one of a float a brick: what sfumato.LitMedium
        has, so the density is zero at the grid's rim. grid_to_world (4, 4) takes cells to metres, world_to_map (4, 4)
        and coefficients are as in splat. Without `slices`, two a cell along the light, as on the CPU. The map holds
        metres times density. Raises ValueError for anything unusable.
        """
        count = _coefficients(coefficients)
        width, height = _size(size)
        to_map = _affine(world_to_map, "world_to_map")
        to_world = _affine(grid_to_world, "grid_to_world")
        map_to_grid = np.linalg.inv(to_world) @ np.linalg.inv(to_map)
        steps = max(1, math.ceil(2.0 * float(np.linalg.norm(map_to_grid[:3, 2])))) if slices is None else slices
        _within(steps, 1, 65536, "slices")
        rows = map_to_grid @ np.diag((1.0 / width, 1.0 / height, 1.0 / steps, 1.0))
        path = float(np.linalg.norm(np.linalg.inv(to_map)[:3, 2]))

        def declare(info: Any, _layers: int) -> None:
            info.define("BRICK", f"{BRICK:.1f}f")
            for name in ("grid_x", "grid_y", "grid_z"):
                info.push_constant("VEC4", name)
            info.push_constant("FLOAT", "slices")
            info.push_constant("FLOAT", "length_of_slice")
            info.sampler(0, "FLOAT_3D", "density")
            info.sampler(1, "FLOAT_3D", "clearance")

        fragment = ["camera.glsl", "opacity.glsl", "viewport/light_map_layers.glsl", "viewport/project_fragment.glsl"]

        def draw(shader: Any, _buffer: Any) -> None:
            for name, row in zip(("grid_x", "grid_y", "grid_z"), rows):
                shader.uniform_float(name, row)
            shader.uniform_float("slices", steps)
            shader.uniform_float("length_of_slice", path / steps)
            shader.uniform_sampler("density", density)
            shader.uniform_sampler("clearance", clearance)
            self._draw(shader)

        light_map = _new_map(width, height, count)
        self._in_passes(light_map, count, "march", declare, fragment, None, draw)
        return light_map

    def read(self, light_map: Any, coefficients: int) -> NDArray[np.float32]:
        """The coefficients of a map, (height, width, coefficients): a0, a1, b1, a2, b2, ..., row 0 at the bottom."""
        import gpu

        count = _coefficients(coefficients)
        width, height = light_map.width, light_map.height

        def declare(info: Any) -> None:
            info.push_constant("INT", "layer")
            info.sampler(0, "FLOAT_2D_ARRAY", "light_map")
            info.fragment_out(0, "VEC4", "colour")

        shader = self._shader("read", lambda: compile_shader("read", declare, ["viewport/light_map_fragment.glsl"]))
        # GPUTexture.read knows the first layer alone.
        picture = gpu.types.GPUTexture((width, height), format="RGBA32F")
        buffer = gpu.types.GPUFrameBuffer(color_slots=[picture])
        pixels = np.empty((_layers(count), height, width, 4), np.float32)
        with plain_state(), buffer.bind():
            for layer, target in enumerate(pixels):
                shader.bind()
                shader.uniform_sampler("light_map", light_map)
                shader.uniform_int("layer", layer)
                self._draw(shader)
                data = gpu.types.Buffer("FLOAT", target.shape, target)
                buffer.read_color(0, 0, width, height, 4, 0, "FLOAT", data=data)
        pairs = pixels.transpose(1, 2, 0, 3).reshape(height, width, -1)
        return np.ascontiguousarray(np.delete(pairs, 1, axis=-1)[..., :count])  # b_0

    def _shader(self, key: str, make: Callable[[], Any]) -> Any:
        if key not in self._shaders:
            self._shaders[key] = make()
        return self._shaders[key]

    def _draw(self, shader: Any) -> None:
        if self._triangle is None:
            self._triangle = screen_triangle(shader)
        self._triangle.draw(shader)

    def _in_passes(
        self,
        light_map: Any,
        count: int,
        kind: str,
        declare: Callable[[Any, int], None],
        fragment: list[str],
        vertex: list[str] | None,
        draw: Callable[[Any, Any], None],
    ) -> None:
        """Draw as many layers at a time as there are targets. `draw` finds its shader and its framebuffer bound."""
        import gpu

        layers = _layers(count)
        passes = np.array_split(np.arange(layers), math.ceil(layers / TARGETS))
        size = light_map.width, light_map.height
        targets = [gpu.types.GPUTexture(size, format=FORMAT) for _ in passes[0]]
        for some in passes:

            def declare_all(info: Any, some: NDArray[np.int64] = some) -> None:
                info.define("FIRST", str(2 * some[0]))
                info.define("LAYERS", str(len(some)))
                info.define("HARMONICS", str(count // 2))
                each = (f"f({slot}, layer{slot}, weight{slot})" for slot in range(len(some)))
                info.define("EACH_LAYER(f)", " ".join(each))
                for slot in range(len(some)):
                    info.fragment_out(slot, "VEC4", f"layer{slot}")
                declare(info, len(some))

            name = f"{kind}, {count} coefficients, layers from {some[0]}"
            shader = self._shader(name, lambda: compile_shader(name, declare_all, fragment, vertex))
            buffer = gpu.types.GPUFrameBuffer(color_slots=targets[: len(some)])
            with plain_state(), buffer.bind():
                shader.bind()
                draw(shader, buffer)
            for target, layer in zip(targets, some):
                self._copy(target, _framebuffer(light_map, int(layer)))

    def _copy(self, picture: Any, buffer: Any) -> None:
        def declare(info: Any) -> None:
            info.sampler(0, "FLOAT_2D", "picture")
            info.fragment_out(0, "VEC4", "colour")

        shader = self._shader("copy", lambda: compile_shader("copy", declare, ["viewport/copy_fragment.glsl"]))
        with plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_sampler("picture", picture)
            self._draw(shader)

    def _particles(
        self, points: ArrayLike, radius: ArrayLike, alpha: ArrayLike, to_map: Doubles, metre: Doubles, thick: bool
    ) -> Any:
        """Four vertices a particle, for those that reach into the map's depths."""
        import gpu

        places = _finite(points, "points")
        if places.ndim != 2 or places.shape[1] != 3 or not len(places):
            raise ValueError(f"points has shape {places.shape}, but must be (n, 3) with n at least 1")
        radii, alphas = (_one_each(value, len(places), name) for value, name in ((radius, "radius"), (alpha, "alpha")))
        _each_within(radii, 1e-30, 1e30, "radius")
        _each_within(alphas, 0.0, 1.0, "alpha")
        centres = places @ to_map[:3, :3].T + to_map[:3, 3]
        reach = SLAB * radii * metre[2] if thick else 0.0
        kept = (centres[:, 2] + reach >= 0.0) & (centres[:, 2] - reach <= 1.0)
        corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)], np.float32)
        count = int(np.count_nonzero(kept))
        if not count:
            return None
        puff, shape = np.empty((count, 4, 4), np.float32), np.empty((count, 4, 3), np.float32)
        puff[..., :3] = centres[kept, None]
        puff[..., 3] = radii[kept, None]
        shape[..., :2] = corners
        shape[..., 2] = alphas[kept, None]
        form = gpu.types.GPUVertFormat()
        form.attr_add(id="puff", comp_type="F32", len=4, fetch_mode="FLOAT")
        form.attr_add(id="shape", comp_type="F32", len=3, fetch_mode="FLOAT")
        vertices = gpu.types.GPUVertBuf(form, 4 * count)
        vertices.attr_fill("puff", puff.reshape(-1, 4))
        vertices.attr_fill("shape", shape.reshape(-1, 3))
        first = 4 * np.arange(count, dtype=np.int32)[:, None]
        triangles = (first + np.array([0, 1, 2, 0, 2, 3], np.int32)).reshape(-1, 3)
        indices = gpu.types.GPUIndexBuf(type="TRIS", seq=triangles)
        return gpu.types.GPUBatch(type="TRIS", buf=vertices, elem=indices)


def _layers(coefficients: int) -> int:
    return (coefficients + 1 + 3) // 4


def _new_map(width: int, height: int, coefficients: int) -> Any:
    import gpu

    return gpu.types.GPUTexture((width, height), layers=_layers(coefficients), format=FORMAT)


def _framebuffer(light_map: Any, layer: int) -> Any:
    """Writes to one layer."""
    import gpu

    try:
        return gpu.types.GPUFrameBuffer(color_slots=[{"texture": light_map, "layer": layer}])
    except TypeError:
        # Built with Python 3.13, Blender 4.3 takes each of these names for the other.
        return gpu.types.GPUFrameBuffer(color_slots=[{"layer": light_map, "texture": layer}])


# Arguments ----------------------------------------------------------------------------------------------------------


def _finite(values: ArrayLike, name: str) -> Doubles:
    array = np.asarray(values, np.float64)
    bad = ~np.isfinite(array)
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(f"{name} holds {array.flat[at]:g} at flat index {at}; every value must be finite")
    return array


def _each_within(array: Doubles, low: float, high: float, name: str) -> None:
    bad = ~((array >= low) & (array <= high))
    if bad.any():
        at = int(np.argmax(bad))
        raise ValueError(
            f"{name} holds {array.flat[at]:g} at flat index {at}; every value must lie between {low:g} and {high:g}"
        )


def _within(value: int, low: int, high: int, name: str) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name} is {value}, but must lie between {low} and {high}")


def _one_each(values: ArrayLike, count: int, name: str) -> Doubles:
    array = _finite(values, name)
    if array.shape not in ((), (count,)):
        raise ValueError(f"{name} has shape {array.shape}, but must have () or ({count},), one for each point")
    return np.broadcast_to(array, (count,))


def _coefficients(count: int) -> int:
    _within(count, 1, MOST_COEFFICIENTS, "coefficients")
    if count % 2 == 0:
        raise ValueError(f"coefficients is {count}, but must be odd: a constant and pairs of harmonics")
    return count


def _size(size: tuple[int, int]) -> tuple[int, int]:
    import gpu

    most = gpu.capabilities.max_texture_size_get()
    width, height = size
    for value in (width, height):
        if not 1 <= value <= most:
            raise ValueError(f"size is {tuple(size)}, but must be (width, height), each between 1 and {most}")
    return width, height


def _affine(matrix: ArrayLike, name: str) -> Doubles:
    m = _finite(matrix, name)
    if m.shape != (4, 4):
        raise ValueError(f"{name} has shape {m.shape}, but must be (4, 4)")
    for column, value in enumerate(m[3]):
        if value != (1.0 if column == 3 else 0.0):
            raise ValueError(f"{name} holds {value:g} at flat index {12 + column}; its last row must be 0, 0, 0, 1")
    if np.linalg.det(m) == 0.0:
        raise ValueError(f"{name} flattens space: its determinant is 0")
    return m
