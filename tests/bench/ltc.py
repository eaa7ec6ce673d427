# SPDX-License-Identifier: GPL-3.0-or-later
"""Rivals of the closed forms of rough reflection: linearly transformed cosines, Karis's representative point, and Monte
Carlo. Rectangles (n, 4, 3) of radiance 1 in the surface's frame, views (n, 3), alphas (n, 2): radiance (n,), F = 1."""

from __future__ import annotations

from pathlib import Path

import numpy as np

Array = np.ndarray
TABLE = Path(__file__).parents[1] / "goldens" / "ltc_ggx.npz"
TABLE_BYTES = 2 * 64 * 64 * 8  # two RGBA16F textures, as shipped


def unit(v: Array) -> Array:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def upper_edges(polygons: Array) -> Array:
    """The edges of what is above the horizon: (n, corners + 1, 2, 3). Those that do not exist have no length."""
    count, corners, _ = polygons.shape
    edges = np.tile(np.array([0.0, 0.0, 1.0]), (count, corners + 1, 2, 1))
    leave, enter = np.zeros((count, 3)), np.zeros((count, 3))
    for k in range(corners):
        a, b = polygons[:, k], polygons[:, (k + 1) % corners]
        za, zb = a[:, 2], b[:, 2]
        cut = (za < 0) != (zb < 0)
        t = np.where(cut, za / np.where(cut, za - zb, 1), 0)[:, None]
        crossing = a + t * (b - a)
        crossing[:, 2] = 0
        seen = ~((za < 0) & (zb < 0))
        edges[seen, k, 0] = np.where((za < 0)[:, None], crossing, a)[seen]
        edges[seen, k, 1] = np.where((zb < 0)[:, None], crossing, b)[seen]
        leave[cut & (zb < 0)] = crossing[cut & (zb < 0)]
        enter[cut & (za < 0)] = crossing[cut & (za < 0)]
    closed = (np.linalg.norm(leave, axis=-1) > 0) & (np.linalg.norm(enter, axis=-1) > 0)
    edges[closed, corners, 0], edges[closed, corners, 1] = leave[closed], enter[closed]
    return edges


def lambert(polygons: Array) -> Array:
    """Irradiance / pi, by exact angles (Lambert 1760)."""
    edges = unit(upper_edges(polygons))
    across = np.cross(edges[:, :, 0], edges[:, :, 1])
    sine = np.linalg.norm(across, axis=-1)
    angle = np.arctan2(sine, np.sum(edges[:, :, 0] * edges[:, :, 1], -1))
    return np.abs(np.sum(angle / np.maximum(sine, 1e-12) * across[..., 2], 1)) / (2 * np.pi)


def looked_up(alpha: Array, cosine: Array) -> Array:
    table = np.load(TABLE)["table"].astype(float)
    size = len(table)
    x, y = np.sqrt(alpha) * (size - 1), np.sqrt(np.maximum(1 - cosine, 0)) * (size - 1)
    i, j = np.clip(x.astype(int), 0, size - 2), np.clip(y.astype(int), 0, size - 2)
    u, v = (x - i)[:, None], (y - j)[:, None]
    low = table[i, j] * (1 - v) + table[i, j + 1] * v
    high = table[i + 1, j] * (1 - v) + table[i + 1, j + 1] * v
    return np.asarray(low * (1 - u) + high * u)


def ltc(rectangles: Array, views: Array, alphas: Array) -> Array:
    """Heitz et al. (2016), with a table of our own fit. Anisotropic surfaces by the geometric mean of both alphas: the
    published table has no more."""
    alpha = np.sqrt(alphas[:, 0] * alphas[:, 1])
    entries = looked_up(alpha, views[:, 2])
    x = unit(views * [1, 1, 0] + [1e-12, 0, 0])
    y = np.cross([0.0, 0.0, 1.0], x)
    # What is below the surface's own horizon goes first: the transformed one is another.
    local = np.stack([np.sum(rectangles * x[:, None], -1), np.sum(rectangles * y[:, None], -1), rectangles[..., 2]], -1)
    inverse = np.zeros((len(alpha), 3, 3))
    inverse[:, 0, 0], inverse[:, 0, 2], inverse[:, 2, 0], inverse[:, 2, 2] = entries[:, :4].T
    inverse[:, 1, 1] = 1
    return np.asarray(entries[:, 4] * lambert(np.einsum("nij,nkj->nki", inverse, local)))


def ggx(alphas: Array, views: Array, i: Array) -> Array:
    """BRDF times n.i for directions (n, k, 3)."""
    h = unit(i + views[:, None])
    x, y = alphas[:, 0, None], alphas[:, 1, None]
    density = 1 / (np.pi * x * y * ((h[..., 0] / x) ** 2 + (h[..., 1] / y) ** 2 + h[..., 2] ** 2) ** 2)

    def reach(d: Array) -> Array:
        return np.sqrt((x * d[..., 0]) ** 2 + (y * d[..., 1]) ** 2 + d[..., 2] ** 2)

    z, cosine = np.maximum(i[..., 2], 0), views[:, 2, None]
    masked = 2 * z / np.maximum(reach(views[:, None]) * z + reach(i) * cosine, 1e-30)
    return density * masked / 4


def solid_angle(rectangles: Array) -> Array:
    a, b, c, d = np.moveaxis(unit(rectangles), 1, 0)

    def triangle(p: Array, q: Array, r: Array) -> Array:
        top = np.abs(np.sum(p * np.cross(q, r), -1))
        return 2 * np.arctan2(top, 1 + np.sum(p * q, -1) + np.sum(q * r, -1) + np.sum(r * p, -1))

    return np.asarray(triangle(a, b, c) + triangle(a, c, d))


def representative_point(rectangles: Array, views: Array, alphas: Array) -> Array:
    """Karis, "Real Shading in Unreal Engine 4", 2013, for rectangles: the BRDF at the light's point nearest to the
    mirrored view, its lobe scaled down by what the light widens it; irradiance from the light's solid angle."""
    mirror = views * [-1, -1, 1]
    origin, u, v = rectangles[:, 0], rectangles[:, 1] - rectangles[:, 0], rectangles[:, 3] - rectangles[:, 0]
    normal = unit(np.cross(u, v))
    along = np.sum(normal * mirror, -1)
    height = np.sum(normal * origin, -1)
    t = height / np.where(np.abs(along) < 1e-6, 1e-6, along)
    hit = np.where((t > 0)[:, None], mirror * t[:, None], mirror * 1e3)
    s = np.clip(np.sum((hit - origin) * u, -1) / np.sum(u * u, -1), 0, 1)[:, None]
    r = np.clip(np.sum((hit - origin) * v, -1) / np.sum(v * v, -1), 0, 1)[:, None]
    point = origin + s * u + r * v
    distance = np.linalg.norm(point, axis=-1)
    omega = solid_angle(rectangles)
    wide = np.sqrt(omega / np.pi) / 2
    alpha = np.sqrt(alphas[:, 0] * alphas[:, 1])
    wider = np.clip(alpha + wide, 0, 1)
    value = ggx(alphas, views, (point / distance[:, None])[:, None])[:, 0]
    return np.asarray(value * (alpha / wider) ** 2 * omega)


def monte_carlo(samples: int, rectangles: Array, views: Array, alphas: Array) -> Array:
    """Points spread evenly over the rectangle, at random in the cells of a grid."""
    random = np.random.default_rng(1)
    side = int(np.sqrt(samples))
    cell = (np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2) + 0.0) / side
    at = cell[None] + random.random((len(rectangles), side * side, 2)) / side
    u, v = rectangles[:, 1] - rectangles[:, 0], rectangles[:, 3] - rectangles[:, 0]
    points = rectangles[:, None, 0] + at[..., :1] * u[:, None] + at[..., 1:] * v[:, None]
    distance = np.linalg.norm(points, axis=-1)
    area = np.abs(np.sum(points * np.cross(u, v)[:, None], -1)) / distance**3
    return np.asarray((ggx(alphas, views, points / distance[..., None]) * area).mean(1))
