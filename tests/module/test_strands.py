# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair in a frame: what it covers of pixels, in what order, and what it costs. How it shades is the business of the C++
tests, and of those beside Cycles."""

from __future__ import annotations

import resource
from typing import Any

import numpy as np
import pytest
import sfumato
from numpy.typing import NDArray

Array = NDArray[Any]
SIZE = 32  # pixels, and metres of the picture's width


def camera() -> sfumato.Camera:
    """From above on [-16, 16]^2: a metre a pixel."""
    projection = np.diag([2.0 / SIZE, 2.0 / SIZE, -1.0 / 50.0, 1.0])
    return sfumato.Camera(projection)


def covered(*strands: tuple[Array, Array], samples: int = 1, smooth: bool = True, **more: Any) -> Array:
    """The alpha that strands of (points, radii) leave of pixels."""
    scene = sfumato.Scene()
    first = np.cumsum([0] + [len(points) for points, _ in strands])
    points, radii = (np.concatenate([each[i] for each in strands]) for i in (0, 1))
    scene.add_strands(points, radii, first, smooth=smooth, **more)
    picture: Array = sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=samples)
    return picture[..., 3]


def line(start: tuple[float, ...], end: tuple[float, ...], radius: float, keys: int = 2) -> tuple[Array, Array]:
    share = np.linspace(0.0, 1.0, keys)[:, None]
    return np.array(start) * (1.0 - share) + np.array(end) * share, np.full(keys, radius)


@pytest.mark.parametrize("radius", [0.001, 0.2, 2.5])
@pytest.mark.parametrize("samples", [1, 16])
@pytest.mark.parametrize("end", [(8.0, 0.3, 0.0), (5.0, 9.0, 0.0)])
def test_a_strand_covers_its_area(radius: float, samples: int, end: tuple[float, ...]) -> None:
    """As far as the filter's weights at pixels add up to one: those of thin lines vary by 2 %."""
    start = (-8.2, -0.1, 0.0)
    length = float(np.linalg.norm(np.subtract(end, start)))
    area = covered(line(start, end, radius), samples=samples).sum(dtype=float)
    assert area == pytest.approx(2.0 * radius * length, rel=0.03)


def test_joints_count_once() -> None:
    whole = covered(line((-8.0, -3.0, 0.0), (8.0, 5.0, 0.0), 0.7))
    for keys in (3, 9, 200):
        cut = covered(line((-8.0, -3.0, 0.0), (8.0, 5.0, 0.0), 0.7, keys))
        assert np.abs(cut - whole).max() < 1e-3, keys


def test_a_corner_neither_gapes_nor_overlaps() -> None:
    """Of a bent strand all pixels along its middle are full, and the area is that of both its legs."""
    points = np.array([[-9.0, -6.0, 0.0], [0.3, 0.2, 0.0], [2.0, 10.0, 0.0]])
    alpha = covered((points, np.full(3, 2.0)), smooth=False)
    for share in np.linspace(0.3, 0.7, 9):
        for a, b in ((points[0], points[1]), (points[1], points[2])):
            x, y, _ = a + (b - a) * share + SIZE / 2
            assert alpha[int(y), int(x)] > 0.999
    legs = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert alpha.sum(dtype=float) == pytest.approx(4.0 * legs, rel=0.02)


def test_smooth_strands_are_curves_and_straight_ones_not() -> None:
    """Catmull and Rom's curve passes .125 of the key distance above the middle of its outer legs' corner."""
    keys = np.array([[-12.0, -8.0, 0.0], [-4.0, 8.0, 0.0], [4.0, 8.0, 0.0], [12.0, -8.0, 0.0]])
    middle = np.array([0.0, 8.0 + 16.0 / 8.0, 0.0])  # -1/16 of each outer key, 9/16 of each inner one
    pixel = (int(middle[1] + SIZE / 2), SIZE // 2)
    curve = covered((keys, np.full(4, 0.5)))
    straight = covered((keys, np.full(4, 0.5)), smooth=False)
    assert curve[pixel] > 0.4 and straight[pixel] < 0.05
    assert straight[int(8.0 + SIZE / 2), SIZE // 2] > 0.4 and curve[int(8.0 + SIZE / 2), SIZE // 2] < 0.2


def lamplit(*, hair_at: float) -> Array:
    scene = sfumato.Scene()
    scene.add_sun((0, 0, -1), (3, 3, 3))
    corners = [[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]]
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], [[[0, 0, 1]] * 3] * 2, [0, 0], [[0.5, 0.0, 0.0]])
    points, radius = line((-20.0, 0.0, hair_at), (20.0, 0.0, hair_at), 4.0)
    scene.add_strands(points, radius, [0, 2], matt=[[0, 0.5, 0, 0, 0, 0, 0.3]])
    picture: Array = sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=1)
    return picture[SIZE // 2, SIZE // 2]


def test_what_is_nearer_hides() -> None:
    assert lamplit(hair_at=-1.0)[0] > 0.1 and lamplit(hair_at=-1.0)[1] == 0.0
    assert lamplit(hair_at=1.0)[1] > 0.1 and lamplit(hair_at=1.0)[0] < 0.02


def test_what_is_nearer_only_here_hides_too() -> None:
    """A strand that begins nearer to the eye, and is opaque, but lies behind another one in the middle."""
    scene = sfumato.Scene()
    scene.add_sun((0, 0, -1), (3, 3, 3))
    points = np.array([[-15, 0, 40], [15, 0, -40], [-15, 0.01, 10], [15, 0.01, 10]])
    matt = [[0.5, 0, 0, 0, 0, 0, 0.3], [0, 0.5, 0, 0, 0, 0, 0.3]]
    scene.add_strands(points, [1.5] * 4, [0, 2, 4], matt=matt, material=[0, 1], smooth=False)
    picture: Array = sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=1)
    red, green, _, alpha = picture[SIZE // 2, SIZE // 2]
    assert alpha > 0.99 and green > 20.0 * red, picture[SIZE // 2, SIZE // 2]


def test_a_pane_dims_the_hair_behind_it() -> None:
    seen = []
    for left in (1.0, 0.1):
        scene = sfumato.Scene()
        scene.add_sun((0, 0, -1), (3, 3, 3))
        points, radius = line((-20.0, 0.0, 0.0), (20.0, 0.0, 0.0), 4.0)
        scene.add_strands(points, radius, [0, 2], matt=[[0.5, 0.5, 0.5, 0, 0, 0, 0.3]])
        corners = [[-90, -90, 70], [90, -90, 70], [90, 90, 70], [-90, 90, 70]]  # behind the eye
        if left < 1.0:
            scene.add_mesh(
                corners, [[0, 1, 2], [0, 2, 3]], [[[0, 0, 1]] * 3] * 2, [0, 0], [[0, 0, 0]], transmittance=[[left] * 3]
            )
        seen.append(sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=1)[SIZE // 2, SIZE // 2, 0])
    assert seen[1] / seen[0] == pytest.approx(0.1, rel=1e-3)


def test_the_shadow_of_hair_is_not_the_smokes() -> None:
    """It is in other renderers' pictures, too."""
    shadows = {}
    for hair in (False, True):
        scene = sfumato.Scene()
        scene.add_sun((0.6, 0, -1), (3, 3, 3))
        corners = [[-20, -20, -8], [20, -20, -8], [20, 20, -8], [-20, 20, -8]]
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], [[[0, 0, 1]] * 3] * 2, [0, 0], [[0.5] * 3])
        if hair:
            points, radius = line((-4.8, -20.0, 0.0), (-4.8, 20.0, 0.0), 2.0)
            scene.add_strands(points, radius, [0, 2])
        frame = sfumato.Frame(scene)
        passes = frame.passes(camera(), SIZE, SIZE, ["smoke_shadow"], edge_samples=1)
        lit = frame.surfaces(camera(), SIZE, SIZE)[SIZE // 2, SIZE // 2, 0]
        shadows[hair] = lit, passes["smoke_shadow"][SIZE // 2, SIZE // 2].min()
    assert shadows[True][0] < 0.9 * shadows[False][0]
    assert shadows[True][1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("at", [[0.0, 0.0, 0.0], [900.0, 900.0, 900.0]])
def test_what_has_no_extent_does_no_harm(at: list[float]) -> None:
    for lamp in ("sun", "point"):
        scene = sfumato.Scene()
        if lamp == "sun":
            scene.add_sun((0, 0, -1), (3, 3, 3))
        else:
            scene.add_point((1, 2, 30), (3, 3, 3), 0.1)
        scene.add_strands([at, at, [at[0], at[1] + 1.0, at[2]]], [0.0] * 3, [0, 2, 3], smooth=False)
        scene.add_strands([at, [at[0] + 1.0, at[1], at[2]]], [0.0] * 2, [0, 2], smooth=False)
        scene.add_particles([at], 1e-20, 0.5)
        scene.add_particles([at], 2e-5, 0.5)
        corners = [[-20, -20, -8], [20, -20, -8], [20, 20, -8], [-20, 20, -8]]
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], [[[0, 0, 1]] * 3] * 2, [0, 0], [[0.5] * 3])
        assert np.isfinite(sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=1)).all()


def test_a_matt_strand_is_lambert_s_cylinder() -> None:
    """Lit from the eye, in its middle: albedo over pi of the irradiance."""
    assert lamplit(hair_at=1.0)[1] == pytest.approx(3.0 * 0.5 / np.pi, rel=0.05)


def test_strands_of_one_key_are_left_out_and_counted() -> None:
    scene = sfumato.Scene()
    points = [[0, 0, 0], [5, 0, 0], [1, 1, 0]]
    assert scene.add_strands(points, [1.0] * 3, [0, 0, 2, 3]) == 2
    assert sfumato.Frame(scene).render(camera(), SIZE, SIZE, edge_samples=1)[..., 3].sum() > 1.0
    empty = sfumato.Scene()
    assert empty.add_strands(np.zeros((0, 3)), [], [0]) == 0
    assert not sfumato.Frame(empty).render(camera(), SIZE, SIZE, edge_samples=1).any()


def test_strands_behind_the_camera_or_through_its_plane_do_no_harm() -> None:
    near, far = 0.1, 100.0
    projection = np.array([[2.0, 0, 0, 0], [0, 2.0, 0, 0], [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)], [0, 0, -1, 0]])  # fmt: skip
    eye = sfumato.Camera(projection)  # at the origin, along -z
    cases: list[list[list[float]]] = [[[0, 0, 1], [1, 1, 3]], [[0, 0, -5], [0.3, 0.2, 5]], [[0, 0, 0], [0, 0, -3]]]
    for points in cases:
        scene = sfumato.Scene()
        scene.add_sun((0, 0, -1), (1, 1, 1))
        scene.add_strands(points, [0.05, 0.05], [0, 2])
        picture = sfumato.Frame(scene).render(eye, SIZE, SIZE, edge_samples=4)
        assert np.isfinite(picture).all() and picture[..., 3].max() <= 1.0
        assert picture.any() == (points[0][2] < 0)


def test_a_million_in_one_pixel() -> None:
    count = 1_000_000
    ends = np.random.default_rng(2).uniform(-0.4, 0.4, (count, 2, 3)) + 0.5
    scene = sfumato.Scene()
    scene.add_sun((0, 0, -1), (1, 1, 1))
    scene.add_strands(ends.reshape(-1, 3), np.full(2 * count, 1e-4), np.arange(0, 2 * count + 1, 2))
    frame = sfumato.Frame(scene)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    picture = frame.render(camera(), SIZE, SIZE, edge_samples=1)
    assert picture[SIZE // 2, SIZE // 2, 3] > 0.99 and np.isfinite(picture).all()
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) < 1_000_000  # KB


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("points", [[0, 0, np.nan], [0, 0, 1]], "points holds nan at flat index 2"),
        ("radius", [0.1, -0.1], "radius holds -0.1 at flat index 1"),
        ("first", [0, 1], "first has shape (2,), but must begin with 0 and end with the 2 rows of points"),
        ("first", [0, 2, 1, 2], "first holds 1 at flat index 2, which is less than the one before"),
        ("fibre", [[0, 0, 0, 0.3, 2.0, 0.3, 0, 1.5]], "fibre holds 2 at flat index 4, which must lie between 0.001 and 1"),
        ("matt", [[0, 0, 1.5, 0, 0, 0, 0.3]], "matt holds 1.5 at flat index 2, which must lie between 0 and 1"),
        ("material", [1], "material holds 1 at flat index 0; every value must be one of the 1 indices from 0"),
        ("visibility", sfumato.Visibility("catcher"), "visibility.seen must be 'shown' or 'unseen'"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_named(name: str, value: Any, message: str) -> None:
    arguments = {"points": [[0, 0, 0], [0, 0, 1]], "radius": [0.1, 0.1], "first": [0, 2], name: value}
    with pytest.raises(ValueError) as error:
        sfumato.Scene().add_strands(**arguments)
    assert str(error.value).startswith(message)
