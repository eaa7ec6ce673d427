# SPDX-License-Identifier: GPL-3.0-or-later
"""What a lens and an open shutter blur: what geometry fixes, and the mean of pictures that are sharp."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sfumato import Camera, Exposure, Frame, Mesh, Scene

SIZE = 64
NEAR, FAR = 0.5, 50.0
HALF = 0.5  # of the picture's width over the distance


def matrix(x: float = 0.0) -> np.ndarray:
    """Of a camera at (x, 0, 0) that looks along -z."""
    projection = np.zeros((4, 4))
    projection[0, 0] = projection[1, 1] = 1.0 / HALF
    projection[2, 2:] = -(FAR + NEAR) / (FAR - NEAR), -2.0 * FAR * NEAR / (FAR - NEAR)
    projection[3, 2] = -1.0
    view = np.eye(4)
    view[0, 3] = -x
    return projection @ view


def add_square(scene: Scene, distance: float, half: float, **material: Any) -> None:
    corners = [[-half, -half, -distance], [half, -half, -distance], [half, half, -distance], [-half, half, -distance]]
    scene.add_instances(Mesh(corners, [[0, 1, 2], [0, 2, 3]]), np.eye(4), albedo=[[0, 0, 0]], **material)


def glowing(distance: float, half: float, background: tuple[float, float, float] = (0, 0, 0)) -> Frame:
    scene = Scene()
    add_square(scene, distance, half, emission=[[1.0, 2.0, 3.0]])
    scene.set_background(background, 1.0)
    return Frame(scene)


def picture(frame: Frame, camera: Camera | Exposure, samples: int = 64) -> np.ndarray:
    return np.asarray(frame.render(camera, SIZE, SIZE, edge_samples=samples), dtype=np.float64)


def spread(image: np.ndarray) -> tuple[float, float]:
    """Of what is bright the standard deviations along x and y, pixels."""
    weights = image[..., 1] / image[..., 1].sum()
    at = np.arange(SIZE) - (SIZE - 1) / 2.0
    return float(np.sqrt((weights.sum(0) * at**2).sum())), float(np.sqrt((weights.sum(1) * at**2).sum()))


def pixels_a_metre(distance: float) -> float:
    return SIZE / (2.0 * HALF * distance)


def test_what_is_in_focus_is_as_a_pinhole_sees_it() -> None:
    frame = glowing(4.0, 0.7)
    sharp = picture(frame, Camera(matrix()))
    seen = picture(frame, Exposure([Camera(matrix())], lens_radius=0.3, focus=4.0, near=NEAR))
    assert np.abs(seen - sharp).max() < 0.15  # of 3: an edge is sampled elsewhere
    assert np.sqrt(np.mean((seen - sharp) ** 2)) < 0.01 * np.sqrt(np.mean(sharp**2))
    assert seen.sum() == pytest.approx(sharp.sum(), rel=2e-3)


@pytest.mark.parametrize("distance", [2.0, 8.0])
def test_a_point_becomes_the_circle_of_confusion(distance: float) -> None:
    """Through a thin lens of radius R, focused at f, a point at d is a disk of radius R |1 - d / f| at its own distance."""
    frame = glowing(distance, 0.25)
    radius, focus = 0.4, 4.0
    sharp = picture(frame, Camera(matrix()))
    seen = picture(frame, Exposure([Camera(matrix())], lens_radius=radius, focus=focus, near=NEAR))
    circle = radius * abs(1.0 - distance / focus) * pixels_a_metre(distance)
    assert circle > 2.9
    own = spread(sharp)
    for found, point in zip(spread(seen), own):
        # An even disk of radius r has the variance r^2 / 4 along each axis.
        assert np.sqrt(found**2 - point**2) == pytest.approx(circle / 2.0, rel=0.06)
    assert seen[..., :3].sum() == pytest.approx(sharp[..., :3].sum(), rel=0.01)


def test_an_aperture_of_four_blades_is_a_square() -> None:
    frame = glowing(8.0, 0.25)
    seen = picture(
        frame,
        Exposure([Camera(matrix())], lens_radius=1.0, focus=4.0, near=NEAR, blades=4, rotation=np.pi / 4.0),
        256,
    )[..., 1]
    # Inscribed in the circle: its half is r / sqrt(2), its variance half^2 / 3.
    circle = pixels_a_metre(8.0)
    own = spread(picture(frame, Camera(matrix())))[0]
    found = spread(np.repeat(seen[..., None], 3, axis=2))[0]
    assert np.sqrt(found**2 - own**2) == pytest.approx(circle / np.sqrt(6.0), rel=0.03)


def test_an_aperture_of_three_blades_points_to_one_side() -> None:
    """Behind the focus it is seen as it stands: a triangle with a corner on the right leans there, by its third moment."""
    frame = glowing(8.0, 0.25)
    aperture: dict[str, Any] = {"lens_radius": 1.0, "focus": 4.0, "near": NEAR, "blades": 3}
    seen = picture(frame, Exposure([Camera(matrix())], **aperture), 256)[..., 1]
    at = np.arange(SIZE) - (SIZE - 1) / 2.0
    along, across = seen.sum(axis=0) / seen.sum(), seen.sum(axis=1) / seen.sum()
    corners = pixels_a_metre(8.0) * np.array([1.0, -0.5, -0.5])
    weights = np.random.default_rng(1).dirichlet((1.0, 1.0, 1.0), 100_000)
    expected = np.mean((weights @ corners) ** 3)
    found = [float((share * (at - (share * at).sum()) ** 3).sum()) for share in (along, across)]
    assert abs(found[0]) == pytest.approx(expected, rel=0.15)
    assert abs(found[1]) < 0.15 * expected


def test_a_squeezed_aperture_is_narrower() -> None:
    frame = glowing(8.0, 0.25)
    seen = picture(frame, Exposure([Camera(matrix())], lens_radius=0.6, focus=4.0, near=NEAR, ratio=2.0))
    x, y = spread(seen)
    point = spread(picture(frame, Camera(matrix())))[0]
    assert np.sqrt(y**2 - point**2) == pytest.approx(2.0 * np.sqrt(x**2 - point**2), rel=0.05)


def test_a_moving_camera_sees_the_mean_of_its_places() -> None:
    scene = Scene()
    add_square(scene, 4.0, 0.5, emission=[[1.0, 2.0, 3.0]])
    scene.add_medium(np.full((8, 8, 8), 2.0), cube(4.0), scattering=(0.5, 0.5, 0.5), absorption=(0.2, 0.3, 0.4))
    scene.add_sun((0.3, 0.2, -1.0), (3.0, 3.0, 3.0))
    scene.set_background((0.1, 0.2, 0.3), 1.0)
    frame = Frame(scene)
    places = np.linspace(-0.5, 0.5, 65)
    mean = np.mean([picture(frame, Camera(matrix(x)), 16) for x in (places[1:] + places[:-1]) / 2.0], axis=0)
    seen = picture(frame, Exposure([Camera(matrix(-0.5)), Camera(matrix(0.5))]))
    sharp = picture(frame, Camera(matrix()))
    off = np.sqrt(np.mean((seen - mean) ** 2)) / np.sqrt(np.mean(mean**2))
    assert off < 0.01
    assert np.sqrt(np.mean((sharp - mean) ** 2)) / np.sqrt(np.mean(mean**2)) > 0.05


def cube(distance: float) -> np.ndarray:
    """Of 8 x 8 x 8 cells, a metre wide, before what is at a distance."""
    out = np.diag([0.125, 0.125, 0.125, 1.0])
    out[:3, 3] = -0.5, -0.2, -distance + 0.5
    return out


def test_light_that_comes_in_at_once_sees_one_place() -> None:
    frame = glowing(4.0, 0.5)
    cameras = [Camera(matrix(-1.0)), Camera(matrix(0.0)), Camera(matrix(1.0))]
    seen = picture(frame, Exposure(cameras, shutter=[0.75, 0.75]))
    assert np.abs(seen - picture(frame, Camera(matrix(0.5)))).max() < 0.05


def test_particles_and_hair_are_blurred_as_surfaces_are() -> None:
    """Of a ball of many puffs, and of a strand, light is spread, not lost."""
    scene = Scene()
    scene.add_particles([[0.0, 0.0, -8.0]], radius=0.5, opacity=0.9, albedo=(1, 1, 1))
    scene.add_sun((0, 0, -1), (4, 4, 4))
    frame = Frame(scene)
    sharp = picture(frame, Camera(matrix()))
    seen = picture(frame, Exposure([Camera(matrix())], lens_radius=0.6, focus=4.0, near=NEAR))
    circle = 0.6 * pixels_a_metre(8.0)
    assert np.sqrt(spread(seen)[0] ** 2 - spread(sharp)[0] ** 2) == pytest.approx(circle / 2.0, rel=0.05)
    assert seen.sum() == pytest.approx(sharp.sum(), rel=0.05)


def test_a_lens_without_width_and_a_camera_that_stands_are_a_camera() -> None:
    frame = glowing(4.0, 0.5)
    sharp = frame.render(Camera(matrix()), SIZE, SIZE)
    assert np.array_equal(frame.render(Exposure([Camera(matrix())]), SIZE, SIZE), sharp)


def test_what_is_very_bright_or_dark_is_blurred_too() -> None:
    exposure = Exposure([Camera(matrix())], lens_radius=0.4, focus=4.0, near=NEAR)
    plain = picture(glowing(8.0, 0.25), exposure)[..., :3]
    for gain in (1e-3, 1e6):
        scene = Scene()
        add_square(scene, 8.0, 0.25, emission=[[gain, 2.0 * gain, 3.0 * gain]])
        scene.set_background((0, 0, 0), 1.0)
        np.testing.assert_allclose(picture(Frame(scene), exposure)[..., :3] / gain, plain, atol=0.002)


def test_what_flies_far_keeps_its_light() -> None:
    """Past many times its own width."""
    scene = Scene()
    square = Mesh([[-0.25, -0.25, -4], [0.25, -0.25, -4], [0.25, 0.25, -4], [-0.25, 0.25, -4]], [[0, 1, 2], [0, 2, 3]])
    way = [[moved(-1.5)], [moved(0.0)], [moved(1.5)]]
    scene.add_instances(square, np.eye(4), albedo=[[0, 0, 0]], emission=[[1, 1, 1]], moving=way)
    scene.set_background((0, 0, 0), 1.0)
    frame = Frame(scene)
    sharp = picture(frame, Camera(matrix()))[..., 0].sum()
    for samples in (16, 64, 256):
        assert picture(frame, Exposure([Camera(matrix())]), samples)[..., 0].sum() == pytest.approx(sharp, rel=0.06)


@pytest.mark.parametrize("flat", [np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]), np.diag([-1.0, 1.0, 1.0])])
def test_places_that_no_ray_enters_are_shown(flat: np.ndarray) -> None:
    """What is flat, or has no size, at one time or is turned inside out on its way."""
    scene = Scene()
    square = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    whole, other = moved(0.0), moved(0.0)
    other[:3, :3] = flat
    whole[2, 3] = other[2, 3] = -4.0
    way = [[whole], [whole], [other]]
    scene.add_instances(square, whole, albedo=[[0, 0, 0]], emission=[[1, 1, 1]], moving=way)
    scene.add_instances(square, np.stack([other, other]), albedo=[[0, 0, 0]])
    seen = picture(Frame(scene), Exposure([Camera(matrix())]))
    assert np.isfinite(seen).all() and 0.2 < seen[SIZE // 2, SIZE // 2, 0] <= 1.0 + 1e-6


def test_equal_exposures_give_equal_pictures() -> None:
    exposure = Exposure([Camera(matrix(-0.1)), Camera(matrix(0.1))], lens_radius=0.2, focus=3.0, near=NEAR)
    first, second = (glowing(4.0, 0.5).render(exposure, SIZE, SIZE) for _ in range(2))
    assert np.array_equal(first, second)


def test_a_blurred_picture_can_be_stopped() -> None:
    shares: list[float] = []

    def go_on(done: float) -> bool:
        shares.append(done)
        return done < 0.2

    exposure = Exposure([Camera(matrix())], lens_radius=0.3, focus=2.0, near=NEAR)
    assert glowing(4.0, 0.7).render(exposure, SIZE, SIZE, progress=go_on) is None
    assert shares == sorted(shares) and shares[-1] < 1.0


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"lens_radius": -1.0}, "lens_radius is -1"),
        ({"focus": 0.0}, "focus is 0"),
        ({"blades": -1}, "blades is -1"),
        ({"ratio": 0.0}, "ratio is 0"),
        ({"shutter": [0.5]}, "shutter has 1 time"),
        ({"shutter": [0.5, 0.25]}, r"shutter\[1\] is 0.25"),
        ({"focus": float("nan")}, "focus is nan"),
    ],
)
def test_what_cannot_be_is_named(changed: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Exposure([Camera(matrix())], **changed)
    with pytest.raises(ValueError, match="cameras is empty"):
        Exposure([])


def moved(x: float) -> np.ndarray:
    out = np.eye(4)
    out[0, 3] = x
    return out


def lit_scene(place: np.ndarray, moving: list[np.ndarray], deforms: bool = False) -> Frame:
    """A square above a floor, whose shadow falls there, and behind it smoke."""
    scene = Scene()
    square = np.array([[-0.4, -0.4, -3.0], [0.4, -0.4, -3.0], [0.4, 0.4, -3.0], [-0.4, 0.4, -3.0]])
    if deforms:
        changed = [square + matrix[:3, 3] for matrix in moving]
        scene.add_instances(Mesh(square, [[0, 1, 2], [0, 2, 3]], moving=changed), np.eye(4), albedo=[[0.8, 0.4, 0.2]])
    else:
        mesh = Mesh(square, [[0, 1, 2], [0, 2, 3]])
        scene.add_instances(mesh, place, albedo=[[0.8, 0.4, 0.2]], moving=[[each] for each in moving] or None)
    add_square(scene, 4.0, 3.0, diffuse=[[0, 0]])
    floor = [[-3, -3, -4.0], [3, -3, -4.0], [3, 3, -4.0], [-3, 3, -4.0]]
    scene.add_instances(Mesh(floor, [[0, 1, 2], [0, 2, 3]]), np.diag([1, 1, 0.999, 1]), albedo=[[0.5, 0.5, 0.5]])
    scene.add_sun((0.3, 0.0, -1.0), (3.0, 3.0, 3.0))
    return Frame(scene)


@pytest.mark.parametrize("deforms", [False, True])
def test_what_moves_is_the_mean_of_its_places_and_so_is_its_shadow(deforms: bool) -> None:
    ends = [moved(-0.6), moved(0.0), moved(0.6)]
    places = np.linspace(-0.6, 0.6, 65)
    camera = Camera(matrix())
    mean = np.mean([picture(lit_scene(moved(x), []), camera, 16) for x in (places[1:] + places[:-1]) / 2.0], axis=0)
    frame = lit_scene(moved(0.0), ends, deforms)
    seen = picture(frame, Exposure([camera]))
    scale = np.sqrt(np.mean(mean**2))
    assert np.sqrt(np.mean((seen - mean) ** 2)) / scale < 0.015
    still = picture(frame, camera)
    assert np.sqrt(np.mean((still - mean) ** 2)) / scale > 0.05
    assert np.array_equal(frame.render(camera, SIZE, SIZE), lit_scene(moved(0.0), []).render(camera, SIZE, SIZE))


def test_what_turns_is_shaded_as_it_stands_at_each_time() -> None:
    """A square that turns a little about x, in a sun: its cosine is the mean of those on its way, not that of its middle
    as it would be with normals that stay."""

    def turned(angle: float) -> np.ndarray:
        out = np.eye(4)
        out[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        out[2, 3] = -4.0
        return out

    square = Mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])
    scene = Scene()
    angles = np.linspace(0.0, 1.0, 9)
    way = [turned(angle) for angle in angles]
    scene.add_instances(square, turned(0.5), albedo=[[0.8, 0.8, 0.8]], moving=[[each] for each in way])
    towards = np.array([0.0, np.sin(1.2), np.cos(1.2)])
    scene.add_sun(tuple(-towards), (np.pi, np.pi, np.pi))
    seen = picture(Frame(scene), Exposure([Camera(matrix())], shutter=[0.0, 0.25, 0.5, 0.75, 1.0]))[
        SIZE // 2, SIZE // 2, 0
    ]
    middles = (np.arange(4096) + 0.5) / 4096
    normals = np.array([[0.0, -np.sin(angle), np.cos(angle)] for angle in middles])
    expected = 0.8 * np.mean(np.maximum(normals @ towards, 0.0))
    assert seen == pytest.approx(expected, rel=0.01)
    assert 0.8 * max(np.cos(1.2 + 0.5), 0.0) != pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("moving", "says"),
    [
        ([[np.eye(4)]], "moving has 1 times"),
        ([[np.eye(4)]] * 4, "moving has 4 times"),
        ([[np.eye(4)] * 2] * 3, r"moving has shape \(3, 2, 4, 4\)"),
    ],
)
def test_times_that_cannot_be_are_named(moving: list[list[np.ndarray]], says: str) -> None:
    square = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[0, 1, 2]])
    with pytest.raises(ValueError, match=says):
        Scene().add_instances(square, np.eye(4), albedo=[[0.8, 0.8, 0.8]], moving=moving)
    with pytest.raises(ValueError, match="moving has shape"):
        Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[0, 1, 2]], moving=[[[0, 0, 0]]] * 3)
