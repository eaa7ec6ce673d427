# SPDX-License-Identifier: GPL-3.0-or-later
"""What a GPU draws of a frame without sorting: its particles as sprites, hair as strips, transparent meshes as triangles.

The module shades each of them for the camera (Frame.sprites, Frame.triangles). Drawn back to front, as Jansen and Bavoil
(2010) drew theirs, sprites look up their light in a map that is splatted here, if one sun is all there is.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .arguments import Doubles
from .fragments import Fragments, Sprites, Triangles
from .light_maps import LightMaps
from .transparency import Light, Transparency, View

# Of the published maps: side in texels, and coefficients, which fill two targets.
PUBLISHED_SIDE, PUBLISHED_COEFFICIENTS = 512, 7
# The air between what throws a shadow and what it falls on, as a share of the depth of all particles: what comes nearest to
# suns of 17 and 34 degrees that are looked at point by point.
SPREAD = 0.2


class Drawn:
    """Owns its shaders, and what it drew last, for as long as neither that nor its light changes."""

    def __init__(self) -> None:
        self._transparency = Transparency()
        self._maps = LightMaps()
        self._arrays: list[Any] = []
        self._fragments: Fragments | None = None
        self._published = False  # whether their light is yet to be looked up
        self._light: tuple[Any, Light] | None = None  # and the frame that it lights

    def fragments(self, frame: Any, camera: Any, size: tuple[int, int], overlay: bool, method: str) -> Fragments:
        """Of a frame that is drawable. In an overlay particles alone: all else is in Blender's own picture."""
        triangles = () if overlay else frame.triangles(camera, *size)
        some = Triangles(*triangles) if triangles and len(triangles[0]) else None
        self._published = method == "sorted" and some is None and has_one_sun(frame)
        sprites = frame.sprites(camera, not self._published)
        arrays = [*sprites, *triangles]
        same = len(arrays) == len(self._arrays) and all(map(np.array_equal, arrays, self._arrays))
        if self._fragments is None or not same:
            self._fragments, self._arrays = Fragments(Sprites(*sprites), some), arrays
        return self._fragments

    def composite(
        self, frame: Any, fragments: Fragments, matrix: Doubles, size: tuple[int, int], method: str, solids: Any
    ) -> Any:
        """The picture of what fragments() gave last, as Transparency makes it; matrix (4, 4), from the frame's space to
        NDC."""
        from_world = view_matrix(matrix)
        view = View(from_world, matrix @ np.linalg.inv(from_world), size, solids)
        light = self._light_of(frame) if self._published and len(fragments.points) else None
        return self._transparency.composite(fragments, view, method, light)

    def _light_of(self, frame: Any) -> Light:
        """The map of the one sun, as published: in half floats; and where that has a size, softened by what its disk
        spreads a shadow over SPREAD of the particles' depth."""
        if self._light is None or self._light[0] is not frame:
            points, radius, opacity, _colour = self._arrays[:4]
            sun = np.asarray(frame.lights)[0]
            to_map, reach = sun_map(sun[0, :3], points, radius, float(np.sqrt(sun[1, 3])))
            side = (PUBLISHED_SIDE, PUBLISHED_SIDE)
            light_map = self._maps.splat(points, radius, opacity, to_map, side, PUBLISHED_COEFFICIENTS, half=True)
            if reach > 0:
                light_map = self._maps.soften(light_map, PUBLISHED_COEFFICIENTS, reach)
            self._light = frame, Light(light_map, PUBLISHED_COEFFICIENTS, to_map)
        return self._light[1]


def has_one_sun(frame: Any) -> bool:
    lights = np.asarray(frame.lights)
    return len(lights) == 1 and bool(lights[0, 0, 3] == 1.0)


def view_matrix(matrix: Doubles) -> Doubles:
    """From the space of a projection (4, 4) to the view's, in metres: x right, y up, z towards the eye."""
    inverse = np.linalg.inv(matrix)

    def place(*ndc: float) -> Doubles:
        there = inverse @ np.array(ndc)
        return np.asarray(there[:3] / there[3])

    corner = place(-1.0, -1.0, -1.0, 1.0)
    right, up = (place(*there, -1.0, 1.0) - corner for there in ((1.0, -1.0), (-1.0, 1.0)))
    axes = np.stack((right / np.linalg.norm(right), up / np.linalg.norm(up), np.zeros(3)))
    axes[2] = np.cross(axes[0], axes[1])
    eye = inverse @ np.array((0.0, 0.0, 1.0, 0.0))
    # Of an orthographic camera, which has no eye, the middle of its near plane.
    perspective = abs(eye[3]) > 1e-9 * np.linalg.norm(eye[:3])
    out = np.eye(4)
    out[:3, :3] = axes
    out[:3, 3] = -axes @ (eye[:3] / eye[3] if perspective else place(0.0, 0.0, -1.0, 1.0))
    return out


def sun_map(direction: Doubles, points: Doubles, radius: Doubles, disk: float) -> tuple[Doubles, int]:
    """world_to_map (4, 4) of a sun that shines along `direction` (3,) on balls: points (n, 3), radius (n,). And how many
    texels a box reaches that blurs as much as a sun whose radius has the sine `disk`, over SPREAD of their depth."""
    z = direction.astype(np.float64) / np.linalg.norm(direction)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    axes = np.stack((x, np.cross(z, x), z))
    there = points.astype(np.float64) @ axes.T
    low, high = (there - radius[:, None]).min(axis=0), (there + radius[:, None]).max(axis=0)
    # Along an axis a disk's deviation is half of its radius, and a box's its width by the root of 12.
    half_width = 0.5 * 3.0**0.5 * disk * SPREAD * (high[2] - low[2])
    side = (high - low)[:2].max() + 2.0 * half_width  # texels are square
    middle = 0.5 * (low + high)[:2]
    low[:2], high[:2] = middle - 0.5 * side, middle + 0.5 * side
    out = np.eye(4)
    out[:3, :3] = axes / (high - low)[:, None]
    out[:3, 3] = -low / (high - low)
    return out, int(half_width / side * PUBLISHED_SIDE)
