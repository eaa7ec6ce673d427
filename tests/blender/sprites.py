# SPDX-License-Identifier: GPL-3.0-or-later
"""Sprites and sheets for tests, and the fragments that they are in each pixel, worked out in double precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray
from sfumato.gpu.fragments import Fragments, Sprites, Triangles
from sfumato.gpu.transparency import View

SIZE = (96, 64)
NEAR, FAR = 0.1, 50.0


def projection(perspective: bool) -> NDArray[np.float64]:
    if perspective:
        return np.array(((1.6, 0, 0, 0), (0, 2.4, 0, 0),
                         (0, 0, (FAR + NEAR) / (NEAR - FAR), 2 * FAR * NEAR / (NEAR - FAR)), (0, 0, -1, 0)))  # fmt: skip
    matrix = np.diag((0.5, 0.75, 2.0 / (NEAR - FAR), 1.0))
    matrix[2, 3] = (FAR + NEAR) / (NEAR - FAR)
    return matrix


def view_of(perspective: bool = True, solids: Any = None, size: tuple[int, int] = SIZE) -> View:
    eye = Matrix.Rotation(0.5, 4, "Z") @ Matrix.Rotation(1.2, 4, "X") @ Matrix.Translation((0.0, 0.0, 4.0))
    return View(np.array(eye.inverted()), projection(perspective), size, solids)


def some_sprites(count: int, seed: int = 3, most: float = 0.3) -> Sprites:
    random = np.random.default_rng(seed)
    points = np.clip(random.standard_normal((count, 3)), -2.5, 2.5) * (0.55, 0.55, 0.4)
    return Sprites(
        points, random.uniform(0.15, 0.5, count), random.uniform(0.02, most, count), random.random((count, 3))
    )


def some_sheets(count: int, seed: int = 4) -> Triangles:
    """Large enough to fill the picture, so that no edge is in it; they intersect each other and the sprites."""
    random = np.random.default_rng(seed)
    facing = np.array(view_of().from_world)[:3, :3]
    corners = np.array([(-30.0, -20.0, 0.0), (30.0, -20.0, 0.0), (0.0, 40.0, 0.0)])
    turned = [
        np.array(Matrix.Rotation(a, 3, "X") @ Matrix.Rotation(b, 3, "Y"))
        for a, b in random.uniform(-0.1, 0.1, (count, 2))
    ]
    places = [corners @ turn.T + (0.0, 0.0, z) for turn, z in zip(turned, random.uniform(-1.0, 1.0, count))]
    return Triangles(np.array(places) @ facing, random.uniform(0.1, 0.6, count), random.random((count, 3)))


def rays(view: View) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of each pixel, in the space of the view: origins and directions (n, 3) whose third component is -1."""
    width, height = view.size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2.0 - 1.0, (np.arange(height) + 0.5) / height * 2.0 - 1.0)
    matrix = np.asarray(view.projection)
    across = np.stack((x.ravel() / matrix[0, 0], y.ravel() / matrix[1, 1], np.zeros(x.size)), axis=1)
    along = np.tile((0.0, 0.0, -1.0), (x.size, 1))
    return (np.zeros_like(across), across + along) if abs(matrix[3, 3]) < 1e-9 else (across, along)


def expected_fragments(
    fragments: Fragments, view: View, sprites: Sprites | None, triangles: Triangles | None, solids: Any = None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Depth and alpha (pixels, n), and colour (pixels, n, 3), in double precision."""
    origin, along = rays(view)
    turn = np.asarray(view.from_world)
    distances, alphas, colours = [], [], []
    if sprites is not None:
        tau = -np.log1p(-np.minimum(np.asarray(sprites.alpha), 1.0 - 2.0**-20))
        for point, radius, depth, colour in zip(
            *map(np.asarray, (sprites.points, sprites.radius, tau, sprites.colour))
        ):
            centre = turn[:3, :3] @ point + turn[:3, 3]
            q = (origin + along * -centre[2] - centre)[:, :2] / radius
            inside = np.maximum(1.0 - (q**2).sum(axis=1), 0.0)
            chord = radius * np.sqrt(inside)
            solid = np.full(len(along), np.inf) if solids is None else solids
            t = np.clip((solid + centre[2]) / np.maximum(chord, 1e-20), -1.0, 1.0)
            edges = np.linspace(-1.0, 1.0, fragments.slices + 1)
            for start, end in zip(edges, edges[1:]):
                share = np.diff(
                    [(2.0 + 3.0 * x - x**3) / 4.0 for x in (np.full_like(t, start), np.clip(t, start, end))], axis=0
                )[0]
                distances.append(-centre[2] + 0.5 * (start + end) * chord)
                alphas.append(-np.expm1(-depth * inside**1.5 * share))
                colours.append(np.tile(colour, (len(along), 1)))
    if triangles is not None:
        for corners, alpha, colour in zip(*map(np.asarray, (triangles.corners, triangles.alpha, triangles.colour))):
            placed = corners @ turn[:3, :3].T + turn[:3, 3]
            normal = np.cross(placed[1] - placed[0], placed[2] - placed[0])
            distance = ((placed[0] - origin) @ normal) / (along @ normal)
            distances.append(distance)
            before = np.ones(len(along), bool) if solids is None else distance < solids
            alphas.append(np.where(before, alpha, 0.0))
            colours.append(np.tile(colour, (len(along), 1)))
    low, high = fragments.depths(view.from_world)
    depth = (np.stack(distances, axis=1) - low) / (high - low)
    return np.clip(depth, 0.0, 1.0), np.stack(alphas, axis=1), np.stack(colours, axis=1)


def read(picture: Any) -> NDArray[np.float64]:
    import gpu

    width, height = picture.width, picture.height
    pixels = np.empty((height, width, 4), np.float32)
    buffer = gpu.types.GPUFrameBuffer(color_slots=[picture])
    with buffer.bind():
        buffer.read_color(0, 0, width, height, 4, 0, "FLOAT", data=gpu.types.Buffer("FLOAT", pixels.shape, pixels))
    return pixels.reshape(-1, 4).astype(np.float64)


def rmse(one: NDArray[Any], other: NDArray[Any]) -> float:
    assert np.isfinite(one).all()
    return float(np.sqrt(np.mean((one - other) ** 2)))


def drawn(pixels: Any) -> tuple[Fragments, View]:
    """Fragments of the benchmark, each as a triangle about the middle of its pixel, from above."""
    count, each = pixels.depth.shape
    width, height = 50, -(-count // 50)
    number = np.arange(count)
    middle = np.stack((number % width + 0.5, number // width + 0.5), axis=1)
    corners = np.empty((count, each, 3, 3))
    corners[..., :2] = middle[:, None, None] + np.array([(-0.3, -0.3), (0.3, -0.3), (0.0, 0.3)])
    corners[..., 2] = -1.0 - pixels.depth[..., None]
    matrix = np.diag((2.0 / width, 2.0 / height, 2.0 / (NEAR - FAR), 1.0))
    matrix[:3, 3] = -1.0, -1.0, (FAR + NEAR) / (NEAR - FAR)
    triangles = Triangles(corners.reshape(-1, 3, 3), pixels.alpha.ravel(), pixels.colour.reshape(-1, 3))
    return Fragments(None, triangles), View(np.eye(4), matrix, (width, height))


def world_points(view: View, sprites: Sprites) -> list[NDArray[np.float64]]:
    """Where each pixel's ray meets each sprite's plane, in the world."""
    origin, along = rays(view)
    turn = np.asarray(view.from_world)
    out = []
    for point in np.asarray(sprites.points):
        distance = -(turn[2, :3] @ point + turn[2, 3])
        out.append((origin + along * distance - turn[:3, 3]) @ turn[:3, :3])
    return out
