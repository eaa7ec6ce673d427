# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of `bench.py heavy` that needs no Blender: one case by the module that PYTHONPATH finds, in its own process.

    PYTHONPATH=build/python python3 heavy_module.py CASE METHOD FOLDER

Leaves CASE-METHOD.json and the picture, CASE-METHOD.npy, in FOLDER. Times are of all processors.
"""

from __future__ import annotations

import json
import math
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import sfumato
from numpy.typing import NDArray

from peak_memory import peak_bytes

Answer = tuple[dict[str, "float | None"], NDArray[np.float32]]

SUN = (0.6, 0.48, -0.64)
EDGE = 2.0  # metres, of the cube that a grid fills
OPTICAL_DEPTH = 6.0  # across it, at a density of 1
MARCHES = 15


def camera(width: int, height: int) -> sfumato.Camera:
    """Three metres from the middle of the cube and a little above, so that it fills the picture."""
    near, far, spread = 0.1, 100.0, 2.2
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = spread * height / width, spread
    projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    projection[3, 2] = -1.0
    eye = np.array([0.3, -2.9, 0.8])
    backward = eye / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0], backward)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(backward, right), backward
    view[:3, 3] = -view[:3, :3] @ eye
    return sfumato.Camera(projection @ view)


def scene_of(density: NDArray[np.float32]) -> sfumato.Scene:
    scene = sfumato.Scene()
    cell = EDGE / density.shape[0]
    matrix = np.diag([cell, cell, cell, 1.0])
    matrix[:3, 3] = -0.5 * EDGE
    scattering = 0.9 * OPTICAL_DEPTH / EDGE
    scene.add_medium(density, matrix, [scattering] * 3, [OPTICAL_DEPTH / EDGE - scattering] * 3, 0.3)
    scene.add_sun(SUN, (10.0, 10.0, 10.0))
    return scene


def turbulent(cells: int) -> NDArray[np.float32]:
    """Noise with the spectrum of turbulence, energy as k^(-5/3), of which the upper half is smoke, up to a density of 1."""
    white = np.fft.rfftn(np.random.default_rng(5).standard_normal((cells, cells, cells)))
    whole, half = np.fft.fftfreq(cells, 1.0 / cells), np.fft.rfftfreq(cells, 1.0 / cells)
    square = whole[:, None, None] ** 2 + whole[None, :, None] ** 2 + half[None, None, :] ** 2
    square[0, 0, 0] = math.inf  # no mean
    # In three dimensions a shell holds k^2 modes, so that the amplitude of each goes as k^(-11/6).
    noise = np.fft.irfftn(white * square ** (-11.0 / 12.0), s=(cells, cells, cells))
    noise -= np.median(noise)
    return np.asarray(np.maximum(noise / noise.max(), 0.0), np.float32)


def half_full() -> Answer:
    """The march alone: the frame is made before."""
    frame = sfumato.Frame(scene_of(turbulent(128)))
    size = 640, 360
    runs = []
    for _ in range(MARCHES):
        start = time.process_time()
        picture = frame.render(camera(*size), *size)
        runs.append(time.process_time() - start)
    return {"seconds": statistics.median(runs), "bytes": None}, picture  # making the noise took the most memory


def dense_256() -> Answer:
    """A grid without an empty cell, from the array to the picture."""
    density = np.random.default_rng(6).random((256, 256, 256), np.float32)
    density += np.float32(0.1)
    before = peak_bytes()
    start = time.process_time()
    picture = sfumato.Frame(scene_of(density)).render(camera(64, 36), 64, 36)
    return {"seconds": time.process_time() - start, "bytes": peak_bytes() - before}, picture


CASES: dict[str, Callable[[], Answer]] = {"half-full": half_full, "dense-256": dense_256}


def main(case: str, method: str, folder: Path) -> None:
    answer: dict[str, Any]
    answer, picture = CASES[case]()
    np.save(folder / f"{case}-{method}.npy", picture)
    answer |= {"again": None, "error": None}
    (folder / f"{case}-{method}.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
