# SPDX-License-Identifier: GPL-3.0-or-later
"""Gloss over a diffuse surface: what it takes from that, and what its facets send to each other."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sfumato import Camera, Frame, Scene

ANGLES = np.radians([0.0, 20.0, 40.0, 60.0, 75.0, 82.0])
Array = NDArray[np.float64]


def seen(gloss: list[float], albedo: float, angle: float) -> Array:
    """The radiance of a floor, RGB, whose diffuse part alone would be `albedo`, in a sun from straight above."""
    scene = Scene()
    floor = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
    normals = np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3))
    scene.add_mesh(floor, [[0, 1, 2], [0, 2, 3]], normals, [0, 0], [[albedo] * 3], gloss=[gloss])
    scene.add_sun((0, 0, -1), [np.pi] * 3)
    eye = np.array([np.sin(angle), 0.0, np.cos(angle)])
    view = np.eye(4)
    view[:3, :3] = (0.0, 1.0, 0.0), np.cross(eye, (0.0, 1.0, 0.0)), eye  # looks from the eye at the origin
    return np.asarray(Frame(scene).surfaces(Camera(np.diag([1.0, 1.0, -0.1, 1.0]) @ view), 1, 1)[0, 0, :3], float)


def kept(gloss: list[float]) -> Array:
    """The share of what is diffuse that is left, at all angles."""
    return np.array([(seen(gloss, 0.5, a) - seen(gloss, 0.0, a))[0] / 0.5 for a in ANGLES])


def row(
    alpha: float, f0: float, index: float, lossless: bool = False, cover: float = 0.0, edge: float = 1.0
) -> list[float]:
    return [f0, f0, f0, edge, alpha, alpha, 0.0, index, float(lossless), cover]


def fresnel(cosine: Array, index: float) -> Array:
    """By Snell's law, as the textbooks have it."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    within = (index * cosine - inside) / (index * cosine + inside)
    return np.asarray(0.5 * (across**2 + within**2))


def reflected(alpha: float, angle: float, index: float | None) -> float:
    """Of light from all sides by GGX facets, each of them once: an integral over their normals; without index for F = 1."""
    eye = np.array([np.sin(angle), 0.0, np.cos(angle)])
    count = 400
    share = (np.arange(count) + 0.5) / count
    lean = np.arctan(alpha * np.sqrt(share / (1.0 - share)))[:, None]  # equal parts of D cos
    turn = (2.0 * np.pi * share)[None, :]
    normals = np.stack(np.broadcast_arrays(np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)), -1)
    towards = normals @ eye
    light = 2.0 * towards[..., None] * normals - eye

    def smith(cosine: Array) -> Array:
        tangent2 = 1.0 / np.clip(cosine, 1e-9, 1.0) ** 2 - 1.0
        return np.asarray(0.5 * (np.sqrt(1.0 + alpha**2 * tangent2) - 1.0))

    lit = (towards > 0.0) & (light[..., 2] > 0.0)
    masking = 1.0 / (1.0 + smith(np.array(eye[2])) + smith(light[..., 2]))
    weight = np.where(lit, masking * towards / (eye[2] * normals[..., 2]), 0.0)
    return float((weight if index is None else weight * fresnel(np.clip(towards, 0.0, 1.0), index)).mean())


@pytest.mark.parametrize("alpha", [0.04, 0.25, 1.0])
@pytest.mark.parametrize("index", [1.2, 1.5, 2.0])
def test_what_is_reflected_is_missing_below(alpha: float, index: float) -> None:
    """What facets lose to each other counts as if it were not lost."""
    f0 = ((index - 1.0) / (index + 1.0)) ** 2
    expected = [1.0 - reflected(alpha, angle, index) / reflected(alpha, angle, None) for angle in ANGLES]
    assert kept(row(alpha, f0, index, cover=index)) == pytest.approx(expected, abs=0.008)


@pytest.mark.parametrize("alpha", [0.25, 1.0])
def test_without_losses_both_layers_send_on_all_light(alpha: float) -> None:
    """Of a white surface: what the gloss reflects, by the factor that the picture shows, and what is left below it."""
    gloss = row(alpha, 0.04, 1.5, lossless=True, cover=1.5)
    gain = [seen(gloss, 0.0, a)[0] / seen(row(alpha, 0.04, 1.5), 0.0, a)[0] for a in ANGLES]
    once = [reflected(alpha, angle, 1.5) for angle in ANGLES]
    assert min(gain) > 1.0
    assert kept(gloss) + np.multiply(gain, once) == pytest.approx(np.ones(len(ANGLES)), abs=0.004)


@pytest.mark.parametrize("alpha", [0.25, 1.0])
def test_a_white_mirror_loses_nothing(alpha: float) -> None:
    for angle in ANGLES:
        gain = seen(row(alpha, 1.0, 0.0, lossless=True), 0.0, angle) / seen(row(alpha, 1.0, 0.0), 0.0, angle)
        assert gain * reflected(alpha, angle, None) == pytest.approx(np.ones(3), abs=0.01)


def test_a_coloured_mirror_deepens_its_colour() -> None:
    """What was reflected twice was coloured twice."""
    once, again = ([0.9, 0.5, 0.1, 0.0, 1.0, 1.0, 0.0, 0.0, lossless, 0.0] for lossless in (0.0, 1.0))
    gain = seen(again, 0.0, 0.3) / seen(once, 0.0, 0.3)
    assert gain[0] > 1.2 * gain[1] > 1.2 * gain[2] > 1.2


def test_rows_without_layers_take_nothing() -> None:
    plain = row(0.25, 0.04, 1.5)
    assert kept(plain) == pytest.approx(np.ones(len(ANGLES)), rel=1e-5)
    assert (seen(plain, 0.5, 0.3) == seen(plain[:8], 0.5, 0.3)).all()


@pytest.mark.parametrize(
    "gloss, words",
    [
        (row(0.25, 0.04, 1.5)[:9], "(1, 9)"),
        (row(0.25, 0.04, 1.5, cover=0.5), "0.5 at flat index 9"),
        ([*row(0.25, 0.04, 1.5)[:8], 2.0, 1.5], "2 at flat index 8"),
    ],
)
def test_what_is_refused(gloss: list[float], words: str) -> None:
    with pytest.raises(ValueError) as refusal:
        seen(gloss, 0.5, 0.0)
    assert "gloss" in str(refusal.value) and words in str(refusal.value)
