# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python module: its examples, its shapes and its refusals. What it computes is the business of the C++ tests."""

from __future__ import annotations

import doctest
import inspect
import math
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

import sfumato
from sfumato import Camera, Frame, Scene

Array = NDArray[Any]

# ---- Examples ----


def documented(owner: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Every public callable below `owner`: functions, classes and methods."""
    for key, member in vars(owner).items():
        if key.startswith("_"):
            continue
        if isinstance(member, staticmethod):  # which has no docstring of its own
            member = member.__func__
        if inspect.ismodule(member):
            yield from documented(member, f"{name}.{key}")
        elif inspect.isclass(member):
            yield f"{name}.{key}", member
            yield from documented(member, f"{name}.{key}")
        elif callable(member):
            yield f"{name}.{key}", member


CALLABLES = dict(documented(sfumato, "sfumato"))
# Classes that only a Frame makes; their properties are documented there.
MADE_BY_FRAME = {"sfumato.LitMedium", "sfumato.LightMap"}


@pytest.mark.parametrize("name", sorted(set(CALLABLES) - MADE_BY_FRAME))
def test_example(name: str) -> None:
    examples = doctest.DocTestParser().get_doctest(CALLABLES[name].__doc__, dict(vars(sfumato)), name, None, None)
    assert examples.examples, f"{name} has no example"
    report: list[str] = []
    assert doctest.DocTestRunner().run(examples, out=report.append).failed == 0, "".join(report)


def test_every_property_is_documented() -> None:
    silent = [
        f"{name}.{key}"
        for name, member in CALLABLES.items()
        if inspect.isclass(member)
        for key, value in vars(member).items()
        if isinstance(value, property) and not value.__doc__
    ]
    assert not silent


# ---- Scenes ----

TRIANGLE: dict[str, Any] = {
    "vertices": [[-9, -9, 0], [9, -9, 0], [0, 9, 0]],
    "triangles": [[0, 1, 2]],
    "corner_normals": [[[0, 0, 1]] * 3],
    "material": [0],
    "albedo": [[0.8, 0.6, 0.4]],
}
MEDIUM: dict[str, Any] = {
    "density": np.full((3, 4, 5), 0.5),
    "grid_to_world": np.diag([0.2, 0.25, 0.3, 1.0]),
    "scattering": (1, 1, 1),
    "absorption": (0.5, 0.5, 0.5),
    "anisotropy": 0.25,
}
SUN: dict[str, Any] = {"direction": (0, 0, -1), "irradiance": (4, 3, 2), "angle": 0.01}


def scene_of(**medium: Any) -> Scene:
    scene = Scene()
    scene.add_mesh(**TRIANGLE)
    scene.add_medium(**{**MEDIUM, **medium})
    scene.add_sun(**SUN)
    scene.set_background((0.1, 0.2, 0.3))
    return scene


def camera_from_above() -> Camera:
    """Orthographic, 4 m by 4 m around the origin, from z = 5 to z = -5."""
    return Camera(np.diag([0.5, 0.5, -0.2, 1.0]))


def picture(scene: Scene, **render: Any) -> Array:
    arguments: dict[str, Any] = {"width": 12, "height": 8, **render}
    image: Array = Frame(scene).render(camera_from_above(), **arguments)
    return image


# ---- Shapes and types ----


def as_lists(array: Array) -> Any:
    return array.tolist()


def strided(array: Array) -> Array:
    """The same values, every second one of a larger array, and in Fortran's order."""
    wide = np.zeros((2 * array.shape[0],) + array.shape[1:], dtype=array.dtype)
    wide[::2] = array
    return np.asfortranarray(wide)[::2]


@pytest.mark.parametrize(
    "convert", [np.float32, np.float64, np.float16, np.int64, np.asfortranarray, strided, as_lists]
)
def test_scenes_take_any_layout(convert: Callable[[Array], Any]) -> None:
    density = np.arange(60.0).reshape(3, 4, 5) % 7
    expected = picture(scene_of(density=density.astype(np.float32)))
    np.testing.assert_array_equal(picture(scene_of(density=convert(density))), expected)
    scene = scene_of(density=density, grid_to_world=convert(np.diag([1.0, 2.0, 1.0, 1.0])))
    np.testing.assert_array_equal(
        picture(scene), picture(scene_of(density=density, grid_to_world=np.diag([1.0, 2.0, 1.0, 1.0])))
    )


def test_a_mesh_takes_any_layout() -> None:
    def with_mesh(**changed: Any) -> Array:
        scene = Scene()
        scene.add_sun(**SUN)
        scene.add_mesh(**{**TRIANGLE, **changed})
        return picture(scene)

    expected = with_mesh()
    assert expected[..., 3].max() == 1.0
    for kind in (np.int32, np.uint32, np.int64, np.float64):
        np.testing.assert_array_equal(with_mesh(triangles=np.array([[0, 1, 2]], dtype=kind)), expected)
    vertices = strided(np.array(TRIANGLE["vertices"], dtype=np.float32))
    assert not vertices.flags.c_contiguous
    np.testing.assert_array_equal(with_mesh(vertices=vertices), expected)


def test_a_scene_keeps_nothing_of_the_callers_arrays() -> None:
    density = np.full((3, 4, 5), 0.5, dtype=np.float32)
    scene = scene_of(density=density)
    before = picture(scene)
    density[:] = 9.0
    np.testing.assert_array_equal(picture(scene), before)


def test_meshes_may_be_empty() -> None:
    scene = Scene()
    scene.add_mesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros(0), np.zeros((0, 3)))
    no_triangle: dict[str, Any] = {"triangles": np.zeros((0, 3)), "corner_normals": np.zeros((0, 3, 3)), "material": []}
    scene.add_mesh(**{**TRIANGLE, **no_triangle})
    assert picture(scene)[..., 3].max() == 0.0


def test_pictures_start_at_the_lower_left() -> None:
    scene = Scene()
    scene.add_sun(**SUN)
    corner = {**TRIANGLE, "vertices": [[-2.0, -2.0, 0.0], [-1.4, -2.0, 0.0], [-2.0, -1.4, 0.0]]}
    scene.add_mesh(**corner)
    image = picture(scene, edge_samples=1)
    assert image.shape == (8, 12, 4) and image.dtype == np.float32
    assert image[0, 0, 3] == 1.0 and image[..., 3].sum() == 1.0


def test_parts_of_a_frame() -> None:
    grid_to_world = np.array([[0.2, 0, 0, 1], [0, 0.25, 0, 2], [0, 0, 0.3, 3], [0, 0, 0, 1]])
    frame = Frame(scene_of(grid_to_world=grid_to_world), coefficients=7, texels_per_cell=2.0, steps_per_cell=2.0)
    (medium,), light_map = frame.media, frame.light_map()
    assert medium.density.shape == (5, 6, 7) and medium.density.dtype == np.float32
    assert medium.light.shape == (1, 5, 6, 7, 2) and medium.light.dtype == np.float32
    assert medium.clearance.shape == (2, 2, 2)
    first = grid_to_world @ (-1, -1, -1, 1)  # there is one empty cell more
    np.testing.assert_allclose(medium.grid_to_world, np.c_[grid_to_world[:, :3], first], atol=1e-6)
    np.testing.assert_allclose(medium.extinction, 1.5)
    np.testing.assert_allclose(medium.scattering, 1.0)
    assert medium.anisotropy == 0.25
    assert light_map.coefficients.shape[2] == 7
    assert light_map.world_to_light.shape == (4, 4)
    assert frame.step_length == pytest.approx(0.5)
    (sun,) = frame.lights
    np.testing.assert_array_equal(sun[0], (*SUN["direction"], 1))
    np.testing.assert_array_equal(sun[2], (*SUN["irradiance"], 1))
    surfaces = frame.surfaces(camera_from_above(), 6, 4)
    assert surfaces.shape == (4, 6, 4) and surfaces.dtype == np.float32
    np.testing.assert_allclose(surfaces[..., 3].min(), 5.0, rtol=1e-5)


def test_parts_are_copies_that_outlive_the_frame() -> None:
    frame = Frame(scene_of())
    (medium,) = frame.media
    volume = medium.light
    volume[:] = 0.0
    assert medium.light.max() > 0.0
    del frame
    assert medium.light.max() > 0.0


def test_a_scene_may_lack_everything() -> None:
    frame = Frame(Scene())
    assert frame.media == [] and frame.lights.shape == (0, 3, 4)
    scene = Scene()
    scene.add_sun(**SUN)
    np.testing.assert_array_equal(Frame(scene).transmittance(np.zeros((2, 3))), np.ones((2, 3)))


def test_coloured_smoke_has_three_depths_towards_each_light() -> None:
    scene = scene_of(absorption=(0, 1, 2))
    scene.add_point((0, 0, 3), (5, 5, 5))
    (medium,) = Frame(scene).media
    assert medium.light.shape == (2, 5, 6, 7, 4)
    root = medium.light[..., :3]
    depth = root * (root + 1.0)
    assert (depth[..., 1] >= depth[..., 0]).all() and depth[..., 2].max() > 2.0 * depth[..., 0].max()


def test_a_large_light_is_sampled_often_and_a_small_one_once() -> None:
    scene = scene_of()
    scene.add_sun((0, 0, -1), (1, 1, 1), angle=1.0)
    scene.add_area((0, 0, 2), (1, 0, 0), (0, 1, 0), (1, 1, 1))
    frame = Frame(scene, light_samples=8)
    assert frame.lights[:, 2, 3].tolist() == [1.0, 8.0, 8.0]
    assert frame.light_map(light=1, sample=7) is not None
    assert frame.light_map(light=2, sample=7).coefficients.shape[2] == 15


@pytest.mark.parametrize("shape", [(), (5,), (2, 3), (0,), (2, 0, 3)])
def test_leading_axes_are_kept(shape: tuple[int, ...]) -> None:
    random = np.random.default_rng(1)
    depth, tau = random.random(shape + (6,)), random.random(shape + (6,))
    series = sfumato.project(depth, tau, coefficients=5)
    assert series.shape == shape + (5,)
    assert sfumato.transmittance(series, random.random(shape + (9,))).shape == shape + (9,)
    assert sfumato.henyey_greenstein(np.zeros(shape), 0.5).shape == shape
    points = random.random(shape + (3,))
    assert Frame(scene_of()).transmittance(points).shape == shape + (3,)
    columns = sfumato.reference.column(scene_of(), points, points + 1.0)
    assert columns.shape == shape and columns.dtype == np.float64
    for row in np.ndindex(shape):
        np.testing.assert_array_equal(series[row], sfumato.project(depth[row], tau[row], coefficients=5))


def test_rays_without_absorbers_or_depths_are_clear() -> None:
    empty = sfumato.project(np.zeros((2, 0)), np.zeros((2, 0)))
    np.testing.assert_array_equal(empty, np.zeros((2, 7)))
    assert sfumato.transmittance(empty, np.zeros((2, 0))).shape == (2, 0)
    assert sfumato.reference.transmittance([], [], [0.5]).tolist() == [1.0]


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_precision_is_kept(kind: type) -> None:
    depth: Array = np.linspace(0.0, 1.0, 8, dtype=kind)
    series = sfumato.project(depth, depth)
    assert series.dtype == kind
    assert sfumato.transmittance(series, depth).dtype == kind
    assert sfumato.henyey_greenstein(depth, 0.5).dtype == kind
    expected = sfumato.project(depth.astype(np.float32), depth.astype(np.float32))
    np.testing.assert_array_equal(series, expected)
    np.testing.assert_array_equal(sfumato.project(strided(depth), strided(depth)), series)
    assert sfumato.project(depth.tolist(), depth.tolist()).dtype == np.float64


# ---- The reference ----


def test_the_reference_judges_the_frame() -> None:
    scene, camera = scene_of(), camera_from_above()
    expected = sfumato.reference.render(scene, camera, 12, 8, sun_samples_per_axis=2, step=0.05)
    assert expected.shape == (8, 12, 4) and expected.dtype == np.float64
    image = Frame(scene, 31, 4.0, 4.0).render(camera, 12, 8, edge_samples=1)
    assert np.abs(image - expected).max() < 0.02 * expected.max()
    points = np.array([[0.5, 0.5, -2.0], [0.5, 0.5, 0.45], [3.0, 3.0, 0.0]])
    exact = np.exp(-1.5 * sfumato.reference.column(scene, points, points + (0, 0, 9)))
    np.testing.assert_allclose(Frame(scene, 31, 4.0).transmittance(points)[:, 0], exact, atol=0.005)


@pytest.mark.parametrize("filled", [1.0, 0.2])
def test_the_reference_judges_smoke_in_many_colours(filled: float) -> None:
    """Dense, and in bricks."""
    draws = np.random.default_rng(5)
    density = (draws.random((20, 20, 20)) * 0.5).astype(np.float32)
    density[:, :, int(20 * filled) :] = 0.0
    colour = draws.random((20, 20, 20, 3)).astype(np.float32)
    placed = np.diag([0.05, 0.05, 0.05, 1.0])
    pictures = []
    for given in (colour, None):
        scene, camera = Scene(), camera_from_above()
        scene.add_medium(density, placed, (4, 6, 8), (1, 1, 1), anisotropy=0.3, colour=given)
        scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4))
        expected = sfumato.reference.render(scene, camera, 12, 8, sun_samples_per_axis=1, step=0.02)
        image = Frame(scene, 31, 4.0, 4.0).render(camera, 12, 8, edge_samples=1)
        assert np.abs(image - expected).max() < 0.02 * expected.max()
        pictures.append(image)
    tinted, white = pictures
    assert np.abs(tinted[..., 3] - white[..., 3]).max() < 1e-6, "what the smoke lets through stays the same"
    assert tinted[..., :3].sum() < 0.7 * white[..., :3].sum()
    grid = sfumato.Grid(density, colour=colour)
    np.testing.assert_allclose(grid.brightest, colour[density > 0.0].max(axis=0), rtol=1e-5)
    scene = Scene()
    scene.add_medium(grid, placed, (4, 6, 8), (1, 1, 1), anisotropy=0.3)
    scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4))
    (medium,) = Frame(scene).media
    first = np.argwhere(density > 0.0).min(axis=0) - 1
    part = tuple(slice(max(f, 0), None) for f in first)
    inner = medium.tint[tuple(slice(max(-f, 0), None) for f in first)]
    cells = (density[..., None] * colour)[part]
    shape = np.minimum(inner.shape, cells.shape)[:3]
    within = tuple(slice(0, n) for n in shape)
    np.testing.assert_allclose(inner[within], cells[within], rtol=1e-5, atol=1e-7)


def test_the_reference_judges_the_series() -> None:
    depth, alpha, d = np.array([0.2, 0.6, 0.4]), np.array([0.1, 0.3, 0.2]), np.array([0.0, 0.5, 1.0])
    series = sfumato.project(depth, -np.log(1.0 - alpha), coefficients=2001)
    np.testing.assert_allclose(
        sfumato.transmittance(series, d), sfumato.reference.transmittance(depth, alpha, d), atol=1e-3
    )
    np.testing.assert_allclose(sfumato.reference.transmittance(depth, alpha, d), [1.0, 0.72, 0.504], rtol=1e-12)


# ---- Gloss ----


def share(cosine: float, index: float) -> float:
    """How far reflectance has risen from straight on to grazing, by Snell's law and Fresnel's amplitudes."""
    refracted = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * refracted) / (cosine + index * refracted)
    within = (index * cosine - refracted) / (index * cosine + refracted)
    straight_on = ((index - 1.0) / (index + 1.0)) ** 2
    return float((0.5 * (across**2 + within**2) - straight_on) / (1.0 - straight_on))


def test_each_material_has_a_curve_of_its_own() -> None:
    """A sun mirrored at a known angle by stripes of five materials, with the rise towards grazing and without."""
    f0, turn = 0.04, math.radians(85.0)
    curves = [0.0, 1.0, 1.2, 1.45, 2.0]
    cosine = math.cos(0.5 * turn)
    shares = [(1.0 - cosine) ** 5, 0.0, *(share(cosine, index) for index in curves[2:])]
    stripes = np.linspace(-2.0, 2.0, 6)
    corners = [[(a, -9, 0), (b, -9, 0), (b, 9, 0), (a, 9, 0)] for a, b in zip(stripes, stripes[1:])]

    def seen(edge: float) -> Array:
        scene = Scene()
        scene.add_mesh(
            vertices=np.reshape(corners, (-1, 3)),
            triangles=[[4 * k, 4 * k + i, 4 * k + i + 1] for k in range(5) for i in (1, 2)],
            corner_normals=np.broadcast_to([0.0, 0.0, 1.0], (10, 3, 3)),
            material=np.repeat(np.arange(5), 2),
            albedo=np.zeros((5, 3)),
            gloss=[[f0, f0, f0, edge, 0.6, 0.6, 0.0, index] for index in curves],
        )
        scene.add_sun((math.sin(turn), 0, -math.cos(turn)), (1, 1, 1))
        return picture(scene, width=35, height=3)[:, 3::7, 0]  # the middles of the stripes

    rise = seen(1.0) / seen(0.0)
    assert rise == pytest.approx(np.broadcast_to([1.0 + (1.0 - f0) / f0 * s for s in shares], (3, 5)), rel=1e-4)


# ---- Refusals ----

NAN, INF = float("nan"), float("inf")


def wrong_mesh(**changed: Any) -> Callable[[], Any]:
    return lambda: Scene().add_mesh(**{**TRIANGLE, **changed})


def wrong_medium(**changed: Any) -> Callable[[], Any]:
    return lambda: Scene().add_medium(**{**MEDIUM, **changed})


def wrong_sun(**changed: Any) -> Callable[[], Any]:
    return lambda: Scene().add_sun(**{**SUN, **changed})


def wrong_point(**changed: Any) -> Callable[[], Any]:
    point: dict[str, Any] = {"position": (0, 0, 3), "intensity": (1, 1, 1), **changed}
    return lambda: Scene().add_point(**point)


def wrong_area(**changed: Any) -> Callable[[], Any]:
    area: dict[str, Any] = {
        "position": (0, 0, 3),
        "across": (1, 0, 0),
        "up": (0, 1, 0),
        "radiance": (1, 1, 1),
        **changed,
    }
    return lambda: Scene().add_area(**area)


def wrong_frame(**changed: Any) -> Callable[[], Any]:
    return lambda: Frame(Scene(), **changed)


def wrong_render(**changed: Any) -> Callable[[], Any]:
    arguments: dict[str, Any] = {"camera": camera_from_above(), "width": 2, "height": 2, **changed}
    return lambda: Frame(Scene()).render(**arguments)


def wrong_surfaces(**changed: Any) -> Callable[[], Any]:
    arguments: dict[str, Any] = {"camera": camera_from_above(), "width": 2, "height": 2, **changed}
    return lambda: Frame(Scene()).surfaces(**arguments)


def wrong_reference(**changed: Any) -> Callable[[], Any]:
    arguments: dict[str, Any] = {"scene": Scene(), "camera": camera_from_above(), "width": 2, "height": 2, **changed}
    return lambda: sfumato.reference.render(**arguments)


def overfull() -> None:
    scene = scene_of()
    for _ in range(64):
        scene.add_medium(**MEDIUM)


def matrix(*, row: int, column: int, value: float) -> Array:
    out = np.eye(4)
    out[row, column] = value
    return out


INFINITE_NEAR_PLANE = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, -1, 0]], dtype=np.float64)

# What is wrong, the argument, and its value or shape, as the message must give them.
REFUSALS: list[tuple[Callable[[], Any], str, str]] = [
    (wrong_mesh(vertices=[[0, 0], [1, 0], [0, 1]]), "vertices", "(3, 2)"),
    (wrong_mesh(vertices=[[NAN, 0, 0]] * 3), "vertices", "nan"),
    (wrong_mesh(vertices=[[0, 0, 0], [1, INF, 0], [0, 1, 0]]), "vertices", "inf at flat index 4"),
    (wrong_mesh(vertices=[[0, 0, 1e39]] * 3), "vertices", "inf"),  # beyond float32
    (wrong_mesh(gloss=[[0.5] * 7]), "gloss", "(1, 7)"),
    (wrong_mesh(gloss=[[0.5] * 7 + [0.9]]), "gloss", "0.9 at flat index 7"),
    (wrong_mesh(gloss=[[0.5] * 7 + [NAN]]), "gloss", "nan at flat index 7"),
    (wrong_mesh(gloss=[[0.5, 0.5, 0.5, 1.5, 0.5, 0.5, 0, 1.5]]), "gloss", "1.5 at flat index 3"),
    (wrong_mesh(triangles=[0, 1, 2]), "triangles", "(3,)"),
    (wrong_mesh(triangles=[[0, 1, 3]]), "triangles", "3 at flat index 2"),
    (wrong_mesh(triangles=[[0, -1, 2]]), "triangles", "-1"),
    (wrong_mesh(triangles=[[0, 0.7, 2]]), "triangles", "0.7"),
    (wrong_mesh(triangles=[[0, NAN, 2]]), "triangles", "nan"),
    (wrong_mesh(triangles=[[0, 1, 2**40]]), "triangles", "1099511627776"),
    (wrong_mesh(corner_normals=[[[0, 0, 1]] * 2]), "corner_normals", "(1, 2, 3)"),
    (wrong_mesh(corner_normals=[[[0, 0, INF]] * 3]), "corner_normals", "inf"),
    (wrong_mesh(material=[0, 0]), "material", "(2,)"),
    (wrong_mesh(material=[1]), "material", "1"),
    (wrong_mesh(albedo=[[0.5, 0.5, 1.25]]), "albedo", "1.25"),
    (wrong_mesh(albedo=[[0.5, -0.5, 1.0]]), "albedo", "-0.5"),
    (wrong_mesh(albedo=[[0.5, NAN, 1.0]]), "albedo", "nan"),
    (wrong_mesh(albedo=[0.5, 0.5, 0.5]), "albedo", "(3,)"),
    (wrong_medium(density=np.zeros((3, 4))), "density", "(3, 4)"),
    (wrong_medium(density=np.zeros((3, 0, 4))), "density", "(3, 0, 4)"),
    (wrong_medium(density=np.full((2, 2, 2), -1.0)), "density", "-1"),
    (wrong_medium(density=np.full((2, 2, 2), NAN)), "density", "nan"),
    (wrong_medium(density=np.full((2, 2, 2), INF)), "density", "inf"),
    (wrong_medium(grid_to_world=np.eye(3)), "grid_to_world", "(3, 3)"),
    (wrong_medium(grid_to_world=matrix(row=1, column=1, value=0.0)), "grid_to_world", "0"),
    (wrong_medium(grid_to_world=matrix(row=1, column=1, value=NAN)), "grid_to_world", "nan"),
    (wrong_medium(grid_to_world=matrix(row=1, column=1, value=1e39)), "grid_to_world", "1e+39"),
    (wrong_medium(grid_to_world=matrix(row=3, column=1, value=0.5)), "grid_to_world", "0.5"),
    (wrong_medium(scattering=(1, 1)), "scattering", "(2,)"),
    (wrong_medium(scattering=(1, 1, -2)), "scattering", "-2"),
    (wrong_medium(absorption=(NAN, 1, 1)), "absorption", "nan"),
    (wrong_medium(absorption=3.0), "absorption", "()"),
    (wrong_medium(anisotropy=1.0), "anisotropy", "1"),
    (wrong_medium(anisotropy=NAN), "anisotropy", "nan"),
    (wrong_sun(direction=(0, 0, 0)), "direction", "(0, 0, 0)"),
    (wrong_point(position=(0, NAN, 0)), "position", "nan"),
    (wrong_point(position=(0, 1e20, 0)), "position", "1e+20"),
    (wrong_point(intensity=(1, -1, 1)), "intensity", "-1"),
    (wrong_point(radius=-0.5), "radius", "-0.5"),
    (wrong_point(direction=(0, 0, 0)), "direction", "(0, 0, 0)"),
    (wrong_point(cone=0.0), "cone", "0"),
    (wrong_point(cone=7.0), "cone", "7"),
    (wrong_point(blend=1.5), "blend", "1.5"),
    (wrong_area(across=(0, 0, 0)), "across", "0"),
    (wrong_area(up=(1, 0, 0)), "across and up", "1"),
    (wrong_area(up=(INF, 0, 0)), "up", "inf"),
    (wrong_area(radiance=(1, NAN, 1)), "radiance", "nan"),
    (wrong_area(spread=0.0), "spread", "0"),
    (wrong_area(spread=4.0), "spread", "4"),
    (lambda: Frame(scene_of()).light_map(light=1), "light", "1"),
    (lambda: Frame(scene_of()).light_map(light=-1), "light", "-1"),
    (lambda: Frame(scene_of()).light_map(sample=1), "sample", "1"),
    (lambda: Frame(scene_of()).light_map(medium=1), "medium", "1"),
    (lambda: Frame(scene_of()).transmittance((0, 0, 0), light=2), "light", "2"),
    (lambda: Frame(Scene()).transmittance((0, 0, 0)), "light", "0"),
    (wrong_frame(light_samples=0), "light_samples", "0"),
    (wrong_surfaces(output="albedo"), "output", "albedo"),
    (overfull, "scene", "64"),
    (wrong_sun(direction=(0, INF, 0)), "direction", "inf"),
    (wrong_sun(direction=(0, 1)), "direction", "(2,)"),
    (wrong_sun(irradiance=(-1, 1, 1)), "irradiance", "-1"),
    (wrong_sun(irradiance=(1, 1, 1, 1)), "irradiance", "(4,)"),
    (wrong_sun(angle=-0.5), "angle", "-0.5"),
    (wrong_sun(angle=4.0), "angle", "4"),
    (wrong_sun(angle=NAN), "angle", "nan"),
    (lambda: Scene().set_background((0, 0)), "radiance", "(2,)"),
    (lambda: Scene().set_background((0, 0, -1)), "radiance", "-1"),
    (lambda: Scene().set_background((0, NAN, 0)), "radiance", "nan"),
    (lambda: Camera(np.eye(3)), "view_projection", "(3, 3)"),
    (lambda: Camera(np.zeros((4, 4))), "view_projection", "0"),
    (lambda: Camera(matrix(row=0, column=0, value=NAN)), "view_projection", "nan"),
    (lambda: Camera(INFINITE_NEAR_PLANE), "view_projection", "infinity"),
    (wrong_frame(coefficients=0), "coefficients", "0"),
    (wrong_frame(coefficients=-3), "coefficients", "-3"),
    (wrong_frame(coefficients=65), "coefficients", "65"),
    (wrong_frame(texels_per_cell=0.0), "texels_per_cell", "0"),
    (wrong_frame(texels_per_cell=NAN), "texels_per_cell", "nan"),
    (wrong_frame(steps_per_cell=-1.0), "steps_per_cell", "-1"),
    (wrong_frame(steps_per_cell=INF), "steps_per_cell", "inf"),
    (wrong_render(width=0), "width", "0"),
    (wrong_render(height=-2), "height", "-2"),
    (wrong_render(width=10**6), "width", "1000000"),
    (wrong_render(edge_samples=0), "edge_samples", "0"),
    (wrong_surfaces(edge_samples=0), "edge_samples", "0"),
    (wrong_surfaces(edge_samples=1025), "edge_samples", "1025"),
    (wrong_surfaces(width=0), "width", "0"),
    (wrong_surfaces(height=0), "height", "0"),
    (lambda: Frame(Scene()).transmittance(np.zeros((2, 2))), "points", "(2, 2)"),
    (lambda: Frame(Scene()).transmittance(1.0), "points", "()"),
    (lambda: Frame(Scene()).transmittance([[0, 0, NAN]]), "points", "nan"),
    (lambda: sfumato.project([0.5], [1.0, 1.0]), "optical_depth", "(2,)"),
    (lambda: sfumato.project(0.5, 1.0), "depth", "single number"),
    (lambda: sfumato.project([1.5], [1.0]), "depth", "1.5"),
    (lambda: sfumato.project([NAN], [1.0]), "depth", "nan"),
    (lambda: sfumato.project([0.5], [-1.0]), "optical_depth", "-1"),
    (lambda: sfumato.project([0.5], [INF]), "optical_depth", "inf"),
    (lambda: sfumato.project([0.5], [1.0], coefficients=4), "coefficients", "4"),
    (lambda: sfumato.project([0.5], [1.0], coefficients=-1), "coefficients", "-1"),
    (lambda: sfumato.project([0.5], [1.0], width=2.0), "width", "2"),
    (lambda: sfumato.project("smoke", [1.0]), "depth", "'smoke'"),
    (lambda: sfumato.project([0.5], [1j]), "optical_depth", "1j"),
    (lambda: sfumato.project([0.5], cast(Array, None)), "optical_depth", "None"),
    (lambda: sfumato.project([[0.5], [0.5, 0.5]], [1.0]), "depth", "[[0.5], [0.5, 0.5]]"),
    (lambda: sfumato.transmittance(np.zeros(4), [0.5]), "coefficients", "4"),
    (lambda: sfumato.transmittance(np.zeros((2, 7)), [0.5]), "depth", "(1,)"),
    (lambda: sfumato.transmittance([NAN], [0.5]), "coefficients", "nan"),
    (lambda: sfumato.transmittance([1.0], [-0.5]), "depth", "-0.5"),
    (lambda: sfumato.henyey_greenstein([1.5]), "cos_theta", "1.5"),
    (lambda: sfumato.henyey_greenstein([0.5], anisotropy=-1.0), "anisotropy", "-1"),
    (lambda: sfumato.read_volume("no such file.vdb"), "path", "no such file.vdb"),
    (lambda: sfumato.reference.transmittance([0.5], [1.5], [1.0]), "alpha", "1.5"),
    (lambda: sfumato.reference.transmittance([0.5], [0.5, 0.5], [1.0]), "alpha", "(2,)"),
    (lambda: sfumato.reference.transmittance([NAN], [0.5], [1.0]), "depth", "nan"),
    (lambda: sfumato.reference.transmittance([0.5], [0.5], [[1.0]]), "d", "(1, 1)"),
    (lambda: sfumato.reference.column(Scene(), [0, 0], [0, 0]), "start", "(2,)"),
    (lambda: sfumato.reference.column(Scene(), [0, 0, 0], [[0, 0, 0]]), "end", "(1, 3)"),
    (lambda: sfumato.reference.column(Scene(), [0, 0, 0], [0, INF, 0]), "end", "inf"),
    (wrong_reference(width=0), "width", "0"),
    (wrong_reference(height=-1), "height", "-1"),
    (wrong_reference(sun_samples_per_axis=0), "sun_samples_per_axis", "0"),
    (wrong_reference(step=0.0), "step", "0"),
    (wrong_reference(step=NAN), "step", "nan"),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore:overflow encountered in cast")
@pytest.mark.parametrize("refused, argument, value", REFUSALS)
def test_bad_input_is_named(refused: Callable[[], Any], argument: str, value: str) -> None:
    with pytest.raises(ValueError) as error:
        refused()
    message = str(error.value)
    assert message.startswith(argument), message
    assert value in message.removeprefix(argument), message


def test_a_refusal_changes_nothing() -> None:
    scene = scene_of()
    before = picture(scene)
    refusals: list[Callable[[], Any]] = [
        lambda: scene.add_mesh(**dict(TRIANGLE, material=[7])),
        lambda: scene.add_medium(**dict(MEDIUM, anisotropy=2.0)),
        lambda: scene.add_sun(**dict(SUN, angle=-1.0)),
        lambda: scene.set_background((NAN, 0, 0)),
    ]
    for refused in refusals:
        with pytest.raises(ValueError):
            refused()
    np.testing.assert_array_equal(picture(scene), before)


@pytest.mark.parametrize("length", [1e-25, 1e25])
def test_a_suns_direction_may_have_any_length(length: float) -> None:
    frames = []
    for scale in (1.0, length):
        scene = Scene()
        scene.add_sun((0.3 * scale, 0.1 * scale, -scale), (1, 1, 1))
        frames.append(Frame(scene).lights[0, 0])
    np.testing.assert_allclose(frames[0], frames[1], rtol=1e-6)


def test_smoke_may_be_very_small() -> None:
    small = scene_of(grid_to_world=np.diag([1e-16, 1e-16, 1e-16, 1.0]), scattering=(1e16, 1e16, 1e16))
    assert Frame(small).media[0].light.max() > 0.0


# ---- Surfaces, sampled as a picture ----


def rectangle(low: tuple[float, float], high: tuple[float, float], height: float) -> dict[str, Any]:
    corners = [
        [low[0], low[1], height],
        [high[0], low[1], height],
        [high[0], high[1], height],
        [low[0], high[1], height],
    ]
    return {**TRIANGLE, "vertices": corners, "triangles": [[0, 1, 2], [0, 2, 3]],
            "corner_normals": [[[0, 0, 1]] * 3] * 2, "material": [0, 0]}  # fmt: skip


def under_a_roof(start: float | None, smoke: bool = False) -> Frame:
    """A floor under a lamp of 1 m by 1 m at a height of 4 m, with a roof at 2 m from x = start on."""
    scene = Scene()
    scene.add_mesh(**rectangle((-9.0, -9.0), (9.0, 9.0), 0.0))
    scene.add_area((0, 0, 4), across=(0.5, 0, 0), up=(0, 0.5, 0), radiance=(5, 4, 3))
    scene.set_background((0.1, 0.2, 0.3))
    if start is not None:
        scene.add_mesh(**rectangle((start, -9.0), (9.0, 9.0), 2.0))
    if smoke:
        scene.add_medium(**MEDIUM)
    return Frame(scene)


# Orthographic, between roof and floor: x and y in [-1, 1], z from 1 to -1.
BELOW = Camera(np.diag([1.0, 1.0, -1.0, 1.0]))


@pytest.mark.parametrize("edge_samples", [1, 16])
def test_surfaces_without_smoke_are_the_picture(edge_samples: int) -> None:
    """With a tilted plate before the sky, so that there are silhouettes too."""
    frame = under_a_roof(0.0)
    tilted = Camera(np.array([[0.1, 0, 0, 0], [0, 0.06, -0.08, 0], [0, -0.04, -0.03, 0], [0, 0, 0, 1.0]]))
    for camera in (BELOW, tilted):
        surfaces = frame.surfaces(camera, 64, 48, "radiance", edge_samples)
        picture = frame.render(camera, 64, 48, edge_samples)
        np.testing.assert_array_equal(surfaces[..., :3], picture[..., :3])
    assert picture[..., 3].min() == 0.0 and picture[..., 3].max() == 1.0
    assert ((picture[..., 3] > 0.0) & (picture[..., 3] < 1.0)).any() == (edge_samples > 1)


@pytest.mark.parametrize("output", ["radiance", "smoke_shadow", "all_shadows"])
def test_the_distance_is_that_of_the_pixels_centre(output: str) -> None:
    frame = under_a_roof(0.0, smoke=True)
    slanted = Camera(np.array([[0.1, 0, 0, 0], [0, 0.06, -0.08, 0], [0, -0.04, -0.03, 0], [0, 0, 0, 1.0]]))
    once, often = (frame.surfaces(slanted, 64, 48, output, samples) for samples in (1, 16))
    np.testing.assert_array_equal(often[..., 3], once[..., 3])
    assert np.abs(often[..., :3] - once[..., :3]).max() > 0.02


@pytest.mark.parametrize("output", ["radiance", "all_shadows"])
def test_a_lamp_with_a_size_throws_a_soft_shadow_of_a_roof(output: str) -> None:
    """The roof's edge is half way up: a point x of the floor sees what of the lamp lies beyond -x, so the light on it
    rises from nothing to all between x = 0.5 and x = -0.5. With one sample a pixel sees the lamp's middle or does not.
    """

    def share_hidden(edge_samples: int) -> Array:
        none, half, all_of_it = (
            under_a_roof(start).surfaces(BELOW, 80, 40, output, edge_samples)[..., 0] for start in (None, 0.0, -9.0)
        )
        hidden: Array = (none - half) / (none - all_of_it)
        return hidden

    x = (np.arange(80) + 0.5) / 40.0 - 1.0
    expected = np.clip(0.5 + x, 0.0, 1.0)
    inner = np.abs(x) < 0.3
    off = (share_hidden(64) - expected)[:, inner]
    # The samples are the middles of 64 shares of the lamp. Here and there, as in Film.SeesThePenumbraOfAHalfPlane, a pixel
    # and its neighbours find the same by chance, and it is not refined.
    assert np.quantile(np.abs(off), 0.95) < 1.5 / 64
    assert np.abs(off.mean(0)).max() < 0.02
    np.testing.assert_allclose(share_hidden(1), np.broadcast_to(x > 0.0, (40, 80)), atol=1e-5)


@pytest.mark.parametrize("roof", [None, -9.0])
def test_a_share_in_shadow_is_of_the_lamp_and_not_of_a_sample_of_it(roof: float | None) -> None:
    """All of the lamp is seen, or nothing: however large it is, the share is the same wherever on it a sample falls."""
    frame = under_a_roof(roof)
    once, often = (frame.surfaces(BELOW, 40, 40, "all_shadows", samples) for samples in (1, 16))
    np.testing.assert_allclose(often, once, atol=1e-4)  # what the film makes of a smooth curve
    assert np.abs(once[..., :3] - (roof is not None)).max() < 0.2


# ---- The interpreter's lock and progress ----


def heavy_frame() -> Frame:
    return Frame(
        scene_of(density=np.random.default_rng(2).random((40, 40, 40)), grid_to_world=np.diag([0.05] * 3 + [1.0]))
    )


def beats_during(work: Callable[[], Any]) -> int:
    """How often another thread gets to run Python while `work` runs."""
    beats, stop = [0], threading.Event()

    def beat() -> None:
        while not stop.wait(0.001):
            beats[0] += 1

    thread = threading.Thread(target=beat)
    thread.start()
    try:
        work()
        return beats[0]
    finally:
        stop.set()
        thread.join()


HEAVY: dict[str, Callable[[], Callable[[], Any]]] = {
    "render": lambda: (lambda frame: lambda: frame.render(camera_from_above(), 600, 600))(heavy_frame()),
    "surfaces": lambda: (lambda frame: lambda: frame.surfaces(camera_from_above(), 4000, 2000))(heavy_frame()),
    "Frame": lambda: lambda: Frame(
        scene_of(density=np.random.default_rng(3).random((60, 60, 60))), coefficients=63, texels_per_cell=2.0
    ),
    "project": lambda: lambda: sfumato.project(np.full((30000, 100), 0.5), np.ones((30000, 100)), 31),
    "reference.render": lambda: lambda: sfumato.reference.render(scene_of(), camera_from_above(), 40, 40, 2, 0.01),
}


@pytest.mark.parametrize("name", HEAVY)
def test_other_threads_run_meanwhile(name: str) -> None:
    work = HEAVY[name]()
    # With the lock held the other thread runs at both ends at most. A busy machine may steal a whole run from it, so it
    # has several chances; no clock decides.
    assert any(beats_during(work) >= 6 for _ in range(20))


def test_progress_is_reported_from_any_thread() -> None:
    frame, shares, images = heavy_frame(), [], []

    def report(share: float) -> bool:
        shares.append(share)
        return True

    thread = threading.Thread(target=lambda: images.append(frame.render(camera_from_above(), 64, 64, progress=report)))
    thread.start()
    thread.join()
    assert images[0].shape == (64, 64, 4)
    assert shares[0] == 0.0 and shares == sorted(shares) and 0.5 < shares[-1] < 1.0


def test_two_threads_render_one_frame() -> None:
    frame, images = heavy_frame(), {}
    threads = [
        threading.Thread(target=lambda key=key: images.update({key: frame.render(camera_from_above(), 64, 64)}))
        for key in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(images[0], images[1])


def test_surfaces_report_progress_too() -> None:
    shares: list[float] = []
    frame = under_a_roof(0.0)
    assert frame.surfaces(BELOW, 64, 64, edge_samples=16, progress=shares.append).shape == (64, 64, 4)
    assert shares[0] == 0.0 and shares == sorted(shares) and 0.5 < shares[-1] < 1.0
    np.testing.assert_array_equal(
        frame.surfaces(BELOW, 64, 64, "all_shadows", 16, lambda done: True),
        frame.surfaces(BELOW, 64, 64, "all_shadows", 16),
    )
    for last in (0.0, 0.3, 0.8):
        assert frame.surfaces(BELOW, 64, 64, edge_samples=16, progress=lambda done: done < last) is None


@pytest.mark.parametrize("answer", [False, np.False_, 0])
def test_progress_stops_the_work_with_false(answer: Any) -> None:
    assert picture(scene_of(), progress=lambda share: answer) is None


def test_progress_that_answers_nothing_lets_the_work_go_on() -> None:
    shares: list[float] = []
    assert picture(scene_of(), progress=shares.append) is not None
    assert shares


def test_an_error_in_progress_reaches_the_caller() -> None:
    def fail(share: float) -> bool:
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        picture(scene_of(), progress=fail)


def test_the_readme_can_be_pasted_into_a_console() -> None:
    readme = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
    block = readme.split("## In the console\n\n")[1].split("\n\n")[0]
    lines = [line.removeprefix("    ") for line in block.splitlines()]
    assert len(lines) > 8 and all(line.startswith("    ") for line in block.splitlines())
    names: dict[str, Any] = {}
    for line in lines:
        exec(compile(line, "README.md", "single"), names)  # one statement after the other, as a console takes them
    assert "march" in names["frame"].stages
