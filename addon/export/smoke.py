# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke domains as density grids with the cross-sections of their material."""

from __future__ import annotations

import glob
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import emission, fire, materials, meshes
from .parts import Parts


@dataclass
class Medium:
    """A native grid of densities, what they sum up to, and what its material makes of it, per metre and unit density; or
    one of what glows, the rows of what that emits, and the spheres by which it lights what is around it."""

    grid: Any
    amount: float
    grid_to_world: NDArray[np.float64]
    scattering: NDArray[np.float64]
    absorption: NDArray[np.float64]
    anisotropy: float = 0.0
    emission: NDArray[np.float64] | None = None
    flames: list[fire.Flame] = field(default_factory=list)


class Missing(ValueError):
    """Smoke that should be there at this frame: its cache or its file is not."""


def domain_settings(thing: Any) -> Any | None:
    """The settings of a gas domain that is switched on, or None."""
    for modifier in thing.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings is not None:
            if modifier.domain_settings.domain_type == "GAS":
                return modifier.domain_settings
    return None


def media_of(
    thing: Any, matrix: NDArray[np.float64], depsgraph: Any, parts: Parts, notices: list[str]
) -> list[Medium] | None:
    """The smoke of an object at this frame, and its fire; None if it is not smoke, or shows none, as in Cycles. Raises
    ValueError for smoke that is not there."""
    settings = None if thing.type == "VOLUME" else domain_settings(thing)
    if thing.type != "VOLUME" and settings is None:
        return None
    if abs(float(np.linalg.det(matrix[:3, :3]))) < 1e-12:
        raise ValueError(f"its scale {np.linalg.norm(matrix[:3, :3], axis=0).tolist()} leaves the smoke no room")
    smoke = materials.smoke_of(thing, depsgraph, notices)
    if smoke is None:
        return None
    emitters = emission.emitters_of(thing, depsgraph, notices)
    fires = _fires(thing, settings, matrix, depsgraph, smoke, emitters, parts) if emitters else []
    if fires and not smoke.extinction.any():
        return fires
    try:
        if settings is not None:
            medium: Medium | None = _of_domain(settings, matrix, depsgraph, smoke, parts)
        else:
            medium = _of_object(thing, matrix, smoke, parts, notices)
    except Missing:
        raise
    except ValueError:
        if not fires:
            raise
        medium = None  # flames alone
    if medium is not None and smoke.tint:
        _name_bright(thing.name, medium, notices)
    return fires if medium is None else [medium, *fires]


def _fires(
    thing: Any,
    settings: Any | None,
    matrix: NDArray[np.float64],
    depsgraph: Any,
    smoke: materials.Smoke,
    emitters: tuple[emission.Emitter, ...],
    parts: Parts,
) -> list[Medium]:
    """What glows of an object, by the grids that say how. A grid that is not there is as in Cycles."""
    if settings is not None:
        grids = _domain_values(
            settings, depsgraph.scene.frame_current, [smoke.attribute, *(e.attribute for e in emitters)]
        )
    else:
        if thing.data.render.space == "OBJECT":
            unit = world_unit(matrix)
            emitters = tuple(replace(emitter, scale=emitter.scale / unit) for emitter in emitters)
        grids = _volume_values(thing, [smoke.attribute, *(e.attribute for e in emitters)])
    known = emission.merged([e if e.attribute in grids else e.everywhere() for e in emitters])
    return [
        medium for emitter in known if (medium := _fire(emitter, grids, smoke.attribute, matrix, parts)) is not None
    ]


def _fire(
    emitter: emission.Emitter, grids: dict[str, _Values], density: str, matrix: NDArray[np.float64], parts: Parts
) -> Medium | None:
    """What glows by one of an object's grids, or everywhere."""
    values = grids.get(emitter.attribute) or grids.get(density) or next(iter(grids.values()))
    if emitter.attribute not in grids:
        values = replace(values, cells=np.zeros_like(values.cells))
    filled = np.zeros(0, np.bool_)
    if emitter.of(np.zeros(1)).any():
        values, filled = _enclosed(values, grids)
    burning = fire.fire_of(values.cells, emitter, filled, compat.voxels_emit())
    if burning is None:
        return None
    glow, rows = burning.glow, burning.emission
    grid_to_world = matrix @ values.grid_to_object
    grid = parts.part(lambda: (glow,), ("glow",), lambda cells: core.module().Grid(np.zeros_like(cells), glow=cells))
    flames = parts.part(
        lambda: (glow, rows),
        ("flames", grid_to_world.tobytes()),
        lambda *made: fire.flames_of(fire.Fire(*made), grid_to_world),
    )
    assert flames is not None
    return Medium(grid, 0.0, grid_to_world, np.zeros(3), np.zeros(3), 0.0, rows, flames)


_CLIPPING = 1e-3  # what Cycles counts as active, by default


@dataclass
class _Values:
    """A grid (z, y, x), the matrix from its cells to the object, and where on the lattice of all the first cell lies."""

    cells: NDArray[np.float32]
    grid_to_object: NDArray[np.float64]
    first: NDArray[np.int64]

    def room_in(self, low: NDArray[np.int64]) -> tuple[slice, ...]:
        return tuple(slice(begin, begin + size) for begin, size in zip(self.first - low, self.cells.shape))


def _enclosed(values: _Values, grids: dict[str, _Values]) -> tuple[_Values, NDArray[np.bool_]]:
    """A grid with room for all of the blocks that Cycles' mesh of a volume with these grids consists of, and the cells in
    those."""
    axes = values.grid_to_object[:3, :3]
    alike = [other for other in grids.values() if np.allclose(other.grid_to_object[:3, :3], axes)]
    low = (np.min([other.first for other in alike], axis=0) - 1) // fire.BLOCK * fire.BLOCK
    high = -(-(np.max([other.first + other.cells.shape for other in alike], axis=0) + 1) // fire.BLOCK) * fire.BLOCK
    active, cells = np.zeros(high - low, np.bool_), np.zeros(high - low, np.float32)
    for other in alike:
        active[other.room_in(low)] |= other.cells > _CLIPPING
    cells[values.room_in(low)] = values.cells
    moved = values.grid_to_object.copy()
    moved[:3, 3] += axes @ (low - values.first)[::-1]
    return _Values(cells, moved, low), fire.in_blocks(active)


def _domain_values(settings: Any, frame: int, attributes: list[str]) -> dict[str, _Values]:
    """The grids that a domain has of these."""
    found: dict[str, _Values] = {}
    for attribute in dict.fromkeys(attributes):
        if attribute in _DOMAIN_GRIDS and len(getattr(settings, _DOMAIN_GRIDS[attribute])):
            found[attribute] = _Values(*domain_grid(settings, frame, attribute, empty=True), np.zeros(3, np.int64))
    if not found:
        domain_grid(settings, frame)  # says what is missing
    return found


def _volume_values(thing: Any, attributes: list[str]) -> dict[str, _Values]:
    """The grids that a file has of these."""
    found: dict[str, _Values] = {}
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
            found[attribute] = _Values(cells, grid_to_object, first)
    if not found:
        raise ValueError(
            f"its file has none of the grids that its material asks for: {', '.join(filter(None, attributes))}"
        )
    return found


def _of_object(
    thing: Any, matrix: NDArray[np.float64], smoke: materials.Smoke, parts: Parts, notices: list[str]
) -> Medium | None:
    if thing.data.render.space == "OBJECT":
        smoke = smoke.divided_by(world_unit(matrix))
    if thing.data.render.clipping > 1.01e-3:  # more than the default
        notices.append(
            f"{thing.name}: its Clipping of {thing.data.render.clipping:.3g} is not followed; all voxels are shown"
        )
    return _of_volume(thing, matrix, smoke, parts)


def _name_bright(name: str, medium: Medium, notices: list[str]) -> None:
    """Where a cell scatters more light than meets it."""
    albedo = medium.scattering * medium.grid.brightest / np.maximum(medium.scattering + medium.absorption, 1e-30)
    if albedo.max() > 1.001:
        notices.append(
            f"{name}: its Color Attribute makes some smoke scatter {albedo.max():.3g} times the light that meets it; "
            "it is shown no denser for that"
        )


def world_unit(matrix: NDArray[np.float64]) -> float:
    """How long Cycles takes a unit of an object's own space to be, of which a Volume object's density is meant. Seen:
    3.4.1 to 5.0.1, objects scaled by (1, 1, 4), (3, 1, 1), (1, 1, .25); not the cube root of the volume."""
    return float(np.linalg.norm(matrix[:3, :3] @ np.ones(3)) / np.sqrt(3.0))


def _of_domain(
    settings: Any, matrix: NDArray[np.float64], depsgraph: Any, smoke: materials.Smoke, parts: Parts
) -> Medium:
    density, grid_to_object = domain_grid(settings, depsgraph.scene.frame_current, smoke.attribute)
    grid_to_world = matrix @ grid_to_object
    emptiness = core.module().emptiness(density.shape, grid_to_world, smoke.extinction)
    tint = _domain_tint(settings, density.shape, smoke.tint)
    grid = parts.part(
        lambda: (density, tint), ("grid", emptiness), lambda cells, colour: _taken(cells, colour, emptiness)
    )
    assert grid is not None
    return Medium(grid, grid.amount, grid_to_world, smoke.scattering, smoke.absorption, smoke.anisotropy)


def _of_volume(thing: Any, matrix: NDArray[np.float64], smoke: materials.Smoke, parts: Parts) -> Medium | None:
    with file_of(thing) as (found, edited):
        if found is None:
            return None
        path = found
        shape, grid_to_object = core.module().volume_header(path, smoke.attribute)
        if 0 in shape:
            raise ValueError(f"'{path}' holds no smoke")
        # To OpenVDB a sample is a point of the lattice: the header's cells lie around those.
        grid_to_object[:3, 3] += grid_to_object[:3, :3] @ np.full(3, compat.sample_place())
        grid_to_world = matrix @ grid_to_object
        emptiness = core.module().emptiness(shape, grid_to_world, smoke.extinction)
        tint = smoke.tint if smoke.tint in thing.data.grids else None  # without such a grid, Cycles takes white
        grid = parts.part(
            (lambda: (np.fromfile(path, np.uint8),)) if edited else (lambda: _size_and_time(path)),
            ("edited" if edited else "file", "" if edited else path, smoke.attribute, emptiness, tint),
            lambda _: core.module().Grid.from_file(path, smoke.attribute, empty_below=emptiness, colour=tint),
        )
    assert grid is not None
    return Medium(grid, grid.amount, grid_to_world, smoke.scattering, smoke.absorption, smoke.anisotropy)


def _taken(density: NDArray[np.float32], tint: NDArray[np.float32] | None, emptiness: float) -> Any:
    """The native grid; what is negative counts as none, as in Cycles. Raises ValueError for densities that cannot be."""
    if not np.isfinite(density.sum()) and not np.isfinite(density).all():
        raise ValueError(f"density is not finite in {int((~np.isfinite(density)).sum())} cells")
    return core.module().Grid(np.maximum(density, 0.0) if density.min() < 0.0 else density, emptiness, colour=tint)


def _size_and_time(path: str) -> tuple[NDArray[np.int64]]:
    """What tells a file from what it was before. Raises ValueError for one that is gone since its header was read."""
    try:
        status = os.stat(path)
    except OSError as error:
        raise ValueError(f"path '{path}' cannot be read: {error.strerror}") from error
    return (np.array([status.st_size, status.st_mtime_ns], np.int64),)


# Where a domain keeps what materials ask for by name.
_DOMAIN_GRIDS = {
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
    if attribute not in _DOMAIN_GRIDS:
        raise ValueError(f"its material takes '{attribute}' for density, which a domain has not: nothing is shown")
    found = getattr(settings, _DOMAIN_GRIDS[attribute])
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


def _domain_tint(settings: Any, shape: tuple[int, ...], attribute: str) -> NDArray[np.float32] | None:
    """The colours (z, y, x, 3) of a domain's cells, None where Cycles takes white."""
    if attribute != "color" and attribute not in _DOMAIN_GRIDS:
        return None
    grid = settings.color_grid if attribute == "color" else getattr(settings, _DOMAIN_GRIDS[attribute])
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
