# SPDX-License-Identifier: GPL-3.0-or-later
"""Light rays in Python: what is refused, shapes and types, and the targets that the benchmark measures."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np
import pytest
import sfumato
from bench_light_maps import METHODS, SUN, TARGETS, rmse, violations
from light_rays import FRAMES, SEEDED, Rays, seeded, smoke_frame

# RMSE of T x1000 that the reference text gives for rivals (its [C] figures), in the order of SEEDED.
PUBLISHED = {
    "fourier": (26, 46, 140, 73, 90, 113, 119),
    "fourier-range": (15, 29, 2, 38, 13, 77, 15),
    "moments-6": (37, 37, 7, 15, 30, 21, 45),
    "avsm-8": (47, 50, 0, 0, 19, 19, 26),
}

HALF = np.array([0.5])


@pytest.fixture(scope="module", name="cases")
def all_cases() -> dict[str, Rays]:
    return {case: seeded(case) for case in SEEDED}


@pytest.fixture(scope="module", name="plumes")
def two_plumes() -> list[Rays]:
    return [smoke_frame("plume", SUN), smoke_frame("plume", (1.0, 0.0, 0.0))]


@pytest.mark.parametrize("method", PUBLISHED)
def test_rivals_do_as_well_as_they_are_said_to(cases: dict[str, Rays], method: str) -> None:
    for case, published in zip(SEEDED, PUBLISHED[method]):
        error = 1e3 * rmse(METHODS[method].method, cases[case])
        assert error == pytest.approx(published, rel=0.15, abs=2.5), case


@pytest.mark.parametrize("method", ["auto", "auto-additive"])
@pytest.mark.parametrize("case", SEEDED)
def test_seeded_profiles_reach_their_targets(cases: dict[str, Rays], case: str, method: str) -> None:
    light = METHODS[method].method(cases[case])
    assert 1e3 * np.sqrt(np.mean((light - cases[case].exact) ** 2)) <= TARGETS[case]
    assert violations(light) == 0


@pytest.mark.parametrize("direction", [0, 1])
def test_plume_is_a_fifth_of_fourier_and_a_sixth_of_slices(plumes: list[Rays], direction: int) -> None:
    rays = plumes[direction]
    for method in ("auto", "auto-additive"):
        error = rmse(METHODS[method].method, rays)
        assert error <= rmse(METHODS["fourier"].method, rays) / 5
        assert error <= rmse(METHODS["piecewise"].method, rays) / 6


@pytest.mark.parametrize("case", FRAMES)
def test_real_frames_are_a_fifth_of_fourier_and_a_sixth_of_slices(case: str) -> None:
    rays = smoke_frame(case, SUN)
    for method in ("auto", "auto-additive"):
        error = rmse(METHODS[method].method, rays)
        assert error <= rmse(METHODS["fourier"].method, rays) / 5
        assert error <= rmse(METHODS["piecewise"].method, rays) / 6


def test_every_method_sees_no_smoke_in_a_clear_ray() -> None:
    depth, none = np.full((2, 3), 0.5), np.zeros((2, 3))
    receivers = np.tile([0.0, 0.5, 1.0], (2, 1))
    bases: tuple[str | sfumato.LearnedBasis, ...] = ("fourier", "cosine", "piecewise")
    for basis in (*bases, sfumato.learn_basis(depth, none, 3)):
        span = sfumato.depth_range(depth, none)
        c = sfumato.project(depth, none, 3, basis=basis, range=span)
        assert (sfumato.transmittance(c, receivers, basis, span) == 1.0).all()
    choice = sfumato.choose_basis(depth, none)
    assert (choice.transmittance(choice.store(depth, none), receivers) == 1.0).all()


def test_leading_axes_and_precision_are_kept() -> None:
    depth = np.random.default_rng(0).uniform(size=(4, 2, 9))
    tau = np.full(depth.shape, 0.1)
    span = sfumato.depth_range(depth, tau, "both")
    assert span.shape == (4, 2, 2)
    for basis in ("fourier", "cosine", "piecewise"):
        c = sfumato.project(depth, tau, 5, basis=basis, range=span)
        assert c.shape == (4, 2, 5) and c.dtype == np.float64
        assert sfumato.project(depth.astype(np.float32), tau, 5, basis=basis).dtype == np.float32
        texels = sfumato.pack(c, basis, span)
        back, stored = sfumato.unpack(texels, basis)
        assert texels.dtype == np.uint8 and back.shape == c.shape and (stored == span).all()
        one = sfumato.project(depth[1, 1], tau[1, 1], 5, basis=basis, range=span[1, 1])
        assert (one == c[1, 1]).all()
    assert sfumato.RayStorage().store(depth, tau).shape == (4, 2, 20)


BASIS = sfumato.learn_basis(np.array([[0.2], [0.7]]), np.ones((2, 1)), 3)
CURVE = sfumato.RayStorage()
REFUSED: dict[str, Callable[[], object]] = {
    "basis is 'wavelet', but must be one of 'fourier', 'cosine', 'piecewise'": lambda: sfumato.project(
        HALF, HALF, basis="wavelet"
    ),
    "coefficients is 4, but must be odd": lambda: sfumato.project(HALF, HALF, 4),
    "coefficients is 0, but must lie between 1": lambda: sfumato.project(HALF, HALF, 0, basis="cosine"),
    "coefficients is 5, but the learned basis has 3": lambda: sfumato.project(HALF, HALF, 5, basis=BASIS),
    "basis is None": lambda: sfumato.project(HALF, HALF, basis=cast(str, None)),
    "depth holds 1.5 at flat index 0": lambda: sfumato.project(np.array([1.5]), HALF),
    "depth holds nan at flat index 0": lambda: CURVE.store(np.array([np.nan]), HALF),
    "optical_depth holds -1 at flat index 0": lambda: sfumato.choose_basis(HALF[None], np.array([[-1.0]])),
    "range holds 0.75 before 0.25 for ray 0": lambda: sfumato.project(HALF, HALF, range=np.array([0.75, 0.25])),
    r"range has shape \(3,\)": lambda: sfumato.transmittance(np.ones(3), HALF, range=np.ones(3)),
    "range holds inf": lambda: sfumato.project(HALF, HALF, range=np.array([0.0, np.inf])),
    "evaluator is 'sigma', but must be one of 'clamp', 'monotone'": lambda: sfumato.transmittance(
        np.ones(3), HALF, evaluator="sigma"
    ),
    "kind is 'mean', but must be one of 'whole', 'minmax', 'moments', 'both', 'trimmed'": lambda: sfumato.depth_range(
        HALF, HALF, "mean"
    ),
    "q is 0, but must lie between": lambda: sfumato.depth_range(HALF, HALF, q=0.0),
    r"optical_depth has shape \(2,\), but must have that of depth, \(1,\)": lambda: sfumato.project(HALF, np.ones(2)),
    "texels has 6 bytes a ray, but must have more than 6": lambda: sfumato.unpack(np.zeros(6, np.uint8)),
    "texels has 19 bytes a ray, but curve has 20": lambda: CURVE.transmittance(np.zeros(19, np.uint8), HALF),
    "bytes is 4, but must lie between 8 and 64": lambda: sfumato.choose_basis(HALF[None], HALF[None], bytes=4),
    "must hold at least one ray": lambda: sfumato.choose_basis(np.zeros((0, 3)), np.zeros((0, 3))),
    "cells is 1, but must lie between 2 and 256": lambda: sfumato.learn_basis(HALF, HALF, cells=1),
}


@pytest.mark.parametrize("message", REFUSED)
def test_unusable_arguments_are_named(message: str) -> None:
    with pytest.raises(ValueError, match=message):
        REFUSED[message]()
