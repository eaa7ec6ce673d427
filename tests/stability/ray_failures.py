# SPDX-License-Identifier: GPL-3.0-or-later
"""How far single light rays are off where ways to store them are known to fail. Methods are those of
`tests/bench/bench_light_maps.py`, METHODS; rays are seeded, or of the sample's plume."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sfumato
from bench_light_maps import Method, rmse
from light_rays import FRAMES, RECEIVERS, ROOT, Rays, flat, seeded, without_outlier

Array = np.ndarray


def outlier_ratio(method: Method) -> float:
    """By how much the error grows when one particle of 48 stands far before the others."""
    rays = seeded("outlier")
    return rmse(method, rays) / rmse(method, without_outlier(rays))


# ---- Depth bounds: figure 5 of Jansen and Bavoil (2010) ----


def plume(fine: int = 1) -> Array:
    """(z, y, x): optical depths of the cells of the sample's plume at frame 25, each cut into `fine`³."""
    file, extinction = FRAMES["plume"]
    density, to_object = sfumato.read_volume(str(ROOT / "blend_samples" / file))
    tau = np.asarray(density, float) * extinction * float(to_object[0, 0])
    for axis in range(3) if fine > 1 else ():
        at = (np.arange(fine * tau.shape[axis]) + 0.5) / fine - 0.5
        low = np.clip(np.floor(at).astype(int), 0, tau.shape[axis] - 2)
        shape = [1, 1, 1]
        shape[axis] = -1
        share = np.clip(at - low, 0.0, 1.0).reshape(shape)
        tau = np.take(tau, low, axis) * (1.0 - share) + np.take(tau, low + 1, axis) * share
    return np.asarray(tau / fine)


def rays_along_x(tau: Array, deeper: float) -> tuple[Rays, Array]:
    """The light rays of a sun along x, each cell one absorber, with receivers in the middles of the cells; and which of
    the rays (z, y) meet smoke. `deeper`: the depth of the map, in units of the smoke's own."""
    met = tau.sum(2) > 1e-3
    count = tau.shape[2]
    depth = np.broadcast_to((np.arange(count) + 0.5) / count / deeper, (int(met.sum()), count))
    own = tau[met]
    exact = np.exp(0.5 * own - np.cumsum(own, 1))
    return Rays(np.ascontiguousarray(depth), own, np.ascontiguousarray(depth), exact, 1.0 / count / deeper), met


def plume_picture(method: Method | None, deeper: float = 1.0, fine: int = 1) -> Array:
    """(z, x): white smoke before black, lit along x, seen along y, row 0 at the bottom. Without a method, exact."""
    tau = plume(fine)
    rays, met = rays_along_x(tau, deeper)
    light = np.ones_like(tau)
    light[met] = rays.exact if method is None else method(rays)
    before = np.exp(tau - np.cumsum(tau, 1))
    return np.asarray((light * before * -np.expm1(-tau)).sum(1))


def change_with_bounds(method: Method) -> float:
    """Root mean square by which the plume's picture changes when the map is 10 % deeper, by its mean, where there is
    smoke."""
    here, deeper = plume_picture(method), plume_picture(method, 1.1)
    smoke = plume_picture(None) > 0.0
    return float(np.sqrt(np.mean((deeper - here)[smoke] ** 2)) / here[smoke].mean())


# ---- Ringing: figure 8 ----

SLABS = 100
SHEETS = 20 + 37 * np.arange(24) % 61  # the slab that the sheet of each ray fills: 20, 57, 33 and on
HAZE, OPAQUE = 0.1, 0.999
ACROSS = (np.arange(1000) + 0.5) / 1000


def sheets_in_haze() -> Rays:
    """A hundredth of each ray takes all but a thousandth of its light, and haze over the whole of it a tenth."""
    tau = np.full((len(SHEETS), SLABS), HAZE / SLABS)
    tau[np.arange(len(SHEETS)), SHEETS] -= np.log1p(-OPAQUE)
    edges = np.arange(SLABS + 1) / SLABS
    before = [np.interp(ACROSS, edges, np.append(0.0, np.cumsum(row))) for row in tau]
    depth, receivers = (np.tile(a, (len(tau), 1)) for a in ((np.arange(SLABS) + 0.5) / SLABS, ACROSS))
    return Rays(depth, tau, receivers, np.exp(-np.array(before)), 1.0 / SLABS)


def light_by_sheets(basis: str, coefficients: int, evaluator: str = "clamp") -> Array:
    """(rays, 1000): by a series over the whole depth, as in the paper."""
    rays = sheets_in_haze()
    span = np.tile(np.array([0.0, 1.0], np.float32), (len(rays.depth), 1))
    c = sfumato.project(rays.depth, rays.optical_depth, coefficients, rays.width, basis, span)
    return np.asarray(sfumato.transmittance(c, rays.receivers, basis, span, evaluator))


def off_beside_sheets(light: Array) -> float:
    """The largest error at receivers at least a twentieth of the depth from the sheet of their ray."""
    away = np.abs(ACROSS - (SHEETS[:, None] + 0.5) / SLABS) > 0.05
    return float(np.abs(light - sheets_in_haze().exact)[away].max())


def rise(light: Array) -> float:
    """By how much light grows again behind what has taken it, at most, along the last axis."""
    return float((light - np.minimum.accumulate(light, -1)).max())


# ---- Sums of many thin layers ----


def many_layers(count: int = 20000, alpha: float = 2e-4, rays: int = 4) -> Rays:
    depth = np.random.default_rng(31).uniform(0.2, 0.8, (rays, count))
    return flat(depth, np.full(depth.shape, alpha), RECEIVERS)


def summed_in_halves(rays: Rays, harmonics: int = 3) -> Array:
    """The paper's series as it is blended into RGBA16F, one fragment after the other."""
    k = np.arange(1, harmonics + 1)
    angle = 2.0 * np.pi * k * rays.depth[..., None]
    parts = (
        2.0
        * rays.optical_depth[..., None]
        * np.concatenate([np.ones((*rays.depth.shape, 1)), np.cos(angle), np.sin(angle)], -1)
    )
    c = np.add.accumulate(parts.astype(np.float16), axis=1, dtype=np.float16)[:, -1].astype(float)[:, None]
    d = rays.receivers[..., None]
    waves = c[..., 1 : 1 + harmonics] * np.sin(2 * np.pi * k * d) + c[..., 1 + harmonics :] * (
        1 - np.cos(2 * np.pi * k * d)
    )
    tau = 0.5 * c[..., 0] * rays.receivers + (waves / (2 * np.pi * k)).sum(-1)
    return np.asarray(np.exp(-np.maximum(tau, 0.0)))


def total_off(method: Callable[[Rays], Array], rays: Rays) -> float:
    """The error of what is left behind all layers."""
    behind = Rays(rays.depth, rays.optical_depth, np.ones((len(rays.depth), 1)), rays.exact[:, -1:], rays.width)
    return float(np.abs(method(behind) - behind.exact).max())
