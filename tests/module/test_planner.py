# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured error of a picture: what it says is checked against pictures at settings that need no judge."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sfumato import Camera, Frame, Mesh, Prepared, Scene, reference

Array = np.ndarray[Any, Any]
WIDTH, HEIGHT = 48, 32


def camera(eye: tuple[float, float, float] = (1.5, -3.2, 2.2), spread: float = 2.0) -> Camera:
    near, far = 0.1, 100.0
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = spread * HEIGHT / WIDTH, spread
    projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    projection[3, 2] = -1.0
    backward = np.array(eye) / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], backward)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(backward, right), backward
    view[:3, 3] = -view[:3, :3] @ np.array(eye)
    return Camera(projection @ view)


def smoke(cells: int = 24) -> Array:
    x, y, z = np.meshgrid(*[(np.arange(cells) + 0.5) / cells * 2.0 - 1.0] * 3, indexing="ij")
    inside = np.cos(0.5 * np.pi * np.minimum(np.sqrt(x * x + y * y + z * z), 1.0))
    return np.asarray(inside**2 * (1.0 + 0.9 * np.sin(9.0 * x + 4.0 * y) * np.cos(8.0 * z)))


def scene_of(angle: float = 0.0, floor: bool = True) -> Scene:
    scene = Scene()
    matrix = np.diag([1 / 12, 1 / 12, 1 / 12, 1.0])
    matrix[:3, 3] = -1.0
    scene.add_medium(smoke(), matrix, scattering=(3, 3, 3), absorption=(1, 1, 1), anisotropy=0.3)
    scene.add_sun((0.5, 0.3, -0.8), (5, 5, 5), angle=angle)
    if floor:
        square = Mesh([[-9, -9, -1.2], [9, -9, -1.2], [9, 9, -1.2], [-9, 9, -1.2]], [[0, 1, 2], [0, 2, 3]])
        scene.add_instances(square, np.eye(4), albedo=[[0.6, 0.6, 0.6]])
    return scene


def off(picture: Array, expected: Array) -> float:
    picture, expected = picture[..., :3].astype(float), expected[..., :3]
    return float(np.sqrt(np.mean((picture - expected) ** 2)) / np.mean(picture))


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_the_same_on_any_number_of_threads(angle: float) -> None:
    scene = scene_of(angle)
    found = []
    for threads in (1, 2, 3):
        frame = Frame(scene, prepared=Prepared(threads=threads))
        picture = frame.render(camera(), WIDTH, HEIGHT)
        measured = frame.measure(camera(), picture, pixels=96, seed=5)
        found.append((measured.reported, measured.low, measured.high, measured.pixels))
    assert found[0] == found[1] == found[2]


def test_coarse_settings_are_found_to_be_worse_than_fine_ones() -> None:
    scene = scene_of()
    ladder: list[dict[str, Any]] = [
        {"coefficients": 1, "texels_per_cell": 0.1, "steps_per_cell": 0.1},
        {"coefficients": 3, "texels_per_cell": 0.25, "steps_per_cell": 0.25},
        {"coefficients": 31, "texels_per_cell": 4.0, "steps_per_cell": 2.0},
    ]
    high = float("inf")
    for settings in ladder:
        frame = Frame(scene, **settings)
        measured = frame.measure(camera(), frame.render(camera(), WIDTH, HEIGHT, edge_samples=64), pixels=512)
        assert 0.0 <= measured.low <= measured.reported <= measured.high
        assert measured.reported < 0.9 * high
        high = measured.reported


def test_intervals_hold_what_the_judge_finds() -> None:
    """Of smoke alone, whose pixels the judge sees through many points of each."""
    scene, side = scene_of(floor=False), 3
    fine = reference.render(scene, camera(), WIDTH * side, HEIGHT * side, step=0.03)
    exact = fine.reshape(HEIGHT, side, WIDTH, side, 4).mean((1, 3))
    frame = Frame(scene, coefficients=5, texels_per_cell=0.5, steps_per_cell=0.3)
    picture = frame.passes(camera(), WIDTH, HEIGHT, [], edge_samples=64, filter="box")["picture"]
    truth = off(picture, exact)
    held = 0
    for seed in range(20):
        measured = frame.measure(camera(), picture, pixels=256, seed=seed, filter="box")
        held += measured.low <= 1.03 * truth and measured.high >= 0.97 * truth  # 9 points a pixel tell no more
    assert held >= 17


def test_a_light_with_a_size_is_measured_at_all_of_it() -> None:
    """One point for a sun that blurs its shadow is what is wrong with a picture that is fine in all else."""
    scene = scene_of(angle=0.4)
    settings: dict[str, Any] = {"coefficients": 31, "texels_per_cell": 4.0, "steps_per_cell": 2.0}
    found = []
    for samples in (1, 64):
        frame = Frame(scene, light_samples=samples, **settings)
        picture = frame.render(camera(), WIDTH, HEIGHT, edge_samples=64)
        found.append(frame.measure(camera(), picture, pixels=512))
    assert found[0].low > 1.5 * found[1].reported


def test_frames_are_counted_together() -> None:
    scene = scene_of()
    frame = Frame(scene, coefficients=3, texels_per_cell=0.25)
    picture = frame.render(camera(), WIDTH, HEIGHT)
    alone = [frame.measure(camera(), picture, pixels=64, seed=seed) for seed in range(6)]
    together = alone[0]
    for seed in range(1, 6):
        together = frame.measure(camera(), picture, pixels=64, seed=seed, earlier=together)
    assert together.frames == 6 and together.pixels == sum(each.pixels for each in alone)
    mean = np.sqrt(np.mean([each.reported**2 for each in alone]))
    assert together.reported == pytest.approx(mean, rel=0.05)
    assert together.high - together.low < max(each.high - each.low for each in alone)


def test_what_is_not_measured_is_named() -> None:
    scene = scene_of()
    assert Frame(scene).measure(camera(), np.ones((8, 8, 4))).unmeasured == []
    scene.add_particles([[0.0, 0.0, 1.5]], radius=0.3, opacity=0.5, albedo=(1, 1, 1))
    (said,) = Frame(scene).measure(camera(), np.ones((8, 8, 4))).unmeasured
    assert "particles" in said


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"picture": np.ones((4, 4, 3))}, r"picture has shape \(4, 4, 3\)"),
        ({"picture": np.full((4, 4, 4), np.nan)}, "picture holds"),
        ({"pixels": 3}, "pixels is 3"),
        ({"filter": "cubic"}, "filter is 'cubic'"),
        ({"filter_width": 0.0}, "filter_width is 0"),
    ],
)
def test_bad_arguments_are_refused_by_name_and_value(arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        wanted: dict[str, Any] = {"picture": np.ones((4, 4, 4)), **arguments}
        Frame(Scene()).measure(camera(), **wanted)
