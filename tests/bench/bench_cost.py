# SPDX-License-Identifier: GPL-3.0-or-later
"""What lighting smoke costs: the light map of a sun and the lit cells of the sample plume, from 64^3 cells to 512^3."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import sfumato
from numpy.typing import NDArray

import progress
from bench_rows import CostRow

PLUME = Path(__file__).resolve().parents[2] / "blend_samples/plume_cache/data/fluid_data_0025.vdb"
SUN = (0.707, 0.0, -0.707)
CROSS_SECTION = 6.0  # scattering, and as much absorption, per metre and unit density
EDGE = 3.5  # metres, of the cube that the grid fills
RUNS = 3


def resampled(density: NDArray[np.float32], cells: int) -> NDArray[np.float32]:
    """`density` on cells^3, each a linear interpolation of its neighbours along every axis."""
    for axis in (2, 1, 0):
        count = density.shape[axis]
        place = np.clip((np.arange(cells) + 0.5) * count / cells - 0.5, 0.0, count - 1.0)
        below = np.minimum(place.astype(np.intp), count - 2)
        share = (place - below).astype(np.float32).reshape([-1 if a == axis else 1 for a in range(3)])
        finer = np.take(density, below + 1, axis)
        finer -= (lower := np.take(density, below, axis))
        finer *= share
        finer += lower
        density = finer
    return density


def padded(density: NDArray[np.float32], times: int) -> NDArray[np.float32]:
    """`density` in the middle of an empty grid `times` as long along every axis."""
    return np.pad(density, [((times - 1) * n // 2, times * n - n - (times - 1) * n // 2) for n in density.shape])


def scene_of(density: NDArray[np.float32], edge: float) -> sfumato.Scene:
    scene = sfumato.Scene()
    cell = edge / density.shape[0]
    scene.add_medium(density, np.diag([cell, cell, cell, 1.0]), [CROSS_SECTION] * 3, [CROSS_SECTION] * 3)
    scene.add_sun(SUN, (24.0, 24.0, 24.0))
    return scene


def map_shape(frame: sfumato.Frame) -> tuple[int, int]:
    height, width, _ = frame.light_map().coefficients.shape
    return height, width


def texels_per_cell(scene: sfumato.Scene, texels: int) -> float:
    """What gives a map of about texels^2."""
    height, width = map_shape(sfumato.Frame(scene, coefficients=1, texels_per_cell=0.25))
    return 0.25 * (texels - 2) / math.sqrt((height - 2) * (width - 2))


def measure(name: str, scene: sfumato.Scene, occupied: int, texels: int) -> CostRow:
    progress.step(f"{name}, map-{texels}")
    share = texels_per_cell(scene, texels)
    seconds = math.inf
    for _ in range(RUNS):
        start = time.perf_counter()
        frame = sfumato.Frame(scene, texels_per_cell=share)
        seconds = min(seconds, time.perf_counter() - start)
        (height, width), size = map_shape(frame), frame.light_map().bytes
        del frame
    return CostRow(
        case=name,
        method=f"map-{texels}",
        metric="none: this is the time of Frame, light map and lit cells, 15 coefficients",
        error=None,
        seconds=seconds,
        bytes=size,
        voxels=occupied,
        texels=height * width,
        seconds_per_voxel=seconds / occupied,
    )


def cost() -> list[CostRow]:
    """The rows of bench.py cost: cells at a constant map, the map at constant cells, both together, and empty space."""
    plume, _ = sfumato.read_volume(str(PLUME), "density")
    sizes = {64: [128, 512], 128: [256, 512], 256: [256, 512, 1024, 2048], 512: [512, 1024]}
    rows: list[CostRow] = []
    for cells, maps in sizes.items():
        density = resampled(plume, cells)
        occupied = int(np.count_nonzero(density > 1e-5))
        scene = scene_of(density, EDGE)
        if cells == 64:
            space = scene_of(padded(density, 4), 4.0 * EDGE)
        del density
        rows += [measure(f"{cells}^3", scene, occupied, texels) for texels in maps]
        if cells == 64:
            rows.append(measure("64^3 in 256^3", space, occupied, 512))
            del space
        del scene
    return rows
