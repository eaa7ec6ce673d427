# SPDX-License-Identifier: GPL-3.0-or-later
"""Filtering a map of coefficients is filtering density: for every basis, for every filter, and only in one range."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sfumato

Array = np.ndarray[Any, Any]

HEIGHT, WIDTH, SLABS = 13, 18, 32
RANGE = (0.1, 0.9)
BASES = ("fourier", "cosine", "piecewise", "learned")


def smoke(seed: int = 1) -> Array:
    """Optical depth (height, width, slabs), with an empty margin of three texels."""
    tau = np.zeros((HEIGHT, WIDTH, SLABS))
    tau[3:-3, 3:-3] = np.random.default_rng(seed).gamma(0.5, 0.2, (HEIGHT - 6, WIDTH - 6, SLABS))
    return tau


def depths(tau: Array) -> Array:
    return np.ascontiguousarray(np.broadcast_to((np.arange(SLABS) + 0.5) / SLABS, tau.shape))


def basis_named(name: str) -> Any:
    if name != "learned":
        return name
    tau = smoke()[4:-4, 4:-4].reshape(-1, SLABS)
    spans = np.tile(np.array(RANGE, np.float32), (len(tau), 1))
    return sfumato.learn_basis(depths(tau), tau, 7, spans, 1 / SLABS)


def coefficients(tau: Array, basis: Any) -> Array:
    span = np.broadcast_to(np.array(RANGE, np.float32), (*tau.shape[:2], 2))
    return np.asarray(sfumato.project(depths(tau), tau, 7, 1 / SLABS, basis, span))


def box_matrix(texels: int, width: int) -> Array:
    apart = np.abs(np.subtract.outer(np.arange(texels), np.arange(texels)))
    return (apart <= width // 2) / width


def filtered(values: Array, width: float, kind: str) -> Array:
    """The same filter, measured: what a lone texel is spread to, as a matrix along each axis."""
    if kind == "box":
        down, across = box_matrix(len(values), int(width)), box_matrix(values.shape[1], int(width))
    else:
        down, across = (
            np.array([sfumato.filter_map(line.reshape(-1, 1, 1), width, kind)[:, 0, 0] for line in np.eye(n)]).T
            * bell_centre(width)
            for n in values.shape[:2]
        )
    return np.asarray(np.einsum("ab,cd,bdn->acn", down, across, values))


def bell_centre(width: float) -> float:
    """A line of one texel's width loses what goes to either side."""
    lone = np.zeros((1, 201, 1))
    lone[0, 100] = 1.0
    return 1.0 / float(sfumato.filter_map(lone, width, "gaussian").sum())


@pytest.mark.parametrize("kind, width", [("box", 3), ("box", 7), ("gaussian", 0.8), ("gaussian", 2.5)])
@pytest.mark.parametrize("name", BASES)
def test_coefficients_filter_as_density_does(name: str, kind: str, width: float) -> None:
    basis, tau = basis_named(name), smoke()
    here = sfumato.filter_map(coefficients(tau, basis), width, kind)
    there = coefficients(filtered(tau, width, kind), basis)
    assert np.abs(here).max() > 0.1
    np.testing.assert_allclose(here, there, rtol=0, atol=3e-6 * np.abs(there).max())


@pytest.mark.parametrize("name", BASES)
def test_each_mip_is_the_projection_of_a_coarser_density(name: str) -> None:
    basis, tau = basis_named(name), smoke()
    down, across = (halving(n) for n in tau.shape[:2])
    coarser = np.einsum("ab,cd,bdn->acn", down, across, tau)
    here = sfumato.mipmaps(coefficients(tau, basis))[1]
    np.testing.assert_allclose(here, coefficients(coarser, basis), rtol=0, atol=3e-6 * np.abs(here).max())


def halving(texels: int) -> Array:
    """How much of each texel lies in each of half as many, over the width of the new ones."""
    half = texels // 2
    edges = np.arange(half + 1) / half
    fine = np.arange(texels + 1) / texels
    overlap = np.minimum(edges[1:, None], fine[1:]) - np.maximum(edges[:-1, None], fine[:-1])
    return np.maximum(overlap, 0.0) * half


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 5), (16, 16), (31, 64), (33, 2)])
def test_mips_keep_the_mean_at_any_size(shape: tuple[int, int]) -> None:
    values = np.random.default_rng(3).normal(1.0, 1.0, (*shape, 5))
    levels = sfumato.mipmaps(values)
    assert (levels[0] == values.astype(np.float32)).all() and levels[-1].shape == (1, 1, 5)
    for fine, coarse in zip(levels, levels[1:]):
        assert coarse.shape[:2] == tuple(max(n // 2, 1) for n in fine.shape[:2])
        np.testing.assert_allclose(coarse.mean((0, 1)), values.mean((0, 1)), rtol=0, atol=1e-6)


@pytest.mark.parametrize("kind, width", [("box", 1), ("gaussian", 0.0)])
def test_no_width_changes_nothing(kind: str, width: float) -> None:
    values = np.random.default_rng(4).normal(size=(6, 70, 3)).astype(np.float32)
    assert (sfumato.filter_map(values, width, kind) == values).all()


@pytest.mark.parametrize("kind, width, margin", [("box", 9, 4), ("gaussian", 2.0, 9)])
def test_the_total_stays_within_an_empty_margin_and_leaves_across_a_rim(kind: str, width: float, margin: int) -> None:
    values = np.random.default_rng(5).gamma(0.5, 1.0, (40, 50, 7))
    lost = sfumato.filter_map(values, width, kind).sum((0, 1))
    assert (lost < 0.95 * values.sum((0, 1))).all()
    values = np.pad(values, ((margin, margin), (margin, margin), (0, 0)))
    kept = sfumato.filter_map(values, width, kind).sum((0, 1))
    np.testing.assert_allclose(kept, values.sum((0, 1)), rtol=1e-6)


@pytest.mark.parametrize("kind, width", [("box", 5), ("gaussian", 1.3)])
def test_filters_are_separable(kind: str, width: float) -> None:
    values = np.zeros((31, 31, 1))
    values[15, 15] = 1.0
    spread = sfumato.filter_map(values, width, kind)[:, :, 0]
    np.testing.assert_allclose(spread, np.outer(spread.sum(1), spread.sum(0)), atol=1e-7)
    np.testing.assert_allclose(spread, spread.T, atol=1e-8)
    across = sfumato.filter_map(values.reshape(1, -1, 1), width, kind)
    assert np.count_nonzero(across) == np.count_nonzero(spread.sum(0))


@pytest.mark.parametrize("deviation", [0.3, 0.7, 1.0, 2.3, 5.5, 40.0])
def test_the_bell_has_its_deviation_and_its_shape(deviation: float) -> None:
    reach = int(4 * deviation) + 8
    x = np.arange(-reach, reach + 1)
    lone = np.zeros((2 * reach + 1, 2 * reach + 1, 1)) if deviation < 10 else np.zeros((1, 2 * reach + 1, 1))
    lone[len(lone) // 2, reach] = 1.0
    spread = sfumato.filter_map(lone, deviation, "gaussian")[:, :, 0].sum(0)
    spread /= spread.sum()
    assert np.sqrt((spread * x**2).sum()) == pytest.approx(deviation, rel=1e-5)
    bell = np.exp(-0.5 * (x / deviation) ** 2)
    if deviation >= 1.0:
        assert np.abs(spread - bell / bell.sum()).max() <= 0.07 * bell.max() / bell.sum()


def test_sums_do_not_drift() -> None:
    values = np.random.default_rng(6).gamma(0.5, 1.0, (1, 20_000, 2))
    values[0, 100] = 1e6  # leaves no trace once the box has passed
    width = 33
    sums = np.pad(values[0].astype(np.float32).astype(float), ((width // 2 + 1, width // 2), (0, 0))).cumsum(0)
    exact = (sums[width:] - sums[:-width]) / width / width  # once more across the rows, of which there is one
    found = sfumato.filter_map(values, width)[0]
    np.testing.assert_allclose(found, exact, rtol=1e-6)


# ---- Blurred hair (Jansen and Bavoil 2010, figure 9) ----


def hair(side: int = 96, strands: int = 40) -> tuple[Array, Array]:
    """Fragments (side, side, strands): as in the case `hair` of the benchmark, behind a round head, and fewer towards
    its rim."""
    rng = np.random.default_rng(9)
    y, x = np.meshgrid(*[np.linspace(-1, 1, side)] * 2, indexing="ij")
    round_ = np.clip(1 - x**2 - y**2, 0, 1)
    depth = (0.55 - 0.2 * np.sqrt(round_))[..., None] + 0.12 * rng.random((side, side, strands))
    alpha = rng.uniform(0.05, 0.15, depth.shape)
    alpha[rng.random(depth.shape) > np.sqrt(round_)[..., None]] = 0.0
    return depth, -np.log1p(-alpha)


def exact_light(depth: Array, tau: Array, receivers: Array, width: int) -> Array:
    """The linked lists' answer: the filtered optical depth in front of each receiver, in double precision."""
    side, matrix = len(depth), box_matrix(len(depth), width)
    passed = np.stack([(tau * (depth <= d)).sum(-1) for d in receivers], -1)
    return np.exp(-np.einsum("ab,cd,bdn->acn", matrix, matrix, passed)).reshape(side, side, -1)


def light_error(depth: Array, tau: Array, basis: str, count: int, span: Array, width: int = 33) -> float:
    receivers = (np.arange(65) + 0.37) / 65
    c = sfumato.filter_map(sfumato.project(depth, tau, count, basis=basis, range=span), width)
    at = np.broadcast_to(receivers, (*depth.shape[:2], 65))
    light = sfumato.transmittance(c, at, basis, span)
    return float(np.sqrt(np.mean((light - exact_light(depth, tau, receivers, width)) ** 2)))


def test_blurred_hair_is_close_to_filtered_lists() -> None:
    """The target is .02. Measured with 5 coefficients on one range: Fourier .0046, cosine .0064, slices .0212; on the
    whole depth .049, .069, .077, and 32 slices .0064; .078 where every texel keeps its own range all the same."""
    depth, tau = hair()
    shared = sfumato.depth_ranges(depth, tau)
    for basis in ("fourier", "cosine"):
        assert light_error(depth, tau, basis, 5, shared) <= 0.02


# ---- Ranges ----


def test_mixed_ranges_are_refused_and_would_be_wrong() -> None:
    depth, tau = hair()
    own, shared = sfumato.depth_range(depth, tau), sfumato.depth_ranges(depth, tau)
    with pytest.raises(ValueError, match=r"range holds .* at texel \(\d+, \d+\)"):
        sfumato.filter_map(np.ones((*depth.shape[:2], 5)), 33, range=own)
    sfumato.filter_map(np.ones((*depth.shape[:2], 5)), 33, range=shared)
    with pytest.raises(ValueError, match="range holds"):
        sfumato.mipmaps(np.ones((*depth.shape[:2], 5)), range=own)
    assert light_error(depth, tau, "fourier", 5, own) > 3 * light_error(depth, tau, "fourier", 5, shared)


@pytest.mark.parametrize("tile, reach", [(0, 0), (1, 0), (4, 0), (4, 1), (5, 3), (100, 1)])
def test_tiles_hold_the_rays_within_reach_and_no_others(tile: int, reach: int) -> None:
    rng = np.random.default_rng(7)
    depth = rng.uniform(0.3, 0.4, (11, 14, 3)) + 0.4 * rng.random((11, 14, 1))
    tau = np.ones(depth.shape) * (rng.random((11, 14, 1)) < 0.6)
    own, shared = sfumato.depth_range(depth, tau), sfumato.depth_ranges(depth, tau, tile, reach)
    side = tile or 100
    for y, x in np.ndindex(11, 14):
        top, left = y // side * side, x // side * side
        part = np.s_[max(top - reach, 0) : top + side + reach, max(left - reach, 0) : left + side + reach]
        some = tau[part].any(-1)
        low, high = own[part][..., 0], own[part][..., 1]
        wanted = (low[some].min(), high[some].max()) if some.any() else (0.0, 1.0)
        assert tuple(shared[y, x]) == wanted


@pytest.mark.parametrize("name", BASES)
def test_a_bilinear_look_up_across_tiles_is_the_filtered_density(name: str) -> None:
    """At a border the tile that asks projects its neighbour's rays into its own range, which holds them."""
    basis, tau = basis_named(name), smoke()
    tau *= np.abs(np.subtract.outer(1.5 * np.arange(WIDTH), np.arange(SLABS))) < 4
    z = depths(tau)
    spans = sfumato.depth_ranges(z, tau, tile=6, reach=1, width=1 / SLABS)
    left, right = np.s_[6, 5], np.s_[6, 6]
    assert tuple(spans[left]) != tuple(spans[right])
    for asks in (left, right):
        c = [sfumato.project(z[at], tau[at], 7, 1 / SLABS, basis, spans[asks]) for at in (left, right)]
        mixed = 0.3 * tau[left] + 0.7 * tau[right]
        wanted = sfumato.project(z[asks], mixed, 7, 1 / SLABS, basis, spans[asks])
        np.testing.assert_allclose(0.3 * c[0] + 0.7 * c[1], wanted, rtol=0, atol=3e-6 * np.abs(wanted).max())
        light = sfumato.transmittance(0.3 * c[0] + 0.7 * c[1], np.array([0.0, 1.0]), basis, spans[asks])
        np.testing.assert_allclose(light, [1.0, np.exp(-mixed.sum())], atol=1e-5)


MAP = np.ones((4, 5, 3))
SPLIT = np.tile(np.array((0.0, 1.0), np.float32), (4, 5, 1))
SPLIT[2, 3] = (0.25, 0.5)
REFUSED: dict[str, Callable[[], object]] = {
    r"width is 4, but that of a box must be an odd": lambda: sfumato.filter_map(MAP, 4),
    r"width is 2.5, but that of a box": lambda: sfumato.filter_map(MAP, 2.5),
    r"width is 0, but must lie between 1": lambda: sfumato.filter_map(MAP, 0),
    r"width is nan, but must lie": lambda: sfumato.filter_map(MAP, np.nan, "gaussian"),
    r"width is -1, but must lie between 0": lambda: sfumato.filter_map(MAP, -1.0, "gaussian"),
    r"kind is 'tent', but must be one of 'box', 'gaussian'": lambda: sfumato.filter_map(MAP, 3, "tent"),
    r"coefficients has shape \(4, 5\)": lambda: sfumato.filter_map(MAP[..., 0], 3),
    r"coefficients has shape \(0, 5, 3\)": lambda: sfumato.mipmaps(MAP[:0]),
    r"coefficients holds inf at flat index 0": lambda: sfumato.mipmaps(MAP * np.inf),
    r"range holds 0.25, 0.5 at texel \(2, 3\)": lambda: sfumato.filter_map(MAP, 3, range=SPLIT),
    r"range has shape \(4, 4, 2\)": lambda: sfumato.filter_map(MAP, 3, range=SPLIT[:, :4]),
    r"tile is -1, but must lie between 0": lambda: sfumato.depth_ranges(0.5 * MAP, MAP, -1),
    r"reach is -1, but must lie between 0": lambda: sfumato.depth_ranges(0.5 * MAP, MAP, 1, -1),
    r"depth has shape \(5, 3\)": lambda: sfumato.depth_ranges(0.5 * MAP[0], MAP[0]),
    r"kind is 'mean', but must be": lambda: sfumato.depth_ranges(0.5 * MAP, MAP, kind="mean"),
}


@pytest.mark.parametrize("message", REFUSED)
def test_unusable_arguments_are_named(message: str) -> None:
    with pytest.raises(ValueError, match=message):
        REFUSED[message]()


def test_precision_is_kept() -> None:
    assert sfumato.filter_map(MAP, 3).dtype == np.float64
    assert sfumato.filter_map(MAP.astype(np.float32)[:, ::-1], 3).dtype == np.float32
    assert sfumato.mipmaps(MAP)[1].dtype == np.float64
