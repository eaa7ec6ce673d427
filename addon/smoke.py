# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke domains as density grids with the cross-sections of their material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import materials


@dataclass
class Medium:
    """A density grid (z, y, x) and what its material makes of it, per metre and unit density."""

    density: NDArray[np.float32]
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


def medium_of(thing: Any, matrix: NDArray[np.float64], depsgraph: Any, notices: list[str]) -> Medium | None:
    """The smoke of an object at this frame, None if it is not smoke. Raises ValueError for smoke that is not there."""
    settings = domain_settings(thing)
    if settings is None:
        return None
    frame = depsgraph.scene.frame_current
    cells = len(settings.density_grid)
    if cells == 0:
        raise ValueError(f"no smoke at frame {frame}. Bake the domain; its cache is '{settings.cache_directory}'")
    density = np.empty(cells, dtype=np.float32)
    settings.density_grid.foreach_get(density)
    resolution = np.array(settings.domain_resolution, dtype=np.int64)
    base = int(resolution.prod())
    # With noise the grid is finer than the domain says, by a whole factor.
    finer = round((cells / base) ** (1.0 / 3.0)) if base else 0
    if finer < 1 or base * finer**3 != cells:
        raise ValueError(f"its grid of {cells} cells does not fit its resolution {tuple(resolution)}")
    resolution *= finer
    if not np.isfinite(density).all():
        raise ValueError(f"density is not finite in {int((~np.isfinite(density)).sum())} cells at frame {frame}")
    if not density.any():
        raise ValueError(f"the smoke is empty at frame {frame}. Bake it, or look for '{settings.cache_directory}'")
    grid_to_object = np.diag([*(np.array(settings.cell_size) / finer), 1.0])
    grid_to_object[:3, 3] = settings.start_point
    scattering, absorption, anisotropy = materials.cross_sections(thing, notices)
    nx, ny, nz = resolution
    return Medium(density.reshape(nz, ny, nx), matrix @ grid_to_object, scattering, absorption, anisotropy)
