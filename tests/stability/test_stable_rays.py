# SPDX-License-Identifier: GPL-3.0-or-later
"""Light rays where ways to store them fail: every way of bench.py lightmaps, ours and rivals'. Sizes of known weaknesses
are those of docs/stability.md."""

from __future__ import annotations

import pytest
from bench_light_maps import METHODS, swing
from known import judge
from ray_failures import (
    change_with_bounds,
    light_by_sheets,
    many_layers,
    off_beside_sheets,
    outlier_ratio,
    rise,
    sheets_in_haze,
    summed_in_halves,
    total_off,
)

every_method = pytest.mark.parametrize("method", METHODS)


@every_method
def test_smoke_that_moves_along_the_ray(method: str) -> None:
    """Through an eighth of the map's depth: by how much the light changes that should not (figure 6)."""
    known = {"fourier": 0.0546, "piecewise": 0.176, "learned": 0.0215, "haar": 0.0369, "moments-6": 0.00412}
    judge(swing(METHODS[method].method), 0.004, known.get(method))


@every_method
def test_bounds_a_tenth_wider(method: str) -> None:
    """The plume's picture, by its mean (figure 5)."""
    known = {"fourier": 0.0312, "piecewise": 0.147, "learned": 0.084, "haar": 0.0448}
    judge(change_with_bounds(METHODS[method].method), 0.005, known.get(method))


@every_method
def test_one_particle_before_all_others(method: str) -> None:
    """How many times the error that is without it (figure 7)."""
    known = {
        "auto-additive": 1.80,
        "fourier-range": 11.7,
        "cosine-range": 5.08,
        "learned-range": 1.74,
        "moments-4": 1.89,
        "deep-opacity": 17.9,
    }
    judge(outlier_ratio(METHODS[method].method), 1.3, known.get(method))


@every_method
def test_an_opaque_sheet_in_haze(method: str) -> None:
    """The error elsewhere on its ray (figure 8)."""
    known = {
        "auto-additive": 0.0615,
        "fourier": 0.743,
        "fourier-range": 0.783,
        "piecewise": 0.948,
        "cosine-range": 0.198,
        "learned": 0.942,
        "learned-range": 0.939,
        "moments-4": 0.628,
        "moments-6": 0.307,
        "haar": 0.596,
        "deep-opacity": 0.956,
    }
    judge(off_beside_sheets(METHODS[method].method(sheets_in_haze())), 0.03, known.get(method))


@every_method
def test_light_does_not_grow_again_behind_a_sheet(method: str) -> None:
    known = {"fourier": 0.553, "fourier-range": 0.555}
    judge(rise(METHODS[method].method(sheets_in_haze())), 0.001, known.get(method))


@pytest.mark.parametrize(
    "basis, coefficients, known",
    [
        ("fourier", 15, 0.436),
        ("fourier", 101, 0.0817),
        ("fourier", 1001, None),
        ("cosine", 15, 0.374),
        ("cosine", 101, 0.0797),
        ("cosine", 1001, None),
        ("piecewise", 15, 0.662),
        ("piecewise", 101, None),
        ("piecewise", 1001, None),
    ],
)
def test_more_coefficients_ring_less(basis: str, coefficients: int, known: float | None) -> None:
    """Over the whole depth, clamped and no more, as figure 8 has 15, 100 and 1000 coefficients of Fourier's series."""
    judge(off_beside_sheets(light_by_sheets(basis, coefficients)), 0.03, known)


@every_method
def test_twenty_thousand_layers_add_up(method: str) -> None:
    judge(total_off(METHODS[method].method, many_layers()), 0.005)


@pytest.mark.parametrize("alpha, known", [(1e-3, 0.0183), (5e-4, 0.135), (2e-4, 0.588)])
def test_half_floats_stall(alpha: float, known: float) -> None:
    """The paper's RGBA16F, blended into: a sum of 4 grows no more by parts of less than a thousandth of it."""
    judge(total_off(summed_in_halves, many_layers(alpha=alpha)), 0.005, known)
