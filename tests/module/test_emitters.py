# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that glow: polygons that light a floor, in the way of each other or not."""

from __future__ import annotations

import numpy as np
import pytest

import sfumato
from sfumato import Camera, Frame, Scene

ALBEDO, RADIANCE = 0.8, 15.0
FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def cube() -> np.ndarray:
    """The corners (6, 4, 3) of a cube that stands on none of its faces, over the floor."""
    signs = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * 0.35
    turn, _ = np.linalg.qr(np.random.default_rng(7).standard_normal((3, 3)))
    return (signs @ turn + [0.2, 1.0, 1.5])[FACES]


def scene_of(polygons: np.ndarray, solid: bool) -> Scene:
    """A floor in the light of glowing polygons, with the mesh that they are the faces of or without."""
    scene = Scene()
    floor = np.array([[-20.0, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]])
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], np.tile([0, 0, 1.0], (2, 3, 1)), [0, 0], [[ALBEDO] * 3])
    if solid:
        count = len(polygons)
        triangles = (4 * np.arange(count)[:, None] + [0, 1, 2, 0, 2, 3]).reshape(-1, 3)
        normals = np.tile([0, 0, 1.0], (2 * count, 3, 1))
        scene.add_mesh(polygons.reshape(-1, 3), triangles, normals, [0] * 2 * count, [[0, 0, 0]])
    for polygon in polygons:
        scene.add_polygon(polygon, [RADIANCE] * 3)
    return scene


def seen_on_floor(scene: Scene, points: np.ndarray) -> np.ndarray:
    """What the floor sends up at each of points (n, 2)."""
    frame = Frame(scene)
    out = []
    for x, y in points:
        matrix = np.diag([1e4, 1e4, -1.0 / 60.0, 1.0])  # from 60 m above
        matrix[:2, 3] = -1e4 * x, -1e4 * y
        out.append(frame.surfaces(Camera(matrix), 1, 1)[0, 0, 0])
    return np.array(out)


def points() -> np.ndarray:
    """On the floor, but for what the cube hides from above."""
    spread = np.random.default_rng(8).uniform(-4, 4, (1000, 2))
    return spread[np.linalg.norm(spread - [0.2, 1.0], axis=1) > 0.7]


def exactly(polygons: np.ndarray, points: np.ndarray) -> np.ndarray:
    """By Lambert's formula, in double precision; of each face its outer side alone."""
    to_floor = np.column_stack([points, np.zeros(len(points))])[:, None]
    sent = [sfumato.diffuse_polygon(polygon - to_floor, np.array([0.0, 0.0, 1.0])) for polygon in polygons]
    return RADIANCE * ALBEDO * np.sum(sent, axis=0)


def test_every_face_of_a_glowing_cube_that_is_seen_gives_its_light_and_no_other() -> None:
    """Grazing faces too: a ray to a face that is nearly edge-on must not end behind it. From 60 m a point is taken to lie
    0.24 mm above the floor, so that rounding does not hide it from the light."""
    faces = cube()
    expected = exactly(faces, points())
    assert seen_on_floor(scene_of(faces, solid=True), points()) == pytest.approx(expected, rel=3e-4, abs=1e-5)
    everything = expected + exactly(faces[:, ::-1], points())
    assert seen_on_floor(scene_of(faces, solid=False), points()) == pytest.approx(everything, rel=3e-4)
    assert (everything > 1.5 * expected).mean() > 0.5


def test_a_triangle_is_half_of_its_parallelogram() -> None:
    face = cube()[0]
    whole = seen_on_floor(scene_of(face[None], solid=False), points())
    parts = []
    for corners in ([0, 1, 2], [0, 2, 3]):
        part = scene_of(face[None][:0], solid=False)
        part.add_polygon(face[corners], [RADIANCE] * 3)
        parts.append(seen_on_floor(part, points()))
    assert parts[0] + parts[1] == pytest.approx(whole, rel=2e-5, abs=1e-6)


def test_a_polygon_shines_from_both_sides() -> None:
    face = cube()[0]
    there = seen_on_floor(scene_of(face[None], solid=False), points())
    assert seen_on_floor(scene_of(face[None, ::-1], solid=False), points()) == pytest.approx(there, rel=1e-5, abs=1e-7)
    assert there.min() > 0.0


def test_a_glowing_surface_does_not_light_itself() -> None:
    """Whatever the last digits say of the side on which its points lie."""
    scene = Scene()
    plate = np.array([[-1.0, -1, 0.1], [1, -1, 0.7], [1, 1, 0.3], [-1, 1, -0.3]])
    normal = np.cross(plate[1] - plate[0], plate[3] - plate[0])
    normals = np.tile(normal / np.linalg.norm(normal), (2, 3, 1))
    scene.add_mesh(plate, [[0, 1, 2], [0, 2, 3]], normals, [0, 0], [[ALBEDO] * 3])
    scene.add_polygon(plate, [RADIANCE] * 3)
    assert (seen_on_floor(scene, np.random.default_rng(9).uniform(-0.9, 0.9, (200, 2))) == 0.0).all()


@pytest.mark.parametrize("points, inner", [(3, 0.4), (5, 0.4), (12, 1.0)])
def test_a_star_shines_as_the_fan_that_it_is(points: int, inner: float) -> None:
    """Around its middle, which sees all of it, it is triangles."""
    angle = np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2 == 0, 1.0, inner)
    star = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 1.5 + 0.2 * radius * np.cos(angle)])
    whole, fan = scene_of(cube()[:0], solid=False), scene_of(cube()[:0], solid=False)
    whole.add_polygon(star, [RADIANCE] * 3)
    for corner, following in zip(star, np.roll(star, -1, axis=0)):
        fan.add_polygon([[0.0, 0.0, 1.5], corner, following], [RADIANCE] * 3)
    assert seen_on_floor(whole, points_beside()) == pytest.approx(seen_on_floor(fan, points_beside()), rel=1e-4)


def points_beside() -> np.ndarray:
    return np.random.default_rng(10).uniform(-3, 3, (200, 2))


@pytest.mark.parametrize(
    "corners, words",
    [
        ([[0, 0, 0], [1, 0, 0]], "(2, 3)"),
        ([[0, 0, 0]] * 65, "(65, 3)"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], "(2, 0, 0)], which has no area"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], "which is not planar"),
        ([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 0.9, 0]], "crosses itself"),
        ([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], "nan"),
        ([[0, 0, 0], [1, 0, 0], [0, 1e20, 0]], "1e+20"),
    ],
)
def test_corners_that_are_refused(corners: list[list[float]], words: str) -> None:
    with pytest.raises(ValueError) as refusal:
        Scene().add_polygon(corners, (1, 1, 1))
    assert "corners" in str(refusal.value) and words in str(refusal.value), refusal.value


def test_a_radiance_that_is_refused() -> None:
    with pytest.raises(ValueError, match="radiance.*-1"):
        Scene().add_polygon([[0, 0, 3], [1, 0, 3], [0, 1, 3]], (1, -1, 1))
