# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py package: the module of a release against the one that was built with Debian's libraries, in one process.

Both see the sample plume above a floor under a sun, as one frame of 640 x 360. They take turns, and the least time of each
counts, of all processors.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from bench_rows import Row
from blender_run import ROOT

TURNS = 15
SIZE = (640, 360)
METRIC = "largest difference from Debian's picture"
PLUME = ROOT / "blend_samples" / "plume_cache" / "data" / "fluid_data_0025.vdb"


def module_in(folder: Path) -> ModuleType:
    """The native module of that folder that this Python can load. Raises FileNotFoundError without one."""
    for suffix in importlib.machinery.EXTENSION_SUFFIXES:
        path = folder / f"sfumato{suffix}"
        if path.exists():
            spec = importlib.util.spec_from_file_location("sfumato", path)
            assert spec and spec.loader
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            return module
    raise FileNotFoundError(f"{folder} has no module for this Python; tests/run and packaging/release build them")


def render_of(module: ModuleType) -> Callable[[], NDArray[np.float32]]:
    """What makes a frame of the plume from nothing, and its picture."""
    density, to_object = module.read_volume(str(PLUME))
    size = np.array(density.shape[::-1])
    centre = to_object @ [*(0.5 * size), 1.0]
    extent = float(to_object[0, 0] * size.max())
    floor = module.Mesh(
        extent * np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]]) + [centre[0], centre[1], to_object[2, 3]],
        [[0, 1, 2], [0, 2, 3]],
    )
    view = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)  # along Y
    view[:3, 3] = -view[:3, :3] @ centre[:3] - [0, 0, 2.5 * extent]
    near, far = 0.1 * extent, 10.0 * extent
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = 1.6, 1.6 * SIZE[0] / SIZE[1]
    projection[2, 2], projection[2, 3] = (far + near) / (near - far), 2.0 * far * near / (near - far)
    projection[3, 2] = -1.0
    camera = module.Camera(projection @ view)

    def render() -> NDArray[np.float32]:
        scene = module.Scene()
        scene.add_medium(density, to_object, scattering=(8, 8, 8), absorption=(2, 2, 2))
        scene.add_instances(floor, np.eye(4), albedo=[[0.8, 0.8, 0.8]])
        scene.add_sun((0.3, 0.4, -1.0), (4, 4, 4), 0.009)
        picture: NDArray[np.float32] = module.Frame(scene).render(camera, *SIZE)
        return picture

    return render


def package() -> tuple[list[Row], list[str]]:
    """Seconds of a frame by each module, and how many times as long the release's takes."""
    folders = {"debian": ROOT / "build" / "python", "package": ROOT / "build" / "release" / "python"}
    renders = {name: render_of(module_in(folder)) for name, folder in folders.items()}
    seconds = dict.fromkeys(renders, float("inf"))
    pictures = {name: render() for name, render in renders.items()}  # kernels and threads
    for _ in range(TURNS):
        for name, render in renders.items():
            start = time.process_time()
            render()
            seconds[name] = min(seconds[name], time.process_time() - start)
    rows: list[Row] = [
        {
            "case": "plume",
            "method": name,
            "metric": METRIC,
            "error": float(np.abs(pictures[name] - pictures["debian"]).max()),
            "seconds": seconds[name],
            "bytes": None,
        }
        for name in renders
    ]
    return rows, [f"the release takes {seconds['package'] / seconds['debian']:.2f} times as long"]
