# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of smoke as arrays: those of domains, of files, and of what modifiers make."""

from __future__ import annotations

import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import fire, meshes


class Missing(ValueError):
    """Smoke that should be there at this frame: its cache or its file is not."""


CLIPPING = 1e-3  # what Cycles counts as active, by default


@dataclass
class Values:
    """A grid (z, y, x), or (z, y, x, 3) of colours, (z, y, x, 4) of a domain's times the fourth, the matrix from its cells to the object, and where on the lattice of all the first cell lies."""

    cells: NDArray[np.float32]
    grid_to_object: NDArray[np.float64]
    first: NDArray[np.int64]

    def room_in(self, low: NDArray[np.int64]) -> tuple[slice, ...]:
        return tuple(slice(begin, begin + size) for begin, size in zip(self.first - low, self.cells.shape))


def enclosed(values: Values, grids: dict[str, Values]) -> tuple[Values, NDArray[np.bool_]]:
    """A grid with room for all of the blocks that Cycles' mesh of a volume with these grids consists of, and the cells in
    those."""
    axes = values.grid_to_object[:3, :3]
    alike = [other for other in grids.values() if np.allclose(other.grid_to_object[:3, :3], axes)]
    low = (np.min([other.first for other in alike], axis=0) - 1) // fire.BLOCK * fire.BLOCK
    high = -(-(np.max([other.first + other.cells.shape[:3] for other in alike], axis=0) + 1) // fire.BLOCK) * fire.BLOCK
    active, cells = np.zeros(high - low, np.bool_), np.zeros(high - low, np.float32)
    for other in alike:
        found = other.cells.any(axis=3) if other.cells.ndim == 4 else other.cells
        active[other.room_in(low)] |= found > CLIPPING
    cells[values.room_in(low)] = values.cells
    moved = values.grid_to_object.copy()
    moved[:3, 3] += axes @ (low - values.first)[::-1]
    return Values(cells, moved, low), fire.in_blocks(active)


def domain_values(settings: Any, frame: int, attributes: list[str]) -> dict[str, Values]:
    """The grids that a domain has of these."""
    found: dict[str, Values] = {}
    for attribute in dict.fromkeys(attributes):
        if attribute == "color" and len(settings.color_grid) and len(settings.density_grid):
            density, grid_to_object = domain_grid(settings, frame, empty=True)
            colours = np.empty(len(settings.color_grid), np.float32)
            settings.color_grid.foreach_get(colours)
            found[attribute] = Values(colours.reshape(*density.shape, 4), grid_to_object, np.zeros(3, np.int64))
        if attribute in DOMAIN_GRIDS and len(getattr(settings, DOMAIN_GRIDS[attribute])):
            found[attribute] = Values(*domain_grid(settings, frame, attribute, empty=True), np.zeros(3, np.int64))
    if not found:
        domain_grid(settings, frame)  # says what is missing
    return found


def volume_values(thing: Any, attributes: list[str]) -> dict[str, Values]:
    """The grids that a file has of these."""
    found: dict[str, Values] = {}
    with file_of(thing) as (path, _):
        for attribute in dict.fromkeys(attributes):
            if path is None or attribute not in thing.data.grids:
                continue
            cells, grid_to_object = core.module().read_volume(path, attribute)
            if not cells.size:
                continue
            # To OpenVDB a sample is a point of the lattice.
            lattice = np.linalg.inv(np.array(thing.data.grids[attribute].matrix_object, np.float64))
            first = np.round((lattice @ grid_to_object @ (0.5, 0.5, 0.5, 1.0))[2::-1]).astype(np.int64)
            grid_to_object[:3, 3] += grid_to_object[:3, :3] @ np.full(3, compat.sample_place())
            found[attribute] = Values(cells, grid_to_object, first)
    if not found:
        raise ValueError(
            f"its file has none of the grids that its material asks for: {', '.join(filter(None, attributes))}"
        )
    return found


# Where a domain keeps what materials ask for by name.
DOMAIN_GRIDS = {
    "density": "density_grid",
    "flame": "flame_grid",
    "heat": "heat_grid",
    "temperature": "temperature_grid",
}


def domain_grid(
    settings: Any, frame: int, attribute: str = "density", empty: bool = False
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """A grid (z, y, x) of a Mantaflow domain, which may be `empty`, and the matrix from its cells to the object."""
    missing = f"no smoke at frame {frame}: bake the domain, or find its cache, '{settings.cache_directory}'"
    if attribute not in DOMAIN_GRIDS:
        raise ValueError(f"its material takes '{attribute}' for density, which a domain has not: nothing is shown")
    found = getattr(settings, DOMAIN_GRIDS[attribute])
    cells = len(found)
    if cells == 0:
        raise _absence(settings, frame, missing)
    density = np.empty(cells, dtype=np.float32)
    found.foreach_get(density)
    resolution = np.array(settings.domain_resolution, dtype=np.int64)
    base = int(resolution.prod())
    # With noise the grid is finer than the domain says, by a whole factor.
    finer = round((cells / base) ** (1.0 / 3.0)) if base else 0
    if finer < 1 or base * finer**3 != cells:
        raise ValueError(f"its grid of {cells} cells does not fit its resolution {tuple(resolution)}")
    if not empty and not density.any():
        raise _absence(settings, frame, missing)
    grid_to_object = np.diag([*(np.array(settings.cell_size) / finer), 1.0])
    # An adaptive domain shrinks to its smoke, and its settings do not say to where; its evaluated mesh does.
    corner = meshes.vertices_of(settings.id_data.data).min(axis=0) if settings.use_adaptive_domain else None
    grid_to_object[:3, 3] = settings.start_point if corner is None else corner
    nx, ny, nz = resolution * finer
    return density.reshape(nz, ny, nx), grid_to_object


def domain_tint(settings: Any, shape: tuple[int, ...], attribute: str) -> NDArray[np.float32] | None:
    """The colours (z, y, x, 3) of a domain's cells, None where Cycles takes white."""
    if attribute != "color" and attribute not in DOMAIN_GRIDS:
        return None
    grid = settings.color_grid if attribute == "color" else getattr(settings, DOMAIN_GRIDS[attribute])
    channels, odd = divmod(len(grid), int(np.prod(shape)))
    if odd or channels not in (1, 4):
        return None
    values = np.empty(len(grid), dtype=np.float32)
    grid.foreach_get(values)
    cells = values.reshape(*shape, channels)
    if channels == 1:
        return np.repeat(np.maximum(cells, 0.0), 3, axis=3)
    # Colours are kept as density times colour, and the density.
    colours: NDArray[np.float32] = np.maximum(cells[..., :3], 0.0) / np.where(
        cells[..., 3:] > 1e-6, cells[..., 3:], 1.0
    )
    return colours


def _absence(settings: Any, frame: int, message: str) -> ValueError:
    """Of a domain without smoke: it may not have any yet; or the cache of a frame that it should have is not there."""
    folder = bpy.path.abspath(settings.cache_directory, library=settings.id_data.library)
    cached = glob.glob(os.path.join(glob.escape(folder), "data", f"*_{frame:04d}.*"))
    expected = settings.cache_frame_start <= frame <= settings.cache_frame_end
    return Missing(message) if expected and not cached else ValueError(message)


@contextmanager
def file_of(thing: Any) -> Iterator[tuple[str | None, bool]]:
    """The file of a Volume object's voxels at this frame, for a while, and whether they are not those of a file of the
    artist's: modifiers and nodes change or make voxels, which Blender writes down for us. None where Blender shows
    nothing. Raises ValueError for a file that is not there."""
    volume = thing.data
    if volume.filepath and not thing.modifiers:
        yield _own_file(volume), False
        return
    volume.grids.load()
    if len(volume.grids) == 0:
        if not volume.filepath and not thing.modifiers:
            raise ValueError("no file: choose an OpenVDB file")
        yield None, True
        return
    handle, path = tempfile.mkstemp(suffix=".vdb", dir=bpy.app.tempdir)
    os.close(handle)
    try:
        if not volume.grids.save(filepath=path):
            raise ValueError(f"its voxels cannot be written to '{path}': {volume.grids.error_message}")
        yield path, True
    finally:
        os.remove(path)


def _own_file(volume: Any) -> str | None:
    volume.grids.load()
    path: str = volume.grids.frame_filepath
    if not volume.is_sequence:
        path = path or str(bpy.path.abspath(volume.filepath, library=volume.library))
        if not os.path.exists(path):
            raise Missing(f"path '{path}' cannot be read: there is no such file")
    if path:
        return path
    if volume.grids.frame == _OUTSIDE:
        return None
    # Once a file was missing, `error_message` stays, and load() goes on to fail, at frames that are there.
    raise Missing(f"no smoke at frame {volume.grids.frame} of its sequence: {volume.grids.error_message}")


_OUTSIDE = 2**31 - 1  # the frame of a sequence that is clipped
