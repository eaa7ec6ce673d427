# SPDX-License-Identifier: GPL-3.0-or-later
"""Fourier opacity maps (Jansen and Bavoil 2010) built on the GPU, from particles or from a density in a 3D texture.

A map is what light_map_layers gives: a 2D array texture of four floats a texel, whose layer j holds
a_2j, b_2j, a_2j+1, b_2j+1, with b_0 = 0. Blender 3.4 has no compute shaders, so maps are drawn, several layers at a
time: into pictures, which are then copied, because from 4.3 on a framebuffer writes to only one layer of a texture.

The paper blends half floats. Half floats stall: additions that are small beside the sum are lost, and 20,000 layers of
opacity 2e-4 keep a transmittance of .6 instead of .02. So maps have single floats, unless `half` asks for the paper's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import arguments
from .arguments import Doubles
from .shader import BRICK, Shaders, compile_shader, plain_state

FORMAT = "RGBA32F"
TARGETS = 6  # colour targets of one framebuffer in Blender 3.4

# Texels that any puff may reach, however narrow: more than LEAST_RADIUS of shaders/media/puff.glsl.
NARROW = 2.0


def light_map_layers(light_map: np.ndarray) -> np.ndarray:
    """(h, w, 1+2m) coefficients a0, a1, b1, ... as (layers, h, w, 4): a_2j, b_2j, a_2j+1, b_2j+1, with b_0 = 0. What a map
    made on the CPU is uploaded as."""
    height, width, coefficients = light_map.shape
    layers = (coefficients + 1 + 3) // 4
    pairs = np.zeros((height, width, 4 * layers), np.float32)
    pairs[..., 0] = light_map[..., 0]
    pairs[..., 2 : coefficients + 1] = light_map[..., 1:]
    return np.ascontiguousarray(pairs.reshape(height, width, layers, 4).transpose(2, 0, 1, 3))


class LightMaps:
    """Builds light maps. Owns its shaders; dropping it frees them, but not the maps that it gave away."""

    def __init__(self) -> None:
        self._shaders = Shaders()

    def splat(
        self,
        points: ArrayLike,
        radius: ArrayLike,
        alpha: ArrayLike,
        world_to_map: ArrayLike,
        size: tuple[int, int],
        coefficients: int,
        thick: bool = True,
        half: bool = False,
    ) -> Any:
        """The light map of particles, in any order: a GPUTexture of `size` (width, height).

        points (n, 3), metres; radius () or (n,), metres; alpha () or (n,) in [0, 1], the opacity through a particle's
        middle, where 1 is taken to be 1 - 2^-20; world_to_map (4, 4), whose first three rows are perpendicular, as in
        sfumato.LightMap; coefficients 1, 3, ..., 63. A particle is a puff whose density falls off as
        1 - (r / radius)^2 (shaders/media/puff.glsl), taken for a slab along the light (shaders/viewport/splat_*.glsl), or
        without `thick` as flat as the paper's; `half` as in the module's docstring. What is outside the map is left
        out. The map holds optical depth. Raises ValueError for anything unusable.
        """
        count = arguments.odd_coefficients(coefficients)
        width, height = _size(size)
        to_map = arguments.affine(world_to_map, "world_to_map")
        metre = np.linalg.norm(to_map[:3, :3], axis=1)  # of the map, along its axes
        rows = to_map[:3, :3] / metre[:, None]
        if np.abs(rows @ rows.T - np.eye(3)).max() > 1e-3:
            raise ValueError("world_to_map is not a sun's: its first three rows must be perpendicular")
        extent = 1.0 if thick else 0.0
        batch = self._particles(points, radius, alpha, to_map, (width, height), extent)

        def declare(info: Any, layers: int) -> None:
            import gpu

            info.vertex_in(0, "VEC4", "puff")
            info.vertex_in(1, "VEC3", "shape")
            info.push_constant("VEC3", "metre")
            info.push_constant("VEC2", "texels")
            info.push_constant("FLOAT", "extent")
            between = gpu.types.GPUStageInterfaceInfo("splat")
            between.flat("VEC4", "footprint")
            for layer in range(layers):
                between.flat("VEC4", f"weight{layer}")
            info.vertex_out(between)

        fragment = ["media/puff.glsl", "viewport/splat_fragment.glsl"]
        vertex = [
            "rays/opacity.glsl",
            "media/puff.glsl",
            "viewport/light_map_layers.glsl",
            "viewport/splat_vertex.glsl",
        ]

        def draw(shader: Any, buffer: Any) -> None:
            import gpu

            buffer.clear(color=(0.0, 0.0, 0.0, 0.0))
            if batch is None:
                return
            gpu.state.blend_set("ADDITIVE_PREMULT")  # adds all four; ADDITIVE weighs three of them by the fourth
            shader.uniform_float("metre", metre)
            shader.uniform_float("texels", (width, height))
            shader.uniform_float("extent", extent)
            batch.draw(shader)

        light_map = _new_map(width, height, count, "RGBA16F" if half else FORMAT)
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
        count = arguments.odd_coefficients(coefficients)
        width, height = _size(size)
        to_map = arguments.affine(world_to_map, "world_to_map")
        to_world = arguments.affine(grid_to_world, "grid_to_world")
        map_to_grid = np.linalg.inv(to_world) @ np.linalg.inv(to_map)
        steps = max(1, math.ceil(2.0 * float(np.linalg.norm(map_to_grid[:3, 2])))) if slices is None else slices
        arguments.within(steps, 1, 65536, "slices")
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

        fragment = [
            "camera.glsl",
            "rays/opacity.glsl",
            "viewport/light_map_layers.glsl",
            "viewport/project_fragment.glsl",
        ]

        def draw(shader: Any, _buffer: Any) -> None:
            for name, row in zip(("grid_x", "grid_y", "grid_z"), rows):
                shader.uniform_float(name, row)
            shader.uniform_float("slices", steps)
            shader.uniform_float("length_of_slice", path / steps)
            shader.uniform_sampler("density", density)
            shader.uniform_sampler("clearance", clearance)
            self._shaders.draw_screen(shader)

        light_map = _new_map(width, height, count, FORMAT)
        self._in_passes(light_map, count, "march", declare, fragment, None, draw)
        return light_map

    def soften(self, light_map: Any, coefficients: int, reach: int) -> Any:
        """The map of smoke that is averaged over 2 reach + 1 texels along both axes, for a light that has a size: a new
        GPUTexture. Beyond the rim there is no smoke, so what is to keep its total must be `reach` texels from it."""
        import gpu

        count = arguments.odd_coefficients(coefficients)
        arguments.within(reach, 0, 4096, "reach")
        width, height = light_map.width, light_map.height
        made = _new_map(width, height, count, light_map.format)
        between = gpu.types.GPUTexture((width, height), format="RGBA32F")
        across = gpu.types.GPUFrameBuffer(color_slots=[between])
        for layer in range(_layers(count)):
            self._mean(light_map, "light_map", layer, (1, 0), reach, across)
            self._mean(between, "picture", 0, (0, 1), reach, _framebuffer(made, layer))
        return made

    def _mean(self, source: Any, name: str, layer: int, along: tuple[int, int], reach: int, buffer: Any) -> None:
        """Along one axis, of a layer of a map or of a picture."""
        is_map = name == "light_map"

        def declare(info: Any) -> None:
            info.define("TEXEL(at)", f"texelFetch({name}, {'ivec3(at, layer)' if is_map else 'at'}, 0)")
            for number in ("reach", "layer"):
                info.push_constant("INT", number)
            for pair in ("along", "size"):
                info.push_constant("IVEC2", pair)
            info.sampler(0, "FLOAT_2D_ARRAY" if is_map else "FLOAT_2D", name)
            info.fragment_out(0, "VEC4", "colour")

        shader = self._shaders.get(
            f"soften a {name}",
            lambda: compile_shader(f"soften a {name}", declare, ["viewport/soften_fragment.glsl"]),
        )
        with plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_sampler(name, source)
            shader.uniform_int("reach", reach)
            if is_map:  # elsewhere it is not used, and some compilers leave out what is not
                shader.uniform_int("layer", layer)
            shader.uniform_int("along", along)
            shader.uniform_int("size", (source.width, source.height))
            self._shaders.draw_screen(shader)

    def read(self, light_map: Any, coefficients: int) -> NDArray[np.float32]:
        """The coefficients of a map, (height, width, coefficients): a0, a1, b1, a2, b2, ..., row 0 at the bottom."""
        import gpu

        count = arguments.odd_coefficients(coefficients)
        width, height = light_map.width, light_map.height

        def declare(info: Any) -> None:
            info.push_constant("INT", "layer")
            info.sampler(0, "FLOAT_2D_ARRAY", "light_map")
            info.fragment_out(0, "VEC4", "colour")

        shader = self._shaders.get(
            "read", lambda: compile_shader("read", declare, ["viewport/light_map_fragment.glsl"])
        )
        # GPUTexture.read knows the first layer alone.
        picture = gpu.types.GPUTexture((width, height), format="RGBA32F")
        buffer = gpu.types.GPUFrameBuffer(color_slots=[picture])
        pixels = np.empty((_layers(count), height, width, 4), np.float32)
        with plain_state(), buffer.bind():
            for layer, target in enumerate(pixels):
                shader.bind()
                shader.uniform_sampler("light_map", light_map)
                shader.uniform_int("layer", layer)
                self._shaders.draw_screen(shader)
                data = gpu.types.Buffer("FLOAT", target.shape, target)
                buffer.read_color(0, 0, width, height, 4, 0, "FLOAT", data=data)
        pairs = pixels.transpose(1, 2, 0, 3).reshape(height, width, -1)
        return np.ascontiguousarray(np.delete(pairs, 1, axis=-1)[..., :count])  # b_0

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
        targets = [gpu.types.GPUTexture(size, format=light_map.format) for _ in passes[0]]
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
            shader = self._shaders.get(name, lambda: compile_shader(name, declare_all, fragment, vertex))
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

        shader = self._shaders.get("copy", lambda: compile_shader("copy", declare, ["viewport/copy_fragment.glsl"]))
        with plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_sampler("picture", picture)
            self._shaders.draw_screen(shader)

    def _particles(
        self,
        points: ArrayLike,
        radius: ArrayLike,
        alpha: ArrayLike,
        to_map: Doubles,
        size: tuple[int, int],
        extent: float,
    ) -> Any:
        """Four vertices a particle, for those that reach into the map."""
        import gpu

        places = arguments.finite(points, "points")
        if places.ndim != 2 or places.shape[1] != 3 or not len(places):
            raise ValueError(f"points has shape {places.shape}, but must be (n, 3) with n at least 1")
        radii, alphas = (
            arguments.one_each(value, len(places), name) for value, name in ((radius, "radius"), (alpha, "alpha"))
        )
        arguments.each_within(radii, 1e-30, 1e30, "radius")
        arguments.each_within(alphas, 0.0, 1.0, "alpha")
        metre = np.linalg.norm(to_map[:3, :3], axis=1)
        centres = places @ to_map[:3, :3].T + to_map[:3, 3]
        reach = radii[:, None] * metre * (1.0, 1.0, extent)
        reach[:, :2] = np.maximum(reach[:, :2], NARROW / np.array(size))
        kept = ((centres + reach >= 0.0) & (centres - reach <= 1.0)).all(axis=1)
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


def _size(size: tuple[int, int]) -> tuple[int, int]:
    import gpu

    most = gpu.capabilities.max_texture_size_get()
    width, height = size
    if not (1 <= width <= most and 1 <= height <= most):
        raise ValueError(f"size is {tuple(size)}, but must be (width, height), each between 1 and {most}")
    return width, height


def _layers(coefficients: int) -> int:
    return (coefficients + 1 + 3) // 4


def _new_map(width: int, height: int, coefficients: int, form: str) -> Any:
    import gpu

    return gpu.types.GPUTexture((width, height), layers=_layers(coefficients), format=form)


def _framebuffer(light_map: Any, layer: int) -> Any:
    """Writes to one layer."""
    import gpu

    try:
        return gpu.types.GPUFrameBuffer(color_slots=[{"texture": light_map, "layer": layer}])
    except TypeError:
        # Built with Python 3.13, Blender 4.3 takes each of these names for the other.
        return gpu.types.GPUFrameBuffer(color_slots=[{"layer": light_map, "texture": layer}])
