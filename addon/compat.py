# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 3.4 and 5.2, by capability rather than by version wherever one can be asked for."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray


def set_pixels(layer: Any, image: NDArray[np.float32]) -> None:
    """Fill the combined pass of a render layer with (height, width, 4) pixels."""
    flat = np.ascontiguousarray(image, dtype=np.float32).reshape(-1)
    combined = layer.passes["Combined"]
    if bpy.app.version >= (4, 0, 0):
        combined.rect.foreach_set(flat)
    elif len(layer.passes) == 1:
        # `rect` itself takes Python lists only before 4.0, at 90 ms for 640 x 360; its collection takes a buffer.
        layer.passes.foreach_set("rect", flat)
    else:
        combined.rect = image.reshape(-1, 4).tolist()


def corner_normals(mesh: Any) -> NDArray[np.float32]:
    """Normals of the corners of each loop triangle: (triangles, 3, 3)."""
    if hasattr(mesh, "calc_normals_split"):  # gone in 4.1, where they are always there
        mesh.calc_normals_split()
    normals = np.empty(len(mesh.loop_triangles) * 9, dtype=np.float32)
    mesh.loop_triangles.foreach_get("split_normals", normals)
    return normals.reshape(-1, 3, 3)


def light_colour(light: Any) -> NDArray[np.float64]:
    """Colour times strength of a light, in its own unit."""
    colour: NDArray[np.float64] = np.array(light.color, dtype=np.float64) * light.energy
    if hasattr(light, "exposure"):  # 4.5
        colour = colour * 2.0**light.exposure
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color)
    return colour


def point_light_habits() -> dict[str, bool]:
    """How Cycles takes the lights of this Blender: before 4.0 a soft point is a disk, and a spot dims by its cosine."""
    old = bpy.app.version < (4, 0, 0)
    return {"facing_disk": old, "spot_cosine": old}


def masks_apart() -> float:
    """1 where Cycles multiplies the two G1 of Smith's masking, as before 4.0; 0 where it correlates them by height."""
    return float(bpy.app.version < (4, 0, 0))


def reflectance(principled: Any) -> float:
    """Of light from straight on, of the dielectric layer of a Principled BSDF."""
    if "Specular IOR Level" in principled.inputs:  # 4.0: a factor of what the index of refraction gives
        index = float(principled.inputs["IOR"].default_value)
        return (
            min(2.0 * float(principled.inputs["Specular IOR Level"].default_value), 2.0)
            * ((index - 1.0) / (index + 1.0)) ** 2
        )
    return 0.08 * float(principled.inputs["Specular"].default_value)


def emission_socket(principled: Any) -> str:
    """The name of the socket of the colour in which a Principled BSDF glows."""
    return "Emission Color" if "Emission Color" in principled.inputs else "Emission"  # 4.0


def uses_nodes(owner: Any) -> bool:
    """Whether a material or world is made of nodes: always so since 5.0."""
    return bpy.app.version >= (5, 0, 0) or bool(owner.use_nodes)
