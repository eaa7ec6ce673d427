# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to plain arrays.

What cannot be shown is said in a notice; it never stops the rest.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core, log, props
from ..limits import MOST_BODIES, MOST_LIGHTS, MOST_MEDIA
from . import lights, materials, meshes, omissions, smoke, surfaces
from .parts import Parts


@dataclass
class Export:
    """A scene for the native module, and what an artist should know about it."""

    scene: Any
    notices: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)  # of these, the smoke that should be there
    drawn: set[str] = field(default_factory=set)  # objects whose smoke a viewport draws


@dataclass
class _Group:
    """Surfaces that share a mesh and materials: the objects themselves may be gone when their matrices are known."""

    name: str
    mesh: Any
    surfaces: list[surfaces.Surface]
    triangles: meshes.Triangles | None  # of what glows
    material_indices: list[int]
    places: list[int] = field(default_factory=list)
    object_indices: list[int] = field(default_factory=list)


def filter_of(space: Any) -> tuple[Any, ...]:
    """What tells what a 3D view leaves out from what others do: in local view, by its own collections, by types of
    objects that are hidden in it. Nothing for a view that shows all."""
    if space is None:
        return ()
    hidden = tuple(name for name in _type_switches() if not getattr(space, name))
    if space.local_view is None and not space.use_local_collections and not hidden:
        return ()
    return space.as_pointer(), space.local_view is not None, space.use_local_collections, hidden


@functools.cache
def _type_switches() -> tuple[str, ...]:
    """The properties of a 3D view that hide objects of one type."""
    names = bpy.types.SpaceView3D.bl_rna.properties.keys()
    return tuple(name for name in names if name.startswith("show_object_viewport_"))


def export(depsgraph: Any, parts: Parts | None = None, space: Any = None, smoke_alone: bool = False) -> Export:
    """Everything that `depsgraph` shows, in a 3D view if there is one, with what `parts` has of an earlier export. Where
    smoke and shadows alone are seen of it there are no notices of what surfaces and the world look like. Raises
    core.Missing without the native module."""
    parts = parts or Parts()
    out = Export(core.module().Scene())
    looks: list[str] = [] if smoke_alone else out.notices
    lit = 0
    media: list[tuple[str, smoke.Medium]] = []
    groups: dict[tuple[int, int], _Group | None] = {}
    shown, matrices = compat.instance_matrices(depsgraph)
    filtered = bool(filter_of(space))
    for number, instance in enumerate(depsgraph.object_instances):
        if not shown[number]:
            continue
        thing = instance.object
        if filtered and not thing.visible_in_viewport_get(space):
            continue
        key = _group_key(thing)
        if key in groups:
            group = groups[key]
            if group is not None:
                group.places.append(number)
                group.object_indices.append(thing.pass_index)
            continue
        try:
            if thing.type == "LIGHT":
                lit += lights.add_light(out.scene, thing, matrices[number], out.notices)
                continue
            medium = smoke.medium_of(thing, matrices[number], depsgraph, parts, out.notices)
            if medium is not None:
                omissions.of_smoke(thing, out.notices)
                media.append((thing.name, medium))
            elif thing.type in meshes.SURFACE_TYPES:
                groups[key] = group = _group_of(thing, depsgraph, parts, looks)
                if group is not None:
                    group.places.append(number)
                    group.object_indices.append(thing.pass_index)
                    if not omissions.lies_over(space):
                        omissions.of_surface(thing, group.triangles is not None, depsgraph, out.notices)
            elif not omissions.lies_over(space):
                omissions.of_type(thing, out.notices)
        except ValueError as error:
            groups[key] = None
            out.notices.append(f"{thing.name}: {error}")
            if isinstance(error, smoke.Missing):
                out.missing.append(out.notices[-1])
    for group in groups.values():
        if group is not None:
            lit += add_surfaces(out, group, matrices[group.places])
    if lit == 0:
        out.notices.append("No light: nothing is lit. Add one, or raise its strength")
    if lit > MOST_LIGHTS:
        out.notices.append(f"{lit} lights: in the viewport only the first {MOST_LIGHTS} light the smoke")
    add_media(out, media)
    omissions.of_frame(depsgraph, space, out.notices)
    omissions.of_objects(depsgraph, out.notices)
    if not depsgraph.scene.render.film_transparent:
        out.scene.set_background(materials.background(depsgraph.scene, looks))
    parts.end_export()
    return out


def frame_of(depsgraph: Any, source: str, parts: Parts | None = None, whole: bool = False, space: Any = None) -> Any:
    """The native Frame of what `depsgraph` shows, in a 3D view if there is one, in the scene's quality; its notices go to
    the log under `source`.

    Raises core.Missing without the native module, ValueError and RuntimeError for what it refuses, and where it must be
    `whole`, ValueError for smoke that is missing.
    """
    parts = parts or Parts()
    out = export(depsgraph, parts, space)
    log.replace(source, out.notices)
    if whole and out.missing:
        raise ValueError("; ".join(out.missing))
    return made_of(out, depsgraph.scene, parts)


def made_of(out: Export, settings: Any, parts: Parts) -> Any:
    """The native Frame of an export, in the quality of a scene."""
    quality = props.QUALITIES[props.of(settings).quality]
    return core.module().Frame(out.scene, **quality.frame, prepared=parts.native)


def _group_key(thing: Any) -> tuple[int, int]:
    """Equal for objects that share mesh and materials, by addresses that hold while the depsgraph is being read. What
    has modifiers or materials of its own stands alone."""
    data = thing.data
    data_address = 0 if data is None else data.as_pointer()
    slots = thing.material_slots
    if thing.type != "MESH" or thing.modifiers or (slots and any(slot.link == "OBJECT" for slot in slots)):
        return thing.as_pointer(), data_address
    return 0, data_address


def _group_of(thing: Any, depsgraph: Any, parts: Parts, notices: list[str]) -> _Group | None:
    """The surfaces of an object, without a place as yet; None where it has none."""
    found = surfaces.surfaces(thing, notices)
    if found is None:
        return None
    mesh = meshes.mesh_of(thing, len(found), surfaces.brushed(found), depsgraph, parts)
    if mesh is None:
        return None
    glows = any(surface.emission.any() for surface in found)
    indices = [slot.material.pass_index if slot.material else 0 for slot in thing.material_slots] or [0]
    return _Group(thing.name, mesh, found, meshes.triangles_of(thing, len(found)) if glows else None, indices)


def add_surfaces(out: Export, group: _Group, places: NDArray[np.float64]) -> int:
    """The triangles of an object in all its places (n, 4, 4). Returns how many lights those that emit are."""
    usable = np.isfinite(places).all(axis=(1, 2))
    indices = np.array(group.object_indices, dtype=np.float64)[usable]
    if not usable.all():
        out.notices.append(f"{group.name}: its matrix is not finite in {int((~usable).sum())} places; left out there")
        places = places[usable]
    emission = np.array([surface.emission for surface in group.surfaces])
    try:
        out.scene.add_instances(
            group.mesh,
            places,
            np.clip([surface.albedo for surface in group.surfaces], 0.0, 1.0),
            surfaces.rows_of_gloss(group.surfaces),
            emission=emission if emission.any() else None,
            diffuse=surfaces.diffuse_kinds(group.surfaces),
            object_index=indices,
            material_index=np.array(group.material_indices, dtype=np.float64),
        )
    except ValueError as error:
        out.notices.append(f"{group.name}: {error}")
        return 0
    read = group.triangles
    if read is None:
        return 0
    radiance = emission[0 if read.material is None else read.material]
    lit = 0
    for matrix in places:
        corners = (read.vertices @ matrix[:3, :3].T + matrix[:3, 3])[read.triangles]
        each = np.broadcast_to(radiance, (len(corners), 3))
        lit += lights.add_emitters(out.scene, corners, each, group.name, out.notices)
    return lit


def add_media(out: Export, media: list[tuple[str, smoke.Medium]]) -> None:
    """The bodies of smoke; where there are too many, those with the most in them."""
    media = sorted(media, key=lambda entry: entry[1].amount, reverse=True)
    for name, _ in media[MOST_BODIES:]:
        out.notices.append(f"{name}: only {MOST_BODIES} bodies of smoke are shown; this one has the least in it")
    if len(media) > MOST_MEDIA:
        kept = ", ".join(name for name, _ in media[:MOST_MEDIA])
        out.notices.append(
            f"{len(media)} bodies of smoke: the viewport draws the {MOST_MEDIA} with the most in them, {kept}; "
            "renders, and shadows on surfaces, have all"
        )
    for number, (name, medium) in enumerate(media[:MOST_BODIES]):
        try:
            out.scene.add_medium(
                medium.grid, medium.grid_to_world, medium.scattering, medium.absorption, medium.anisotropy
            )
            out.drawn |= {name} if number < MOST_MEDIA else set()
        except ValueError as error:
            out.notices.append(f"{name}: {error}")
