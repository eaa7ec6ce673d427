# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights at the horizon and at grazing angles, and light shafts whose epipole lies on the edge of something."""

from __future__ import annotations

import functools

import bench_microfacet
import numpy as np
import sfumato
from bench_microfacet import Lit
from shaft_cases import distances, perspective, room, sun_map

Array = np.ndarray
STEPS = 121
GRAZING = 0.03  # the cosine of the view


@functools.cache
def setting(alpha: float = 0.09) -> Lit:
    """A square of 1 m, upright, 2 m away, mirrored by a surface that is seen at 1.7 degrees, sets behind its horizon."""
    height = np.linspace(0.6, -0.6, STEPS)
    zero, half = np.zeros(STEPS), 0.5
    sides = ((-half, -half), (half, -half), (half, half), (-half, half))
    corners = np.stack([np.stack([zero + 2.0, zero + y, height + z], -1) for y, z in sides], 1)
    view = np.tile([-np.sqrt(1.0 - GRAZING**2), 0.0, GRAZING], (STEPS, 1))
    return Lit(corners, view, np.full((STEPS, 2), alpha))


@functools.cache
def of_reference() -> Array:
    return setting().reference()


def reflected(method: str) -> Array:
    """(STEPS,): radiance, of those methods that bench.py arealights has."""
    return np.asarray(bench_microfacet.METHODS[method][0](setting()), float)


def off_while_it_sets(method: str) -> tuple[float, float]:
    """The root mean square of the error, and its largest change between two places a centimetre apart, by the range."""
    off = (reflected(method) - of_reference()) / np.ptp(of_reference())
    return float(np.sqrt(np.mean(off**2))), float(np.abs(np.diff(off)).max())


def off_at_grazing(method: str) -> float:
    """Random rectangles, views less than 1.7 degrees above the surface: the root mean square error, by the range."""
    lights = bench_microfacet.lit(400, 12, (0.003, GRAZING))
    exact = lights.reference()
    off = np.asarray(bench_microfacet.METHODS[method][0](lights), float) - exact
    return float(np.sqrt(np.mean(off**2)) / np.ptp(exact))


PHONG = ("poles-2", "arvo", "lorentzian", "lorentzian-pearson", "ellipse-peak")


def phong_while_it_sets(method: str, exponent: int = 100) -> float:
    """The largest error of a Phong lobe of that square, which is in [0, 1]."""
    corners, normal = setting().rectangles, (0, 0, 1)
    axis = (np.sqrt(1.0 - GRAZING**2), 0.0, GRAZING)
    exact = sfumato.reference.polygon_integral(corners, axis, exponent, normal)
    found = sfumato.polygon_integral(corners, axis, exponent, method, normal, two_sided=True)
    return float(np.abs(np.asarray(found, float) - exact).max())


# ---- Light shafts ----

SUN = np.array((-0.75, -0.25, -0.42)) / np.linalg.norm((-0.75, -0.25, -0.42))
EDGE = np.array((1.8, 1.2, 1.5))  # of a pillar, between it and what is behind
SIZE = 192, 120


@functools.cache
def room_map() -> tuple[Array, sfumato.SolidMap]:
    boxes = room()
    return boxes, sfumato.SolidMap(*sun_map(boxes, SUN, 256))


@functools.cache
def along_the_edge(shift: float) -> tuple[sfumato.Camera, Array]:
    """A camera that looks into the sun along the pillar's edge, `shift` of a pixel beside it, and how far it sees."""
    boxes, _ = room_map()
    eye = EDGE + 2.8 * SUN
    matrix = perspective(eye, eye - SUN, *SIZE)
    matrix[0] += 2.0 * shift / SIZE[0] * matrix[3]
    camera = sfumato.Camera(matrix)
    return camera, distances(boxes, camera, *SIZE)


def shafts_round_an_edge(shift: float, method: str) -> Array:
    """(rows, columns)"""
    camera, far = along_the_edge(shift)
    mie = (0.05, 0.05, 0.05)
    made = sfumato.shafts(far, camera, [room_map()[1]], [SUN], [(3, 3, 3)], mie=mie, anisotropy=0.5, method=method)[0]
    return np.asarray(made[..., 1], float)


SHIFTS = (-0.5, 0.0, 0.5)


@functools.cache
def marched() -> Array:
    return np.array([shafts_round_an_edge(shift, "march") for shift in SHIFTS])


def off_at_an_edge(method: str) -> tuple[float, float]:
    """Against the march: the root mean square over all pixels and shifts, and of its change between shifts, by the mean."""
    off = (np.array([shafts_round_an_edge(shift, method) for shift in SHIFTS]) - marched()) / marched().mean()
    return float(np.sqrt(np.mean(off**2))), float(np.sqrt(np.mean(np.diff(off, axis=0) ** 2)))
