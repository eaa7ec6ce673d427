# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent fragments of pixels: seeded draws, and four scenes at 1600 x 900 with the depth complexity that they have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

SIZE = (1600, 900)  # Song's pictures (2021)


@dataclass(frozen=True)
class Pixels:
    """Fragments of as many pixels, in the order of their submission: depth (n, f) in [0, 1], alpha (n, f) and colour
    (n, f, 3). Where alpha is 0 there is none."""

    depth: np.ndarray
    alpha: np.ndarray
    colour: np.ndarray

    def sorted(self) -> Pixels:
        """Nearest first, and what is no fragment last."""
        order = np.argsort(np.where(self.alpha > 0.0, self.depth, np.inf), axis=1, kind="stable")
        return self.taken(order)

    def every(self, step: int) -> Pixels:
        """One pixel out of `step`."""
        return Pixels(self.depth[::step], self.alpha[::step], self.colour[::step])

    def taken(self, order: np.ndarray) -> Pixels:
        """With the fragments of each pixel in another order (n, f)."""
        rows = np.arange(len(order))[:, None]
        return Pixels(self.depth[rows, order], self.alpha[rows, order], self.colour[rows, order])


@dataclass(frozen=True)
class Scene:
    """Fragments of a picture, one after another: pixel (m,), depth, alpha (m,) and colour (m, 3). Of the picture, every
    `stride`-th pixel of every `stride`-th row."""

    pixel: np.ndarray
    depth: np.ndarray
    alpha: np.ndarray
    colour: np.ndarray
    stride: int = 1

    def covered(self, groups: list[Pixels]) -> float:
        """The share of the picture's pixels that any fragment covers."""
        everywhere = (SIZE[0] // self.stride) * (SIZE[1] // self.stride)
        return sum(len(group.depth) for group in groups) / everywhere

    def pixels(self, values: int = 4_000_000) -> Iterator[Pixels]:
        """Pixels that any fragment covers, those of like count together, at most `values` fragments at a time."""
        order = np.argsort(self.pixel, kind="stable")
        _, first, counts = np.unique(self.pixel[order], return_index=True, return_counts=True)
        by_count = np.argsort(counts, kind="stable")
        start = 0
        while start < len(by_count):
            least = int(counts[by_count[start]])
            end = min(len(by_count), start + max(1, values // max(least, 1)))
            end = max(start + 1, int(np.searchsorted(counts[by_count[:end]], 1.25 * least + 1.0, side="right")))
            some = by_count[start:end]
            most = int(counts[some].max())
            place = np.arange(most)
            there = place < counts[some][:, None]
            index = order[np.minimum(first[some][:, None] + place, len(order) - 1)]
            yield Pixels(self.depth[index], np.where(there, self.alpha[index], 0.0), self.colour[index])
            start = end


def grey(depth: np.ndarray, alpha: np.ndarray, colour: np.ndarray) -> Pixels:
    return Pixels(depth, alpha, np.repeat(colour[..., None], 3, axis=-1))


def random_fragments(count: int, pixels: int = 2000) -> Pixels:
    random = np.random.default_rng(count)
    depth, alpha = 0.05 + 0.9 * random.random((pixels, count)), 0.1 + 0.5 * random.random((pixels, count))
    return grey(depth, alpha, random.random((pixels, count)))


def cluster(count: int, low: float, high: float, pixels: int = 1500) -> Pixels:
    """Around one depth, brighter behind, as what light shines into is."""
    random = np.random.default_rng(5)
    centre, width = 0.3 + 0.4 * random.random((pixels, 1)), 0.06 + 0.08 * random.random((pixels, 1))
    depth = np.clip(centre + width * random.standard_normal((pixels, count)), 0.001, 0.999)
    alpha = low + (high - low) * random.random((pixels, count))
    return grey(depth, alpha, 0.5 + 0.5 * depth + 0.3 * (random.random((pixels, count)) - 0.5))


def draws() -> dict[str, Pixels]:
    out = {f"fragments-{count}": random_fragments(count) for count in (2, 8, 32)}
    return out | {"smoke-64": cluster(64, 0.03, 0.07), "hair-40": cluster(40, 0.4, 0.8)}


# ---- Scenes: a camera at the origin looks along -z, and its picture is 2 x 1.125 at distance 2 ----


def rays(stride: int) -> tuple[np.ndarray, np.ndarray]:
    """Pixel numbers, and directions (n, 3) whose component along the view is 1."""
    width, height = SIZE
    x, y = np.meshgrid(np.arange(0, width, stride), np.arange(0, height, stride))
    pixel = (y * width + x).ravel()
    across = (np.stack((x.ravel(), y.ravel()), axis=1) + 0.5 - 0.5 * np.array(SIZE)) / width
    return pixel, np.concatenate((across, -np.ones((len(pixel), 1))), axis=1)


def shuffled(scene: Scene) -> Scene:
    """Depths stretched to [0, 1], and another order than that in which they were made."""
    order = np.random.default_rng(9).permutation(len(scene.pixel))
    low, high = scene.depth.min(), scene.depth.max()
    depth = ((scene.depth - low) / (high - low))[order]
    return Scene(scene.pixel[order], depth, scene.alpha[order], scene.colour[order], scene.stride)


def joined(parts: Sequence[tuple[np.ndarray, ...]], stride: int) -> Scene:
    pixel, depth, alpha, colour = (np.concatenate(values) for values in zip(*parts))
    return shuffled(Scene(pixel, depth, alpha, colour, stride))


SUN = np.array((0.48, 0.6, 0.64))


def sheets() -> Scene:
    """Ten intersecting rectangles of glass."""
    random, stride = np.random.default_rng(21), 2
    pixel, ray = rays(stride)
    parts = []
    for _ in range(10):
        axes = np.linalg.qr(random.standard_normal((3, 3)))[0]
        centre = np.array((*random.uniform(-0.7, 0.7, 2), -2.6)) + (0, 0, random.uniform(-0.5, 0.5))
        size = random.uniform(0.5, 1.0, 2)
        distance = (centre @ axes[2]) / (ray @ axes[2])
        place = ray * distance[:, None] - centre
        hit = (np.abs(place @ axes[:2].T) <= size).all(axis=1) & (distance > 0.2)
        tint, alpha = random.uniform(0.1, 1.0, 3), random.uniform(0.2, 0.7)
        colour = tint * (0.3 + 0.7 * abs(axes[2] @ SUN))
        count = int(hit.sum())
        parts.append((pixel[hit], distance[hit], np.full(count, alpha), np.tile(colour, (count, 1))))
    return joined(parts, stride)


def particles() -> Scene:
    """A plume of 16,384 soft sprites, darker away from the light."""
    random, stride = np.random.default_rng(22), 4
    width, height = (side // stride for side in SIZE)
    up = random.random(16384)
    swirl = 0.08 * np.stack((np.sin(7.0 * up), np.zeros_like(up), np.cos(9.0 * up)), axis=1)
    spread = (0.05 + 0.22 * up)[:, None] * np.clip(random.standard_normal((len(up), 3)), -2.5, 2.5) * 0.5
    centre = np.stack((0.0 * up, up - 0.5, -2.4 + 0.0 * up), axis=1) + swirl + spread
    radius = 0.015 + 0.03 * up
    light = np.exp(-1.5 * np.maximum(0.6 - (spread @ SUN) / (0.1 + 0.22 * up), 0.0)) * (
        0.8 + 0.4 * random.random(len(up))
    )
    colour = light[:, None] * np.array((1.0, 0.94, 0.86))
    alpha = random.uniform(0.04, 0.12, len(up))
    focal = SIZE[0] / stride  # pixels at a distance of one
    parts = []
    for c, r, shade, a in zip(centre, radius, colour, alpha):
        middle = focal * c[:2] / -c[2] + 0.5 * np.array((width, height))
        reach = focal * r / -c[2]
        low = np.maximum(np.floor(middle - reach).astype(int), 0)
        high = np.minimum(np.ceil(middle + reach).astype(int) + 1, (width, height))
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        inside = 1.0 - ((x + 0.5 - middle[0]) ** 2 + (y + 0.5 - middle[1]) ** 2) / reach**2
        hit = inside > 0.0
        here = -np.expm1(np.log1p(-a) * inside[hit] ** 1.5)
        kept = here > 1e-4
        pixel = (y[hit] * width + x[hit])[kept]
        parts.append((pixel, np.full(len(pixel), -c[2]), here[kept], np.tile(shade, (len(pixel), 1))))
    return joined(parts, stride)


def hair() -> Scene:
    """A ball of 20,000 curling strands, a pixel wide, lit from above."""
    random = np.random.default_rng(23)
    root = random.standard_normal((20000, 3))
    root /= np.linalg.norm(root, axis=1, keepdims=True)
    along = np.linspace(0.0, 1.0, 400)[None, :, None]
    lean = 0.25 * random.standard_normal(root.shape)
    curl = 0.05 * random.standard_normal(root.shape)
    path = root[:, None] * (0.3 + 0.25 * along) + lean[:, None] * 0.4 * along**2 - np.array((0, 0.18, 0)) * along**2
    path = path + curl[:, None] * np.sin(14.0 * along + 6.0 * random.random((len(root), 1, 1)))
    path = path + np.array((0.0, 0.05, -2.2))
    step = np.diff(path, axis=1, append=2.0 * path[:, -1:] - path[:, -2:-1])
    turned = (step @ SUN) / np.linalg.norm(step, axis=2)
    shade = (0.15 + 0.85 * np.sqrt(1.0 - turned**2)) * np.exp(
        -2.0 * (0.6 - np.linalg.norm(path - path.mean((0, 1)), axis=2))
    )
    x, y = (np.floor(SIZE[0] * path[..., i] / -path[..., 2] + 0.5 * SIZE[i]).astype(int) for i in (0, 1))
    pixel = y * SIZE[0] + x
    first = np.ones(pixel.shape, bool)
    first[:, 1:] = pixel[:, 1:] != pixel[:, :-1]  # a strand covers a pixel once
    first &= (x >= 0) & (x < SIZE[0]) & (y >= 0) & (y < SIZE[1])
    tint = np.array((0.5, 0.32, 0.2)) * random.uniform(0.7, 1.3, (len(root), 1))
    alpha = np.broadcast_to(random.uniform(0.3, 0.7, (len(root), 1)), pixel.shape)
    colour = (shade[..., None] * tint[:, None])[first]
    return shuffled(Scene(pixel[first], -path[..., 2][first], alpha[first], colour))


def model() -> Scene:
    """Nested shells of three bodies, which show more at their rims: a machine under glass."""
    random, stride = np.random.default_rng(24), 3
    pixel, ray = rays(stride)
    parts = []
    for body in range(3):
        place = np.array((0.42 * (body - 1), 0.08 * (-1) ** body, -2.4 + 0.15 * body))
        for shell in range(9):
            radii = (0.42 - 0.04 * shell) * random.uniform(0.8, 1.15, 3)
            turn = np.linalg.qr(random.standard_normal((3, 3)))[0]
            centre = place + 0.03 * random.standard_normal(3)
            d, o = ray @ turn / radii, -(centre @ turn) / radii
            a, b, c = (d * d).sum(1), d @ o, o @ o - 1.0
            inside = b * b - a * c
            hit = inside > 0.0
            tint, least = random.uniform(0.1, 1.0, 3), random.uniform(0.05, 0.25)
            for side in (-1.0, 1.0):
                distance = (-b[hit] + side * np.sqrt(inside[hit])) / a[hit]
                normal = (d[hit] * distance[:, None] + o) / radii @ turn.T
                normal /= np.linalg.norm(normal, axis=1, keepdims=True)
                facing = np.abs((normal * ray[hit]).sum(1)) / np.linalg.norm(ray[hit], axis=1)
                alpha = least + (0.9 - least) * (1.0 - facing) ** 3
                parts.append((pixel[hit], distance, alpha, tint * (0.25 + 0.75 * np.abs(normal @ SUN))[:, None]))
    return joined(parts, stride)


SCENES = {"sheets": sheets, "particles": particles, "hair": hair, "model": model}
