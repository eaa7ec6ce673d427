# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen through, drawn by the GPU while a view moves: what the module composites of the same fragments, near to
what the processor sorts, and back to the processor wherever that cannot be."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from unittest import mock

import bpy
import gpu
import harness
import numpy as np
import screen
import sfumato
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray
from sfumato import log, props, ui  # type: ignore[attr-defined]
from sfumato.gpu import fragments as gpu_fragments, shader as gpu_shader
from sfumato.gpu.drawn import view_matrix
from sfumato.gpu.fragments import Fragments, Sprites, Triangles
from sfumato.gpu.transparency import View
from sfumato.view import painter, refinement, sorting
from sprites import expected_fragments, rays, rmse

SIZE = (96, 64)
TOLERANCE = 1e-3
METHODS = {
    "NEAREST": sfumato.composite_nearest,
    "WEIGHTED": sfumato.composite_weighted,
    "FOURIER": sfumato.composite_fourier,
}
KINDS = ("particles", "hair", "sheets")


def frame_of(*kinds: str, seed: int = 3, suns: int = 2, smoke: bool = False) -> Any:
    """A floor and a pillar in two suns, and before and in them what is asked for."""
    random = np.random.default_rng(seed)
    made = sfumato.Scene()
    floor: Any = [(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)]
    pillar: Any = [(0.3, 0, 0), (0.7, 0, 0), (0.7, 0, 2), (0.3, 0, 2)]
    for corners, normal in ((floor, (0, 0, 1)), (pillar, (0, -1, 0))):
        made.add_mesh(corners, [(0, 1, 2), (0, 2, 3)], [[normal] * 3] * 2, [0, 0], [(0.7, 0.6, 0.5)])
    made.set_background((0.3, 0.4, 0.6), alpha=1.0)
    for direction in ((0.5, 0.3, -1.0), (-0.6, 0.5, -1.0))[:suns]:
        made.add_sun(direction, (4.0, 3.5, 3.0))
    if "particles" in kinds:
        points = random.normal(size=(120, 3)) * (0.5, 0.5, 0.4) + (0.0, 0.0, 1.2)
        made.add_particles(
            points, random.uniform(0.15, 0.4, 120), random.uniform(0.02, 0.4, 120), albedo=(0.9, 0.8, 0.7)
        )
    if "hair" in kinds:
        roots = random.uniform(-1.0, 1.0, (150, 3)) * (1.0, 0.6, 0.0)
        points = np.stack((roots, roots + (0.0, 0.0, 0.8), roots + (0.2, 0.0, 1.5)), axis=1)
        first = np.arange(0, 3 * len(roots) + 1, 3)
        made.add_strands(points.reshape(-1, 3), np.full(3 * len(roots), 0.02), first)
    if "sheets" in kinds:
        pane: Any = [(-1.2, -0.8, 0.1), (1.0, -0.5, 0.1), (1.0, -0.5, 1.8), (-1.2, -0.8, 1.8)]
        glass = sfumato.Mesh(pane, [[0, 1, 2], [0, 2, 3]])
        made.add_instances(glass, np.eye(4), albedo=[[0.1, 0.25, 0.3]], transmittance=[[0.5, 0.5, 0.5]])
        made.add_instances(glass, np.array(Matrix.Rotation(0.5, 4, "Z")), albedo=[[0.3, 0.1, 0.1]],
                           transmittance=[[0.6, 0.6, 0.6]])  # fmt: skip
    if smoke:
        made.add_medium(np.ones((4, 4, 4)), np.eye(4), (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
    return sfumato.Frame(made)


def look(way: str = "NEAREST", perspective: bool = True, turn: float = 0.0, **kind: bool) -> painter.Look:
    near, far = 0.1, 40.0
    if perspective:
        projection = Matrix(((1.6, 0, 0, 0), (0, 2.4, 0, 0),
                             (0, 0, (far + near) / (near - far), 2 * far * near / (near - far)), (0, 0, -1, 0)))  # fmt: skip
    else:
        projection = Matrix.Diagonal((0.4, 0.6, 2.0 / (near - far), 1.0))
        projection[2][3] = (far + near) / (near - far)
    eye = Matrix.Rotation(turn, 4, "Z") @ Matrix.Translation((0.4, -4.5, 2.4)) @ Matrix.Rotation(1.25, 4, "X")
    values = tuple(value for row in projection @ eye.inverted() for value in row)
    return painter.Look(values, SIZE, sorting=way, **kind)


def shown(frame: Any, seen: painter.Look, artist: painter.Painter | None = None) -> NDArray[np.float64]:
    """What the GPU draws: (pixels, 3)."""
    artist = artist or painter.Painter()
    picture = artist.picture("test", frame, seen)
    assert picture.buffer is not None, f"drawn by {artist.sorted_by}"
    return screen.read(picture.buffer, 0, SIZE).reshape(-1, 4)[:, :3].astype(np.float64)


def surfaces(frame: Any, seen: painter.Look) -> tuple[NDArray[np.float64], View, NDArray[np.float64]]:
    """The colours of what is opaque, the view, and the distances along it."""
    matrix = np.reshape(seen.matrix, (4, 4))
    from_world = view_matrix(matrix)
    view = View(from_world, matrix @ np.linalg.inv(from_world), SIZE)
    traced = frame.surfaces(seen.camera(), *SIZE, output="opaque").reshape(-1, 4).astype(np.float64)
    origin, along = rays(view)
    near = -np.linalg.inv(np.asarray(view.projection)) @ (0.0, 0.0, -1.0, 1.0)
    start = near[2] / -near[3]
    return traced[:, :3], view, start + traced[:, 3] / np.linalg.norm(along, axis=1)


def cover(strip: NDArray[np.float64]) -> NDArray[np.float64]:
    """The share of Blackman and Harris's filter (1978), 3 pixels wide, that lies on a strip (distance, half its width)."""
    edges = np.clip(0.5 + (strip[:, :1] + strip[:, 1:] * (-1.0, 1.0)) / 3.0, 0.0, 1.0)
    sums = edges.copy()
    for k, a in ((1, -0.48829), (2, 0.14128), (3, -0.01168)):
        sums += a / 0.35875 * np.sin(2.0 * np.pi * k * edges) / (2.0 * np.pi * k)
    return np.where(strip[:, 1] > 0.0, sums[:, 1] - sums[:, 0], 1.0)


def met(view: View, triangles: Triangles, solids: Any) -> tuple[Any, Any, Any]:
    """Where each pixel's ray meets each triangle: distance, alpha (0 beside it), and colour, in double precision."""
    origin, along = rays(view)
    turn = np.asarray(view.from_world)
    distances, alphas, colours = [], [], []
    parts = triangles.corners, triangles.alpha, triangles.colour, triangles.strip
    for corners, alpha, colour, strip in zip(*map(np.asarray, parts)):
        a, b, c = corners.astype(np.float64) @ turn[:3, :3].T + turn[:3, 3]
        normal = np.cross(b - a, c - a)
        facing = along @ normal
        distance = ((a - origin) @ normal) / np.where(facing == 0.0, 1e-30, facing)
        point = origin + along * distance[:, None]
        size = max(normal @ normal, 1e-300)
        u, v = (np.cross(point - a, c - a) @ normal) / size, (np.cross(b - a, point - a) @ normal) / size
        inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance < solids)
        distances.append(distance)

        def between(values: Any, u: Any = u[:, None], v: Any = v[:, None]) -> Any:
            return values[0] + u * (values[1] - values[0]) + v * (values[2] - values[0])

        alphas.append(np.where(inside, alpha * cover(between(strip)), 0.0))
        colours.append(between(colour))
    return np.stack(distances, 1), np.stack(alphas, 1), np.stack(colours, 1)


def composited(frame: Any, seen: painter.Look) -> NDArray[np.float64]:
    """The same picture, of the same fragments, by the module."""
    behind, view, solids = surfaces(frame, seen)
    sprites = Sprites(*frame.sprites(seen.camera()))
    parts = frame.triangles(seen.camera(), *SIZE)
    triangles = Triangles(*parts) if len(parts[0]) else None
    all_of_it = Fragments(sprites, triangles)
    low, high = all_of_it.depths(view.from_world)
    there = list(expected_fragments(all_of_it, view, sprites, None, solids)) if len(all_of_it.points) else None
    if triangles is not None:
        distance, *rest = met(view, triangles, solids)
        of_triangles = [np.clip((distance - low) / (high - low), 0.0, 1.0), *rest]
        there = of_triangles if there is None else [np.concatenate(both, 1) for both in zip(there, of_triangles)]
    made = METHODS[seen.sorting](*there)
    return np.asarray(made[:, :3] + (1.0 - made[:, 3:]) * behind)


def test_it_is_what_the_module_composites() -> None:
    for kinds in (("particles",), ("sheets",), ("hair",), KINDS):
        frame = frame_of(*kinds)
        assert frame.drawable and frame.opaque and frame.sorted
        for perspective in (True, False):
            for way in METHODS if len(kinds) == 1 else ("NEAREST",):
                seen = look(way, perspective)
                error = rmse(shown(frame, seen), composited(frame, seen))
                print(
                    f"  {' and '.join(kinds)}, {way}, {'perspective' if perspective else 'orthographic'}: {error:.1e}"
                )
                assert error <= TOLERANCE


def test_it_is_near_to_what_the_processor_sorts() -> None:
    """Over the pixels where anything is seen through, of their mean."""
    for kinds, limit in ((("particles",), 0.05), (("sheets",), 0.02), (("hair",), 0.05), (KINDS, 0.05)):
        frame = frame_of(*kinds)
        seen = look()
        exact = frame.render(seen.camera(), *SIZE, edge_samples=1).reshape(-1, 4)[:, :3]
        opaque = frame.surfaces(seen.camera(), *SIZE, output="opaque").reshape(-1, 4)[:, :3]
        there = np.abs(exact - opaque).max(-1) > 0.01
        error = {way: rmse(shown(frame, look(way))[there], exact[there]) / exact[there].mean() for way in METHODS}
        print(f"  {' and '.join(kinds)}: " + ", ".join(f"{way} {value:.1%}" for way, value in error.items()))
        assert there.mean() > 0.05
        assert error["NEAREST"] <= limit and error["NEAREST"] <= min(error.values()) * 1.1


harness.main()
