# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 3.4 and 5.2, by capability rather than by version wherever one can be asked for."""

from __future__ import annotations

import math
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


def size_factor(light: Any, area: float = 0.0) -> float:
    """What Cycles multiplies a light by where 'Normalize' is off, as it can be from 4.5 on: the area over which it would
    else spread its strength. `area` is that of an area light, scaled; those of points and suns know no scale."""
    if getattr(light, "normalize", True):
        return 1.0
    if light.type == "AREA":
        return area
    if light.type == "SUN":
        sine = math.sin(0.5 * light.angle)
        return math.pi * sine * sine if sine > 0.0 else 1.0
    # A point without a radius counts as 4, so that what is left of its 1 / 4 pi is 1 / pi.
    radius = float(light.shadow_soft_size)
    return 4.0 * math.pi * radius * radius if radius > 0.0 else 4.0


def radiance_of_watts(area: float) -> float:
    """What Cycles makes of each watt of an area light: what sends one watt, or before 4.0 pi / 4 of that."""
    return 1.0 / ((4.0 if bpy.app.version < (4, 0, 0) else math.pi) * area)


def point_light_habits(light: Any) -> dict[str, bool]:
    """How Cycles takes a point or spot light: a soft one as a disk that faces what it lights, always before 4.0 and
    where it says so from 4.1 on; and before 4.0 a spot dims by its cosine."""
    old = bpy.app.version < (4, 0, 0)
    return {"facing_disk": old or bool(getattr(light, "use_soft_falloff", False)), "spot_cosine": old}


def masks_apart() -> float:
    """1 where Cycles multiplies the two G1 of Smith's masking, as before 4.0; 0 where it correlates them by height."""
    return float(bpy.app.version < (4, 0, 0))


def reflectance(principled: Any) -> float:
    """Of light from straight on, of the dielectric layer of a Principled BSDF."""
    if "Specular IOR Level" in principled.inputs:  # 4.0: a factor of what the index of refraction gives
        index = max(float(principled.inputs["IOR"].default_value), 1e-5)
        level = float(np.clip(principled.inputs["Specular IOR Level"].default_value, 0.0, 1.0))
        return min(2.0 * level * ((index - 1.0) / (index + 1.0)) ** 2, 1.0)
    return 0.08 * float(np.clip(principled.inputs["Specular"].default_value, 0.0, 1.0))


def metals_have_an_index() -> bool:
    """Whether Cycles lets a Principled metal rise to white as its dielectric layer does, as before 4.0. From there on
    a metal has the F82 model (Kutz, Hasan and Edmondson 2021), which with a white edge is Schlick's curve."""
    return bool(bpy.app.version < (4, 0, 0))


def diffuse_roughness(principled: Any) -> float:
    """Of Burley's diffuse surfaces, as Cycles has them in a Principled BSDF before 4.0; -1 for Lambert's, as it has since."""
    old = bpy.app.version < (4, 0, 0)
    return float(np.clip(principled.inputs["Roughness"].default_value, 0.0, 1.0)) if old else -1.0


def emission_socket(principled: Any) -> str:
    """The name of the socket of the colour in which a Principled BSDF glows."""
    return "Emission Color" if "Emission Color" in principled.inputs else "Emission"  # 4.0


def uses_nodes(owner: Any) -> bool:
    """Whether a material or world is made of nodes: always so since 5.0."""
    return bpy.app.version >= (5, 0, 0) or bool(owner.use_nodes)
