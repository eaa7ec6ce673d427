# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangles of objects as native meshes, read in bulk and no more often than they change."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bmesh
import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from . import channels
from .channels import Channel
from .parts import Owner, Parts

SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@dataclass
class Triangles:
    """What a native Mesh is made of, in the object's space."""

    vertices: NDArray[np.float32]  # (n, 3)
    triangles: NDArray[np.int32]  # (m, 3)
    normals: NDArray[np.float32] | None  # (n, 3) or (m, 3, 3); None for flat triangles
    material: NDArray[np.int32] | None  # (m,), the slot; None where there is but one
    tangents: NDArray[np.float32] | None  # (m, 3, 3)
    channels: NDArray[np.float32] | None = None  # (m, 3, k)


def mesh_of(
    thing: Any,
    slots: int,
    brushed: bool,
    depsgraph: Any,
    parts: Parts,
    wanted: tuple[Channel, ...] = (),
    moving: NDArray[np.float32] | None = None,
) -> Any | None:
    """The native mesh of an object with so many material slots, with tangents if its gloss is brushed, and with what
    patterns want of it; `moving`, its vertices at times, (times, n, 3), where they move; None without triangles. Raises
    ValueError for what cannot be shown."""

    def read() -> tuple[Any, ...] | None:
        found = triangles_of(thing, slots, brushed, wanted)
        if found is None:
            return None
        made = (found.vertices, found.triangles, found.normals, found.material, found.tangents, found.channels)
        if moving is None or moving.shape[1] != len(found.vertices):
            return made
        return *made, moving

    owner = owner_of(thing, depsgraph, (slots, brushed, wanted)) if parts.told and moving is None else None
    return parts.part(read, ("mesh",), core.module().Mesh, owner)


def owner_of(thing: Any, depsgraph: Any, how: tuple[Any, ...]) -> Owner | None:
    """Whose mesh it is, if Blender would tell of its changes: not of what nodes make for an instance, which takes the
    place of the object's own data."""
    if thing.type != "MESH" or thing.data.is_editmode:
        return None
    mesh, original = thing.data, thing.original
    own = original.evaluated_get(depsgraph).data
    if own is None or own.as_pointer() != mesh.as_pointer():
        return None
    positions = core.module().content_hash(vertices_of(mesh))
    addresses = original.as_pointer(), original.data.as_pointer()
    view_layer = depsgraph.view_layer.name
    return Owner(addresses, (positions, len(mesh.loops), len(mesh.polygons), view_layer, *how))


def triangles_of(thing: Any, slots: int, brushed: bool = False, wanted: tuple[Channel, ...] = ()) -> Triangles | None:
    """The triangles of an object, None if it has none."""
    with _mesh_data(thing) as (mesh, own_copy):
        return None if mesh is None else _read(mesh, vertices_of(mesh), slots, brushed, own_copy, wanted)


def channels_of(thing: Any, names: Iterable[str]) -> tuple[Channel, ...]:
    """Of what patterns want of an object's mesh, by their names, what it has."""
    with _mesh_data(thing) as (mesh, _):
        return () if mesh is None else channels.layout(mesh, names)


@contextmanager
def _mesh_data(thing: Any) -> Iterator[tuple[Any | None, bool]]:
    """The final mesh of an object, and whether it is a copy that may be changed."""
    if _own_data_will_do(thing):
        yield thing.data, False
        return
    try:
        yield thing.to_mesh(), True
    finally:
        thing.to_mesh_clear()


def _own_data_will_do(thing: Any) -> bool:
    """Whether an evaluated object's data is its final mesh, and all that is wanted can be read without changing it."""
    if thing.type != "MESH" or thing.data.is_editmode or compat.corner_normals_need_a_copy(thing.data):
        return False
    return not compat.subdivides_on_the_gpu(thing)


def vertices_of(mesh: Any) -> NDArray[np.float32]:
    vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", vertices)
    return vertices.reshape(-1, 3)


def _read(
    mesh: Any,
    vertices: NDArray[np.float32],
    slots: int,
    brushed: bool,
    own_copy: bool,
    wanted: tuple[Channel, ...],
) -> Triangles | None:
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0:
        return None
    corners = np.empty(count * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    triangles = corners.reshape(-1, 3)
    material = None
    if slots > 1:
        material = np.empty(count, dtype=np.int32)
        mesh.loop_triangles.foreach_get("material_index", material)
        # A face may name a slot that the object lacks: Blender then shows the last one.
        material = np.clip(material, 0, slots - 1)
        material = material if material.any() else None
    tangents = radial_tangents(vertices)[triangles] if brushed else None
    values = channels.read(mesh, wanted, vertices, triangles) if wanted else None
    return Triangles(vertices, triangles, compat.normals(mesh, own_copy), material, tangents, values)


def radial_tangents(vertices: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cycles' tangent where nothing else is said: around the object's Z axis, through the middle of its bounding box."""
    middle = 0.5 * (vertices.min(0) + vertices.max(0))
    size = np.maximum(vertices.max(0) - vertices.min(0), 1e-12)
    place = (vertices - middle) / size
    tangents: NDArray[np.float32] = np.zeros((len(place), 3), dtype=np.float32)
    tangents[:, 0], tangents[:, 1] = -place[:, 1], place[:, 0]
    return tangents


def sphere(parts: Parts) -> Any:
    """The native mesh of a smooth sphere of radius 1 about the origin, of 1280 triangles, which hides as much as one."""
    return parts.part(_icosphere, ("mesh",), core.module().Mesh)


def _icosphere() -> tuple[Any, ...]:
    made = bmesh.new()
    try:
        bmesh.ops.create_icosphere(made, subdivisions=4, radius=1.0)
        vertices = np.array([vertex.co for vertex in made.verts], dtype=np.float32)
        triangles = np.array([[vertex.index for vertex in face.verts] for face in made.faces], dtype=np.int32)
    finally:
        made.free()
    corners = vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # What is convex hides, seen from all around, a quarter of its surface (Cauchy).
    larger = np.sqrt(8.0 * np.pi / np.linalg.norm(across, axis=1).sum())
    return (vertices * larger).astype(np.float32), triangles, vertices, None, None
