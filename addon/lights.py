# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights in physical units, as Cycles takes them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import compat


def add_light(scene: Any, thing: Any, matrix: NDArray[np.float64], notices: list[str]) -> bool:
    """Add a light object to a native scene. False if it gives no light. Raises ValueError for one that cannot be."""
    light = thing.data
    colour = compat.light_colour(light)
    if not (colour > 0.0).any():
        return False
    colour = np.maximum(colour, 0.0)
    forwards = -matrix[:3, 2]
    if light.type == "SUN":
        scene.add_sun(forwards, colour * compat.size_factor(light), min(float(light.angle), 3.1415))
    elif light.type == "AREA":
        add_area(scene, light, matrix, colour)
    else:
        cone = {"cone": float(light.spot_size), "blend": float(light.spot_blend)} if light.type == "SPOT" else {}
        # Watts over all directions, though a spot sends them into some.
        intensity, habits = colour * compat.size_factor(light) / (4.0 * math.pi), compat.point_light_habits(light)
        scene.add_point(matrix[:3, 3], intensity, float(light.shadow_soft_size), forwards, **cone, **habits)
    return True


def add_area(scene: Any, light: Any, matrix: NDArray[np.float64], colour: NDArray[np.float64]) -> None:
    """An area light of any of the four shapes."""
    ellipse = light.shape in {"DISK", "ELLIPSE"}
    size_y = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    across, up = matrix[:3, 0] * 0.5 * light.size, matrix[:3, 1] * 0.5 * size_y
    area = (math.pi if ellipse else 4.0) * float(np.linalg.norm(across) * np.linalg.norm(up))
    if area < 1e-12:
        raise ValueError(f"its size {light.size:g} x {size_y:g}, scaled, leaves it no area")
    # A grid before it makes it as much brighter as keeps its power.
    radiance = colour * compat.size_factor(light, area) * compat.radiance_of_watts(area)
    spread = min(float(light.spread), math.pi)
    if spread < math.pi - 1e-4:
        tangent = math.tan(0.5 * spread)
        radiance = radiance * (tangent / (tangent - 0.5 * spread))
    scene.add_area(matrix[:3, 3], across, up, radiance, ellipse, spread)


MOST_RECTANGLES = 8


def add_emitters(
    scene: Any, corners: NDArray[np.float64], radiance: NDArray[np.float64], name: str, notices: list[str]
) -> int:
    """Light from triangles (n, 3, 3) that emit (n, 3), on both sides: the rectangles among them. Returns how many lights.

    What is no rectangle is seen to glow, but lights nothing; a notice says so.
    """
    glowing = radiance.any(axis=1)
    corners, radiance = corners[glowing], radiance[glowing]
    if len(corners) == 0:
        return 0
    # Blender makes two triangles in a row of each face with four corners.
    pairs = zip(corners[::2], corners[1::2], radiance[::2], radiance[1::2])
    found = [(rectangle_of(a, b), c) for a, b, c, d in pairs if (c == d).all()]
    rectangles = [(rectangle, c) for rectangle, c in found if rectangle is not None]
    if 2 * len(rectangles) != len(corners) or len(rectangles) > MOST_RECTANGLES:
        notices.append(f"{name}: it emits, but lights nothing: only up to {MOST_RECTANGLES} flat rectangles do")
        return 0
    for (middle, across, up), colour in rectangles:
        for x, y in ((across, up), (up, across)):
            # Off the surface, so that this does not shade the light that it gives to smoke.
            normal = np.cross(y, x)
            off = 1e-4 * normal / np.sqrt(np.linalg.norm(normal))
            scene.add_area(middle + off, x, y, colour)
    return 2 * len(rectangles)


def rectangle_of(
    a: NDArray[np.float64], b: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """The middle and the half axes of the rectangle that two triangles (3, 3) make, or None."""
    shared = [i for i in range(3) if (a[i] == b).all(axis=1).any()]
    others = [i for i in range(3) if not (b[i] == a).all(axis=1).any()]
    if len(shared) != 2 or len(others) != 1:
        return None
    apex = a[3 - sum(shared)]
    across, up = 0.5 * (a[shared[0]] - apex), 0.5 * (a[shared[1]] - apex)
    size = float(np.linalg.norm(across) * np.linalg.norm(up))
    opposite = b[others[0]] - (apex + 2.0 * (across + up))
    if size < 1e-12 or abs(across @ up) > 1e-3 * size or np.linalg.norm(opposite) > 1e-3 * np.sqrt(size):
        return None
    return apex + across + up, across, up
