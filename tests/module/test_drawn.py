# SPDX-License-Identifier: GPL-3.0-or-later
"""What a frame tells of what a GPU is to draw: Frame.sprites, Frame.triangles, and surfaces without sheets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sfumato import Camera, Frame, Mesh, Scene

# Straight down from a height of 10, two metres square.
DOWN = Camera(np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, -0.1, 0], [0, 0, 0, 1]]))
PANE = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
FLAT = np.eye(4)


def lifted(height: float) -> Any:
    place = np.eye(4)
    place[2, 3] = height
    return place


def test_sprites_are_lit_as_the_light_that_arrives() -> None:
    """A sun straight from above: E / (4 pi), times what the puffs and the plate above leave."""
    scene = Scene()
    places = np.array([[0, 0, 2], [0, 0, 0], [0.7, 0, 0]])
    scene.add_particles(places, 0.2, [0.5, 0.75, 0.25], albedo=(1, 0.5, 0.25))
    scene.add_sun((0, 0, -1), (4 * np.pi,) * 3)
    plate = Mesh(np.array([[0.4, -1, 5], [1, -1, 5], [1, 1, 5], [0.4, 1, 5]]), [[0, 1, 2], [0, 2, 3]])
    scene.add_instances(plate, FLAT, albedo=[[1, 1, 1]])
    frame = Frame(scene, coefficients=31)
    points, radius, opacity, colour = frame.sprites(DOWN)
    assert points == pytest.approx(places, abs=1e-6)
    assert radius == pytest.approx(0.2) and opacity == pytest.approx([0.5, 0.75, 0.25], abs=1e-6)
    # Of itself each has half before its middle.
    left = np.array([np.sqrt(0.5), 0.5 * np.sqrt(0.25), 0.0])
    np.testing.assert_allclose(colour, left[:, None] * (1, 0.5, 0.25), rtol=0.02, atol=1e-6)
    bare = frame.sprites(DOWN, past_smoke=False)[3]
    np.testing.assert_allclose(bare, np.array([1, 1, 0])[:, None] * (1, 0.5, 0.25), rtol=1e-5, atol=1e-6)


def test_pieces_of_a_sheet_cover_it_and_have_its_light() -> None:
    scene = Scene()
    scene.add_instances(PANE, lifted(1.0), albedo=[[0.2, 0.1, 0.05]], transmittance=[[0.6, 0.6, 0.6]])
    scene.add_sun((0, 0, -1), (np.pi,) * 3)
    frame = Frame(scene)
    corners, opacity, colour, strip = frame.triangles(DOWN, 64, 64)
    edges = corners[:, 1:].astype(float) - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    assert area.sum() == pytest.approx(4.0, rel=1e-5) and area.max() < 0.01
    np.testing.assert_allclose(corners[..., 2], 1.0, atol=1e-6)
    np.testing.assert_allclose(opacity, 0.4, rtol=1e-6)
    assert not strip.any()
    # What it sends is its own, whatever it hides: a picture has just that.
    seen = frame.render(DOWN, 1, 1)[0, 0, :3]
    np.testing.assert_allclose(colour * opacity[:, None, None], np.broadcast_to(seen, colour.shape), rtol=1e-4)


def test_what_mirrors_but_hides_nothing_is_drawn() -> None:
    scene = Scene()
    scene.add_instances(PANE, FLAT, albedo=[[0, 0, 0]], emission=[[0.3, 0.2, 0.1]], transmittance=[[1, 1, 1]])
    _corners, opacity, colour, _strip = Frame(scene).triangles(DOWN, 64, 64)
    assert (opacity > 0.0).all()
    np.testing.assert_allclose((colour * opacity[:, None, None]).reshape(-1, 3)[0], (0.3, 0.2, 0.1), rtol=1e-5)


def test_strips_of_hair_are_wider_than_it_by_what_a_pixel_sees() -> None:
    scene = Scene()
    scene.add_strands([[-0.5, 0, 0], [0.5, 0, 0]], [0.02, 0.02], [0, 2], smooth=False)
    corners, opacity, _colour, strip = Frame(scene).triangles(DOWN, 100, 100)  # of 2 cm
    assert (opacity == 1.0).all()
    np.testing.assert_allclose(strip[..., 1], 1.0, rtol=1e-5)
    np.testing.assert_allclose(np.abs(strip[..., 0]), 2.5, rtol=1e-5)
    np.testing.assert_allclose(np.abs(corners[..., 1]), 0.05, rtol=1e-4)
    assert corners[..., 0].min() == pytest.approx(-0.5, abs=1e-5) and corners[..., 0].max() == pytest.approx(
        0.5, abs=1e-5
    )


def test_opaque_surfaces_have_no_sheets_before_them() -> None:
    def made(pane: bool) -> Any:
        scene = Scene()
        scene.add_instances(PANE, FLAT, albedo=[[0.5, 0.4, 0.3]])
        if pane:  # beside the light
            scene.add_instances(PANE, lifted(1.0), albedo=[[0.9, 0, 0]], transmittance=[[0.5, 0.5, 0.5]])
        scene.add_sun((0, 3.0, -0.3), (5, 5, 5))
        return Frame(scene)

    with_pane, without = made(True), made(False)
    for look in ("surfaces", "glance"):
        bare = getattr(without, look)(DOWN, 4, 4, output="opaque")
        opaque, merged = (getattr(with_pane, look)(DOWN, 4, 4, output=name) for name in ("opaque", "radiance"))
        np.testing.assert_array_equal(bare, getattr(without, look)(DOWN, 4, 4, output="radiance"))
        np.testing.assert_allclose(opaque[1:3, 1:3], bare[1:3, 1:3], rtol=1e-5)
        assert np.abs(merged - opaque)[..., 0].max() > 0.05


@pytest.mark.parametrize(
    ("change", "drawable"),
    [
        (lambda scene: None, True),
        (lambda scene: scene.add_medium(np.ones((4, 4, 4)), FLAT, (1, 1, 1), (0, 0, 0)), False),
        (lambda scene: scene.add_particles([[0, 0, 0]], 1.0, 0.5, extinction=(1, 0.5, 1)), False),
        (lambda scene: scene.add_instances(PANE, FLAT, albedo=[[0, 0, 0]], transmittance=[[0.5, 0.5, 0.5]]), True),
        (lambda scene: scene.add_instances(PANE, FLAT, albedo=[[0, 0, 0]], transmittance=[[0.5, 0.4, 0.5]]), False),
    ],
)  # fmt: skip
def test_only_what_is_grey_and_stands_in_no_grid_is_drawn(change: Any, drawable: bool) -> None:
    scene = Scene()
    scene.add_particles([[0, 0, 0]], 0.5, 0.5)
    scene.add_sun((0, 0, -1), (1, 1, 1))
    change(scene)
    assert Frame(scene).drawable == drawable


def test_nothing_to_draw() -> None:
    frame = Frame(Scene())
    assert frame.drawable
    assert [part.shape for part in frame.sprites(DOWN)] == [(0, 3), (0,), (0,), (0, 3)]
    assert [part.shape for part in frame.triangles(DOWN, 2, 2)] == [(0, 3, 3), (0,), (0, 3, 3), (0, 3, 2)]
    with pytest.raises(ValueError, match="width is 0"):
        frame.triangles(DOWN, 0, 2)
