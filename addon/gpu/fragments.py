# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent fragments as the GPU draws them: soft sprites, which face the camera, and triangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import arguments
from .arguments import Doubles
from .shader import shader_text

# Variants of shaders/viewport/fragment.glsl
LIT, SOLIDS = "LIT", "SOLIDS"
SLICES = 4  # of a sprite among triangles
STRIP_REACH = 1.5  # pixels: half of what the filter of F12 is wide
CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


@dataclass(frozen=True)
class Sprites:
    """points (n, 3) and radius () or (n,), metres; alpha () or (n,) in [0, 1], through the middle; colour (3,) or (n, 3),
    radiance. Density falls off as 1 - (r / radius)^2."""

    points: ArrayLike
    radius: ArrayLike
    alpha: ArrayLike
    colour: ArrayLike


@dataclass(frozen=True)
class Triangles:
    """corners (n, 3, 3), metres; alpha () or (n,) in [0, 1]; colour (3,), (n, 3) or of each corner (n, 3, 3), radiance.
    strip (n, 3, 2): of what is hair, how far a corner is from its middle and half of its width, in pixels; else 0."""

    corners: ArrayLike
    alpha: ArrayLike
    colour: ArrayLike
    strip: ArrayLike | None = None


class Fragments:
    """Sprites and triangles in one batch. Raises ValueError for anything unusable."""

    def __init__(self, sprites: Sprites | None = None, triangles: Triangles | None = None) -> None:
        self.has_triangles = triangles is not None
        self.slices = SLICES if self.has_triangles else 1
        place, shape, tint = [np.empty((0, 4))], [np.empty((0, 4))], [np.empty((0, 3))]
        self.points = np.empty((0, 3))  # of sprites
        if sprites is not None:
            self.points = _points(sprites.points, (-1, 3), "points")
            count = len(self.points)
            radius = arguments.one_each(sprites.radius, count, "radius")
            arguments.each_within(radius, 1e-30, 1e30, "radius")
            alpha = _opacity(sprites.alpha, count)
            own = np.arange(count).repeat(4 * self.slices)  # the sprite of each vertex
            place.append(np.column_stack((self.points, radius))[own])
            corners = np.tile(CORNERS, (count * self.slices, 1))
            shape.append(np.column_stack((corners, alpha[own], np.tile(np.arange(self.slices).repeat(4), count))))
            tint.append(_colours(sprites.colour, count)[own])
        quads = len(self.points) * self.slices
        first = (4 * np.arange(quads)[:, None] + np.array([0, 1, 2, 0, 2, 3])).reshape(-1, 3)
        if triangles is not None:
            corners = _points(triangles.corners, (-1, 3, 3), "corners")
            count = len(corners)
            alpha = _opacity(triangles.alpha, count)
            place.append(np.column_stack((corners.reshape(-1, 3), np.zeros(3 * count))))
            strip = np.zeros((3 * count, 2)) if triangles.strip is None else _strip(triangles.strip, count)
            shape.append(np.column_stack((strip, np.repeat(alpha, 3), np.zeros(3 * count))))
            tint.append(_corner_colours(triangles.colour, count))
            first = np.concatenate((first, 4 * quads + np.arange(3 * count).reshape(-1, 3)))
        self._place = np.concatenate(place)
        self._attributes = {"place": self._place, "shape": np.concatenate(shape), "tint": np.concatenate(tint)}
        self._indices = first.astype(np.int32)
        self._vertices: Any = None
        self._batch: Any = None

    def __len__(self) -> int:
        """Of sprites and triangles."""
        return len(self.points) + (len(self._indices) - 2 * self.slices * len(self.points))

    def depths(self, from_world: ArrayLike) -> tuple[float, float]:
        """The distances along the view between which all fragments in front of the camera are."""
        turned = np.asarray(from_world, np.float64)
        distance = -(self._place[:, :3] @ turned[2, :3] + turned[2, 3])
        reach = self._place[:, 3] * (1.0 - 1.0 / self.slices)
        distance = np.concatenate((distance - reach, distance + reach))
        seen = distance[distance > 0.0]
        low, high = (float(seen.min()), float(seen.max())) if seen.size else (0.0, 1.0)
        if seen.size < distance.size:  # what goes on behind the camera
            low = 0.0
        margin = 1e-4 * (high - low) + 1e-6 * high  # for what triangles round
        return low - margin, high + margin

    def uniforms(self, from_world: ArrayLike, projection: ArrayLike, to_map: ArrayLike) -> Any:
        """FragmentView of shaders/viewport/fragment_uniforms.glsl."""
        import gpu

        matrices = [arguments.finite(m, name) for m, name in
                    ((from_world, "from_world"), (projection, "projection"), (to_map, "world_to_map"))]  # fmt: skip
        low, high = self.depths(from_world)
        numbers = [m.T.ravel() for m in matrices] + [np.array((low, 1.0 / (high - low), 0.0, 0.0))]
        data = np.concatenate(numbers).astype(np.float32)
        return gpu.types.GPUUniformBuf(gpu.types.Buffer("FLOAT", data.size, data))

    def back_to_front(self, from_world: ArrayLike) -> NDArray[np.int32]:
        """Indices of the triangles of sprites alone, the furthest sprite first."""
        turned = np.asarray(from_world, np.float64)
        order = np.argsort(self.points @ turned[2, :3], kind="stable")
        return np.asarray(self._indices.reshape(-1, 2, 3)[order].reshape(-1, 3))

    def draw(self, shader: Any, indices: NDArray[np.int32] | None = None) -> None:
        """All of them, or in another order."""
        import gpu

        if not len(self._indices):
            return
        if self._vertices is None:
            form = gpu.types.GPUVertFormat()
            for name, values in self._attributes.items():
                form.attr_add(id=name, comp_type="F32", len=values.shape[1], fetch_mode="FLOAT")
            self._vertices = gpu.types.GPUVertBuf(form, len(self._place))
            for name, values in self._attributes.items():
                self._vertices.attr_fill(name, np.ascontiguousarray(values, np.float32))
        if indices is None and self._batch is not None:
            self._batch.draw(shader)
            return
        seq = gpu.types.GPUIndexBuf(type="TRIS", seq=self._indices if indices is None else indices)
        batch = gpu.types.GPUBatch(type="TRIS", buf=self._vertices, elem=seq)
        batch.draw(shader)
        if indices is None:
            self._batch = batch


def declare_fragments(info: Any, variants: list[str], coefficients: int, slices: int) -> None:
    """What the vertex shader reads and hands on; `coefficients` of a light map."""
    import gpu

    for variant in variants:
        info.define(variant, "1")
    info.define("SLICES", str(slices))
    info.define("STRIP_REACH", f"{STRIP_REACH}f")
    info.typedef_source(shader_text("viewport/fragment_uniforms.glsl"))
    info.uniform_buf(0, "FragmentView", "view")
    info.vertex_in(0, "VEC4", "place")
    info.vertex_in(1, "VEC4", "shape")
    info.vertex_in(2, "VEC3", "tint")
    between = gpu.types.GPUStageInterfaceInfo("transparent")
    between.smooth("VEC3", "spot")  # in a sprite, and the distance along the view
    between.smooth("VEC3", "sent")  # at an opacity of 1
    between.flat("VEC4", "slice")  # radius, where along the chord it begins and ends, and the whole's optical depth
    if LIT in variants:
        info.define("MAP_LAYERS", str((coefficients + 4) // 4))
        between.smooth("VEC3", "in_map")
    info.vertex_out(between)


def _points(given: ArrayLike, shape: tuple[int, ...], name: str) -> Doubles:
    array = arguments.finite(given, name)
    if array.size == 0:
        return np.zeros((0, *shape[1:]))
    if array.shape[1:] != shape[1:]:
        wanted = ", ".join("n" if size < 0 else str(size) for size in shape)
        raise ValueError(f"{name} has shape {array.shape}, but must have ({wanted})")
    return array


def _strip(given: ArrayLike, count: int) -> Doubles:
    strip = arguments.finite(given, "strip")
    if strip.shape != (count, 3, 2):
        raise ValueError(f"strip has shape {strip.shape}, but must have ({count}, 3, 2)")
    return strip.reshape(-1, 2)


def _opacity(alpha: ArrayLike, count: int) -> Doubles:
    alphas = arguments.one_each(alpha, count, "alpha")
    arguments.each_within(alphas, 0.0, 1.0, "alpha")
    return alphas


def _corner_colours(given: ArrayLike, count: int) -> Doubles:
    """Of each corner of triangles, (3 count, 3)."""
    if np.ndim(given) < 3:
        return np.repeat(_colours(given, count), 3, axis=0)
    colours = arguments.finite(given, "colour")
    if colours.shape != (count, 3, 3):
        raise ValueError(f"colour has shape {colours.shape}, but must have (3,), ({count}, 3) or ({count}, 3, 3)")
    return colours.reshape(-1, 3)


def _colours(given: ArrayLike, count: int) -> Doubles:
    colours = arguments.finite(given, "colour")
    if colours.shape not in ((3,), (count, 3)):
        raise ValueError(f"colour has shape {colours.shape}, but must have (3,) or ({count}, 3)")
    return np.broadcast_to(colours, (count, 3))
