# SPDX-License-Identifier: GPL-3.0-or-later
"""What patterns want of a mesh at the corners of its triangles."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .shading import places

Array = NDArray[np.float32]


class Channel(NamedTuple):
    """By a field's name: how many numbers."""

    name: str
    width: int


_WIDTHS = {
    "FLOAT": 1, "INT": 1, "INT8": 1, "BOOLEAN": 1, "FLOAT2": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4, "BYTE_COLOR": 4,
}  # fmt: skip
_PROPERTIES = {"FLOAT2": "vector", "FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}


def layout(mesh: Any, names: Iterable[str]) -> tuple[Channel, ...]:
    """Of what is wanted, what a mesh has."""
    found = []
    for name in sorted(names):
        if name == places.GENERATED:
            found.append(Channel(name, 3))
        elif name.startswith(places.UV):
            if _uv_layer(mesh, name[len(places.UV) :]) is not None:
                found.append(Channel(name, 2))
        elif name.startswith(places.TANGENT):
            if _uv_layer(mesh, name[len(places.TANGENT) :]) is not None:
                found.append(Channel(name, 4))
        elif name.startswith(places.ATTRIBUTE):
            width = _attribute_width(mesh, name[len(places.ATTRIBUTE) :])
            if width:
                found.append(Channel(name, width))
    return tuple(found)


def read(mesh: Any, wanted: tuple[Channel, ...], vertices: Array, triangles: NDArray[np.int32]) -> Array:
    """(m, 3, k) of a mesh whose loop triangles are calculated."""
    loops = np.empty(len(triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    corners = loops.reshape(-1, 3)
    out = np.empty((len(triangles), 3, sum(channel.width for channel in wanted)), np.float32)
    first = 0
    for channel in wanted:
        values = _values(mesh, channel, corners, vertices, triangles)
        out[:, :, first : first + channel.width] = np.where(np.isfinite(values), values, 0.0)
        first += channel.width
    return out


def _values(mesh: Any, channel: Channel, corners: NDArray[np.int32], vertices: Array, triangles: Any) -> Array:
    name = channel.name
    if name == places.GENERATED:
        return np.asarray(_generated(mesh)[triangles])
    if name.startswith(places.UV):
        return np.asarray(_uv(mesh, name[len(places.UV) :])[corners])
    if name.startswith(places.TANGENT):
        return tangents(vertices, triangles, _uv(mesh, name[len(places.TANGENT) :])[corners])
    return _attribute(mesh, name[len(places.ATTRIBUTE) :], channel.width, corners, triangles)


def _generated(mesh: Any) -> Array:
    """Places in the mesh's texture space, from 0 to 1, before it was deformed."""
    place = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("undeformed_co", place)
    size = np.array(mesh.texspace_size, np.float32)
    low = np.array(mesh.texspace_location, np.float32) - size
    found: Array = (place.reshape(-1, 3) - low) / np.where(size != 0.0, 2.0 * size, 1.0)
    return found


def _uv_layer(mesh: Any, name: str) -> Any | None:
    """By its name; without one the one that renders."""
    if name:
        return mesh.uv_layers.get(name)
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def _uv(mesh: Any, name: str) -> Array:
    layer = _uv_layer(mesh, name)
    found = np.empty(len(mesh.loops) * 2, np.float32)
    if layer is not None:
        layer.data.foreach_get("uv", found)
    return found.reshape(-1, 2)


def _named(mesh: Any, name: str) -> Any | None:
    """An attribute; without a name the color that renders."""
    if name:
        return mesh.attributes.get(name)
    colours = mesh.color_attributes
    number = colours.render_color_index
    return colours[number] if 0 <= number < len(colours) else None


def _attribute_width(mesh: Any, name: str) -> int:
    if name and mesh.uv_layers.get(name) is not None:
        return 2
    attribute = _named(mesh, name)
    return 0 if attribute is None or attribute.domain == "EDGE" else _WIDTHS.get(attribute.data_type, 0)


def _attribute(mesh: Any, name: str, width: int, corners: NDArray[np.int32], triangles: Any) -> Array:
    if name and mesh.uv_layers.get(name) is not None:
        return np.asarray(_uv(mesh, name)[corners])
    attribute = _named(mesh, name)
    assert attribute is not None
    kind = attribute.data_type
    whole = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": np.bool_}.get(kind, np.float32)
    values = np.empty(len(attribute.data) * width, whole)
    attribute.data.foreach_get(_PROPERTIES.get(kind, "value"), values)
    found = values.astype(np.float32).reshape(-1, width)
    if attribute.domain == "POINT":
        return np.asarray(found[triangles])
    if attribute.domain == "CORNER":
        return np.asarray(found[corners])
    faces = np.empty(len(triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", faces)
    return np.repeat(found[faces][:, None], 3, axis=1)


def tangents(vertices: Array, triangles: NDArray[np.int32], uv: Array) -> Array:
    """(m, 3, 4): unit vectors in which u grows, and the side on which v does. Corners share those of all triangles that
    have the vertex, the place on the map and the side in common, by their angles there."""
    corner = vertices[triangles].astype(np.float64)
    edge, along = np.roll(corner, -1, 1) - corner, np.roll(uv, -1, 1).astype(np.float64) - uv
    p, q, du, dv = edge[:, 0], -edge[:, 2], along[:, 0], -along[:, 2]
    area = du[:, 0] * dv[:, 1] - dv[:, 0] * du[:, 1]
    flat = (p * dv[:, 1:2] - q * du[:, 1:2]) * np.sign(area)[:, None]
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-30)
    unit = edge / np.maximum(np.linalg.norm(edge, axis=2, keepdims=True), 1e-30)
    angle = np.arccos(np.clip(-(unit * np.roll(unit, 1, 1)).sum(2), -1.0, 1.0))
    side = np.repeat(np.where(area < 0.0, -1.0, 1.0), 3)
    key = np.column_stack((triangles.ravel(), uv.reshape(-1, 2), side))
    _, group = np.unique(key, axis=0, return_inverse=True)
    weighted = (angle[:, :, None] * flat[:, None]).reshape(-1, 3)
    sums = np.stack([np.bincount(group.ravel(), weighted[:, k]) for k in range(3)], axis=1)[group.ravel()]
    sums /= np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    return np.column_stack((sums, side)).astype(np.float32).reshape(-1, 3, 4)
