# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture nodes that are formulas, read into fields; by what each Blender has of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ... import compat
from . import fields
from .fields import Field
from .reading import Place, Reader

Vector = Callable[[Reader, Place], Field]  # a texture's own, where nothing is linked
Readers = dict[str, Callable[[Reader, Place, Any], Field]]

_DIMENSIONS = {"1D": 1, "2D": 2, "3D": 3, "4D": 4}
_FRACTALS = {"FBM": 0, "MULTIFRACTAL": 1, "RIDGED_MULTIFRACTAL": 2, "HYBRID_MULTIFRACTAL": 3, "HETERO_TERRAIN": 4}
_FEATURES = {"F1": 0, "F2": 1, "SMOOTH_F1": 2, "DISTANCE_TO_EDGE": 3, "N_SPHERE_RADIUS": 4}
_METRICS = {"EUCLIDEAN": 0, "MANHATTAN": 1, "CHEBYCHEV": 2, "MINKOWSKI": 3}
_WAVES = {"BANDS": 0, "RINGS": 1}
_DIRECTIONS = {"X": 0, "Y": 1, "Z": 2, "DIAGONAL": 3, "SPHERICAL": 3}
_PROFILES = {"SIN": 0, "SAW": 1, "TRI": 2}
_VALUES = {"Fac", "Factor", "Value", "Height", "Distance", "Radius"}


def _of(name: str, integers: tuple[int, ...], inputs: list[Field], first: int = 0, count: int = 1) -> Field:
    whole = (*integers, *[0] * (6 - len(integers)))
    return fields.of("texture", *inputs, settings=(name, whole, first, count))


def readers(vector: Vector) -> Readers:
    """By the type of a node, where textures lie by `vector` if nothing else is said."""

    def number(reader: Reader, place: Place, name: str, absent: float = 0.0) -> Field:
        socket = place.node.inputs.get(name)
        return fields.constant(absent) if socket is None else reader.of_socket(place, socket)

    def within_one(value: Field) -> Field:
        return value if compat.textures_have_types() else fields.clipped(value, 0.0, 1.0)

    def at(reader: Reader, place: Place, scaled: bool = True) -> list[Field]:
        """The point and w, times the scale."""
        socket = place.node.inputs.get("Vector")
        where = (
            vector(reader, place) if socket is None else reader.of_socket(place, socket, unlinked=vector(reader, place))
        )
        w = number(reader, place, "W")
        if not scaled:
            return [where, w]
        scale = number(reader, place, "Scale", 1.0)
        return [scale * where, scale * w]

    def noise(reader: Reader, place: Place, output: Any) -> Field:
        node = place.node
        value = output.identifier in _VALUES
        kind = _FRACTALS[getattr(node, "noise_type", "FBM")]
        normalise = getattr(node, "normalize", True)
        numbers = [
            number(reader, place, "Detail"),
            within_one(number(reader, place, "Roughness")),
            number(reader, place, "Lacunarity", 2.0),
            number(reader, place, "Offset"),
            number(reader, place, "Gain"),
            number(reader, place, "Distortion"),
        ]
        integers = _DIMENSIONS[node.noise_dimensions], kind, compat.noise_repeats(), int(normalise), int(not value)
        inputs = [*at(reader, place), *numbers]
        return _of("noise", integers, inputs, *((0, 1) if value else (1, 3)))

    def musgrave(reader: Reader, place: Place, _: Any) -> Field:
        node = place.node
        names = "Detail", "Dimension", "Lacunarity", "Offset", "Gain"
        numbers = [number(reader, place, name) for name in names]
        integers = _DIMENSIONS[node.musgrave_dimensions], _FRACTALS[node.musgrave_type], compat.noise_repeats()
        return _of("musgrave", integers, [*at(reader, place), *numbers])

    def voronoi(reader: Reader, place: Place, output: Any) -> Field:
        node, name = place.node, output.identifier
        numbers = [
            number(reader, place, "Detail"),
            number(reader, place, "Roughness", 0.5),
            number(reader, place, "Lacunarity", 2.0),
            number(reader, place, "Smoothness"),
            number(reader, place, "Exponent", 0.5),
            number(reader, place, "Randomness", 1.0),
        ]
        dimensions = _DIMENSIONS[node.voronoi_dimensions]
        coloured = int(name == "Color")
        normalise = int(getattr(node, "normalize", False))
        integers = (
            dimensions, _FEATURES[node.feature], _METRICS[node.distance], compat.voronoi_edition(), normalise, coloured,
        )  # fmt: skip
        inputs = [*at(reader, place), *numbers]
        if name in _VALUES:
            return _of("voronoi", integers, inputs)
        if name == "Color":
            return _of("voronoi", integers, inputs, 1, 3)
        scale = number(reader, place, "Scale", 1.0)
        if name == "W":
            return _of("voronoi", integers, inputs, 7) / scale
        kept = fields.constant([float(k < dimensions) if dimensions in {2, 3, 4} else 0.0 for k in range(3)])
        return (_of("voronoi", integers, inputs, 4, 3) / scale) * kept

    def two_colours(reader: Reader, place: Place) -> tuple[Field, Field]:
        first, second = (reader.of_socket(place, place.node.inputs[name]) for name in ("Color1", "Color2"))
        return first, second

    def checker(reader: Reader, place: Place, output: Any) -> Field:
        value = _of("checker", (), at(reader, place)[:1])
        # Which is 1 in cells of the first colour.
        if output.identifier in _VALUES:
            return value
        first, second = two_colours(reader, place)
        return second + value * (first - second)

    def brick(reader: Reader, place: Place, output: Any) -> Field:
        node = place.node
        where = fields.of_parts(at(reader, place)[0])[:2]
        names = "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height"
        numbers = [number(reader, place, name) for name in names]
        moved = [fields.constant(node.offset), fields.constant(node.squash)]
        inputs, integers = [*where, *numbers, *moved], (node.offset_frequency, node.squash_frequency)
        share = _of("brick", integers, inputs)
        if output.identifier in _VALUES:
            return share
        first, second = two_colours(reader, place)
        mortar = reader.of_socket(place, node.inputs["Mortar"])
        tint = _of("brick", integers, inputs, 1)
        return first + share * (mortar - first) + tint * (second - first)

    def magic(reader: Reader, place: Place, output: Any) -> Field:
        inputs = [at(reader, place)[0], number(reader, place, "Distortion")]
        value = output.identifier in _VALUES
        return _of("magic", (place.node.turbulence_depth,), inputs, *((0, 1) if value else (1, 3)))

    def wave(reader: Reader, place: Place, output: Any) -> Field:
        node = place.node
        direction = node.bands_direction if node.wave_type == "BANDS" else node.rings_direction
        names = "Distortion", "Detail", "Detail Scale"
        numbers = [number(reader, place, name) for name in names]
        numbers += [within_one(number(reader, place, "Detail Roughness", 0.5)), number(reader, place, "Phase Offset")]
        integers = (
            _WAVES[node.wave_type], _DIRECTIONS[direction], _PROFILES[node.wave_profile], compat.noise_repeats(),
        )  # fmt: skip
        found = _of("wave", integers, [at(reader, place)[0], *numbers])
        return found if output.identifier in _VALUES else fields.of("spread", found)

    def white_noise(reader: Reader, place: Place, output: Any) -> Field:
        value = output.identifier in _VALUES
        integers = _DIMENSIONS[place.node.noise_dimensions], int(not value)
        return _of("white noise", integers, at(reader, place, scaled=False), *((0, 1) if value else (1, 3)))

    def gradient(reader: Reader, place: Place, output: Any) -> Field:
        found = fields.of("gradient", at(reader, place, scaled=False)[0], settings=(place.node.gradient_type,))
        return fields.of("spread", found) if output.identifier == "Color" else found

    return {
        "TEX_NOISE": noise,
        "TEX_MUSGRAVE": musgrave,
        "TEX_VORONOI": voronoi,
        "TEX_CHECKER": checker,
        "TEX_BRICK": brick,
        "TEX_MAGIC": magic,
        "TEX_WAVE": wave,
        "TEX_WHITE_NOISE": white_noise,
        "TEX_GRADIENT": gradient,
    }
