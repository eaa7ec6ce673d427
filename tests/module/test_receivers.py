# SPDX-License-Identifier: GPL-3.0-or-later
"""Receivers that are absorbers too: what they absorb themselves does not darken them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sfumato

Array = np.ndarray[Any, Any]


def fragments(count: int, rays: int = 2000) -> tuple[Array, Array, Array]:
    """Depth, optical depth, and the exact share of light in front of each."""
    rng = np.random.default_rng(count)
    depth = 0.05 + 0.9 * rng.random((rays, count))
    tau = -np.log1p(-(0.1 + 0.5 * rng.random((rays, count))))
    before = depth[:, None, :] < depth[:, :, None]
    return depth, tau, np.exp(-(tau[:, None, :] * before).sum(-1))


def rms(error: Array) -> float:
    return 1e3 * float(np.sqrt(np.mean(error**2)))


# What the reference text gives for four harmonics, T x1000.
@pytest.mark.parametrize("count, with_self, without", [(2, 189, 43), (8, 121, 62), (32, 85, 67)])
def test_fragments_are_lit_as_the_reference_text_says(count: int, with_self: float, without: float) -> None:
    depth, tau, exact = fragments(count)
    c = sfumato.project(depth, tau, 9)
    assert rms(sfumato.transmittance(c, depth) - exact) == pytest.approx(with_self, rel=0.05)
    assert rms(sfumato.transmittance_before(c, depth, tau) - exact) == pytest.approx(without, rel=0.05)


@pytest.mark.parametrize("basis", ["fourier", "cosine", "piecewise", "learned"])
@pytest.mark.parametrize("width", [0.0, 0.1])
def test_the_others_alone_darken_a_receiver(basis: str, width: float) -> None:
    """As if its own optical depth had never been projected, on the ray's own range too."""
    depth, tau, _ = fragments(5, 50)
    span = sfumato.depth_range(depth, tau, width=width)
    functions: str | sfumato.LearnedBasis = basis
    if basis == "learned":
        functions = sfumato.learn_basis(depth, tau, 7, span, width)
    c = sfumato.project(depth, tau, 7, width, functions, span)
    found = sfumato.transmittance_before(c, depth, tau, functions, span, width)
    for i in range(5):
        others = np.where(np.arange(5) == i, 0.0, tau)
        wanted = sfumato.transmittance(
            sfumato.project(depth, others, 7, width, functions, span), depth[:, i : i + 1], functions, span
        )
        np.testing.assert_allclose(found[:, i : i + 1], wanted, atol=2e-5)


@pytest.mark.parametrize("optical_depth", [0.0, 0.5, 13.9])
def test_a_lone_receiver_is_in_full_light(optical_depth: float) -> None:
    depth = np.linspace(0.0, 1.0, 21)[:, None]
    tau = np.full(depth.shape, optical_depth)
    light = sfumato.transmittance_before(sfumato.project(depth, tau), depth, tau)
    np.testing.assert_allclose(light, 1.0, atol=1e-5)


def test_unusable_receivers_are_named() -> None:
    c, half = np.ones(3), np.array([0.5])
    with pytest.raises(ValueError, match="depth holds 1.5 at flat index 0"):
        sfumato.transmittance_before(c, np.array([1.5]), half)
    with pytest.raises(ValueError, match=r"optical_depth has shape \(2,\)"):
        sfumato.transmittance_before(c, half, np.ones(2))
    with pytest.raises(ValueError, match=r"depth has shape \(1,\), but all axes other than the last"):
        sfumato.transmittance_before(np.ones((4, 3)), half, half)
