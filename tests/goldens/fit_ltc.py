#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits tests/goldens/ltc_ggx.npz: linearly transformed cosines (Heitz, Dupuy, Hill and Neubelt, "Real-Time
Polygonal-Light Shading with Linearly Transformed Cosines", 2016) for isotropic GGX with height-correlated Smith masking
and F = 1, on 64 x 64 cells of (roughness, sqrt(1 - cos theta)).

As in the paper: the lobe's frame is that of its mean direction, three entries are fitted to the least third power of the
difference, sampled by both lobes. A row of cells at once, by a batch of Nelder and Mead's simplexes. Some minutes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

SIZE = 64
SAMPLES = 16  # squared, of each lobe
STEPS = 80
OUT = Path(__file__).with_name("ltc_ggx.npz")

Array = np.ndarray


def unit(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def cells() -> tuple[Array, Array]:
    """alpha and cos theta, each (SIZE * SIZE, 1); rows are roughness."""
    rough, tilt = np.meshgrid(np.linspace(0, 1, SIZE), np.linspace(0, 1, SIZE), indexing="ij")
    return np.maximum(rough.ravel() ** 2, 1e-3)[:, None], np.maximum(1 - tilt.ravel() ** 2, 1e-3)[:, None]


def brdf(alpha: Array, view: Array, i: Array) -> tuple[Array, Array]:
    """BRDF times cosine, and the density of the directions that sample_brdf makes."""
    h = unit(i + view[:, None])
    hz = np.maximum(h[..., 2], 1e-9)
    slope2 = (1 - hz**2) / hz**2 / alpha**2
    density = 1 / (np.pi * alpha**2 * hz**4 * (1 + slope2) ** 2)

    def shadow(z: Array) -> Array:
        z = np.clip(z, 1e-6, 1)
        return 0.5 * (np.sqrt(1 + alpha**2 * (1 - z**2) / z**2) - 1)

    cos_view = view[:, None, 2]
    masked = 1 / (1 + shadow(cos_view) + shadow(i[..., 2]))
    along = np.maximum(np.sum(h * view[:, None], -1), 1e-9)
    return np.where(i[..., 2] > 0, density * masked / (4 * cos_view), 0), density * hz / (4 * along)


def square() -> tuple[Array, Array]:
    u = (np.arange(SAMPLES) + 0.5) / SAMPLES
    a, b = np.meshgrid(u, u)
    return a.ravel(), b.ravel()


def sample_brdf(alpha: Array, view: Array) -> Array:
    a, b = square()
    r = alpha * np.sqrt(a / (1 - a))
    h = unit(np.stack([r * np.cos(2 * np.pi * b), r * np.sin(2 * np.pi * b), np.ones_like(r)], -1))
    return 2 * np.sum(h * view[:, None], -1)[..., None] * h - view[:, None]


def matrices(p: Array, frame: Array) -> Array:
    m = np.zeros((len(p), 3, 3))
    m[:, 0, 0], m[:, 1, 1], m[:, 0, 2], m[:, 2, 2] = p[:, 0], p[:, 1], p[:, 2], 1
    return frame @ m


def ltc(m: Array, i: Array) -> Array:
    w = np.einsum("nij,nkj->nki", np.linalg.inv(m), i)
    length = np.linalg.norm(w, axis=-1)
    return np.maximum(w[..., 2], 0) / np.pi / (length**4 * np.abs(np.linalg.det(m))[:, None])


def sample_ltc(m: Array) -> Array:
    a, b = square()
    r = np.sqrt(a)
    w = np.stack([r * np.cos(2 * np.pi * b), r * np.sin(2 * np.pi * b), np.sqrt(1 - a)], -1)
    return unit(np.einsum("nij,kj->nki", m, w))


def fit(alpha: Array, cosine: Array) -> Array:
    """(cells, 5): four entries of the inverse matrix, whose middle one is 1, and the directional albedo."""
    view = np.concatenate([np.sqrt(1 - cosine**2), np.zeros_like(cosine), cosine], -1)
    i = sample_brdf(alpha, view)
    value, density = brdf(alpha, view, i)
    weight = value / density
    albedo = weight.mean(1)
    z = np.einsum("nk,nki->ni", weight, i)
    z[:, 1] = 0
    z = unit(z)
    x = np.stack([z[:, 2], np.zeros(len(z)), -z[:, 0]], -1)
    frame = np.stack([x, np.tile([0.0, 1.0, 0.0], (len(z), 1)), z], -1)
    brdf_samples = (i, value / albedo[:, None], density)

    def error(p: Array) -> Array:
        m = matrices(p, frame)
        total = np.zeros(len(p))
        mine = sample_ltc(m)
        other, other_density = brdf(alpha, view, mine)
        for directions, wanted, by_brdf in (brdf_samples, (mine, other / albedo[:, None], other_density)):
            fitted = ltc(m, directions)
            total += (np.abs(wanted - fitted) ** 3 / np.maximum(fitted + by_brdf, 1e-12)).mean(1)
        bad = (p[:, 0] < 1e-4) | (p[:, 1] < 1e-4) | ~np.isfinite(total)
        return np.where(bad, 1e30, total)

    # The slopes of a clamped cosine have the median 0.577.
    local = np.einsum("nij,nki->nkj", frame, i)
    up = np.maximum(local[..., 2:], 1e-3)
    width = np.median(np.abs(local[..., :2] / up), axis=1) / 0.577
    start = np.concatenate([np.maximum(width, 1e-3), np.zeros((len(z), 1))], -1)
    steps = np.eye(3)[None] * np.stack([0.2 * start[:, 0], 0.2 * start[:, 1], np.full(len(z), 0.05)], -1)[:, None]
    simplex = np.concatenate([start[:, None], start[:, None] + steps], 1)
    f = np.stack([error(simplex[:, k]) for k in range(4)], 1)
    rows = np.arange(len(z))
    for _ in range(STEPS):
        order = np.argsort(f, 1)
        simplex, f = simplex[rows[:, None], order], f[rows[:, None], order]
        middle, worst = simplex[:, :3].mean(1), simplex[:, 3]
        tried = 2 * middle - worst
        ft = error(tried)
        better, poor = ft < f[:, 0], ft >= f[:, 2]
        t = np.where(better, 2.0, np.where(ft < f[:, 3], 0.5, -0.5))[:, None]
        again = middle + t * (middle - worst)
        fa = error(again)
        use = (better & (fa < ft)) | (poor & (fa < np.minimum(ft, f[:, 3])))
        point, value_at = np.where(use[:, None], again, tried), np.where(use, fa, ft)
        shrink = poor & ~use
        simplex[:, 3] = np.where(shrink[:, None], worst, point)
        f[:, 3] = np.where(shrink, f[:, 3], value_at)
        if shrink.any():
            for k in range(1, 4):
                simplex[:, k] = np.where(shrink[:, None], 0.5 * (simplex[:, k] + simplex[:, 0]), simplex[:, k])
                f[:, k] = np.where(shrink, error(simplex[:, k]), f[:, k])
    best = simplex[rows, np.argmin(f, 1)]
    inverse = np.linalg.inv(matrices(best, frame))
    inverse /= inverse[:, 1:2, 1:2]
    entries = np.stack([inverse[:, 0, 0], inverse[:, 0, 2], inverse[:, 2, 0], inverse[:, 2, 2]], -1)
    return np.concatenate([entries, albedo[:, None]], -1)


def main() -> None:
    alpha, cosine = cells()
    rows = [slice(k, k + SIZE) for k in range(0, SIZE * SIZE, SIZE)]
    table = np.stack([fit(alpha[row], cosine[row]) for row in rows])
    np.savez_compressed(OUT, table=table.astype(np.float16))


if __name__ == "__main__":
    main()
