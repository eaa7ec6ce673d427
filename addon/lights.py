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
    if not getattr(light, "normalize", True):
        notices.append(f"{thing.name}: 'Normalize' off is not followed; its power is taken as watts")
    if light.type == "SUN":
        scene.add_sun(forwards, colour, min(float(light.angle), 3.1415))
    elif light.type == "AREA":
        add_area(scene, light, matrix, colour)
    else:
        cone = {"cone": float(light.spot_size), "blend": float(light.spot_blend)} if light.type == "SPOT" else {}
        # Watts over all directions, though a spot sends them into some.
        intensity, habits = colour / (4.0 * math.pi), compat.point_light_habits()
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
    # Cycles gives a lamp of P watts the radiance P / 4A, and with a grid before it as much more as keeps its power.
    radiance = colour / (4.0 * area)
    spread = min(float(light.spread), math.pi)
    if spread < math.pi - 1e-4:
        tangent = math.tan(0.5 * spread)
        radiance = radiance * (tangent / (tangent - 0.5 * spread))
    scene.add_area(matrix[:3, 3], across, up, radiance, ellipse, spread)
