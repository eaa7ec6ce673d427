# SPDX-License-Identifier: GPL-3.0-or-later
"""Air that fills the world: closed forms of one scattering, and the reference, which marches in double precision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sfumato import Camera, Frame, Mesh, Scene, Visibility, reference

QUAD = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
SIZE = 12, 12
HG = 1.0 / (4.0 * np.pi)


def down(half: float = 0.8, height: float = 10.0) -> Camera:
    """From a height straight down, orthographic, to as far below."""
    return Camera(np.diag([1.0 / half, 1.0 / half, -1.0 / height, 1.0]))


def look(eye: Any, at: Any, near: float = 0.1, far: float = 20.0, half: float = 0.5) -> Camera:
    """Perspective; half is the tangent of half its angle."""
    eye, at = np.asarray(eye, float), np.asarray(at, float)
    back = (eye - at) / np.linalg.norm(eye - at)
    right = np.cross((0.0, 0.0, 1.0) if abs(back[2]) < 0.9 else (0.0, 1.0, 0.0), back)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(back, right), back
    view[:3, 3] = -view[:3, :3] @ eye
    project = np.array(
        [
            [1 / half, 0, 0, 0],
            [0, 1 / half, 0, 0],
            [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)],
            [0, 0, -1, 0],
        ]
    )
    return Camera(project @ view)


def place(at: Any = (0, 0, 0), scale: Any = (1, 1, 1), axes: Any = None) -> NDArray[np.float64]:
    """A square of 2 m in the xy plane, or in that of two axes."""
    matrix = np.eye(4)
    if axes is not None:
        matrix[:3, 0], matrix[:3, 1] = axes
        matrix[:3, 2] = np.cross(*axes)
    matrix[:3, :3] = matrix[:3, :3] * np.asarray(scale, float)
    matrix[:3, 3] = at
    return matrix


def picture(scene: Scene, camera: Camera, size: tuple[int, int] = SIZE, **settings: Any) -> NDArray[np.float64]:
    frame = Frame(scene, **settings)
    return np.asarray(frame.render(camera, *size, edge_samples=1), np.float64)


def judged(scene: Scene, camera: Camera, step: float, size: tuple[int, int] = SIZE, **more: Any) -> NDArray[np.float64]:
    return np.asarray(reference.render(scene, camera, *size, step=step, **more), np.float64)


def error(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> float:
    """Relative root mean square."""
    difference = found[..., :3] - wanted[..., :3]
    return float(np.sqrt(np.mean(difference**2) / np.mean(wanted[..., :3] ** 2)))


def test_none_is_free() -> None:
    scene, none = Scene(), Scene()
    for each in (scene, none):
        each.add_sun((0.3, 0.2, -1), (3, 3, 3))
        each.add_instances(QUAD, place(), [[0.8, 0.7, 0.6]])
    none.set_air(mie=(1, 1, 1))
    none.set_air()
    frames = [Frame(each) for each in (scene, none)]
    pictures = [frame.render(down(), *SIZE) for frame in frames]
    np.testing.assert_array_equal(*pictures)
    assert list(frames[1].stages) == ["solids", "lights", "surfaces", "composite"]
    assert not frames[1].air and not frames[1].sorted


def test_even_air_in_a_sun_is_one_exponential() -> None:
    scene = Scene()
    rayleigh, mie, absorption = np.array((0.01, 0.02, 0.04)), np.array((0.03, 0.03, 0.01)), np.array((0.0, 0.01, 0.02))
    towards = np.array((0.6, 0.0, -0.8))
    scene.add_sun(towards, (3, 2, 1))
    scene.set_background((0.5, 0.25, 0.125))
    scene.set_air(rayleigh, mie, absorption, emission=(0.02, 0.01, 0.0), anisotropy=0.6)
    cosine, g = 0.8 * -1.0, 0.6  # light goes down and on to the eye, which is above
    phases = (
        rayleigh * 3 / (16 * np.pi) * (1 + cosine**2) + mie * HG * (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5
    )
    beta, length = rayleigh + mie + absorption, 20.0
    sent = (phases * (3, 2, 1) + (0.02, 0.01, 0.0)) / beta * (1 - np.exp(-beta * length))
    wanted = sent + np.array((0.5, 0.25, 0.125)) * np.exp(-beta * length)
    frame = Frame(scene)
    found = frame.render(down(), *SIZE)
    np.testing.assert_allclose(found[..., :3], np.broadcast_to(wanted, (*SIZE, 3)), rtol=2e-5)
    assert frame.air and frame.sorted and "air" in frame.stages


def test_cornette_and_shanks_scatter_as_they_say() -> None:
    scene = Scene()
    scene.add_sun((0, 0.6, -0.8), (1, 1, 1))
    scene.set_air(mie=(0.1, 0.1, 0.1), anisotropy=0.5, phase="cornette-shanks")
    cosine, g = -0.8, 0.5
    phase = 3 / (8 * np.pi) * (1 - g * g) * (1 + cosine**2) / ((2 + g * g) * (1 + g * g - 2 * g * cosine) ** 1.5)
    np.testing.assert_allclose(picture(scene, down())[..., 0], phase * (1 - np.exp(-2.0)), rtol=2e-5)


def test_a_wall_with_a_window_leaves_a_shaft() -> None:
    """The sun shines along x through a window from z = 1 to z = 2; the eye looks down from z = 3."""
    scene = Scene()
    scene.add_sun((1, 0, 0), (5, 4, 3))
    upright = (0, 1, 0), (0, 0, 1)
    scene.add_instances(QUAD, place((-2, 0, -1.5), (4, 2.5, 1), upright), [[0, 0, 0]])
    scene.add_instances(QUAD, place((-2, 0, 3.0), (4, 1.0, 1), upright), [[0, 0, 0]])
    beta = np.array((0.1, 0.2, 0.5))
    scene.set_air(mie=beta, anisotropy=0.5)
    found = picture(scene, down(height=3.0), air_texels=2048)[..., :3]
    phase = HG * 0.75 / 1.25**1.5
    wanted = phase * np.array((5, 4, 3)) * (np.exp(-beta) - np.exp(-2 * beta))
    np.testing.assert_allclose(found, np.broadcast_to(wanted, found.shape), rtol=4e-3)


LAMPS: dict[str, Callable[[Scene], None]] = {
    "point": lambda scene: scene.add_point((0.5, 0.3, 1.0), (10, 8, 6)),
    "sphere": lambda scene: scene.add_point((0.5, 0.3, 1.0), (10, 8, 6), radius=0.1),
    "spot": lambda scene: scene.add_point((0, 0, 2.0), (30, 20, 10), direction=(0.2, 0, -1), cone=0.7, blend=0.3),
    "area": lambda scene: scene.add_area((0, 0, 2.5), (0.3, 0, 0), (0, 0.3, 0), (10, 10, 10)),
    "sun": lambda scene: scene.add_sun((0.5, 0.3, -1.0), (5, 4, 3)),
}


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("height", [0.0, 1.5])
def test_lamps_in_open_air(lamp: str, height: float) -> None:
    scene = Scene()
    LAMPS[lamp](scene)
    scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    scene.set_air((0.02, 0.03, 0.05), (0.1, 0.1, 0.1), (0.0, 0.02, 0.0), (0.01, 0, 0), 0.5, scale_height=height)
    camera = look((4.0, -3.0, 0.7), (0.0, 0.0, 0.5), far=12.0)
    wanted = judged(scene, camera, 0.05, light_samples_per_axis=8 if lamp == "area" else 1)
    # Of a lamp with an extent it is those of its parts that are nearest to a ray that are off.
    most = {"area": 0.015, "sphere": 0.005}.get(lamp, 0.001)
    assert error(picture(scene, camera, light_samples=64), wanted) < most


@pytest.mark.parametrize("spot", [False, True])
@pytest.mark.parametrize("eye", [(3.0, -2.0, 1.4), (0.4, 0.9, -2.6), (-0.3, 0.2, 0.1)])
def test_solids_all_around_a_lamp_cut_its_light(eye: Any, spot: bool) -> None:
    """Rays go through all octants about the lamp, where its map is folded, and pass in and out of its plates' shadows."""
    scene = Scene()
    if spot:
        scene.add_point((0.1, 0.0, 0.05), (10, 8, 6), direction=(0.5, 0.4, 0.3), cone=3.0, blend=0.5)
    else:
        scene.add_point((0.1, 0.0, 0.05), (10, 8, 6))
    random = np.random.default_rng(3)
    for _ in range(14):
        n, x = random.normal(size=(2, 3))
        n /= np.linalg.norm(n)
        x -= n * (x @ n)
        x /= np.linalg.norm(x)
        size = random.uniform(0.1, 0.4)
        scene.add_instances(
            QUAD, place(n * random.uniform(0.8, 1.6), (size, size, 1), (x, np.cross(n, x))), [[0, 0, 0]]
        )
    scene.set_air((0.02, 0.03, 0.05), (0.1, 0.1, 0.1), anisotropy=0.5)
    camera = look(eye, (0.0, 0.1, 0.1), far=8.0, half=1.0)
    found = picture(scene, camera, (16, 16), air_texels=2048)
    assert error(found, judged(scene, camera, 0.01, (16, 16))) < 0.003


def smoke(scene: Scene) -> None:
    # So fine that cells are not what differs.
    z, y, x = (np.indices((32, 32, 32)) + 0.5) / 16.0 - 1.0
    density = np.clip(1.0 - x * x - y * y - z * z, 0, None) * 3.0
    matrix = np.diag([0.0625, 0.0625, 0.0625, 1.0])
    matrix[:3, 3] = -1.0, -1.0, -0.5
    scene.add_medium(density, matrix, (1.0, 0.8, 0.6), (0.1, 0.1, 0.2), 0.3)


@pytest.mark.parametrize("eye", [(4.0, -3.0, 0.7), (0.2, 0.1, 0.4)])
@pytest.mark.parametrize("lamp", ["point", "sun"])
def test_smoke_shades_air_and_air_dims_smoke(lamp: str, eye: Any) -> None:
    """The eye outside the smoke and in it."""
    scene = Scene()
    if lamp == "sun":
        scene.add_sun((0.5, 0.3, -1.0), (5, 4, 3))
    else:
        scene.add_point((1.5, 1.0, 2.5), (30, 24, 18))
    smoke(scene)
    scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0.5, 0.5, 0.5]])
    scene.set_air((0.02, 0.03, 0.05), (0.2, 0.2, 0.2), anisotropy=0.4)
    camera = look(eye, (-0.5, 0.5, 0.3), far=10.0)
    found = picture(scene, camera, (8, 8), steps_per_cell=2.0)
    assert error(found, judged(scene, camera, 0.1, (8, 8), sun_samples_per_axis=1)) < 0.01


@pytest.mark.parametrize("height", [10.0, 30.0, 100.0])
def test_rays_that_end_nowhere_in_air_that_ends_with_height(height: float) -> None:
    """Down into air that is as thick as can be, and up to where there is none."""
    camera = look((0, 0, 2), (10, 0, 0.5), far=1000, half=0.4)
    lit, glowing = Scene(), Scene()
    lit.add_sun((0.3, 0.2, -1), (5, 4, 3))
    lit.set_air(mie=(0.02,) * 3, scale_height=height)
    glowing.set_air(absorption=(0.02,) * 3, emission=(0.01,) * 3, scale_height=height)
    for scene in (lit, glowing):
        assert error(picture(scene, camera, (8, 8)), judged(scene, camera, 0.1, (8, 8))) < 1e-5


@pytest.mark.parametrize(("height", "most"), [(0.05, 0.1), (0.2, 0.01)])
def test_a_lamp_over_a_thin_layer(height: float, most: float) -> None:
    scene = Scene()
    scene.add_point((0, 0, 0.5), (10, 8, 6))
    scene.set_air(mie=(0.1,) * 3, anisotropy=0.5, ground=-0.5, scale_height=height)
    camera = look((3, -2, 1.4), (0, 0, 0))
    assert error(picture(scene, camera), judged(scene, camera, 0.01)) < most


@pytest.mark.parametrize("radius", [0.0, 0.05])
def test_a_ray_right_through_a_lamp(radius: float) -> None:
    through, beside = Scene(), Scene()
    for scene, x in ((through, 0.0), (beside, 1e-6)):
        scene.add_point((x, 0, 0), (1, 1, 1), radius=radius)
        scene.set_air(mie=(0.1,) * 3, anisotropy=0.5)
    camera = look((0, -3, 0), (0, 0, 0))
    found, wanted = (picture(scene, camera, (15, 15))[7, 7, 0] for scene in (through, beside))
    assert np.isfinite(found) and (radius == 0.0 or abs(found - wanted) < 1e-4 * wanted)


@pytest.mark.parametrize(("radius", "cone", "most"), [(0.02, 0.4, 0.002), (0.1, 0.2, 0.01), (0.3, 0.4, 0.03)])
def test_spots_with_a_size_shine_beyond_the_cone_of_their_middle(radius: float, cone: float, most: float) -> None:
    scene = Scene()
    scene.add_point((0, 0, 2.5), (30, 20, 10), radius=radius, direction=(0, 0, -1), cone=cone, blend=0.1)
    scene.add_instances(QUAD, place((0, 0, -1), (8, 8, 1)), [[0, 0, 0]])
    scene.set_air(mie=(0.1,) * 3, anisotropy=0.3)
    camera = look((1.5, -2, 0.3), (0, 0, 0.3), far=6, half=0.3)
    wanted = judged(scene, camera, 0.02, light_samples_per_axis=10)
    assert error(picture(scene, camera, light_samples=64), wanted) < most


def test_narrow_beams_are_met() -> None:
    """A cone of 3 degrees that is measured along two axes is the round one; and so narrow a lamp with a grid before it."""
    camera = look((1.5, -2, 0.8), (0, 0, 0.9), far=6)
    pictures = []
    each: tuple[dict[str, Any], ...] = ({}, {"across": ((1, 0, 0), (0, 1, 0))})
    for axes in each:
        scene = Scene()
        scene.add_point((0, 0, 2), (30, 20, 10), direction=(0, 0, -1), cone=0.05, blend=0.3, **axes)
        scene.set_air(mie=(0.1,) * 3, anisotropy=0.3)
        pictures.append(picture(scene, camera, (24, 24)))
    assert pictures[0].max() > 0.0 and error(pictures[1], pictures[0]) < 2e-3
    scene = Scene()
    scene.add_area((0, 0, 2.5), (0.03, 0, 0), (0, 0.03, 0), (1000,) * 3, spread=0.1)
    scene.set_air(mie=(0.1,) * 3, anisotropy=0.3)
    wanted = judged(scene, camera, 0.02, light_samples_per_axis=10)
    assert error(picture(scene, camera, light_samples=64), wanted) < 0.04


@pytest.mark.parametrize(("angle", "anisotropy", "most"), [(0.3, 0.5, 0.005), (0.3, 0.9, 0.05)])
def test_air_tells_where_in_a_soft_sun_its_light_comes_from(angle: float, anisotropy: float, most: float) -> None:
    scene = Scene()
    scene.add_sun((1, 0, -0.1), (5, 4, 3), angle=angle)
    scene.add_instances(QUAD, place((0, 0, -1)), [[0, 0, 0]])
    scene.set_air(mie=(0.1,) * 3, anisotropy=anisotropy)
    camera = look((3, 0, 0), (0, 0, 0.3), far=8)
    wanted = judged(scene, camera, 0.05, (8, 8), light_samples_per_axis=8)
    assert error(picture(scene, camera, (8, 8)), wanted) < most


def test_a_sheet_that_some_points_of_a_lamp_see_edge_on() -> None:
    """The first of its four does."""
    means = []
    for x in (-0.6, -0.59):
        scene = Scene()
        scene.add_area((0, 0, 2.5), (0.8, 0, 0), (0, 0.8, 0), (10, 10, 10))
        sheet = place((x, 0, 0.7), (1.5, 1.5, 1), ((0, 1, 0), (0, 0, 1)))
        unseen = Visibility("unseen")
        scene.add_instances(QUAD, sheet, [[0, 0, 0]], transmittance=[[0.5, 0.5, 0.5]], visibility=unseen)
        scene.add_instances(QUAD, place((0, 0, -1), (3, 3, 1)), [[0, 0, 0]])
        scene.set_air(mie=(0.1,) * 3, anisotropy=0.3)
        means.append(picture(scene, look((4, -3, 0.3), (0, 0, 0.4), far=9, half=0.35), light_samples=4)[..., :3].mean())
    assert abs(means[0] / means[1] - 1.0) < 0.005


def test_a_lamp_that_is_all_there_is_has_its_size_in_air() -> None:
    scene = Scene()
    scene.add_area((0, 0, 2.5), (0.3, 0, 0), (0, 0.3, 0), (10, 10, 10))
    scene.set_air(mie=(0.1,) * 3, anisotropy=0.3)
    camera = look((1.5, -2, 0.8), (0, 0, 0.9), far=6)
    wanted = judged(scene, camera, 0.02, light_samples_per_axis=8)
    assert error(picture(scene, camera, light_samples=64), wanted) < 0.02


def test_a_sheet_stands_in_the_air() -> None:
    """Half way, it leaves half of what is behind; while the camera moves, too."""
    scene = Scene()
    scene.add_instances(QUAD, place(), [[0, 0, 0]], transmittance=[[0.5, 0.25, 1.0]])
    scene.set_air(absorption=(0.1, 0.2, 0.05), emission=(1, 2, 3))
    beta = np.array((0.1, 0.2, 0.05))
    near = np.array((1, 2, 3)) / beta * (1 - np.exp(-10 * beta))
    wanted = near * (1 + np.array((0.5, 0.25, 1.0)) * np.exp(-10 * beta))
    frame = Frame(scene)
    for found in (frame.render(down(), *SIZE, edge_samples=1), frame.glance(down(), *SIZE, spacing=2)):
        np.testing.assert_allclose(np.asarray(found)[..., :3], np.broadcast_to(wanted, (*SIZE, 3)), rtol=1e-4)


def test_air_between_a_lamp_and_a_floor_dims_it() -> None:
    scene = Scene()
    scene.add_point((0, 0, 2), (10, 10, 10))
    scene.add_instances(QUAD, place((0, 0, 0), (3, 3, 1)), [[1, 1, 1]])
    scene.set_air(absorption=(0.3, 0.1, 0.5))
    found = picture(scene, down(half=0.001), (2, 2))[0, 0, :3]
    beta = np.array((0.3, 0.1, 0.5))
    np.testing.assert_allclose(found, 10 / 4 / np.pi * np.exp(-beta * (2 + 10)), rtol=1e-3)


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_the_eye_may_be_in_a_lamp(radius: float) -> None:
    scene = Scene()
    scene.add_point((0, 0, 1), (1, 1, 1), radius=radius)
    scene.set_air(mie=(0.1, 0.1, 0.1), anisotropy=0.9)
    found = picture(scene, look((0, 0, 1), (1, 0, 1), near=0.001))
    assert np.isfinite(found).all() and (found[..., :3] > 0).all()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"anisotropy": 1.0}, "anisotropy"),
        ({"anisotropy": -1.0}, "anisotropy"),
        ({"mie": (-1, 0, 0)}, "mie"),
        ({"rayleigh": (np.inf, 0, 0)}, "rayleigh"),
        ({"absorption": (0, np.nan, 0)}, "absorption"),
        ({"phase": "schlick"}, "phase"),
        ({"scale_height": -1.0}, "scale_height"),
    ],
)
def test_what_is_no_air_is_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Scene().set_air(**dict[str, Any](wrong))
