# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene.add_particles: what a picture of them has to be, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sfumato

# Straight down, one square metre around the origin.
DOWN = sfumato.Camera(np.array([[2.0, 0, 0, 0], [0, 2, 0, 0], [0, 0, -0.1, 0], [0, 0, 0, 1]]))


def picture(scene: sfumato.Scene, size: int = 1) -> Any:
    return sfumato.Frame(scene).render(DOWN, size, size, edge_samples=1)


def particles(*arguments: Any, **others: Any) -> sfumato.Scene:
    scene = sfumato.Scene()
    scene.add_particles(*arguments, **others)
    return scene


def test_a_puff_hides_what_its_opacity_says() -> None:
    assert picture(particles([[0, 0, 0]], 0.2, 0.7))[0, 0].tolist() == pytest.approx([0, 0, 0, 0.7], abs=1e-6)
    stacked = picture(particles([[0, 0, 0], [0, 0, 1]], [0.2, 0.4], [0.5, 0.8]))
    assert stacked[0, 0, 3] == pytest.approx(0.9, abs=1e-6)
    assert picture(particles([[0, 0, 0]], 0.2, 1.0))[0, 0, 3] == pytest.approx(1.0, abs=2e-6)


def test_each_colour_is_taken_by_its_own_extinction() -> None:
    scene = particles([[0, 0, 0]], 0.2, 0.75, extinction=(1, 0.5, 0))
    scene.set_background((1, 1, 1), alpha=1)
    assert picture(scene)[0, 0].tolist() == pytest.approx([0.25, 0.5, 1.0, 1.0], abs=1e-6)


def test_the_light_of_a_sun_behind_the_eye_is_the_closed_form() -> None:
    scene = particles([[0, 0, 0]], 0.2, 0.6, albedo=(0.2, 0.5, 1.0))
    scene.add_sun((0, 0, -1), (np.pi, np.pi, np.pi))
    # Of light that crosses the same depth twice: 1/(4 pi) E int_0^tau exp(-2 t) dt.
    wanted = 0.25 * 0.5 * (1 - 0.4**2) * np.array([0.2, 0.5, 1.0])
    assert picture(scene)[0, 0, :3] == pytest.approx(wanted, rel=0.01)


def test_none_show_nothing() -> None:
    empty: Any = np.zeros((0, 3))
    assert not picture(particles(empty, 0.1, 0.5), 3).any()
    assert not picture(particles(empty, np.zeros(0), np.zeros(0), albedo=empty), 3).any()
    assert not picture(particles([[0, 0, 0]], 0.0, 0.5), 3).any()


def test_maps_are_kept_while_particles_and_lights_stay() -> None:
    prepared = sfumato.Prepared()

    def made(points: Any, light: tuple[float, float, float]) -> int:
        scene = particles(points, 0.2, 0.7)
        scene.add_sun(light, (1, 1, 1))
        sfumato.Frame(scene, prepared=prepared)
        return int(prepared.made["maps"])

    points = np.random.default_rng(0).random((50, 3))
    assert made(points, (0, 0, -1)) == 1
    assert made(points.copy(), (0, 0, -1)) == 1
    assert made(points, (0, 1, -1)) == 2
    points[7, 1] += 0.001
    assert made(points, (0, 1, -1)) == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (dict(points=[[0, 0]]), "points has shape (1, 2)"),
        (dict(points=[[0, 0, np.nan]]), "points holds nan at flat index 2"),
        (dict(radius=[0.1, 0.2]), "radius has shape (2,), but must have (1,)"),
        (dict(radius=-0.5), "radius holds -0.5 at flat index 0"),
        (dict(opacity=[1.5]), "opacity holds 1.5 at flat index 0"),
        (dict(opacity=np.nan), "opacity holds nan"),
        (dict(albedo=(0.5, 2, 0)), "albedo holds 2 at flat index 1"),
        (dict(albedo=np.ones((2, 3))), "albedo has shape (2, 3), but must have (1, 3)"),
        (dict(extinction=(0.5, 0.2, 0)), "extinction is (0.5, 0.2, 0), but that of the strongest colour must be 1"),
        (dict(anisotropy=1.0), "anisotropy is 1"),
        (dict(visibility=sfumato.Visibility("catcher")), "visibility.seen must be 'shown' or 'unseen'"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(arguments: dict[str, Any], said: str) -> None:
    usable: dict[str, Any] = {"points": [[0, 0, 0]], "radius": 0.1, "opacity": 0.5}
    with pytest.raises(ValueError) as refusal:
        particles(**(usable | arguments))
    assert said in str(refusal.value)
