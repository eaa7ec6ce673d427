# SPDX-License-Identifier: GPL-3.0-or-later
"""Diffuse surfaces that are not Lambert's."""

from __future__ import annotations

import numpy as np
import pytest

from sfumato import Camera, Frame, Scene

ALBEDO, UP = 0.7, np.array([0.0, 0.0, 1.0])


def seen(roughness: list[float] | None, towards: np.ndarray, eye: np.ndarray) -> float:
    """The radiance of a floor of two materials, the second of which is looked at, in light from a direction."""
    scene = Scene()
    floor = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
    normals = np.tile(UP, (2, 3, 1))
    scene.add_mesh(
        floor, [[0, 1, 2], [0, 2, 3]], normals, [1, 1], [[0.2] * 3, [ALBEDO] * 3], diffuse_roughness=roughness
    )
    scene.add_sun(-towards, [np.pi] * 3)
    side = np.cross(UP, eye) / np.linalg.norm(np.cross(UP, eye))
    view = np.eye(4)
    view[:3, :3] = side, np.cross(eye, side), eye  # looks from the eye at the origin
    return float(Frame(scene).surfaces(Camera(np.diag([1.0, 1.0, -0.1, 1.0]) @ view), 1, 1)[0, 0, 0])


def burley(towards: np.ndarray, eye: np.ndarray, roughness: float) -> float:
    """Burley (2012), section 5.3, as it stands there."""
    half = (towards + eye) / np.linalg.norm(towards + eye)
    grazing = 0.5 + 2.0 * roughness * float(towards @ half) ** 2
    light, view = ((1.0 - float(d[2])) ** 5 for d in (towards, eye))
    return (1.0 + (grazing - 1.0) * light) * (1.0 + (grazing - 1.0) * view)


def directions(count: int) -> np.ndarray:
    random = np.random.default_rng(3).normal(size=(count, 3))
    random[:, 2] = np.abs(random[:, 2]) * 0.5 + 0.1
    return random / np.linalg.norm(random, axis=1, keepdims=True)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_the_rim_is_burleys(roughness: float) -> None:
    for towards, eye in zip(directions(20), directions(40)[20:]):
        lambert = seen(None, towards, eye)
        assert lambert == pytest.approx(ALBEDO * towards[2], rel=1e-4)
        expected = lambert * burley(towards, eye, roughness)
        assert seen([0.5, roughness], towards, eye) == pytest.approx(expected, rel=1e-4)


def test_a_surface_of_lambert_beside_it_stays_lamberts() -> None:
    for towards, eye in zip(directions(20), directions(40)[20:]):
        assert seen([1.0, -1.0], towards, eye) == pytest.approx(seen(None, towards, eye), rel=1e-6)


@pytest.mark.parametrize("roughness, words", [([0.5], "(1)"), ([0.5, 1.5], "1.5"), ([0.5, float("nan")], "nan")])
def test_what_is_refused(roughness: list[float], words: str) -> None:
    with pytest.raises(ValueError) as refusal:
        seen(roughness, UP, directions(1)[0])
    assert "diffuse_roughness" in str(refusal.value) and words in str(refusal.value)
