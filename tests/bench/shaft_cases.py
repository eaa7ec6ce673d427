# SPDX-License-Identifier: GPL-3.0-or-later
"""Boxes, the rays of a camera up to them, and the maps of suns: what light shafts are measured on."""

from __future__ import annotations

from typing import Any

import numpy as np
import sfumato

Array = np.ndarray[Any, np.dtype[Any]]


def room() -> Array:
    """(n, 2, 3): corners of boxes. A room of 8 x 6 x 3 m with two windows of twelve panes, pillars, a table, and a hundred
    small things that hang in the air."""
    boxes = [
        [(-4, -3, -0.1), (4, 3, 0)],
        [(-4, -3, 3), (4.2, 3, 3.1)],
        [(-4.1, -3, 0), (-4, 3, 3)],
        [(-4, -3.1, 0), (4, -3, 3)],
        [(-4, 3, 0), (4, 3.1, 3)],
        [(4, -3, 0), (4.15, 3, 0.8)],
        [(4, -3, 2.6), (4.15, 3, 3)],
        [(4, -3, 0.8), (4.15, -2.4, 2.6)],
        [(4, -0.3, 0.8), (4.15, 0.3, 2.6)],
        [(4, 2.4, 0.8), (4.15, 3, 2.6)],
        [(-1.2, -0.8, 0.7), (0.6, 0.5, 0.75)],
        [(-1.1, -0.7, 0), (-1.04, -0.64, 0.7)],
        [(0.44, 0.34, 0), (0.5, 0.4, 0.7)],
        [(1.8, 1.2, 0), (2.0, 1.4, 3)],
        [(1.8, -1.6, 0), (2.0, -1.4, 3)],
    ]
    for low in (-2.4, 0.3):
        boxes += [[(4.05, low + 0.525 * k - 0.02, 0.8), (4.09, low + 0.525 * k + 0.02, 2.6)] for k in range(1, 4)]
        boxes += [[(4.05, low, z - 0.02), (4.09, low + 2.1, z + 0.02)] for z in (1.4, 2.0)]
    random = np.random.default_rng(3)
    middle = random.uniform((-2.5, -2.5, 0.8), (3.5, 2.5, 2.7), (100, 3))
    half = random.uniform(0.005, 0.06, (100, 3))
    return np.concatenate([np.array(boxes, float), np.stack([middle - half, middle + half], axis=1)])


def first_hits(boxes: Array, origin: Array, direction: Array) -> Array:
    """(...): how many directions away each ray enters a box, from where it begins on; infinite where it meets none.

    origin and direction: (..., 3).
    """
    nearest = np.full(direction.shape[:-1], np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        per = 1 / np.where(np.abs(direction) < 1e-12, 1e-12, direction)
        for low, high in boxes:
            near, far = np.zeros_like(nearest), np.full_like(nearest, np.inf)
            for k in range(3):
                a, b = (low[k] - origin[..., k]) * per[..., k], (high[k] - origin[..., k]) * per[..., k]
                near, far = np.maximum(near, np.minimum(a, b)), np.minimum(far, np.maximum(a, b))
            nearest = np.where((near <= far) & (near > 0), np.minimum(nearest, near), nearest)
    return nearest


def perspective(eye: Array, target: Array, width: int, height: int, view: float = 1.2) -> Array:
    """(4, 4): view and projection of a camera that sees `view` of a metre across at a metre's distance."""
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    turn = np.eye(4)
    turn[:3, :3] = right, np.cross(back, right), back
    turn[:3, 3] = -turn[:3, :3] @ eye
    near, far = 0.05, 100.0
    project = np.zeros((4, 4))
    project[0, 0], project[1, 1] = 2 / view, 2 / view * width / height
    project[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
    project[3, 2] = -1
    return project @ turn


def distances(boxes: Array, camera: sfumato.Camera, width: int, height: int) -> Array:
    """(height, width): metres along the ray of each pixel up to a box; rows from the bottom."""
    u, v = (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height
    near, far = camera.corners[:3].astype(float), camera.corners[3:].astype(float)
    out = np.empty((height, width), np.float32)
    for row in range(height):
        at = np.stack([np.ones(width), u, np.full(width, v[row])], axis=1)
        origin = at @ near
        along = at @ far - origin
        length = np.linalg.norm(along, axis=1)
        out[row] = np.minimum(first_hits(boxes, origin, along / length[:, None]), length)
    return out


def sun_map(boxes: Array, direction: Array, texels: int) -> tuple[Array, Array]:
    """What SolidMap takes, of the box around all boxes, with square texels."""
    along = direction / np.linalg.norm(direction)
    across = np.cross(along, (0, 0, 1) if abs(along[2]) < 0.9 else (1, 0, 0))
    across /= np.linalg.norm(across)
    axes = np.array([across, np.cross(along, across), along])
    corners = np.array(
        [[boxes[:, i, 0], boxes[:, j, 1], boxes[:, k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    )
    places = np.moveaxis(corners, 1, 2).reshape(-1, 3) @ axes.T
    low, high = places.min(axis=0) - 0.01, places.max(axis=0) + 0.01
    size = np.array([max(high[:2] - low[:2])] * 2 + [high[2] - low[2]])
    onto = np.eye(4)
    onto[:3, :3] = axes / size[:, None]
    onto[:3, 3] = -low / size
    back = np.linalg.inv(onto)
    depth = np.empty((texels, texels), np.float32)
    place = (np.arange(texels) + 0.5) / texels
    for row in range(texels):
        at = np.stack([place, np.full(texels, place[row]), np.zeros(texels), np.ones(texels)], axis=1)
        origin = (at @ back.T)[:, :3]
        depth[row] = first_hits(boxes, origin, np.broadcast_to(back[:3, 2], origin.shape))
    return depth, onto
