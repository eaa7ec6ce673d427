# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that surfaces send to each other, where its amount is known: in rooms that glow, and in mirrors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sfumato import Camera, Frame, Scene

FACES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def add_box(scene: Scene, low: tuple[float, ...], high: tuple[float, ...], **material: Any) -> None:
    """A box, seen from both sides."""
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    vertices = np.array(low) + vertices * (np.array(high) - np.array(low))
    triangles = np.concatenate([FACES[:, [0, 1, 2]], FACES[:, [0, 2, 3]]])
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    scene.add_mesh(vertices, triangles, np.repeat(normals[:, None], 3, axis=1), np.zeros(len(triangles)), **material)


def looking(eye: tuple[float, ...], at: tuple[float, ...], up: tuple[float, ...] = (0, 0, 1)) -> Camera:
    """A perspective camera of 80 degrees."""
    back = np.array(eye, float) - np.array(at, float)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(back, right), back
    view[:3, 3] = -view[:3, :3] @ np.array(eye)
    near, far, focal = 0.01, 100.0, 1.0 / np.tan(np.radians(40.0))
    project = np.zeros((4, 4))
    project[0, 0] = project[1, 1] = focal
    project[2, 2:] = (far + near) / (near - far), 2.0 * far * near / (near - far)
    project[3, 2] = -1.0
    return Camera(project @ view)


@pytest.mark.parametrize("bounces", [0, 1, 4, 40])
def test_a_glowing_room_sums_a_geometric_series(bounces: int) -> None:
    albedo, scene = np.array((0.8, 0.5, 0.2)), Scene()
    add_box(scene, (-2, -2, 0), (2, 2, 3), albedo=[albedo], emission=[(1, 1, 1)])
    scene.set_bounces(diffuse=bounces)
    picture = Frame(scene).render(looking((-1.5, -1.5, 1.2), (1, 1, 1.5)), 48, 32)[..., :3]
    # Each point sees nothing but walls. What they send first is a lamp's light, which goes between surfaces after that.
    wanted = sum(albedo**k for k in range(bounces + 2 if bounces else 1))
    np.testing.assert_allclose(picture, np.broadcast_to(wanted, picture.shape), rtol=2e-3)


def test_what_a_wall_sends_to_another_is_its_form_factor() -> None:
    # A matt plate under a small glowing one that faces it, far from its edges: Lambert's law over a disk, whose form factor
    # from a point below its middle is r^2 / (r^2 + h^2).
    scene, radius, height = Scene(), 1.0, 1.0
    scene.add_mesh([[-9, -9, 0], [9, -9, 0], [0, 18, 0]], [[0, 1, 2]], [[[0, 0, 1]] * 3], [0], [(0.5, 0.5, 0.5)])
    turns = np.linspace(0.0, 2.0 * np.pi, 65)[:-1]
    ring = np.column_stack([radius * np.cos(turns), radius * np.sin(turns), np.full(64, height)])
    fan = [[0, i, i + 1] for i in range(1, 63)]
    scene.add_mesh(ring, fan, [[[0, 0, -1]] * 3] * 62, [0] * 62, [(0, 0, 0)], emission=[(2, 2, 2)])
    scene.set_bounces(diffuse=1)
    picture = Frame(scene).render(looking((0, 0.3, 0.3), (0, 0, 0)), 65, 65)
    wanted = 0.5 * 2.0 * radius**2 / (radius**2 + height**2)
    assert picture[28:37, 28:37, :3].mean() == pytest.approx(wanted, rel=0.03)


def mirrored_scene(mirror: bool, smoke: bool) -> Scene:
    scene = Scene()
    if mirror:
        gloss = [[1, 1, 1, 0, 1e-4, 1e-4, 0, 0]]
        corners = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], [[[0, 0, 1]] * 3] * 2, [0, 0], [(0, 0, 0)], gloss=gloss)
    add_box(scene, (-1, -0.5, 0.5), (0.5, 0.5, 1.5), albedo=[(0.8, 0.3, 0.1)])
    if smoke:
        place = np.diag([0.25, 0.25, 0.25, 1.0])
        place[:3, 3] = 0.3, -1.5, 0.2
        density: NDArray[np.float64] = np.linspace(0.0, 1.0, 8)[:, None, None] * np.ones((8, 8, 8))
        scene.add_medium(density, place, scattering=(1, 1, 1), absorption=(0.2, 0.2, 0.2))
    scene.add_sun((0.3, 0.6, -0.6), irradiance=(6, 6, 6), angle=0.0)
    scene.set_bounces(gloss=True)
    return scene


@pytest.mark.parametrize("smoke", [False, True])
def test_a_mirror_shows_what_a_mirrored_eye_sees(smoke: bool) -> None:
    eye, at = (0.5, -3.0, 2.0), (0.0, 0.2, -0.5)
    scene = mirrored_scene(True, smoke)
    there = Frame(scene).render(looking(eye, at), 64, 64)[..., :3]
    scene.set_bounces()
    black = Frame(scene).render(looking(eye, at), 64, 64)[..., :3]
    other = looking((eye[0], eye[1], -eye[2]), (at[0], at[1], -at[2]), up=(0, 0, -1))
    alone = Frame(mirrored_scene(False, smoke)).render(other, 64, 64)[:, ::-1, :3]
    # The mirror, but for where box and smoke are seen themselves, or the sun in it.
    own = black.max(axis=2) > 0.03
    for axis in (0, 1):
        own |= np.roll(own, 1, axis) | np.roll(own, -1, axis)
    shown = ~own & (alone.max(axis=2) > 0.0)
    assert shown.sum() > 100 and alone[shown].mean() > 0.05
    assert black[shown].max() < 0.03
    assert np.abs(there - alone)[shown].mean() < 0.03 * alone[shown].mean()


@pytest.mark.parametrize("samples", [1, 4, 16, 64])
def test_a_mirror_in_an_even_room_is_even(samples: int) -> None:
    # Whatever its facets show, and however often they are asked.
    scene = Scene()
    add_box(scene, (-2, -2, 0), (2, 2, 3), albedo=[(0, 0, 0)], emission=[(1, 1, 1)])
    gloss = [[0.9, 0.9, 0.9, 0, 0.01, 0.01, 0, 0]]
    add_box(scene, (-0.5, -0.5, 0.5), (0.5, 0.5, 1.5), albedo=[(0, 0, 0)], gloss=gloss)
    scene.set_bounces(gloss=True)
    picture = Frame(scene).render(looking((1.5, 1.3, 1.2), (0, 0, 1)), 64, 48, edge_samples=samples)[..., 0]
    assert picture.min() > 0.885 and picture[20:28, 28:36].max() < 0.91 and picture.max() < 1.001


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_a_sky_counts_once(bounces: int) -> None:
    scene = Scene()
    scene.add_mesh([[-9, -9, 0], [9, -9, 0], [0, 18, 0]], [[0, 1, 2]], [[[0, 0, 1]] * 3], [0], [(0.5, 0.25, 1.0)])
    scene.add_sky((2, 2, 2))
    scene.set_bounces(diffuse=bounces)
    picture = Frame(scene).render(looking((0, 0.3, 2), (0, 0, 0)), 16, 16)[4:12, 4:12, :3]
    np.testing.assert_allclose(picture, np.broadcast_to((1.0, 0.5, 2.0), picture.shape), rtol=2e-3)


def test_a_picture_does_not_hang_on_what_was_seen_before() -> None:
    scene = Scene()
    add_box(scene, (-2, -2, 0), (2, 2, 3), albedo=[(0.7, 0.7, 0.7)])
    scene.add_point((0, 0, 2.5), (5, 5, 5), radius=0.1)
    scene.set_bounces(diffuse=2)
    first, second = looking((-1.5, -1.5, 1.2), (1, 1, 1.5)), looking((1.5, 0, 1.2), (0, 0, 0))
    frame = Frame(scene)
    once = frame.render(first, 32, 24)
    frame.render(second, 32, 24)
    np.testing.assert_array_equal(frame.render(first, 32, 24), once)
