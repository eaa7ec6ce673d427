# SPDX-License-Identifier: GPL-3.0-or-later
"""Published ways to store a light ray that the product does not use, for the benchmark alone.

Each takes absorbers (rays, n), depths in [0, 1] and optical depths, and receivers (rays, d), and returns T (rays, d).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def half(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float16).astype(float)


def moments(count: int) -> Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Power moments of optical depth in single floats and Hamburger's problem: Muenstermann, Krumpen, Klein and
    Peters, "Moment-based order-independent transparency", 2018, their biases for 32 bits. beta = .5, half of the
    absorbance at the receiver's own depth, had the least error of .1, .25 and .5."""
    bias = {4: 5e-7, 6: 5e-6}[count]
    towards = np.array({4: (1, 0, 0.375, 0, 0.375), 6: (1, 0, 0.48, 0, 0.451, 0, 0.45)}[count])
    size = count // 2 + 1

    def transmittance(depth: np.ndarray, tau: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        total = tau.sum(1)
        powers = (2.0 * depth[..., None] - 1.0) ** np.arange(count + 1)
        b = (tau[..., None] * powers).sum(1) / total[:, None]
        b = (1.0 - bias) * b.astype(np.float32).astype(float) + bias * towards
        hankel = b[:, np.add.outer(np.arange(size), np.arange(size))]
        z0 = 2.0 * receivers - 1.0
        c = np.linalg.solve(hankel[:, None], (z0[..., None] ** np.arange(size))[..., None])[..., 0]
        companion = np.zeros((*z0.shape, size - 1, size - 1))
        companion[..., 1:, :-1] = np.eye(size - 2)
        companion[..., :, -1] = -c[..., :-1] / c[..., -1:]
        support = np.concatenate([z0[..., None], np.linalg.eigvals(companion).real], -1)
        vandermonde = np.swapaxes(support[..., None] ** np.arange(size), -1, -2)
        right = np.broadcast_to(b[:, None, :size], (*z0.shape, size))
        w = np.linalg.solve(vandermonde, right[..., None])[..., 0]
        before = (w[..., 1:] * (support[..., 1:] < z0[..., None])).sum(-1) + 0.5 * w[..., 0]
        return np.asarray(np.exp(-total[:, None] * np.clip(before, 0.0, 1.0)))

    return transmittance


def haar(depth: np.ndarray, tau: np.ndarray, receivers: np.ndarray) -> np.ndarray:
    """Sixteen half floats: Aizenshtein, Smal and McGuire, "Wavelet Transparency", 2022, rank 3. The Haar series of the
    cumulative optical depth down to cells of 1/16 is its mean over each of them; neighbours are interpolated, and
    depths scaled by 15/16 leave room for that."""
    cells, scale = 16, 15 / 16
    edges = np.arange(cells + 1) / cells
    integral = (tau[..., None] * np.maximum(edges - scale * depth[..., None], 0.0)).sum(1)
    means = half(cells * np.diff(integral, axis=1))
    x = np.clip(scale * cells * receivers - 0.5, 0.0, cells - 1.0)
    cell = np.minimum(x.astype(int), cells - 2)
    low, high = (np.take_along_axis(means, cell + i, 1) for i in (0, 1))
    return np.asarray(np.exp(-np.clip(low + (x - cell) * (high - low), 0.0, tau.sum(1)[:, None])))


def avsm(depth: np.ndarray, tau: np.ndarray, receivers: np.ndarray, nodes: int = 8) -> np.ndarray:
    """Steps at eight nodes: Salvi, Vidimce, Lauritzen and Lefohn, "Adaptive volumetric shadow maps", 2010. Absorbers
    come in any order; with a ninth node, that goes whose removal changes the area below the steps least."""
    rays, order = len(depth), np.arange(nodes + 1)
    z = np.full((rays, nodes + 1), np.inf)
    t = np.ones((rays, nodes + 1))
    for new_z, new_t in zip(depth.T[..., None], np.exp(-tau.T)[..., None]):
        k = (z <= new_z).sum(1, keepdims=True)
        before, here = order < k, order == k
        previous = np.where(k > 0, np.take_along_axis(t, np.maximum(k - 1, 0), 1), 1.0)
        t = np.where(before, t, np.where(here, previous, np.roll(t, 1, 1)) * new_t)
        z = np.where(before, z, np.where(here, new_z, np.roll(z, 1, 1)))
        full = np.isfinite(z[:, -1])
        with np.errstate(invalid="ignore"):  # between nodes that are not there yet
            area = (z[:, 2:] - z[:, 1:-1]) * (t[:, :-2] - t[:, 1:-1])
        gone = 1 + np.argmin(np.where(np.isfinite(area), area, np.inf), 1)
        keep = np.where(full[:, None], order + (order >= gone[:, None]), order).clip(max=nodes)
        z, t = np.take_along_axis(z, keep, 1), np.take_along_axis(t, keep, 1)
        z[full, -1] = np.inf
    passed = (z[:, None] <= receivers[..., None]).sum(-1)
    return np.take_along_axis(np.concatenate([np.ones((rays, 1)), t], 1), passed, 1)


def deep_opacity(layers: int) -> Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Optical depth up to the ends of layers that begin at each ray's first absorber: Yuksel and Keyser, "Deep opacity
    maps", 2008. Each layer is wider than the one before by the width of the first, and all rays share the widths, by
    which the last layer ends where the longest ray does. Half floats, and a single one for where they begin."""

    def transmittance(depth: np.ndarray, tau: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        there = tau > 0.0
        first = np.where(there, depth, np.inf).min(1, keepdims=True)
        reach = float((np.where(there, depth, 0.0).max(1) - first[:, 0]).max()) + 1e-6
        k = np.arange(layers + 1)
        edges = reach * k * (k + 1) / (layers * (layers + 1))
        before = [np.where(depth - first <= edge, tau, 0.0).sum(1) for edge in edges[1:]]
        stored = np.stack([np.zeros(len(depth)), *map(half, before)], 1)
        z = np.clip(receivers - first, 0.0, reach)
        layer = np.clip(np.searchsorted(edges, z, side="right") - 1, 0, layers - 1)
        low, high = (np.take_along_axis(stored, layer + i, 1) for i in (0, 1))
        share = (z - edges[layer]) / (edges[layer + 1] - edges[layer])
        return np.asarray(np.exp(-(low + share * (high - low))))

    return transmittance
