# SPDX-License-Identifier: GPL-3.0-or-later
"""A panel of which a plate right before it hides one half: what is left is the panel of the other half, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import sfumato
from sfumato import Camera, Frame, Scene

HEIGHT, HALF = 0.8, np.array([[1.0, 0, 0], [0, 0.6, 0]])
ALBEDO, ALPHA = 0.5, 0.3
SIZE, SPAN = 24, 1.2  # pixels and metres of the picture, from straight above through the panel, which is not seen


def rectangle(scene: Scene, corner: np.ndarray, edges: np.ndarray, albedo: float, gloss: list[float] | None) -> None:
    corners = np.array([corner, corner + edges[0], corner + edges[0] + edges[1], corner + edges[1]])
    normal = np.cross(*edges) / np.linalg.norm(np.cross(*edges))
    normals = np.tile(normal, (2, 3, 1))
    given = [gloss] if gloss else None
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], normals, [0, 0], [[albedo] * 3], given)


def floor_under_a_panel(glossy: bool) -> Scene:
    scene = Scene()
    gloss = [1.0, 1.0, 1.0, 0.0, ALPHA, ALPHA, 0.0, 0.0] if glossy else None
    rectangle(scene, np.array([-5.0, -5, 0]), np.array([[10.0, 0, 0], [0, 10, 0]]), 0.0 if glossy else ALBEDO, gloss)
    scene.add_area((0, 0, HEIGHT), HALF[0], HALF[1], (1, 1, 1))
    rectangle(scene, np.array([0.0, -1, HEIGHT - 1e-3]), np.array([[3.0, 0, 0], [0, 2, 0]]), 0.0, None)
    return scene


def camera() -> Camera:
    """Begins below the plate, so that it sees the floor."""
    matrix = np.diag([2.0 / SPAN, 2.0 / SPAN, -4.0, 1.0])
    matrix[2, 3] = 1.0
    return Camera(matrix)


def points() -> np.ndarray:
    along = (np.arange(SIZE) + 0.5) / SIZE * SPAN - 0.5 * SPAN
    x, y = np.meshgrid(along, along)
    return np.stack([x, y, np.zeros_like(x)], -1)


def left_half() -> np.ndarray:
    return np.array([[-1.0, -0.6, HEIGHT], [0, -0.6, HEIGHT], [0, 0.6, HEIGHT], [-1, 0.6, HEIGHT]])


@pytest.mark.parametrize("glossy", [False, True])
def test_half_of_a_panel_is_left(glossy: bool) -> None:
    """Where the hidden half is what a surface mirrors, or is the nearer one, its share of the light is not its share of
    the area: that alone would be off by up to half of the light."""
    seen = Frame(floor_under_a_panel(glossy)).surfaces(camera(), SIZE, SIZE, edge_samples=256)[..., 0]
    corners = left_half() - points()[..., None, :]
    up = np.array([0.0, 0.0, 1.0])
    if glossy:
        expected = sfumato.microfacet_polygon(corners, up, ALPHA)
    else:
        expected = ALBEDO * np.maximum(
            sfumato.diffuse_polygon(corners, up), sfumato.diffuse_polygon(corners[..., ::-1, :], up)
        )
    error = (seen - expected)[2:-2, 2:-2]
    assert np.abs(error).max() < 0.03 * expected.max() and abs(error.mean()) < 0.003 * expected.mean()
