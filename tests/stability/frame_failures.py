# SPDX-License-Identifier: GPL-3.0-or-later
"""How far pictures are off where methods are known to fail, with light rays stored in every way that a frame has."""

from __future__ import annotations

from typing import Any

import numpy as np
import sfumato
from light_rays import FRAMES, ROOT
from sfumato import Camera, Frame, Scene
from shaft_cases import perspective

Array = np.ndarray

# How a frame may store light rays: as artists have it, what filters, the paper's seven coefficients, slices, and so on.
WAYS: dict[str, dict[str, Any]] = {
    "cosine": {"coefficients": 15},
    "cosine-shared": {"coefficients": 15, "ranges": "shared"},
    "fourier": {"basis": "fourier", "coefficients": 7, "ranges": "shared"},
    "piecewise": {"basis": "piecewise", "coefficients": 7, "ranges": "shared"},
    "learned": {"basis": "learned", "coefficients": 9},
    "curve": {"basis": "curve"},
}
PREVIEW: dict[str, Any] = {"texels_per_cell": 2.0, "steps_per_cell": 1.0, "light_samples": 16}
WIDTH, HEIGHT = 96, 72


def frame(scene: Scene, way: str = "cosine") -> Frame:
    return Frame(scene, **{**PREVIEW, **WAYS[way]})


def pixels(picture: Any) -> Array:
    return np.asarray(picture, float)[..., :3]


def rms(off: Array) -> float:
    return float(np.sqrt(np.mean(np.square(off))))


def camera(eye: Any, target: Any, width: int = WIDTH, height: int = HEIGHT) -> Camera:
    return Camera(perspective(np.array(eye, float), np.array(target, float), width, height))


def add_square(scene: Scene, corners: Any, albedo: float = 0.8, **more: Any) -> None:
    """Of four corners in turn, seen from where they go round counterclockwise."""
    corners = np.asarray(corners, float)
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normals = np.broadcast_to(normal / np.linalg.norm(normal), (2, 3, 3))
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], normals, [0, 0], [[albedo] * 3], **more)


def add_floor(scene: Scene, z: float = 0.0, half: float = 60.0, albedo: float = 0.8) -> None:
    add_square(scene, [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]], albedo)


def cube(cells: int, size: float, at: Any = (0.0, 0.0, 0.0)) -> Array:
    """Grid to world: a cube `size` metres wide, of which `at` is the middle of the lowest face."""
    matrix = np.diag([size / cells] * 3 + [1.0])
    matrix[:3, 3] = np.asarray(at, float) - (size / 2, size / 2, 0.0)
    return matrix


def add_smoke(scene: Scene, density: Array, to_world: Array, extinction: float) -> None:
    scene.add_medium(density, to_world, [0.8 * extinction] * 3, [0.2 * extinction] * 3)


def revolved(cells: int = 32) -> Array:
    """(z, y, x): a cloud that looks the same from all sides, wider above, smooth up to where it ends."""
    z, y, x = np.meshgrid(*[(np.arange(cells) + 0.5) / cells * 2 - 1] * 3, indexing="ij")
    inside = np.minimum(np.hypot(x, y) / (0.5 + 0.15 * z), 1.0)
    return np.asarray((np.cos(np.pi / 2 * inside) * np.cos(np.pi / 2 * z)) ** 2, np.float32)


# ---- What moves ----


def orbit_of_the_camera(way: str) -> float:
    """Round a cloud of revolution in a sun straight above, 3 degrees a frame: the root mean square of what changes from
    frame to frame, where nothing should, by the mean."""
    scene = Scene()
    add_smoke(scene, revolved(), cube(32, 2.0, (0, 0, 0.3)), 7.0)
    scene.add_sun((0, 0, -1), (4, 4, 4))
    add_floor(scene)
    made = frame(scene, way)
    angles = np.radians(3 * np.arange(16))
    eyes = [(5 * np.sin(a), -5 * np.cos(a), 4.0) for a in angles]
    seen = np.array([pixels(made.render(camera(eye, (0, 0, 0.8)), WIDTH, HEIGHT)) for eye in eyes])
    return rms(np.diff(seen, axis=0)) / float(seen.mean())


def orbit_of_the_sun(way: str) -> float:
    """Round the plume, 4 degrees a frame: the change from frame to frame of what the picture is off from the judge's."""
    file, _ = FRAMES["plume"]
    density, to_object = sfumato.read_volume(str(ROOT / "blend_samples" / file))
    eye, size = camera((0, -5, 2.2), (0, 0, 1.2), 24, 18), (24, 18)
    off, truth = [], []
    for angle in np.radians(4 * np.arange(8)):
        scene = Scene()
        add_smoke(scene, density, to_object, 12.0)
        scene.add_sun((np.cos(angle), np.sin(angle), -1), (4, 4, 4))
        add_floor(scene)
        truth.append(pixels(sfumato.reference.render(scene, eye, *size, sun_samples_per_axis=1, step=0.02)))
        off.append(pixels(frame(scene, way).render(eye, *size, 1)) - truth[-1])
    return rms(np.diff(off, axis=0)) / float(np.mean(truth))


def along_the_ray(way: str) -> float:
    """Smoke, floor and eye move along the sun's rays, by three tenths of a cell a frame."""
    sun, seen = np.array((0.4, 0.3, -1.0)), []
    for by in 0.3 / 16 * np.arange(8):
        scene, moved = Scene(), by * sun
        add_smoke(scene, revolved(), cube(32, 2.0, moved + (0, 0, 0.3)), 7.0)
        scene.add_sun(sun, (4, 4, 4))
        add_floor(scene, moved[2])
        eye = camera(moved + (0.5, -4, 3), moved + (0, 0, 0.8))
        seen.append(pixels(frame(scene, way).render(eye, WIDTH, HEIGHT)))
    return rms(np.diff(seen, axis=0)) / float(np.mean(seen))


def stray_wisp(way: str) -> float:
    """A cell of a ten-thousandth of the density, twice as far from the floor as the smoke ends: what it changes, by the
    mean, which is 1e-5 at most of what is there."""
    pictures = []
    for wisp in (0.0, 1e-4):
        density = np.zeros((40, 20, 20), np.float32)
        density[2:18, 2:18, 2:18] = revolved(16)
        density[38, 10, 10] = wisp
        scene = Scene()
        add_smoke(scene, density, cube(20, 2.0, (0, 0, 0.1)), 12.0)
        scene.add_sun((0.05, 0.02, -1.0), (4, 4, 4))
        add_floor(scene)
        eye = camera((0.5, -2.2, 2.0), (0, 0, 0.7))
        pictures.append(pixels(frame(scene, way).render(eye, WIDTH, HEIGHT, 1)))
    return rms(pictures[1] - pictures[0]) / float(pictures[0].mean())


# ---- What is small, dense or far away ----


def filled(where: str) -> Array:
    """(z, y, x): one cell, two that meet at corners of bricks, a line of cells, or a layer of them, in 16³."""
    density = np.zeros((16, 16, 16), np.float32)
    if where == "cell":
        density[8, 8, 8] = 1.0
    elif where == "corners":
        density[3, 3, 3] = density[4, 4, 4] = 1.0
    elif where == "line":
        density[8, 8] = 1.0
    else:
        density[8] = 1.0
    return density


def one_cell_wide(where: str, way: str) -> float:
    """The picture of such smoke, of an optical depth of .8 a cell, beside the judge's, by its mean."""
    scene = Scene()
    add_smoke(scene, filled(where), cube(16, 1.6, (0, 0, 0.2)), 8.0)
    scene.add_sun((0.4, 0.3, -1.0), (4, 4, 4))
    add_floor(scene)
    eye, size = camera((0.5, -2.2, 2.0), (0, 0, 0.7), 48, 36), (48, 36)
    truth = pixels(sfumato.reference.render(scene, eye, *size, sun_samples_per_axis=1, step=0.02))
    return rms(pixels(frame(scene, way).render(eye, *size, 1)) - truth) / float(truth.mean())


def dense_cells(depth: float, edges: str) -> float:
    """The root mean square by which smoke of so great an optical depth a cell is off at Preview, by its mean: a cloud
    that ends softly, or a block of even smoke, which ends within a cell."""
    density = np.zeros((16, 16, 16), np.float32)
    if edges == "soft":
        density[:] = revolved(16)
    else:
        density[2:-2, 2:-2, 2:-2] = 1.0
    eye, size = camera((0.5, -3.2, 2.6), (0, 0, 1.0), 24, 18), (24, 18)
    scene = Scene()
    add_smoke(scene, density, cube(16, 1.6, (0, 0, 0.2)), depth / 0.1)
    scene.add_sun((0.4, 0.5, -1.0), (4, 4, 4))
    step = min(0.02, 0.02 / depth)
    truth = np.asarray(sfumato.reference.render(scene, eye, *size, sun_samples_per_axis=1, step=step))
    seen = pixels(frame(scene).render(eye, *size, 1))
    smoke = truth[..., 3] > 0.5
    return rms((seen - truth[..., :3])[smoke]) / float(truth[smoke][:, :3].mean())


def far_away(metres: float, told: bool) -> float:
    """What being so far from the origin of the world changes, by the mean; `told`: the scene has its origin there."""
    pictures = []
    for away in (0.0, metres):
        at = away * np.array((1.0, -0.5, 0.025))
        scene = Scene()
        if told:
            scene.set_origin(at)
            at = np.zeros(3)
        add_smoke(scene, revolved(), cube(32, 2.0, at + (0, 0, 0.3)), 7.0)
        scene.add_sun((0.4, 0.2, -1), (4, 4, 4))
        add_square(scene, at + [[-6, -6, 0], [6, -6, 0], [6, 6, 0], [-6, 6, 0]])
        pictures.append(pixels(frame(scene).render(camera(at + (0.5, -5.2, 3), at + (0, 0, 0.7)), WIDTH, HEIGHT, 4)))
    return rms(pictures[1] - pictures[0]) / float(pictures[0].mean())


# ---- Leaks and self-shadows ----

LAMPS = ("sun", "point", "ball", "area", "sky")


def add_lamp(scene: Scene, lamp: str) -> None:
    if lamp == "sun":
        scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4), angle=0.05)
    elif lamp == "area":
        scene.add_area((3, 3, 4), (0.3, -0.3, 0), (0.2, 0.2, -0.3), (90, 90, 90))
    elif lamp == "sky":
        scene.add_sky((1, 1, 1))
    else:
        scene.add_point((3, 3, 4), (90, 90, 90), radius=0.2 if lamp == "ball" else 0.0)


def add_room(scene: Scene) -> None:
    """A closed box of walls without thickness, which end where the next ones begin."""
    low, high = np.array((-2.0, -2.0, -0.5)), np.array((2.0, 2.0, 2.5))
    for axis in range(3):
        for side in (low, high):
            corners = np.tile(side, (4, 1))
            for k, other in enumerate(i for i in range(3) if i != axis):
                turn = np.array((0, 1, 1, 0) if k == 0 else (0, 0, 1, 1), bool)
                corners[:, other] = np.where(turn, high[other], low[other])
            add_square(scene, corners)


def leak_into_a_room(lamp: str, air: bool) -> float:
    """The most that a closed room with smoke, or with air, in it shows of a lamp outside, by what is seen without it."""
    pictures = []
    for closed in (True, False):
        scene = Scene()
        add_smoke(scene, np.full((20, 20, 20), 0.1, np.float32), cube(20, 2.0), 2.0)
        add_lamp(scene, lamp)
        if air:
            scene.set_air(mie=(0.05, 0.05, 0.05))
        if closed:
            add_room(scene)
        eye = camera((-1.8, -1.8, 1.9), (0, 0, 0.7), 48, 36)
        pictures.append(pixels(frame(scene).render(eye, 48, 36, 4)))
    return float(pictures[0].max() / pictures[1].max())


def leak_below_a_roof(height: float) -> float:
    """The most that smoke below a black roof shows of a sun straight above it, by what it shows without it. The roof
    lies so many cells above the middles of the cells below."""
    pictures, z = [], 1.05 + 0.1 * height
    for roofed in (True, False):
        density = np.zeros((20, 20, 20), np.float32)
        density[1:-1, 1:-1, 1:-1] = 0.5
        scene = Scene()
        add_smoke(scene, density, cube(20, 2.0), 2.0)
        scene.add_sun((0, 0, -1), (4, 4, 4))
        if roofed:
            add_floor(scene, z, 30.0, 0.0)
        # From just below the plane of the roof, which hides all that is above.
        eye = camera((0, -4, z - 0.3), (0, 0, z - 0.3), 48, 36)
        pictures.append(pixels(frame(scene).render(eye, 48, 36, 1)))
    return float(pictures[0].max() / pictures[1].max())


def shadow_of_itself(kind: str, elevation: float, above: float | None = None) -> float:
    """The largest error of a plate's light in a sun so many degrees above it, by the light. The plate is tilted, away
    from the origin, opaque or half transparent. Where `above` is given, a plate that the camera does not see lies so
    many metres above it, and any light at all is wrong."""
    turn, lift = np.radians((37.0, elevation))
    axes = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    at = np.array([17.3, -41.1, 5.7])
    sun = axes @ [0.6 * np.cos(lift), 0.8 * np.cos(lift), np.sin(lift)]
    scene = Scene()
    more: dict[str, Any] = {} if kind == "solid" else {"transmittance": [[0.5, 0.5, 0.5]]}
    corners = np.array([[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]]) @ axes.T + at
    add_square(scene, corners, **more)
    if above is not None:
        plate = sfumato.Mesh(corners + above * axes[:, 2], [[0, 1, 2], [0, 2, 3]])
        scene.add_instances(plate, np.eye(4), [[0.8] * 3], visibility=sfumato.Visibility("unseen"))
    scene.add_sun(-sun, [np.pi] * 3)
    eye = camera(at + axes @ (0.3, 0.2, 2.0), at)
    seen = pixels(Frame(scene).render(eye, WIDTH, HEIGHT, 1))
    light = 0.0 if above is not None else 1.0
    return float(np.abs(seen / (0.8 * np.sin(lift)) - light).max())
