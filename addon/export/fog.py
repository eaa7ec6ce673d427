# SPDX-License-Identifier: GPL-3.0-or-later
"""Fog: meshes whose material has a volume, which fills them evenly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from . import air, materials, meshes
from .parts import Parts


@dataclass(frozen=True)
class Vessel:
    """A mesh as fog fills it: the native one, how many of its edges are not shared by two triangles, and whether its
    normals point inwards."""

    mesh: Any
    open_edges: int
    inside_out: bool


def volume_of(thing: Any, depsgraph: Any, notices: list[str]) -> air.Even | None:
    """What fills an object, by the first of its materials with a volume, as Cycles reads it in a mesh; None where nothing
    does."""
    filling = [
        material
        for material in dict.fromkeys(materials.materials_of(thing, depsgraph))
        if material is not None and _fills(material)
    ]
    if not filling:
        return None
    found = air.even_volume(materials.active_output(filling[0]), thing.name, notices)
    if found is None or found.is_nothing:
        return None
    if len(filling) > 1:
        notices.append(f"{thing.name}: {len(filling)} of its materials have a volume; the first fills all of it")
    if found.emission.any():
        notices.append(f"{thing.name}: its volume glows, but lights nothing else")
    return found


def _fills(material: Any) -> bool:
    output = materials.active_output(material)
    return output is not None and air.is_filled(output)


def vessel_of(thing: Any, depsgraph: Any, parts: Parts) -> Vessel | None:
    """The mesh that a volume fills; None without triangles. Raises ValueError for what cannot be shown."""

    def read() -> tuple[Any, ...] | None:
        found = meshes.triangles_of(thing, 1)
        return None if found is None else (found.vertices, found.triangles)

    owner = meshes.owner_of(thing, depsgraph, ("fog",)) if parts.told else None
    made: Vessel | None = parts.part(read, ("fog",), _vessel, owner)
    return made


def _vessel(vertices: NDArray[np.float32], triangles: NDArray[np.int32]) -> Vessel:
    corners = vertices.astype(np.float64)[triangles]
    corners -= vertices.mean(axis=0, dtype=np.float64)
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return Vessel(core.module().Mesh(vertices, triangles), open_edges(vertices, triangles), bool(volume < 0.0))


def open_edges(vertices: NDArray[np.float32], triangles: NDArray[np.int32]) -> int:
    """How many edges an odd number of triangles have. Corners at one place are one."""
    _, place = np.unique(vertices, axis=0, return_inverse=True)
    at = place.reshape(-1)[triangles].astype(np.int64)
    edges = np.sort(np.concatenate([at[:, (0, 1)], at[:, (1, 2)], at[:, (2, 0)]]), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, times = np.unique(edges[:, 0] * (len(vertices) + 1) + edges[:, 1], return_counts=True)
    return int((times % 2).sum())


def say(name: str, vessel: Vessel, notices: list[str]) -> None:
    """How a mesh is filled that is not closed as it should be."""
    if vessel.open_edges:
        edges = "an edge" if vessel.open_edges == 1 else f"{vessel.open_edges} edges"
        notices.append(
            f"{name}: its mesh is open at {edges}; its volume lies between the front that is looked at and the back behind it"
        )
    elif vessel.inside_out:
        notices.append(
            f"{name}: its normals point inwards, so Cycles fills what is around it; here its inside is filled"
        )
