# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to plain arrays.

What cannot be shown is said in a notice; it never stops the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat, core, log, props
from . import lights, materials, smoke

# What the viewport's shader takes (smoke_uniforms.glsl): each medium has three of the 16 textures that it may have.
MOST_MEDIA, MOST_LIGHTS = 5, 16
SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@dataclass
class Export:
    """A scene for the native module, and what an artist should know about it."""

    scene: Any
    notices: list[str] = field(default_factory=list)


def export(depsgraph: Any) -> Export:
    """Everything that `depsgraph` shows. Raises core.Missing without the native module."""
    out = Export(core.module().Scene())
    lit = 0
    media: list[tuple[str, smoke.Medium]] = []
    for instance in depsgraph.object_instances:
        thing = instance.object
        matrix = np.array(instance.matrix_world, dtype=np.float64)
        if not instance.show_self:
            continue
        try:
            if thing.type == "LIGHT":
                lit += lights.add_light(out.scene, thing, matrix, out.notices)
                continue
            medium = smoke.medium_of(thing, matrix, depsgraph, out.notices)
            if medium is not None:
                media.append((thing.name, medium))
            elif thing.type in SURFACE_TYPES:
                lit += add_surface(out, thing, matrix)
        except ValueError as error:
            out.notices.append(f"{thing.name}: {error}")
    if lit == 0:
        out.notices.append("No light: nothing is lit. Add one, or raise its strength")
    if lit > MOST_LIGHTS:
        out.notices.append(f"{lit} lights: in the viewport only the first {MOST_LIGHTS} light the smoke")
    add_media(out, media)
    out.scene.set_background(materials.background(depsgraph.scene, out.notices))
    return out


def frame_of(depsgraph: Any, source: str) -> Any:
    """The native Frame of what `depsgraph` shows, in the scene's quality; its notices go to the log under `source`.

    Raises core.Missing without the native module, ValueError and RuntimeError for what it refuses.
    """
    out = export(depsgraph)
    log.replace(source, out.notices)
    return core.module().Frame(out.scene, **props.QUALITIES[props.of(depsgraph.scene).quality].frame)


def add_surface(out: Export, thing: Any, matrix: NDArray[np.float64]) -> int:
    """The triangles of an object, in world space. Returns how many lights those that emit are."""
    surfaces = materials.surfaces(thing, out.notices)
    if surfaces is None:
        return 0
    mesh = thing.to_mesh()
    if mesh is None:
        return 0
    try:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0:
            return 0
        vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        triangles = np.empty(count * 3, dtype=np.int32)
        material = np.empty(count, dtype=np.int32)
        mesh.vertices.foreach_get("co", vertices)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        mesh.loop_triangles.foreach_get("material_index", material)
        normals = compat.corner_normals(mesh)
    finally:
        thing.to_mesh_clear()
    world = vertices.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    # Normals go with the inverse transpose; a flattened object has none, and any direction will do.
    turned = normals @ np.linalg.pinv(matrix[:3, :3])
    length = np.linalg.norm(turned, axis=-1, keepdims=True)
    turned = np.where(length > 0.0, turned / np.maximum(length, 1e-30), (0.0, 0.0, 1.0))
    # A face may name a slot that the object lacks: Blender then shows the last one.
    slots = np.clip(material, 0, len(surfaces) - 1)
    albedo = np.clip([surface.albedo for surface in surfaces], 0.0, 1.0)
    corners = triangles.reshape(-1, 3)
    gloss, tangents = None, None
    if any(surface.alpha[0] > 0.0 for surface in surfaces):
        gloss = [surface.gloss for surface in surfaces]
    if any(surface.alpha[0] != surface.alpha[1] for surface in surfaces):
        tangents = (radial_tangents(vertices.reshape(-1, 3)) @ matrix[:3, :3].T)[corners]
    emission = np.array([surface.emission for surface in surfaces])
    rough = np.array([surface.diffuse_roughness for surface in surfaces])
    out.scene.add_mesh(
        world,
        corners,
        turned,
        slots,
        albedo,
        gloss,
        tangents,
        emission=emission if emission.any() else None,
        diffuse_roughness=rough if rough.max() >= 0.0 else None,
    )
    return lights.add_emitters(out.scene, world[corners], emission[slots], thing.name, out.notices)


def radial_tangents(vertices: NDArray[np.float32]) -> NDArray[np.float64]:
    """Cycles' tangent where nothing else is said: around the object's Z axis, through the middle of its bounding box."""
    middle = 0.5 * (vertices.min(0) + vertices.max(0))
    size = np.maximum(vertices.max(0) - vertices.min(0), 1e-12)
    place = (vertices - middle) / size
    tangents: NDArray[np.float64] = np.zeros((len(place), 3))
    tangents[:, 0], tangents[:, 1] = -place[:, 1], place[:, 0]
    return tangents


def add_media(out: Export, media: list[tuple[str, smoke.Medium]]) -> None:
    """The bodies of smoke; where there are too many, those with the most in them."""
    media = sorted(media, key=lambda entry: float(entry[1].density.sum()), reverse=True)
    for name, _ in media[MOST_MEDIA:]:
        out.notices.append(f"{name}: only {MOST_MEDIA} bodies of smoke are shown; this one has the least in it")
    for name, medium in media[:MOST_MEDIA]:
        try:
            out.scene.add_medium(
                medium.density, medium.grid_to_world, medium.scattering, medium.absorption, medium.anisotropy
            )
        except ValueError as error:
            out.notices.append(f"{name}: {error}")
