# SPDX-License-Identifier: GPL-3.0-or-later
"""Published ways to composite transparent fragments that the product does not use, and the exact one, for tests and the
benchmark alone. Each takes the fragments of pixels and returns premultiplied radiance (n, 3)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from fragments import Pixels


def before(alpha: np.ndarray) -> np.ndarray:
    """(n, f + 1): the transmittance before each fragment of sorted pixels, and behind the last."""
    return np.concatenate([np.ones((len(alpha), 1)), np.cumprod(1.0 - alpha, axis=1)], axis=1)


def exact(pixels: Pixels) -> np.ndarray:
    """The over operator on sorted fragments: Porter and Duff, 1984."""
    own = pixels.sorted()
    seen = own.alpha * before(own.alpha)[:, :-1]
    return np.asarray((own.colour * seen[..., None]).sum(1))


def shared(pixels: Pixels, seen: np.ndarray) -> np.ndarray:
    """By weights alone: what is not let through, shared among colours."""
    opacity = 1.0 - np.prod(1.0 - pixels.alpha, axis=1)
    scale = opacity / np.maximum(seen.sum(1), 1e-300)
    return np.asarray((pixels.colour * seen[..., None]).sum(1) * scale[:, None])


def moments(count: int, beta: float = 0.25) -> Callable[[Pixels], np.ndarray]:
    """Muenstermann, Krumpen, Klein and Peters, "Moment-based order-independent transparency", 2018: power moments in
    single floats, and the biases for them. `beta` of a fragment's own absorbance is taken to be before it."""
    bias = {4: 5e-7, 6: 5e-6}[count]
    towards = np.array({4: (1, 0, 0.375, 0, 0.375), 6: (1, 0, 0.48, 0, 0.451, 0, 0.45)}[count])
    size = count // 2 + 1

    def composite(pixels: Pixels) -> np.ndarray:
        tau = -np.log1p(-np.minimum(pixels.alpha, 1.0 - 2.0**-20))
        total = tau.sum(1)
        z = 2.0 * pixels.depth - 1.0
        b = np.stack([(tau * z**k).sum(1) for k in range(count + 1)], axis=1).astype(np.float32).astype(float)
        b = (1.0 - bias) * b / b[:, :1] + bias * towards
        hankel = b[:, np.add.outer(np.arange(size), np.arange(size))]
        inverse = np.linalg.inv(hankel)  # one for each pixel: it has as many right sides as fragments
        c = np.einsum("nij,nfj->nfi", inverse, z[..., None] ** np.arange(size))
        nodes = [z, *(quadratic(c) if count == 4 else cubic(c))]
        share = np.zeros_like(z)
        for node in nodes:
            others = [other for other in nodes if other is not node]
            weight = weight_of(node, others, b)
            share += weight * (beta if node is z else node < z)
        return shared(pixels, pixels.alpha * np.exp(-total[:, None] * np.clip(share, 0.0, 1.0)))

    return composite


def quadratic(c: np.ndarray) -> list[np.ndarray]:
    """The real parts of the roots of c_0 + c_1 x + c_2 x^2."""
    p, q = c[..., 1] / c[..., 2], c[..., 0] / c[..., 2]
    root = np.sqrt(np.maximum(0.25 * p * p - q, 0.0))
    return [-0.5 * p - root, -0.5 * p + root]


def cubic(c: np.ndarray) -> list[np.ndarray]:
    """Of c_0 + ... + c_3 x^3, all of whose roots are real: Viete's trigonometry."""
    b2, b1, b0 = (c[..., i] / c[..., 3] for i in (2, 1, 0))
    p, q = np.minimum(b1 - b2 * b2 / 3.0, -1e-30), 2.0 * b2**3 / 27.0 - b2 * b1 / 3.0 + b0
    radius = 2.0 * np.sqrt(-p / 3.0)
    angle = np.arccos(np.clip(3.0 * q / (p * radius), -1.0, 1.0)) / 3.0
    return [radius * np.cos(angle - 2.0 * np.pi * k / 3.0) - b2 / 3.0 for k in range(3)]


def weight_of(node: np.ndarray, others: list[np.ndarray], b: np.ndarray) -> np.ndarray:
    """What of the absorbance lies at a node: the integral of Lagrange's polynomial, by the moments."""
    polynomial = np.ones((1, *node.shape))  # lowest power first
    scale = np.ones_like(node)
    for other in others:
        higher, lower = (np.pad(polynomial, (place, (0, 0), (0, 0))) for place in ((1, 0), (0, 1)))
        polynomial = higher - other * lower
        gap = node - other
        scale *= np.where(np.abs(gap) < 1e-9, 1e-9, gap)
    return np.asarray((polynomial * b.T[: len(polynomial), :, None]).sum(0) / scale)


def mlab(pixels: Pixels, nodes: int = 4) -> np.ndarray:
    """Multi-layer alpha blending: Salvi and Vaidyanathan, 2014. With a node too many the two furthest are merged."""
    count = len(pixels.depth)
    z = np.full((count, nodes + 1), np.inf)
    light = np.zeros((count, nodes + 1, 3))
    passed = np.ones((count, nodes + 1))
    for i in range(pixels.depth.shape[1]):
        there = pixels.alpha[:, i] > 0.0
        z[:, -1] = np.where(there, pixels.depth[:, i], np.inf)
        light[:, -1] = pixels.colour[:, i] * pixels.alpha[:, i, None]
        passed[:, -1] = 1.0 - pixels.alpha[:, i]
        order = np.argsort(z, axis=1, kind="stable")
        rows = np.arange(count)[:, None]
        z, light, passed = z[rows, order], light[rows, order], passed[rows, order]
        full = np.isfinite(z[:, -1])
        light[full, -2] += passed[full, -2, None] * light[full, -1]
        passed[full, -2] *= passed[full, -1]
        z[:, -1], light[:, -1], passed[:, -1] = np.inf, 0.0, 1.0
    return np.asarray((light * before(1.0 - passed)[:, :-1, None]).sum(1))


def nearest_tail(pixels: Pixels, nearest: int = 5) -> np.ndarray:
    """Hybrid transparency: Maule, Comba, Torchelsen and Bastos, 2013. The nearest in order, with 24 bits of depth and 8 of
    opacity; the others' mean colour behind them."""
    own = pixels.sorted()
    alpha = np.round(255.0 * own.alpha[:, :nearest]) / 255.0
    passed = before(alpha)
    colour = (own.colour[:, :nearest] * (alpha * passed[:, :-1])[..., None]).sum(1)
    rest = own.alpha[:, nearest:]
    opacity = 1.0 - np.prod(1.0 - rest, axis=1)
    mean = (own.colour[:, nearest:] * rest[..., None]).sum(1) / np.maximum(rest.sum(1), 1e-300)[:, None]
    return np.asarray(colour + (passed[:, -1] * opacity)[:, None] * mean)
