# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights in physical units, as Cycles takes them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import compat
from . import materials, visibility
from .visibility import Reach


def add_light(scene: Any, thing: Any, matrix: NDArray[np.float64], notices: list[str], reach: Reach) -> bool:
    """Add a light object to a native scene. False if it gives no light. Raises ValueError for one that cannot be."""
    light = thing.data
    if getattr(getattr(light, "cycles", None), "is_portal", False):
        return False  # it only tells Cycles where the world shines in
    colour = compat.light_colour(light) * emission_of(thing, notices)
    if (colour < 0.0).any():
        notices.append(f"{thing.name}: light that takes light away is not shown")
    colour = np.maximum(colour, 0.0)
    if not colour.any():
        return False
    reaches = visibility.native(reach)
    forwards = -matrix[:3, 2]
    if light.type == "SUN":
        irradiance = colour * (compat.size_factor(light) * compat.sun_share(light))
        scene.add_sun(forwards, irradiance, min(float(light.angle), 3.1415), reach=reaches)
    elif light.type == "AREA":
        if add_area(scene, light, matrix, colour, reaches):
            notices.append(f"{thing.name}: its parent's uneven scale skews it; it is shown with right angles")
    else:
        # Watts over all directions, though a spot sends them into some. Its radius knows no scale.
        intensity, habits = colour * compat.size_factor(light) / (4.0 * math.pi), compat.point_light_habits(light)
        cone = cone_of(light, matrix) if light.type == "SPOT" else {}
        radius = float(light.shadow_soft_size)
        scene.add_point(matrix[:3, 3], intensity, radius, **cone, **habits, reach=reaches)
    return True


def is_sharp(light: Any) -> bool:
    """Whether it has no size, so that no ray meets it by chance."""
    if light.type == "AREA":
        return False
    return float(light.angle if light.type == "SUN" else light.shadow_soft_size) == 0.0


def emission_of(thing: Any, notices: list[str]) -> NDArray[np.float64]:
    """What a light's nodes make of its colour and strength: each of them is multiplied by this."""
    light = thing.data
    if not light.use_nodes or light.node_tree is None:
        return np.ones(3)
    output = materials.output_in(light.node_tree, "OUTPUT_LIGHT")
    shader = None if output is None else materials.linked_node(output, "Surface")
    if shader is None or shader.mute:
        return np.zeros(3)
    if shader.type != "EMISSION":
        notices.append(
            f"{thing.name}: the node {shader.bl_rna.name} of its light is not shown; it shines as if it had none"
        )
        return np.ones(3)
    colour = materials.value_of(shader, "Color", thing.name, notices)
    emission: NDArray[np.float64] = colour * materials.value_of(shader, "Strength", thing.name, notices)
    return emission


def cone_of(light: Any, matrix: NDArray[np.float64]) -> dict[str, Any]:
    """The cone of a spot, as add_point takes it. It is round in the space of the object."""
    cone: dict[str, Any] = {
        "direction": -matrix[:3, 2],
        "cone": float(light.spot_size),
        "blend": float(light.spot_blend),
    }
    to_world = matrix[:3, :3]
    lengths = np.linalg.norm(to_world, axis=0)
    angles = to_world.T @ to_world - np.diag(lengths**2)
    uneven = max(float(np.ptp(lengths**2)), float(np.abs(angles).max())) > 1e-5 * float(lengths.max()) ** 2
    if uneven and abs(float(np.linalg.det(to_world))) > 1e-12 and compat.scale_stretches_cones():
        x, y, z = np.linalg.inv(to_world) / np.linalg.norm(np.linalg.inv(to_world)[2])
        cone.update(direction=-z, across=np.stack([x, y]))
    return cone


def add_area(scene: Any, light: Any, matrix: NDArray[np.float64], colour: NDArray[np.float64], reaches: Any) -> bool:
    """An area light of any of the four shapes, with its native Reach, or None. Whether it is shown as another one, for what
    uneven scale makes of its axes."""
    ellipse = light.shape in {"DISK", "ELLIPSE"}
    size_y = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    axes = matrix[:3, :2] * (0.5 * light.size, 0.5 * size_y)
    # What Cycles takes for its area, whatever the angle between its axes.
    whole = (math.pi if ellipse else 4.0) * float(np.prod(np.linalg.norm(axes, axis=0)))
    axes, is_another = right_angled(axes, matrix[:3, 2], ellipse)
    area = (math.pi if ellipse else 4.0) * float(np.prod(np.linalg.norm(axes, axis=0)))
    if area < 1e-12:
        raise ValueError(f"its size {light.size:g} x {size_y:g}, scaled, leaves it no area")
    # A grid before it makes it as much brighter as keeps its power.
    radiance = colour * compat.size_factor(light, whole) * compat.radiance_of_watts(area)
    spread = min(float(light.spread), math.pi)
    if spread < math.pi - 1e-4:
        tangent = math.tan(0.5 * spread)
        radiance = radiance * (tangent / (tangent - 0.5 * spread))
    scene.add_area(matrix[:3, 3], *axes.T, radiance, ellipse, spread, reach=reaches)
    return is_another


def right_angled(
    axes: NDArray[np.float64], backwards: NDArray[np.float64], ellipse: bool
) -> tuple[NDArray[np.float64], bool]:
    """Half axes (3, 2) of a lamp at right angles to each other and to the way that it does not shine, where their cross
    product points; and whether it is another lamp for that. An ellipse is the same one between any axes of its plane.
    """
    normal = backwards / max(float(np.linalg.norm(backwards)), 1e-30)
    unit = axes / np.maximum(np.linalg.norm(axes, axis=0), 1e-30)
    tilted = float(np.abs(normal @ unit).max()) > 1e-3
    skewed = abs(float(unit[:, 0] @ unit[:, 1])) > 1e-3
    if tilted or skewed:
        flat = axes - np.outer(normal, normal @ axes)
        if ellipse:
            directions, lengths, _ = np.linalg.svd(flat, full_matrices=False)
            axes = directions * lengths
        else:
            across, up = flat.T
            axes = np.column_stack([across, up - across * float(across @ up) / max(float(across @ across), 1e-30)])
    if np.cross(axes[:, 0], axes[:, 1]) @ normal < 0.0:
        axes = axes * (-1.0, 1.0)  # a mirrored lamp still shines along its own -Z
    return axes, tilted or (skewed and not ellipse)


MOST_POLYGONS = 16


def emitters(
    corners: NDArray[np.float64], radiance: NDArray[np.float64]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]] | None:
    """Of triangles (n, 3, 3) that emit (n, 3), on both sides, the polygons that are lights, and what these emit; None where
    too many faces emit for that."""
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    glowing = radiance.any(axis=1) & (area > 1e-12)
    if int(glowing.sum()) > 2 * MOST_POLYGONS:
        return None
    polygons = polygons_of(corners[glowing], radiance[glowing])
    return polygons if len(polygons) <= MOST_POLYGONS else None


def polygons_of(
    corners: NDArray[np.float64], radiance: NDArray[np.float64]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Triangles (n, 3, 3) and what they emit (n, 3), two in a row as one where they make a flat convex face of four.

    Blender makes such two of each face with four corners, and a fan of triangles of one with more.
    """
    polygons: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
    mergeable = False  # whether the last polygon is a triangle
    for triangle, colour in zip(corners, radiance):
        quad = quad_of(polygons[-1][0], triangle) if mergeable and (polygons[-1][1] == colour).all() else None
        if quad is None:
            polygons.append((triangle, colour))
        else:
            polygons[-1] = quad, colour
        mergeable = quad is None
    return polygons


def quad_of(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The flat convex quadrilateral (4, 3) that two triangles (3, 3) make, in turn, or None."""
    own = [i for i in range(3) if not (b == a[i]).all(axis=1).any()]
    others = [i for i in range(3) if not (a == b[i]).all(axis=1).any()]
    if len(own) != 1 or len(others) != 1:
        return None
    first = own[0]
    quad = np.stack([a[first], a[(first + 1) % 3], b[others[0]], a[(first + 2) % 3]])
    edges = np.roll(quad, -1, axis=0) - quad
    turns = np.cross(edges, np.roll(edges, -1, axis=0))
    normal = turns.sum(axis=0)
    normal /= max(float(np.linalg.norm(normal)), 1e-30)
    lengths = np.linalg.norm(edges, axis=1)
    flat = np.abs((quad - quad[0]) @ normal).max() < 1e-4 * lengths.max()
    convex = (turns @ normal > 1e-6 * lengths * np.roll(lengths, -1)).all()
    return quad if flat and convex else None
