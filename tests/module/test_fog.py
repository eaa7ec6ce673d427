# SPDX-License-Identifier: GPL-3.0-or-later
"""Fog in meshes: closed forms of one scattering, and the reference, which counts how often a mesh winds around a point and
marches in double precision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from test_air import HG, QUAD, SIZE, down, error, judged, look, picture, place

from sfumato import Frame, Mesh, Scene, Visibility

FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box(low: Any = (-1, -1, -1), high: Any = (1, 1, 1)) -> tuple[list[Any], list[Any]]:
    corners = [[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)]
    return corners, [triangle for a, b, c, d in FACES for triangle in ((a, b, c), (a, c, d))]


def arch() -> Mesh:
    """Two legs and a lintel, as one closed mesh with one shell: a prism with a notch."""
    outline = np.array([(-1, -1), (-0.5, -1), (-0.5, 0.4), (0.5, 0.4), (0.5, -1), (1, -1), (1, 1), (-1, 1)], float)
    count = len(outline)
    corners = [(x, y, z) for y in (-0.6, 0.6) for x, z in outline]
    cap = [(0, 1, 2), (0, 2, 7), (2, 3, 7), (3, 6, 7), (3, 4, 6), (4, 5, 6)]  # counterclockwise, seen along +y
    triangles = [*cap, *((count + a, count + c, count + b) for a, b, c in cap)]
    for i in range(count):
        a, b = i, (i + 1) % count
        triangles += [(a, count + a, count + b), (a, count + b, b)]
    return Mesh(corners, triangles)


BOX = Mesh(*box())


def test_what_it_absorbs_and_emits_is_in_closed_form() -> None:
    scene = Scene()
    scene.set_background((3, 2, 1))
    taken, sent = np.array((0.1, 0.4, 1.5)), np.array((0.3, 0.0, 0.2))
    scene.add_fog(BOX, np.eye(4), absorption=taken, emission=sent)
    left = np.exp(-2 * taken)
    wanted = np.array((3, 2, 1)) * left + sent / taken * (1 - left)
    found = picture(scene, down())
    np.testing.assert_allclose(found[..., :3], np.broadcast_to(wanted, (*SIZE, 3)), rtol=2e-5)
    within = picture(scene, look((0, 0, 0), (0, 0, -1), near=1e-3, half=0.3))[5, 5, :3]
    assert np.all(
        np.abs(within / (np.array((3, 2, 1)) * np.exp(-taken) + sent / taken * (1 - np.exp(-taken))) - 1) < 0.01
    )


def test_a_sun_straight_down_is_one_exponential() -> None:
    """Light that has gone d into the fog goes d back."""
    scene = Scene()
    beta = np.array((0.2, 0.7, 2.0))
    scene.add_sun((0, 0, -1), (3, 2, 1))
    scene.add_fog(BOX, np.eye(4), mie=beta, anisotropy=0.4)
    phase = HG * (1 - 0.16) / (1 + 0.16 + 0.8) ** 1.5
    wanted = phase * np.array((3, 2, 1)) * (1 - np.exp(-4 * beta)) / 2
    found = picture(scene, down())[..., :3]
    np.testing.assert_allclose(found, np.broadcast_to(wanted, found.shape), rtol=3e-3)


def test_it_throws_a_shadow() -> None:
    scene = Scene()
    scene.add_sun((0, 0, -1), (1, 1, 1))
    scene.add_instances(QUAD, place((0, 0, -3), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    scene.add_fog(BOX, np.eye(4), absorption=(0.5, 0.5, 0.5))
    found = picture(scene, down(half=0.5))[..., 0]
    np.testing.assert_allclose(found, 0.5 / np.pi * np.exp(-2.0), rtol=2e-3)


LAMPS: dict[str, Callable[[Scene], None]] = {
    "sun": lambda scene: scene.add_sun((0.5, 0.3, -1.0), (5, 4, 3)),
    "outside": lambda scene: scene.add_point((1.5, -1.2, 2.0), (30, 25, 20)),
    "inside": lambda scene: scene.add_point((0.3, 0.1, 0.2), (6, 5, 4)),
    "spot": lambda scene: scene.add_point((0, -0.5, 2.5), (60, 40, 20), direction=(0.1, 0.2, -1), cone=0.5, blend=0.3),
}
BETA: dict[str, Any] = {"mie": (0.4, 0.7, 1.0), "absorption": (0.1, 0.1, 0.1), "anisotropy": 0.4}


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("shape", ["box", "arch"])
def test_lamps_in_fog(lamp: str, shape: str) -> None:
    scene = Scene()
    LAMPS[lamp](scene)
    scene.add_instances(QUAD, place((0, 0, -1.2), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    scene.add_fog(BOX if shape == "box" else arch(), np.eye(4), **BETA)
    camera = look((1.0, -4.5, 1.5), (0, 0, -0.1), half=0.3)
    # Of a spot the edge of its cone lies between samples.
    assert error(picture(scene, camera), judged(scene, camera, 0.1)) < (0.006 if lamp == "spot" else 0.002)


def test_the_eye_is_in_it_and_so_is_a_solid() -> None:
    scene = Scene()
    LAMPS["sun"](scene)
    LAMPS["inside"](scene)
    corners, triangles = box((-0.5, 0.2, -0.6), (-0.1, 0.6, 0.6))
    scene.add_instances(Mesh(corners, triangles), np.eye(4), [[0.3, 0.5, 0.7]])
    scene.add_fog(BOX, np.eye(4), **BETA)
    camera = look((0.2, -0.7, 0.1), (-0.2, 0.5, 0), near=0.01, half=0.8)
    assert error(picture(scene, camera, (16, 16)), judged(scene, camera, 0.05, (16, 16))) < 0.002


def test_places_air_and_other_fog_add() -> None:
    scene = Scene()
    LAMPS["sun"](scene)
    LAMPS["outside"](scene)
    turned = place((0.4, 0.3, 0.2), (0.6, 0.9, 0.7), ((0.8, 0.6, 0), (-0.6, 0.8, 0)))
    mirrored = np.diag([-0.5, 0.8, 0.4, 1.0])
    scene.add_fog(BOX, np.stack([turned, mirrored]), **BETA)
    scene.add_fog(arch(), np.eye(4), rayleigh=(0.1, 0.2, 0.4))
    scene.set_air(mie=(0.02, 0.02, 0.02), anisotropy=0.3)
    camera = look((1.0, -4.5, 1.5), (0, 0, 0), half=0.3, far=8.0)
    assert error(picture(scene, camera), judged(scene, camera, 0.1)) < 0.01


def test_what_is_behind_an_unseen_fog_is_in_its_shadow() -> None:
    scene = Scene()
    scene.add_sun((0, 0, -1), (1, 1, 1))
    scene.add_instances(QUAD, place((0, 0, -3), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    scene.add_fog(BOX, np.eye(4), mie=(0.5, 0.5, 0.5), visibility=Visibility("unseen"))
    frame = Frame(scene)
    found: NDArray[np.float64] = np.asarray(frame.render(down(half=0.5), *SIZE), np.float64)[..., 0]
    np.testing.assert_allclose(found, 0.5 / np.pi * np.exp(-1.0), rtol=2e-3)
    assert not frame.air


@pytest.mark.parametrize("angle", [0.0, 0.0093, 0.2])
@pytest.mark.parametrize("density", [3.0, 30.0])
def test_thick_fog_in_a_sun(density: float, angle: float) -> None:
    """So thick that light does not go straight over as much of it as texels would allow."""
    scene = Scene()
    scene.add_sun((0.3, 0.2, -1), (5, 4, 3), angle=angle)
    scene.add_fog(BOX, np.eye(4), mie=(density,) * 3)
    camera = look((1, -4.5, 1.5), (0, 0, 0), far=8, half=0.3)
    assert error(picture(scene, camera, (8, 8)), judged(scene, camera, 0.02, (8, 8))) < 0.04
