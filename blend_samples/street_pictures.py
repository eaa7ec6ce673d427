# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of street.blend, painted: its sky, its paving stones, and a twig with leaves. Row 0 is at the bottom."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def noise(rng: np.random.Generator, height: int, width: int, cells: int, octaves: int) -> Array:
    """Smooth between random numbers, ever finer ones; it closes around its columns. About 0 to 1."""
    total, weight = np.zeros((height, width)), 0.0
    for octave in range(octaves):
        across, down = cells << octave, max((cells << octave) // 2, 2)
        values = rng.random((down + 1, across))
        v, u = np.linspace(0.0, down - 1e-6, height), np.arange(width) * across / width
        j, i = v.astype(int), u.astype(int)
        s, t = ((x - n)[None] ** 2 * (3.0 - 2.0 * (x - n)[None]) for x, n in ((v, j), (u, i)))
        rows = (1.0 - s.T) * values[j] + s.T * values[j + 1]
        total += 0.5**octave * ((1.0 - t) * rows[:, i] + t * rows[:, (i + 1) % across])
        weight += 0.5**octave
    return np.asarray(total / weight)


def sky(sun: Sequence[float], seed: int, width: int = 1024) -> Array:
    """An equirectangular picture (width / 2, width, 3), row 0 at the bottom: a morning's sky with clouds, a sun of one
    degree where `sun` points, and below the horizon the haze of a town."""
    rng = np.random.default_rng(seed)
    height = width // 2
    up = np.pi * ((np.arange(height) + 0.5) / height - 0.5)[:, None]
    around = 2.0 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)[None]
    x, y, z = np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up) + 0.0 * around
    towards = np.clip(x * sun[0] + y * sun[1] + z * sun[2], -1.0, 1.0)
    high = np.clip(z, 0.0, 1.0)[..., None] ** 0.45
    rgb = (1.0 - high) * np.array((0.62, 0.50, 0.40)) + high * np.array((0.07, 0.17, 0.42))
    glow = np.exp(-(np.arccos(towards)[..., None] / np.array((0.55, 0.45, 0.38))))
    rgb = rgb + glow * np.array((0.9, 0.6, 0.33))
    cloud = np.clip((noise(rng, height, width, 6, 6) - 0.50) / 0.16, 0.0, 1.0) * np.clip(z / 0.25, 0.0, 1.0)
    cloud = (0.85 * cloud**1.5)[..., None]
    rgb = (1.0 - cloud) * rgb + cloud * (np.array((0.62, 0.58, 0.57)) + 1.0 * glow)
    roofs = 0.03 + 0.05 * np.repeat(rng.random(width // 16), 16)[None] + 0.0 * z
    town = np.clip((roofs - z) / 0.01, 0.0, 1.0)[..., None]
    rgb = (1.0 - town) * rgb + town * (np.array((0.24, 0.22, 0.23)) + 0.2 * glow)
    ground = np.clip(-z / 0.03, 0.0, 1.0)[..., None]
    rgb = (1.0 - ground) * rgb + ground * np.array((0.14, 0.13, 0.12))
    return np.where((towards > math.cos(math.radians(0.5)))[..., None], np.array((16000.0, 12500.0, 9000.0)), rgb)


def slabs(seed: int) -> tuple[Array, Array]:
    """Paving stones, 256 x 256 x 3: their colour, and their height in [0, 1]."""
    rng = np.random.default_rng(seed)
    size = 256
    v, u = np.mgrid[0:size, 0:size] * 4.0 / size
    row = v.astype(int)
    along = u + 0.5 * (row % 2)
    stone = rng.random((4, 4))[row % 4, along.astype(int) % 4]
    edge = np.minimum(np.minimum(along % 1.0, 1.0 - along % 1.0), np.minimum(v % 1.0, 1.0 - v % 1.0))
    grain = noise(rng, size, size, 32, 3)
    high = np.clip(edge / 0.045, 0.0, 1.0) * (0.9 + 0.1 * grain)
    tone = (0.42 + 0.22 * stone + 0.25 * (grain - 0.5)) * (0.45 + 0.55 * np.clip(edge / 0.035, 0.0, 1.0))
    rgb = np.clip(tone[..., None] * np.array((1.0, 0.96, 0.9)), 0.0, 1.0)
    return rgb, high[..., None] * np.ones(3)


def spray() -> Array:
    """128 x 128 x 4: opaque where a leaf or the twig is."""
    size = 128
    v, u = np.mgrid[0:size, 0:size] / (size / 2.0) - 1.0
    inside, rib = np.zeros((size, size), bool), np.zeros((size, size), bool)
    shade = np.zeros((size, size))
    for number in range(9):
        side = 0.0 if number == 8 else (-1.0) ** number
        y = 0.3 if number == 8 else -0.75 + 0.13 * number
        turn = 0.95 * side
        x0, y0 = 0.42 * math.sin(turn), y + 0.36 * math.cos(turn)
        a = (u - x0) * math.sin(turn) + (v - y0) * math.cos(turn)
        b = (u - x0) * math.cos(turn) - (v - y0) * math.sin(turn)
        leaf = np.abs(b) < 0.17 * np.clip(1.0 - (a / 0.36) ** 2, 0.0, 1.0) * (1.0 - 0.5 * a)
        inside |= leaf
        rib = np.where(leaf, np.abs(b) < 0.015, rib)
        shade = np.where(leaf, 0.8 + 0.4 * ((number * 0.37) % 1.0), shade)
    twig = (np.abs(u) < 0.02) & (v < 0.3)
    green = shade[..., None] * np.array((0.36, 0.52, 0.16))
    green = np.where(rib[..., None], 1.25 * green, green)
    rgb = np.where(inside[..., None], green, np.where(twig[..., None], (0.3, 0.22, 0.14), (0.33, 0.47, 0.16)))
    pixels = np.concatenate((rgb, (inside | twig)[..., None] * 1.0), axis=2)
    return np.clip(pixels, 0.0, 1.0)
