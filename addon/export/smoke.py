# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke domains as density grids with the cross-sections of their material."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import materials
from .parts import Parts


@dataclass
class Medium:
    """A native grid of densities, what they sum up to, and what its material makes of it, per metre and unit density."""

    grid: Any
    amount: float
    grid_to_world: NDArray[np.float64]
    scattering: NDArray[np.float64]
    absorption: NDArray[np.float64]
    anisotropy: float


def domain_settings(thing: Any) -> Any | None:
    """The settings of a gas domain that is switched on, or None."""
    for modifier in thing.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings is not None:
            if modifier.domain_settings.domain_type == "GAS":
                return modifier.domain_settings
    return None


def medium_of(
    thing: Any, matrix: NDArray[np.float64], depsgraph: Any, parts: Parts, notices: list[str]
) -> Medium | None:
    """The smoke of an object at this frame, None if it is not smoke. Raises ValueError for smoke that is not there."""
    settings = None if thing.type == "VOLUME" else domain_settings(thing)
    if thing.type != "VOLUME" and settings is None:
        return None
    room = abs(float(np.linalg.det(matrix[:3, :3])))
    if room < 1e-12:
        raise ValueError(f"its scale {np.linalg.norm(matrix[:3, :3], axis=0).tolist()} leaves the smoke no room")
    shape: tuple[int, ...]
    if settings is None:
        path, shape, grid_to_object = volume_file(thing.data)
    else:
        density, grid_to_object = domain_grid(settings, depsgraph.scene.frame_current)
        shape = density.shape
    scattering, absorption, anisotropy = materials.cross_sections(thing, notices)
    if thing.type == "VOLUME" and thing.data.render.space == "OBJECT":
        # A volume's density is per unit of the object's own space, a domain's per metre.
        scale = room ** (1.0 / 3.0)
        scattering, absorption = scattering / scale, absorption / scale
    grid_to_world = matrix @ grid_to_object
    emptiness = core.module().emptiness(shape, grid_to_world, scattering + absorption)
    if settings is None:
        grid = parts.part(
            lambda: _size_and_time(path),
            ("file", path, emptiness),
            lambda _: core.module().Grid.from_file(path, empty_below=emptiness),
        )
    else:
        grid = parts.part(lambda: (density,), ("grid", emptiness), lambda cells: _taken(cells, emptiness))
    assert grid is not None
    return Medium(grid, grid.amount, grid_to_world, scattering, absorption, anisotropy)


def _taken(density: NDArray[np.float32], emptiness: float) -> Any:
    """The native grid. Raises ValueError for densities that cannot be."""
    if not np.isfinite(density.sum()) and not np.isfinite(density).all():
        raise ValueError(f"density is not finite in {int((~np.isfinite(density)).sum())} cells")
    return core.module().Grid(density, emptiness)


def _size_and_time(path: str) -> tuple[NDArray[np.int64]]:
    """What tells a file from what it was before. Raises ValueError for one that is gone since its header was read."""
    try:
        status = os.stat(path)
    except OSError as error:
        raise ValueError(f"path '{path}' cannot be read: {error.strerror}") from error
    return (np.array([status.st_size, status.st_mtime_ns], np.int64),)


def domain_grid(settings: Any, frame: int) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Density (z, y, x) of a Mantaflow domain, and the matrix from its cells to the object."""
    missing = f"no smoke at frame {frame}: bake the domain, or find its cache, '{settings.cache_directory}'"
    cells = len(settings.density_grid)
    if cells == 0:
        raise ValueError(missing)
    density = np.empty(cells, dtype=np.float32)
    settings.density_grid.foreach_get(density)
    resolution = np.array(settings.domain_resolution, dtype=np.int64)
    base = int(resolution.prod())
    # With noise the grid is finer than the domain says, by a whole factor.
    finer = round((cells / base) ** (1.0 / 3.0)) if base else 0
    if finer < 1 or base * finer**3 != cells:
        raise ValueError(f"its grid of {cells} cells does not fit its resolution {tuple(resolution)}")
    if not density.any():
        raise ValueError(missing)
    grid_to_object = np.diag([*(np.array(settings.cell_size) / finer), 1.0])
    grid_to_object[:3, 3] = settings.start_point
    nx, ny, nz = resolution * finer
    return density.reshape(nz, ny, nx), grid_to_object


def volume_file(volume: Any) -> tuple[str, tuple[int, int, int], NDArray[np.float64]]:
    """The path of a Volume object's file at this frame, its density's shape, and the matrix from its cells to the object."""
    if not volume.filepath:
        raise ValueError("no file: choose an OpenVDB file")
    volume.grids.load()
    path = volume.grids.frame_filepath or bpy.path.abspath(volume.filepath, library=volume.library)
    shape, grid_to_object = core.module().volume_header(path)
    if 0 in shape:
        raise ValueError(f"'{path}' holds no smoke")
    # To OpenVDB a sample is a point of the lattice: the header's cells lie around those.
    grid_to_object[:3, 3] += grid_to_object[:3, :3] @ np.full(3, compat.sample_place())
    return path, shape, grid_to_object
