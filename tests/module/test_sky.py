# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is the same from all sides: closed forms, and the reference, which follows each direction by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from test_air import QUAD, SIZE, down, error, judged, look, picture, place, smoke

from sfumato import Frame, Scene, Sky, reference

L = np.array((0.5, 0.25, 0.125))


def under_the_sky(*, floor: bool = False) -> Scene:
    scene = Scene()
    scene.add_sky(L)
    if floor:
        scene.add_instances(QUAD, place((0, 0, 0), (60, 60, 1)), [[0.8, 0.6, 0.4]])
    return scene


def closely(scene: Scene, camera: Any, size: tuple[int, int], **settings: Any) -> NDArray[np.float64]:
    """With a closer look at what one does not tell."""
    return np.asarray(Frame(scene, **settings).render(camera, *size, edge_samples=16), np.float64)


def test_what_is_open_sends_back_its_albedo() -> None:
    found = picture(under_the_sky(floor=True), down())[..., :3]
    np.testing.assert_allclose(found, np.broadcast_to(L * (0.8, 0.6, 0.4), found.shape), rtol=2e-3)


@pytest.mark.parametrize(("samples", "most"), [(16, 0.04), (36, 0.02)])
def test_a_wall_hides_its_part_of_it(samples: int, most: float) -> None:
    """At a distance d from a long wall of height h the floor has (1 + d / sqrt(d^2 + h^2)) / 2 of its light. Neighbouring
    pixels see different parts of it, of which nothing is left to be seen."""
    scene = under_the_sky(floor=True)
    scene.add_instances(QUAD, place((1.0, 0, 0.5), (60, 0.5, 1), ((0, 1, 0), (0, 0, 1))), [[0, 0, 0]])
    found = closely(scene, down(half=0.95, height=0.4), (64, 64), light_samples=samples)[8:-8, :60, 0]
    x = ((np.arange(64) + 0.5) / 32.0 - 1.0)[:60] * 0.95
    off = found / (L[0] * 0.8 * (1.0 + (1.0 - x) / np.hypot(1.0 - x, 1.0)) / 2.0) - 1.0
    assert np.abs(off).max() < most and abs(off.mean()) < 0.25 * most and off.std(axis=0).max() < 0.01


def test_an_upright_wall_over_a_floor_has_half_of_it() -> None:
    """The horizon goes through the middle of what it sees."""
    scene = under_the_sky()
    scene.add_instances(QUAD, place((0, 0, 0), (400, 400, 1)), [[0, 0, 0]])
    scene.add_instances(QUAD, place((0, 0, 5), (5, 5, 1), ((1, 0, 0), (0, 0, 1))), [[1, 1, 1]])
    found = closely(scene, look((0, -8, 5), (0, 0, 5), half=0.3), (32, 32), light_samples=16)
    np.testing.assert_allclose(found[4:-4, 4:-4, 0], 0.5 * L[0], rtol=0.04)
    assert abs(found[..., 0].mean() / (0.5 * L[0]) - 1.0) < 0.015


@pytest.mark.parametrize("eye", [(4.0, -3.0, 0.7), (0.2, 0.1, 0.4)])
def test_smoke_shades_itself_and_the_floor(eye: Any) -> None:
    """It scatters forwards: how much it sends to the eye depends on where the light comes from."""
    scene = under_the_sky()
    smoke(scene)
    scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    camera = look(eye, (-0.5, 0.5, 0.3), far=10.0)
    found = picture(scene, camera, (8, 8), steps_per_cell=2.0, light_samples=36)
    wanted = judged(scene, camera, 0.1, (8, 8), sun_samples_per_axis=12, light_samples_per_axis=12)
    assert error(found, wanted) < 0.06


def test_air_scatters_it_whatever_its_phase_function() -> None:
    scene = under_the_sky()
    beta = np.array((0.05, 0.1, 0.2))
    scene.set_air(mie=beta, anisotropy=0.7)
    found = picture(scene, down())[..., :3]
    np.testing.assert_allclose(found, np.broadcast_to(L * (1.0 - np.exp(-20.0 * beta)), (*SIZE, 3)), rtol=2e-3)


def test_the_judge_adds_up_all_of_it() -> None:
    scene = under_the_sky(floor=True)
    found = np.asarray(reference.render(scene, down(), 2, 2, sun_samples_per_axis=24))[..., :3]
    np.testing.assert_allclose(found, np.broadcast_to(L * (0.8, 0.6, 0.4), found.shape), rtol=2e-3)


# ---- Skies that differ from side to side ----


def directions(height: int, width: int) -> NDArray[np.float64]:
    """Those of the texels' centres, (height, width, 3)."""
    down = np.pi * (np.arange(height) + 0.5)[:, None] / height
    around = 2.0 * np.pi * (0.5 - (np.arange(width) + 0.5)[None] / width)
    x, y = np.sin(down) * np.cos(around), np.sin(down) * np.sin(around)
    return np.stack((x, y, np.broadcast_to(np.cos(down), x.shape)), axis=-1)


def solid_angles(height: int, width: int) -> NDArray[np.float64]:
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return np.repeat((edges[:-1] - edges[1:])[:, None] * 2.0 * np.pi / width, width, axis=1)


def gradient(height: int = 32, width: int = 64) -> NDArray[np.float64]:
    """Warm from one side, blue from above: 1 + a . d in each colour, whose integrals are known."""
    return np.asarray(0.5 * (1.0 + directions(height, width) @ AXES.T))


AXES = np.array(((0.8, 0.0, 0.2), (0.3, 0.3, 0.3), (0.0, -0.2, 0.9)))  # of red, green, blue


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (0, -0.6, 0.8), (-0.6, 0.8, 0)])
def test_a_matt_surface_in_the_open_has_the_mean_by_cosines(normal: Any) -> None:
    """Of 1 + a . d that is 1 + 2/3 a . n (Ramamoorthi and Hanrahan 2001)."""
    n = np.array(normal, np.float64)
    across = np.cross(n, (0.0, 0.3, 0.7))
    across /= np.linalg.norm(across)
    scene = Scene()
    scene.add_sky(Sky(gradient()))
    scene.add_instances(
        QUAD, place((0, 0, 0), (9, 9, 1), (tuple(across), tuple(np.cross(n, across)))), [[0.8, 0.6, 0.4]]
    )
    found = picture(scene, look(tuple(3.0 * n), (0, 0, 0), half=0.2))[..., :3]
    wanted = np.array((0.8, 0.6, 0.4)) * 0.5 * (1.0 + AXES @ n * 2.0 / 3.0)
    np.testing.assert_allclose(found, np.broadcast_to(wanted, found.shape), rtol=4e-3)


def test_the_eye_sees_the_picture_itself() -> None:
    """Every texel where it lies: the middle column is x, a quarter of the way around y."""
    rng = np.random.default_rng(3)
    radiance = rng.uniform(size=(8, 16, 3))
    scene = Scene()
    scene.set_background(Sky(radiance), alpha=1.0)
    for row, column in ((4, 8), (3, 3), (2, 15), (6, 0)):
        towards = directions(8, 16)[row, column]
        found = picture(scene, look((0, 0, 0), tuple(towards), half=1e-3), (2, 2))
        np.testing.assert_allclose(found[0, 0], (*radiance[row, column], 1.0), rtol=2e-2)
    across = picture(scene, look((0, 0, 0), (-1.0, 0.0, 0.0), half=1e-4), (2, 2))[0, 0, :3]
    mean = radiance[3:5][:, (0, 15)].mean(axis=(0, 1))  # over the seam
    np.testing.assert_allclose(across, mean, rtol=2e-2)


def with_a_sun(of: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    radiance, towards = gradient(64, 128), directions(64, 128)
    sun = np.array((0.48, 0.36, 0.8))
    radiance[(towards @ sun) > np.cos(0.06)] += of
    return radiance, sun


def test_what_is_bright_and_narrow_becomes_a_sun() -> None:
    radiance, towards = with_a_sun(400.0)
    (sun,) = Sky(radiance).suns()
    direction, irradiance, angle = sun
    added = ((radiance - gradient(64, 128)) * solid_angles(64, 128)[..., None]).sum(axis=(0, 1))
    assert -direction @ towards > np.cos(0.01)
    np.testing.assert_allclose(irradiance, added, rtol=0.02)
    assert 0.09 < angle < 0.15
    assert not Sky(gradient()).suns()


@pytest.mark.parametrize("of", [0.0, 400.0])
def test_smoke_and_floor_in_it_beside_the_judge(of: float) -> None:
    """Whatever becomes a sun, the sum is the picture's."""
    scene = Scene()
    scene.add_sky(Sky(with_a_sun(of)[0]))
    smoke(scene)
    scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    camera = look((4.0, -3.0, 0.7), (-0.5, 0.5, 0.3), far=10.0)
    found = picture(scene, camera, (8, 8), steps_per_cell=2.0, light_samples=36)
    wanted = judged(scene, camera, 0.1, (8, 8), sun_samples_per_axis=48, light_samples_per_axis=48 if of else 16)
    assert error(found, wanted) < 0.06


def mirrored(alpha: float, to_eye: NDArray[np.float64]) -> NDArray[np.float64]:
    """What GGX's facets (Walter et al. 2007), with heights correlated (Heitz 2014), send of gradient() to the eye of all
    that comes from above: a sum over the half sphere."""
    l = directions(800, 1600)[:400].reshape(-1, 3)
    by = solid_angles(800, 1600)[:400].reshape(-1)
    h = l + to_eye
    h /= np.linalg.norm(h, axis=1)[:, None]
    a2 = alpha**2
    d = a2 / (np.pi * (h[:, 2] ** 2 * (a2 - 1.0) + 1.0) ** 2)

    def smith(cosine: Any) -> Any:
        return (np.sqrt(1.0 + a2 * (1.0 / cosine**2 - 1.0)) - 1.0) / 2.0

    sent = d / (4.0 * to_eye[2] * (1.0 + smith(l[:, 2]) + smith(to_eye[2]))) * by
    return np.asarray(sent @ (0.5 * (1.0 + l @ AXES.T)))


@pytest.mark.parametrize(("alpha", "most"), [(0.01, 0.01), (0.05, 0.02), (0.25, 0.02), (0.5, 0.02), (1.0, 0.03)])
def test_a_metal_in_the_open_mirrors_it(alpha: float, most: float) -> None:
    """Seen from 45 and from 80 degrees."""
    for height, off in ((3.0, most), (0.53, 2.0 * most)):
        scene = Scene()
        scene.add_sky(Sky(gradient()))
        gloss = [[1, 1, 1, 0, alpha, alpha, 0, 1.5]]
        scene.add_instances(QUAD, place((0, 0, 0), (9, 9, 1)), [[0, 0, 0]], gloss=gloss)
        to_eye = np.array((0.0, -3.0, height)) / np.hypot(3.0, height)
        found = picture(scene, look((0, -3.0, height), (0, 0, 0), half=0.002))[..., :3].mean(axis=(0, 1))
        wanted = mirrored(alpha, to_eye) if alpha > 0.02 else 0.5 * (1.0 + AXES @ (to_eye * (-1, -1, 1)))
        assert np.abs(found / wanted - 1.0).max() < off, (height, found / wanted)


def test_a_sun_of_one_texel_is_as_large_as_that() -> None:
    radiance = np.zeros((64, 128, 3))
    radiance[20, 30] = 1e4
    ((direction, irradiance, angle),) = Sky(radiance).suns()
    assert 0.5 * np.pi / 64 < angle < 2.0 * np.pi / 64
    found = []
    for sky in (True, False):
        scene = Scene()
        if sky:
            scene.add_sky(Sky(radiance))
        else:
            scene.add_sun(direction, irradiance, angle)
        gloss = [[1, 1, 1, 0, 0.25, 0.25, 0, 1.5]]
        scene.add_instances(QUAD, place((0, 0, 0), (9, 9, 1)), [[0.5, 0.5, 0.5]], gloss=gloss)
        found.append(picture(scene, look((0, -3.0, 3.0), (0, 0, 0), half=0.5))[..., :3])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-3)


@pytest.mark.parametrize("angle", [1e-30, 1e-8, 1e-5, 1e-3])
def test_a_sun_of_next_to_no_size_is_one_of_none(angle: float) -> None:
    found = []
    for size in (0.0, angle):
        scene = Scene()
        scene.add_sun((0.3, 0.2, -1.0), (3, 3, 3), size)
        gloss = [[1, 1, 1, 0, 0.25, 0.25, 0, 1.5]]
        scene.add_instances(QUAD, place((0, 0, 0), (9, 9, 1)), [[0.5, 0.5, 0.5]], gloss=gloss)
        found.append(picture(scene, look((0, -3.0, 3.0), (0, 0, 0), half=0.5))[..., :3])
    np.testing.assert_allclose(found[0], found[1], rtol=2e-3)


@pytest.mark.parametrize("half_angle", [5.0, 12.0, 20.0, 35.0])
def test_however_wide_what_is_bright_is_all_of_it_gives_light(half_angle: float) -> None:
    """A floor below a disk straight above has pi sin^2 of its radiance."""
    radiance = np.full((128, 256, 3), 0.2)
    within = directions(128, 256)[..., 2] > np.cos(np.radians(half_angle))
    radiance[within] = 20.0
    scene = Scene()
    scene.add_sky(Sky(radiance))
    scene.add_instances(QUAD, place((0, 0, 0), (60, 60, 1)), [[0.8, 0.6, 0.4]])
    found = picture(scene, down())[..., :3].mean(axis=(0, 1))
    by = np.maximum(directions(128, 256)[..., 2], 0.0) * solid_angles(128, 256)
    wanted = np.array((0.8, 0.6, 0.4)) / np.pi * (radiance * by[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(found, wanted, rtol=0.01)


def test_gain_is_strength() -> None:
    def seen(gain: float, by: float) -> NDArray[np.float64]:
        scene = Scene()
        sky = Sky(by * with_a_sun(400.0)[0])
        scene.add_sky(sky, gain=gain)
        scene.set_background(sky, 1.0, gain)
        smoke(scene)
        scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0.5, 0.5, 0.5]])
        camera = look((4.0, -3.0, 0.7), (-0.5, 0.5, 0.3), far=10.0)
        both = picture(scene, camera, (6, 6)), reference.render(scene, camera, 3, 3, sun_samples_per_axis=4)
        return np.concatenate([np.asarray(each)[..., :3].ravel() for each in both])

    np.testing.assert_allclose(seen(3.0, 1.0), seen(1.0, 3.0), rtol=2e-5)


def test_no_sky_is_refused_in_silence() -> None:
    with pytest.raises(ValueError, match="radiance is None"):
        Scene().add_sky(None)  # type: ignore[arg-type]
    for given, said in (
        (np.ones((4, 3)), "shape"),
        (np.ones((0, 8, 3)), "texels"),
        (-np.ones((4, 8, 3)), "flat index 0"),
        (np.full((4, 8, 3), np.nan), "flat index 0"),
    ):
        with pytest.raises(ValueError, match=f"radiance.*{said}"):
            Sky(given)


def test_gloss_under_a_sun_straight_above_has_no_holes() -> None:
    """The sun's axis is the normal, but for rounding, at each point of a ball."""
    rings, spokes = np.linspace(0.0, np.pi, 25)[:, None], np.linspace(0.0, 2.0 * np.pi, 49)[None]
    ball = np.stack(
        (np.sin(rings) * np.cos(spokes), np.sin(rings) * np.sin(spokes), np.cos(rings) + 0.0 * spokes), axis=-1
    ).reshape(-1, 3)
    first = (np.arange(24)[:, None] * 49 + np.arange(48)[None]).reshape(-1)
    corners = np.concatenate(
        (np.stack((first, first + 49, first + 1), 1), np.stack((first + 1, first + 49, first + 50), 1))
    )
    scene = Scene()
    scene.add_sky((0.5, 0.5, 0.5))
    gloss = [[1, 1, 1, 0, 0.02, 0.02, 0, 1.5]]
    scene.add_mesh(ball, corners, ball[corners], np.zeros(len(corners), int), [[0, 0, 0]], gloss=gloss)
    found = picture(scene, look((0, -5.0, 0.3), (0, 0, 0), half=0.24), (48, 48))[..., 0]
    inside = np.hypot(*(np.mgrid[:48, :48] - 23.5)) < 17.0
    assert abs(found[inside] / 0.5 - 1.0).max() < 0.02
