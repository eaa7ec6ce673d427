# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke domains as density grids with the cross-sections of their material."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import cells, emission, fire, materials, voxels
from .parts import Parts
from .shading import shaders
from .shading.fields import Field


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
    look = shaders.look_of(thing, depsgraph, notices)
    if look is None:
        return None
    if thing.type == "VOLUME" and thing.data.render.clipping > 1.01e-3:  # more than the default
        notices.append(
            f"{thing.name}: its Clipping of {thing.data.render.clipping:.3g} is not followed; all voxels are shown"
        )
    fires, bodies = _by_grids(thing, settings, matrix, depsgraph, look, parts, notices)
    smoke = look.plain
    if smoke is None or (fires and not smoke.extinction.any()):
        return bodies + fires
    try:
        if settings is not None:
            medium: Medium | None = _of_domain(settings, matrix, depsgraph, smoke, parts)
        else:
            medium = _of_object(thing, matrix, smoke, parts)
    except voxels.Missing:
        raise
    except ValueError:
        if not fires:
            raise
        medium = None  # flames alone
    if medium is not None and smoke.tint:
        _name_bright(thing.name, medium, notices)
    return fires if medium is None else [medium, *fires]


def _by_grids(
    thing: Any,
    settings: Any | None,
    matrix: NDArray[np.float64],
    depsgraph: Any,
    look: shaders.Look,
    parts: Parts,
    notices: list[str],
) -> tuple[list[Medium], list[Medium]]:
    """What glows of an object, and its smoke that is not plain, by the grids that say how. A grid that is not there is as
    in Cycles."""
    if not (look.emission or look.bodies) or not look.attributes:
        return [], []  # of what asks for no grid, Cycles shows nothing
    scale = 1.0
    if settings is not None:
        grids = voxels.domain_values(settings, depsgraph.scene.frame_current, look.attributes)
        if "velocity" in look.attributes:
            notices.append(
                f"{thing.name}: its material asks for the domain's velocity, which is not read; it is taken for 0"
            )
    else:
        if thing.data.render.space == "OBJECT":
            scale = 1.0 / world_unit(matrix)
        grids = voxels.volume_values(thing, look.attributes)
    if compat.constants_fill_more() and any(not glow.attributes for glow in look.emission):
        notices.append(
            f"{thing.name}: it emits the same everywhere; around its smoke that fills less than in Cycles of this Blender"
        )
    joint = [glow for glow in look.emission if _takes_cells(glow, grids)]
    alone = emission.emitters_of((glow for glow in look.emission if glow not in joint), scale)
    known = emission.merged(e if e.attribute in grids else e.everywhere() for e in alone)
    smoke = look.plain.attribute if look.plain is not None else ""
    made = [_fire(emitter, grids, smoke, matrix, parts) for emitter in known]
    made += _of_cells(thing.name, look.bodies, joint, grids, matrix, scale, parts, notices)
    found = [medium for medium in made if medium is not None]
    return [one for one in found if one.emission is not None], [one for one in found if one.emission is None]


def _takes_cells(glow: Field, grids: dict[str, voxels.Values]) -> bool:
    """Whether what is emitted is no function of one number."""
    return len(glow.attributes) > 1 or any(grids[name].cells.ndim == 4 for name in glow.attributes if name in grids)


def _of_cells(
    name: str,
    bodies: tuple[shaders.Body, ...],
    glows: list[Field],
    grids: dict[str, voxels.Values],
    matrix: NDArray[np.float64],
    scale: float,
    parts: Parts,
    notices: list[str],
) -> list[Medium]:
    """Smoke and fire that are calculated cell by cell: again only where grids, nodes or the object's place changed."""
    if not bodies and not glows:
        return []
    names = sorted(grids)
    wanted = [field for body in bodies for field in (body.scattering, body.absorption)] + glows
    asked = [field.digest for field in (*wanted, *(body.anisotropy for body in bodies))]
    where = [(grid.grid_to_object.tobytes(), grid.first.tobytes()) for grid in grids.values()]

    def made(*_: Any) -> list[list[Medium]]:
        lattice = cells.lattice_of(grids, 1 if compat.voxels_emit() else cells.fineness(wanted, grids))
        to_world = matrix @ lattice.grid_to_object
        smoke = [cells.parts_of(body, lattice, to_world, scale) for body in bodies]
        out = [
            [Medium(p.grid, p.grid.amount, to_world, p.scattering, p.absorption, p.anisotropy) for p in one]
            for one in smoke
        ]
        for glow in glows:
            burning = cells.fires_of(glow, lattice, scale)
            lit = [_glowing(one.glow, one.emission, to_world) for one in burning]
            if lit:
                lit[0].flames = fire.flames_of(burning, to_world)
            out.append(lit)
        return out

    found = parts.part(
        lambda: [grids[one].cells for one in names], ("cells", *names, *asked, *where, matrix.tobytes(), scale), made
    )
    assert found is not None
    for media, body in zip(found, bodies):
        if media and body.anisotropy.constant is None:
            mean = media[0].anisotropy
            notices.append(f"{name}: its Anisotropy differs from place to place; it is taken for its mean, {mean:.3g}")
    return [medium for media in found for medium in media]


def _glowing(glow: NDArray[np.float32], rows: NDArray[np.float64], grid_to_world: NDArray[np.float64]) -> Medium:
    grid = core.module().Grid(np.zeros_like(glow), glow=glow)
    return Medium(grid, 0.0, grid_to_world, np.zeros(3), np.zeros(3), 0.0, rows)


def _fire(
    emitter: emission.Emitter, grids: dict[str, voxels.Values], density: str, matrix: NDArray[np.float64], parts: Parts
) -> Medium | None:
    """What glows by one of an object's grids, or everywhere."""
    values = grids.get(emitter.attribute) or grids.get(density) or next(iter(grids.values()))
    if emitter.attribute not in grids:
        values = replace(values, cells=np.zeros(values.cells.shape[:3], np.float32))
    filled = np.zeros(0, np.bool_)
    if emitter.of(np.zeros(1)).any():
        values, filled = voxels.enclosed(values, grids)
    burning = fire.fire_of(values.cells, emitter, filled, compat.voxels_emit())
    if burning is None:
        return None
    glow, rows = burning.glow, burning.emission
    grid_to_world = matrix @ values.grid_to_object
    grid = parts.part(lambda: (glow,), ("glow",), lambda cells: core.module().Grid(np.zeros_like(cells), glow=cells))
    flames = parts.part(
        lambda: (glow, rows),
        ("flames", grid_to_world.tobytes()),
        lambda *made: fire.flames_of([fire.Fire(*made)], grid_to_world),
    )
    assert flames is not None
    return Medium(grid, 0.0, grid_to_world, np.zeros(3), np.zeros(3), 0.0, rows, flames)


def _of_object(thing: Any, matrix: NDArray[np.float64], smoke: materials.Smoke, parts: Parts) -> Medium | None:
    if thing.data.render.space == "OBJECT":
        smoke = smoke.divided_by(world_unit(matrix))
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
    density, grid_to_object = voxels.domain_grid(settings, depsgraph.scene.frame_current, smoke.attribute)
    grid_to_world = matrix @ grid_to_object
    emptiness = core.module().emptiness(density.shape, grid_to_world, smoke.extinction)
    tint = voxels.domain_tint(settings, density.shape, smoke.tint)
    grid = parts.part(
        lambda: (density, tint), ("grid", emptiness), lambda cells, colour: _taken(cells, colour, emptiness)
    )
    assert grid is not None
    return Medium(grid, grid.amount, grid_to_world, smoke.scattering, smoke.absorption, smoke.anisotropy)


def _of_volume(thing: Any, matrix: NDArray[np.float64], smoke: materials.Smoke, parts: Parts) -> Medium | None:
    with voxels.file_of(thing) as (found, edited):
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
