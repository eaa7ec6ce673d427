# SPDX-License-Identifier: GPL-3.0-or-later
"""What smoke emits: against closed forms, and against the judge."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sfumato
from sfumato import Camera, Frame, Grid, Scene

FIRE = np.array([3.0, 1.0, 0.25])


def from_above(half: float = 0.5, middle: float = 0.5) -> Camera:
    """Orthographic, of 10 metres of depth above and below z = 0."""
    return Camera(
        np.array(
            [
                [1 / half, 0, 0, -middle / half],
                [0, 1 / half, 0, -middle / half],
                [0, 0, -0.1, 0],
                [0, 0, 0, 1],
            ]
        )
    )


def box(density: float, absorption: Any, n: int = 64, below: int = 0) -> Scene:
    """A cube of a metre of smoke that glows throughout, `below` of its cells of glow alone."""
    cells = np.full((n, n, n), density, np.float32)
    cells[:below] = 0.0
    scene = Scene()
    scene.add_medium(
        cells,
        np.diag([1 / n, 1 / n, 1 / n, 1]),
        (0, 0, 0),
        np.broadcast_to(absorption, 3),
        glow=np.ones((n, n, n), np.float32),
        emission=np.stack((np.zeros(3), FIRE)),
    )
    return scene


def middle_of(scene: Scene) -> np.ndarray:
    picture: np.ndarray = Frame(scene).render(from_above(0.1), 3, 3)
    return picture[1, 1].astype(np.float64)


@pytest.mark.parametrize("depth", [0.0, 1e-4, 0.3, 2.0, 9.0])
def test_a_uniform_box_sends_what_its_own_depth_leaves(depth: float) -> None:
    """Density and glow fade over the same cell at its ends: (1 - e^-depth) / depth, but for what a cell there takes."""
    red, green, blue, alpha = middle_of(box(1.0, depth))
    mean = -np.expm1(-depth) / depth if depth else 1.0
    np.testing.assert_allclose((red, green, blue), FIRE * mean, rtol=1e-5 + 2e-4 * depth)
    assert alpha == pytest.approx(-np.expm1(-depth), abs=1e-5)


def test_each_colour_is_taken_by_its_own_extinction() -> None:
    depth = np.array([0.5, 1.0, 4.0])
    np.testing.assert_allclose(middle_of(box(1.0, depth))[:3], FIRE * -np.expm1(-depth) / depth, rtol=8e-4)


def test_what_glows_without_smoke_is_seen_behind_smoke() -> None:
    """Seen from above the smoke of the upper half takes of what glows below."""
    depth = 2.0
    sent = FIRE * (-np.expm1(-depth / 2) / depth + 0.5 * np.exp(-depth / 2))
    np.testing.assert_allclose(middle_of(box(1.0, depth, below=32))[:3], sent, rtol=5e-3)


def test_a_mesh_hides_what_glows_behind_it_and_fire_needs_no_light() -> None:
    scene = box(0.0, 0.0)
    corners = [(0, 0, 0.75), (1, 0, 0.75), (1, 1, 0.75), (0, 1, 0.75)]
    scene.add_mesh(corners, [(0, 1, 2), (0, 2, 3)], [[(0, 0, 1)] * 3] * 2, [0, 0], [(0, 0, 0)])
    np.testing.assert_allclose(middle_of(scene)[:3], 0.25 * FIRE, rtol=1e-4)


def test_fire_casts_no_shadow_and_takes_no_light() -> None:
    floor = [(-2, -2, -1), (2, -2, -1), (2, 2, -1), (-2, 2, -1)]
    pictures = []
    for fiery in (True, False):
        scene = box(0.0, 0.0) if fiery else Scene()
        scene.add_mesh(floor, [(0, 1, 2), (0, 2, 3)], [[(0, 0, 1)] * 3] * 2, [0, 0], [(0.5, 0.5, 0.5)])
        scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4))
        scene.add_point((0.5, 0.5, 0.5), (2, 2, 2))
        pictures.append(Frame(scene).render(from_above(1.5), 12, 12)[..., :3])
    fire = pictures[0] - pictures[1]
    assert fire.min() > -1e-5
    np.testing.assert_allclose(fire.sum(axis=(0, 1)), FIRE * 12 * 12 / 9, rtol=0.02)


@pytest.mark.parametrize("filled", [1.0, 0.2])
def test_the_reference_judges_fire_in_smoke(filled: float) -> None:
    """Dense, and in bricks; the glow reaches beyond the smoke."""
    draws = np.random.default_rng(7)
    density = (draws.random((20, 20, 20)) * 0.5).astype(np.float32)
    density[:, :, int(20 * filled) :] = 0.0
    glow = draws.random((20, 20, 20)).astype(np.float32)
    glow[:, int(24 * filled) :] = 0.0
    rows = np.linspace(0.0, 1.0, 128)[:, None] ** np.array([2.0, 3.0, 4.0])
    placed = np.diag([0.05, 0.05, 0.05, 1.0])
    pictures = []
    for emission in (rows, None):
        scene, camera = Scene(), from_above(0.6)
        scene.add_medium(
            density, placed, (4, 6, 8), (1, 1, 1), 0.3, glow=None if emission is None else glow, emission=emission
        )
        scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4))
        expected = sfumato.reference.render(scene, camera, 12, 8, sun_samples_per_axis=1, step=0.01)
        image = Frame(scene, 31, 4.0, 4.0).render(camera, 12, 8, edge_samples=1)
        assert np.abs(image - expected).max() < 0.01 * expected.max()
        pictures.append(expected)
    assert pictures[0][..., :3].sum() > 1.3 * pictures[1][..., :3].sum()
    (medium,) = Frame(_of(Grid(density, glow=glow), placed, rows)).media
    assert medium.glow.max() == glow.max() and medium.glow.sum() == pytest.approx(glow.sum(), rel=1e-5)
    np.testing.assert_array_equal(medium.emission, rows.astype(np.float32))


def _of(grid: Grid, placed: np.ndarray, emission: np.ndarray | None) -> Scene:
    scene = Scene()
    scene.add_medium(grid, placed, (1, 1, 1), (0, 0, 0), emission=emission)
    return scene


def test_the_part_of_a_grid_is_kept_where_another_fire_burns_in_it() -> None:
    grid = Grid(np.ones((4, 4, 4)), glow=np.ones((4, 4, 4)))
    one, other = (middle_of(_of(grid, np.eye(4), np.array([(0, 0, 0), FIRE * power]))) for power in (1.0, 2.0))
    np.testing.assert_allclose(other[:3], 2.0 * one[:3], rtol=1e-5)


def test_what_cannot_burn_is_refused() -> None:
    ones, rows = np.ones((2, 2, 2)), [(0, 0, 0), (1, 1, 1)]

    def refused(message: str, density: Any = ones, **more: Any) -> None:
        with pytest.raises(ValueError, match=message):
            Scene().add_medium(density, np.eye(4), (1, 1, 1), (0, 0, 0), **more)

    refused("no emission that says what", glow=ones)
    refused("no glow that says where", emission=rows)
    refused("no glow that says where", Grid(ones), emission=rows)
    refused("no emission that says what", Grid(ones, glow=ones))
    refused("glow is given beside a Grid", Grid(ones), glow=ones, emission=rows)
    refused("glow holds 1.5 at flat index 0", glow=1.5 * ones, emission=rows)
    refused("glow", glow=np.ones((2, 2, 3)), emission=rows)
    refused("emission begins with", glow=ones, emission=[(0, 1, 0), (1, 1, 1)])
    refused("emission has 1 rows", glow=ones, emission=[(0, 0, 0)])
    refused("emission has 129 rows", glow=ones, emission=np.zeros((129, 3)))
    refused("emission holds -1", glow=ones, emission=[(0, 0, 0), (1, -1, 1)])
    refused("emission holds nan", glow=ones, emission=[(0, 0, 0), (1, np.nan, 1)])
