# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves, which light from behind shines through, and fibres on surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sfumato import Camera, Frame, Mesh, Scene

QUAD = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
DOWN, UP = Camera(np.diag([1.0, 1.0, -0.1, 1.0])), Camera(np.diag([-1.0, 1.0, 0.1, 1.0]))
BLACK, GREEN = [[0.0, 0.0, 0.0]], (0.2, 0.5, 0.1)


def seen(scene: Scene, camera: Camera = DOWN) -> NDArray[np.float32]:
    picture: NDArray[np.float32] = Frame(scene).render(camera, 3, 3)[1, 1, :3]
    return picture


def lit(towards: tuple[float, float, float], **leaf: Any) -> Scene:
    """By a sun of pi."""
    scene = Scene()
    leaf.setdefault("albedo", BLACK)
    scene.add_instances(QUAD, np.eye(4), **leaf)
    scene.add_sun(towards, (np.pi,) * 3)
    return scene


@pytest.mark.parametrize(("sun", "camera"), [((0, 0, 1), DOWN), ((0, 0, -1), UP)])
def test_a_leaf_sends_on_what_falls_on_its_other_side(sun: tuple[float, float, float], camera: Camera) -> None:
    leaf = lit(sun, translucence=[GREEN])
    np.testing.assert_allclose(seen(leaf, camera), GREEN, rtol=1e-5)
    np.testing.assert_allclose(seen(leaf, UP if camera is DOWN else DOWN), 0.0, atol=1e-6)


def test_light_from_aside_falls_on_less_of_it() -> None:
    aside = lit((np.sin(1.0), 0.0, np.cos(1.0)), albedo=[[0.3] * 3], translucence=[GREEN])
    np.testing.assert_allclose(seen(aside), np.cos(1.0) * np.array(GREEN), rtol=1e-5)


def test_what_stands_behind_a_leaf_shades_it() -> None:
    shaded = lit((0, 0, 1), translucence=[GREEN])
    below = np.eye(4)
    below[2, 3] = -1.0
    shaded.add_instances(QUAD, below, [[0.8] * 3])
    np.testing.assert_allclose(seen(shaded), 0.0, atol=1e-6)
    before = lit((0, 0, -1), albedo=[GREEN], translucence=[[0.9] * 3])
    before.add_instances(QUAD, below, [[0.8] * 3])
    np.testing.assert_allclose(seen(before), GREEN, rtol=1e-5)


@pytest.mark.parametrize("through", [0.0, 0.4])
@pytest.mark.parametrize("bounces", [0, 1])
def test_a_sky_lights_both_sides_of_a_leaf(through: float, bounces: int) -> None:
    """Also where light goes between surfaces, by which a sky's then comes, and where the leaf lets some straight through."""
    scene = Scene()
    scene.add_instances(QUAD, np.eye(4), [[0.3] * 3], translucence=[GREEN], transmittance=[[through] * 3])
    scene.add_sky((1.0, 1.0, 1.0))
    scene.set_bounces(diffuse=bounces)
    np.testing.assert_allclose(seen(scene), 0.3 + np.array(GREEN), rtol=1e-3)


@pytest.mark.parametrize("roughness", [0.3, 0.5, 1.0])
def test_of_light_from_all_sides_fibres_send_as_much_as_they_are_said_to(roughness: float) -> None:
    """Seen at 73 degrees. Lambert's lobe, however it is turned and stretched, stays one; what of it is below the surface is
    lost."""
    scene = Scene()
    turned = np.eye(4)
    angle = np.arccos(0.3)
    turned[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    turned[:3, :3] *= 9.0
    scene.add_instances(QUAD, turned, BLACK, sheen=[[0.5, 0.25, 1.0, 7, roughness]])
    scene.add_sky((1.0, 1.0, 1.0))
    np.testing.assert_allclose(seen(scene), (0.5, 0.25, 1.0), rtol=0.06)


def test_burleys_sheen() -> None:
    """pi (1 - cos(half))^5 of Lambert's: from straight above as (1 - cos 30)^5 where the sun stands at 60 degrees."""
    fuzzy = lit((np.sin(np.pi / 3), 0.0, -0.5), sheen=[[1.0, 0.5, 0.0, 5, 0.0]])
    expected = 0.5 * np.pi * (1.0 - np.cos(np.pi / 6)) ** 5
    np.testing.assert_allclose(seen(fuzzy), expected * np.array((1.0, 0.5, 0.0)), rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"translucence": [[1.5, 0.0, 0.0]]}, "translucence"),
        ({"translucence": [[0.5, 0.0]]}, "translucence"),
        ({"sheen": [[1.0, 1.0, 1.0, 4, 0.5]]}, "kind 4"),
        ({"sheen": [[1.0, 1.0, 1.0, 7, 1.5]]}, "roughness 1.5"),
        ({"sheen": [[1.0, 1.0, 1.0]]}, "sheen"),
    ],
)
def test_what_is_wrong_is_named(more: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Scene().add_instances(QUAD, np.eye(4), BLACK, **more)
