# SPDX-License-Identifier: GPL-3.0-or-later
"""Diffuse surfaces that are not Lambert's."""

from __future__ import annotations

import numpy as np
import pytest

from sfumato import Camera, Frame, Scene

ALBEDO, UP = 0.7, np.array([0.0, 0.0, 1.0])


LAMBERT, BURLEY, GROOVES, AGAIN, DEEPER = range(5)


def floor_of(albedo: float, diffuse: list[tuple[int, float]] | None) -> Scene:
    """A floor of two materials, of which the second is seen."""
    scene = Scene()
    floor = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
    normals = np.tile(UP, (2, 3, 1))
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], normals, [1, 1], [[0.2] * 3, [albedo] * 3], diffuse=diffuse)
    return scene


def from_eye(scene: Scene, eye: np.ndarray) -> float:
    """The radiance at the origin."""
    side = np.cross(UP, eye) / np.linalg.norm(np.cross(UP, eye))
    view = np.eye(4)
    view[:3, :3] = side, np.cross(eye, side), eye
    return float(Frame(scene).surfaces(Camera(np.diag([1.0, 1.0, -0.1, 1.0]) @ view), 1, 1)[0, 0, 0])


def seen(
    diffuse: list[tuple[int, float]] | None, towards: np.ndarray, eye: np.ndarray, albedo: float = ALBEDO
) -> float:
    """In light from a direction."""
    scene = floor_of(albedo, diffuse)
    scene.add_sun(-towards, [np.pi] * 3)
    return from_eye(scene, eye)


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
        assert seen([(LAMBERT, 0.5), (BURLEY, roughness)], towards, eye) == pytest.approx(expected, rel=1e-4)


def test_a_surface_of_lambert_beside_it_stays_lamberts() -> None:
    for towards, eye in zip(directions(20), directions(40)[20:]):
        assert seen([(BURLEY, 1.0), (LAMBERT, 0.0)], towards, eye) == pytest.approx(seen(None, towards, eye), rel=1e-6)


def oren_nayar(towards: np.ndarray, eye: np.ndarray, roughness: float) -> float:
    """Over Lambert's, in the form of Fujii (2012)."""
    between = float(towards @ eye) - towards[2] * eye[2]
    between = between / max(towards[2], eye[2]) if between > 0.0 else between
    return (1.0 + roughness * between) / (1.0 + roughness * (0.5 - 2.0 / (3.0 * np.pi)))


@pytest.mark.parametrize("roughness", [0.0, 0.4, 1.0])
def test_grooves_are_oren_and_nayars(roughness: float) -> None:
    for towards, eye in zip(directions(20), directions(40)[20:]):
        expected = ALBEDO * towards[2] * oren_nayar(towards, eye, roughness)
        assert seen([(LAMBERT, 0.0), (GROOVES, roughness)], towards, eye) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("cosine", [0.35, 0.6, 0.9])
def test_white_grooves_lose_nothing_in_the_end(cosine: float) -> None:
    """In light from all sides they are as bright as that, to every eye."""
    rings, spokes = 16, 14
    scene = floor_of(1.0, [(LAMBERT, 0.0), (AGAIN, 1.0)])
    for height in np.sqrt((np.arange(rings) + 0.5) / rings):  # equal shares of what falls on the floor
        for turn in 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes:
            across = np.sqrt(1.0 - height * height)
            towards = np.array([across * np.cos(turn), across * np.sin(turn), height])
            scene.add_sun(-towards, [np.pi / (height * rings * spokes)] * 3)
    eye = np.array([np.sqrt(1.0 - cosine * cosine), 0.0, cosine])
    assert from_eye(scene, eye) == pytest.approx(1.0, abs=0.004)


@pytest.mark.parametrize("kind", [GROOVES, AGAIN, DEEPER])
def test_grooves_know_no_direction_of_light(kind: int) -> None:
    """Helmholtz: the BRDF is the same with light and eye exchanged."""
    for towards, eye in zip(directions(10), directions(20)[10:]):
        there = seen([(LAMBERT, 0.0), (kind, 0.8)], towards, eye) / towards[2]
        back = seen([(LAMBERT, 0.0), (kind, 0.8)], eye, towards) / eye[2]
        assert there == pytest.approx(back, rel=1e-4)


def test_what_comes_again_is_coloured_again() -> None:
    """The further reflections of a dark surface are its albedo times darker, and coloured once more where asked for."""
    towards, eye = directions(2)

    def again(kind: int, albedo: float) -> float:
        def sent(of: int) -> float:
            return seen([(LAMBERT, 0.0), (of, 1.0)], towards, eye, albedo)

        return (sent(kind) - sent(GROOVES)) / albedo**2

    assert again(AGAIN, 0.02) == pytest.approx(again(AGAIN, 0.01), rel=0.02)
    for albedo in (0.2, 0.9):
        assert again(DEEPER, albedo) == pytest.approx(albedo * again(AGAIN, albedo), rel=1e-3)


def test_grooves_see_all_of_a_lamp() -> None:
    """A wide lamp is the sum of its parts, though grooves send most light back to where it came from."""

    def radiance(cuts: int) -> float:
        scene = floor_of(ALBEDO, [(LAMBERT, 0.0), (AGAIN, 1.0)])
        size = 2.0 / cuts
        for x in (np.arange(cuts) + 0.5) * size - 1.0:
            for y in (np.arange(cuts) + 0.5) * size - 1.0:
                scene.add_area((x, y, 1.0), (0.5 * size, 0, 0), (0, 0.5 * size, 0), [1.0] * 3)
        return from_eye(scene, np.array([0.6, 0.0, 0.8]))

    whole = radiance(1)
    assert whole > 0.1
    assert whole == pytest.approx(radiance(7), rel=0.005)


@pytest.mark.parametrize(
    "diffuse, words",
    [
        ([[BURLEY, 0.5]], "(1, 2)"),
        ([[LAMBERT, 0.0], [BURLEY, 1.5]], "1.5"),
        ([[LAMBERT, 0.0], [BURLEY, float("nan")]], "nan"),
        ([[LAMBERT, 0.0], [5, 0.5]], "kind 5"),
        ([[LAMBERT, 0.0], [0.5, 0.5]], "kind 0.5"),
    ],
)
def test_what_is_refused(diffuse: list[tuple[int, float]], words: str) -> None:
    with pytest.raises(ValueError) as refusal:
        seen(diffuse, UP, directions(1)[0])
    assert "diffuse" in str(refusal.value) and words in str(refusal.value)
