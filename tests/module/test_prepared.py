# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with identity: what did not change is not made again, and a frame is what it would be without them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sfumato
from sfumato import Camera, Frame, Grid, Mesh, Prepared, Scene

SIZE = 24, 16
CAMERA = Camera(np.array([[0.5, 0.0, 0.0, 0.0], [0.0, 0.45, 0.25, -0.1], [0.0, 0.1, -0.12, 0.3], [0.0, 0.0, 0.0, 1.0]]))
QUAD = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
RNG = np.random.default_rng(3)
SMOKE = (RNG.random((10, 9, 8)) * 3.0).astype(np.float32)


def placed(x: float, y: float, z: float, scale: float = 1.0) -> NDArray[np.float64]:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = x, y, z
    return matrix


GRID_TO_WORLD = placed(-0.4, -0.45, 0.3, 0.1)


class Description:
    """A scene by the things that can change in it."""

    def __init__(self) -> None:
        self.places = [placed(0, 0, 0, 4.0), placed(0.6, 0.2, 0.9, 0.2)]
        self.albedo = [0.8, 0.6, 0.4]
        self.sun = (0.3, 0.2, -1.0)
        self.lamp = np.array([1.0, -1.0, 2.0])
        self.strength = 3.0
        self.grid: Any = Grid(SMOKE)
        self.grid_to_world = GRID_TO_WORLD
        self.scattering = 1.0

    def scene(self) -> Scene:
        scene = Scene()
        scene.add_instances(QUAD, np.stack(self.places), [self.albedo])
        scene.add_medium(self.grid, self.grid_to_world, np.full(3, self.scattering), np.full(3, 0.5))
        scene.add_sun(self.sun, np.full(3, self.strength))
        scene.add_point(self.lamp, (9, 9, 9), radius=0.1)
        return scene


def picture(frame: Any) -> NDArray[np.float32]:
    return np.asarray(frame.render(CAMERA, *SIZE, edge_samples=4))


def turn_the_sun(d: Description) -> None:
    d.sun = (0.1, 0.2, -1.0)


def move_the_lamp(d: Description) -> None:
    d.lamp = d.lamp + 0.1


def dim(d: Description) -> None:
    d.strength = 2.0


def move_a_mesh(d: Description) -> None:
    d.places[1] = placed(0.5, 0.2, 0.9, 0.2)


def add_a_place(d: Description) -> None:
    d.places.append(placed(-0.6, 0.2, 0.9, 0.2))


def paint(d: Description) -> None:
    d.albedo = [0.1, 0.6, 0.4]


def change_the_smoke(d: Description) -> None:
    d.grid = Grid(SMOKE[::-1].copy())


def thicken(d: Description) -> None:
    d.scattering = 2.0


def move_the_smoke(d: Description) -> None:
    d.grid_to_world = placed(-0.3, -0.45, 0.3, 0.1)


def nothing(_: Description) -> None:
    pass


# What each change makes anew: meshes, places, maps, solids on maps, volumes. There are two lights and one body of smoke.
CHANGES: list[tuple[Callable[[Description], None], tuple[int, int, int, int, int]]] = [
    (nothing, (0, 0, 0, 0, 0)),
    (dim, (0, 0, 0, 0, 0)),
    (paint, (0, 0, 0, 0, 0)),
    (turn_the_sun, (0, 0, 1, 1, 1)),
    (move_the_lamp, (0, 0, 1, 1, 1)),
    (move_a_mesh, (0, 1, 0, 2, 2)),
    (add_a_place, (0, 1, 0, 2, 2)),
    (change_the_smoke, (0, 0, 2, 0, 2)),
    (thicken, (0, 0, 2, 0, 2)),
    (move_the_smoke, (0, 0, 2, 2, 2)),
]
IDS = [change.__name__ for change, _ in CHANGES]


@pytest.mark.parametrize("change, made", CHANGES, ids=IDS)
def test_only_what_changed_is_made(change: Callable[[Description], None], made: tuple[int, ...]) -> None:
    described, prepared = Description(), Prepared()
    first = Frame(described.scene(), light_samples=1, prepared=prepared)
    before = picture(first)
    counts = prepared.made
    assert tuple(counts.values()) == (1, 1, 2, 2, 2)
    change(described)
    second = Frame(described.scene(), light_samples=1, prepared=prepared)
    assert tuple(prepared.made[name] - counts[name] for name in counts) == made
    after = picture(second)
    assert (after == picture(Frame(described.scene(), light_samples=1))).all()
    assert (after != before).any() == (change is not nothing)
    assert (picture(first) == before).all()  # the older frame has what it was made of


def test_what_nobody_asked_for_is_forgotten() -> None:
    described, prepared = Description(), Prepared()
    Frame(described.scene(), light_samples=1, prepared=prepared)
    Frame(Scene(), prepared=prepared)
    Frame(described.scene(), light_samples=1, prepared=prepared)
    assert tuple(prepared.made.values()) == (2, 2, 4, 4, 4)


def test_a_place_is_a_mesh_moved_there() -> None:
    """By any affine map, mirrored and flattened ones too."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 0.8]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    shape = Mesh(corners, triangles)
    turned = np.array([[0.6, -0.5, 0.1, 0.3], [0.4, 0.7, 0.2, -0.6], [-0.1, 0.3, 0.9, 0.4], [0.0, 0.0, 0.0, 1.0]])
    for matrix in (turned, turned @ np.diag([-1.0, 1, 1, 1]), turned @ np.diag([1.0, 2.0, 0.1, 1])):
        placed_scene, moved_scene = Scene(), Scene()
        placed_scene.add_instances(shape, matrix, [[0.8, 0.7, 0.6]])
        moved = corners @ matrix[:3, :3].T + matrix[:3, 3]
        moved_scene.add_instances(Mesh(moved, triangles), np.eye(4), [[0.8, 0.7, 0.6]])
        pictures = []
        for scene in (placed_scene, moved_scene):
            scene.add_sun((0.3, 0.5, -1.0), (3, 3, 3))
            pictures.append(picture(Frame(scene)))
        assert np.abs(pictures[0] - pictures[1]).max() < 1e-5
        assert pictures[0].max() > 0.1


@pytest.mark.parametrize("normals", ["flat", "vertex", "corner"])
def test_normals_of_all_kinds_are_the_references(normals: str) -> None:
    corners = np.array([[-1.0, -1, 0.2], [1, -1, 0], [1, 1, 0.4], [-1, 1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    of_vertices = np.array([[0.1, 0.2, 1.0], [0, 0.3, 1.0], [-0.3, 0, 1.0], [0.2, -0.2, 1.0]])
    of_vertices /= np.linalg.norm(of_vertices, axis=1, keepdims=True)
    given = {"flat": None, "vertex": of_vertices, "corner": of_vertices[triangles]}[normals]
    scene = Scene()
    scene.add_instances(Mesh(corners, triangles, given), placed(0.1, -0.1, 0.2, 0.8), [[0.8, 0.7, 0.6]])
    scene.add_sun((0.3, 0.5, -1.0), (3, 3, 3))
    seen = np.asarray(Frame(scene).render(CAMERA, *SIZE, edge_samples=1))
    exact = np.asarray(sfumato.reference.render(scene, CAMERA, *SIZE))
    inside = exact[..., 3] == 1.0
    assert inside.sum() > 40 and np.abs(seen - exact)[inside & (seen[..., 3] == 1.0)].max() < 1e-5


def test_threads_do_not_change_a_picture() -> None:
    described = Description()
    one, many = (picture(Frame(described.scene(), prepared=Prepared(threads=n))) for n in (1, 0))
    assert (one == many).all()


def test_a_grid_is_the_array_that_it_was_made_of() -> None:
    by_array, by_grid = Description(), Description()
    extinction = np.full(3, 1.5)
    by_grid.grid = Grid(SMOKE, sfumato.emptiness(SMOKE.shape, GRID_TO_WORLD, extinction))
    by_array.grid = SMOKE
    assert (picture(Frame(by_array.scene())) == picture(Frame(by_grid.scene()))).all()
    with pytest.raises(ValueError, match="medium 0 came as a Grid"):
        sfumato.reference.render(by_grid.scene(), CAMERA, 1, 1)


def test_refusals() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    with pytest.raises(ValueError, match="triangles holds 3 at flat index 2"):
        Mesh(corners, np.array([[0, 1, 3]], np.int32))
    with pytest.raises(ValueError, match="triangles holds -1 at flat index 0"):
        Mesh(corners, np.array([[-1, 1, 2]], np.int32))
    with pytest.raises(ValueError, match=r"normals has shape \(2, 3\), but must have \(3, 3\)"):
        Mesh(corners, [[0, 1, 2]], np.ones((2, 3)))
    with pytest.raises(ValueError, match="vertices holds nan at flat index 0"):
        Mesh(corners + np.array([np.nan, 0, 0]), [[0, 1, 2]])
    mesh = Mesh(corners, [[0, 1, 2]], material=[2])
    with pytest.raises(ValueError, match="albedo has 1 rows, but the mesh names 3 materials"):
        Scene().add_instances(mesh, np.eye(4), [[1, 1, 1]])
    with pytest.raises(ValueError, match=r"to_world has shape \(3, 3\), but must have \(4, 4\) or \(any, 4, 4\)"):
        Scene().add_instances(mesh, np.eye(3), [[1, 1, 1]] * 3)
    with pytest.raises(ValueError, match="to_world holds 2 at flat index 31; its last row must be 0, 0, 0, 1"):
        Scene().add_instances(mesh, np.stack([np.eye(4), np.diag([1, 1, 1, 2])]), [[1, 1, 1]] * 3)
    with pytest.raises(ValueError, match="threads is -1"):
        Prepared(threads=-1)
    with pytest.raises(ValueError, match="density holds -1 at flat index 0"):
        Grid(np.full((2, 2, 2), -1.0))
