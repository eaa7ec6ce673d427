# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes drawn from a seed, small enough for the judge: smoke over a floor in lights of every kind."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import sfumato
from numpy.typing import NDArray

Array = NDArray[np.float64]
LIGHTS = ("sun", "soft-sun", "point", "ball", "spot", "area", "disk", "two")


@dataclass(frozen=True)
class Case:
    name: str
    scene: sfumato.Scene
    camera: sfumato.Camera
    width: int
    height: int
    soft: bool  # whether a light is large


def smoke(rng: np.random.Generator, cells: int) -> Array:
    """A ball of waves of random lengths, nothing at the faces."""
    axis = (np.arange(cells) + 0.5) / cells * 2.0 - 1.0
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    waves = np.zeros_like(x)
    for _ in range(6):
        k = rng.normal(size=3) * rng.uniform(2.0, 0.35 * cells)
        waves += np.sin(k[0] * x + k[1] * y + k[2] * z + rng.uniform(0.0, 2.0 * math.pi)) / 3.0
    inside = np.cos(0.5 * np.pi * np.minimum(np.sqrt(x * x + y * y + z * z), 1.0)) ** 2
    return np.asarray(inside * np.maximum(1.0 + waves, 0.0))


def looking_at_the_middle(eye: Array, width: int, height: int, spread: float) -> sfumato.Camera:
    near, far = 0.1, 100.0
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = spread * height / width, spread
    projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    projection[3, 2] = -1.0
    backward = eye / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], backward)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(backward, right), backward
    view[:3, 3] = -view[:3, :3] @ eye
    return sfumato.Camera(projection @ view)


def add_light(rng: np.random.Generator, scene: sfumato.Scene, kind: str) -> None:
    turn, height = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.8, 1.4)
    towards = np.array([math.cos(turn) * math.cos(height), math.sin(turn) * math.cos(height), math.sin(height)])
    place, size = 3.0 * towards, float(rng.uniform(0.2, 0.6))
    across = np.cross(towards, [0.0, 0.0, 1.0])
    across *= size / np.linalg.norm(across)
    up = np.cross(towards, across)
    if kind in ("sun", "two"):
        scene.add_sun(-towards, (4, 4, 4))
    elif kind == "soft-sun":
        scene.add_sun(-towards, (4, 4, 4), angle=size)
    if kind in ("point", "two"):
        scene.add_point(place[[1, 0, 2]], (20, 20, 20))
    elif kind == "ball":
        scene.add_point(place, (30, 30, 30), radius=size)
    elif kind == "spot":
        scene.add_point(place, (40, 40, 40), direction=-towards, cone=0.9, blend=0.3)
    elif kind in ("area", "disk"):
        brightness = 30.0 / (4.0 * size * size)
        scene.add_area(place, across, up, (brightness, brightness, brightness), ellipse=kind == "disk")


def case_of(seed: int, number: int) -> Case:
    rng = np.random.default_rng([seed, number])
    kind = LIGHTS[number % len(LIGHTS)]
    cells = int(rng.integers(12, 33))
    density = 10.0 ** rng.uniform(-1.0, math.log10(50.0))
    scene = sfumato.Scene()
    matrix = np.diag([2.0 / cells] * 3 + [1.0])
    matrix[:3, 3] = -1.0
    albedo, anisotropy = rng.uniform(0.5, 0.98), rng.uniform(-0.2, 0.7)
    scene.add_medium(
        smoke(rng, cells), matrix, [density * albedo] * 3, [density * (1.0 - albedo)] * 3, anisotropy=anisotropy
    )
    floor = bool(rng.uniform() < 0.7)
    if floor:
        square = sfumato.Mesh(
            [[-30, -30, -1.1], [30, -30, -1.1], [30, 30, -1.1], [-30, 30, -1.1]], [[0, 1, 2], [0, 2, 3]]
        )
        scene.add_instances(square, np.eye(4), albedo=[[0.6, 0.6, 0.6]])
    add_light(rng, scene, kind)
    # From so high above that no horizon is seen.
    turn, height, away = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.75, 1.3), rng.uniform(2.6, 4.5)
    eye = away * np.array([math.cos(turn) * math.cos(height), math.sin(turn) * math.cos(height), math.sin(height)])
    width = int(rng.choice([24, 32, 48]))
    wide = int(width * 0.75)
    name = f"{seed}-{number} {kind} {cells}^3 x{density:.2g}{' floor' if floor else ''}"
    soft = kind in ("soft-sun", "ball", "area", "disk")
    return Case(name, scene, looking_at_the_middle(eye, width, wide, rng.uniform(1.6, 2.6)), width, wide, soft)


def judged(case: Case, side: int = 3) -> Array:
    """The exact picture, as a box filter sees it through side^2 points of each pixel."""
    options: dict[str, Any] = {"light_samples_per_axis": 3, "sun_samples_per_axis": 5} if case.soft else {}
    fine = sfumato.reference.render(
        case.scene, case.camera, case.width * side, case.height * side, step=0.03, **options
    )
    pixels = fine.reshape(case.height, side, case.width, side, 4)
    return np.asarray(pixels.mean(axis=(1, 3)))
