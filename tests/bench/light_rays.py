# SPDX-License-Identifier: GPL-3.0-or-later
"""Light rays to measure with: seeded profiles, and those of real frames. All draws are from named seeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sfumato

ROOT = Path(__file__).resolve().parents[2]
RECEIVERS = (np.arange(65) + 0.37) / 65
SEEDED = ("smoke", "sheets", "layer", "layers", "hair", "outlier", "dense")
# Real frames: the file, and the extinction per metre and unit density. The plume's is its material's; the others are as
# dense as makes their thickest rays some ten optical depths, and the wisp thin.
FRAMES = {
    "plume": ("plume_cache/data/fluid_data_0025.vdb", 12.0),
    "fire": ("frames/fire.vdb", 12.0),
    "collision": ("frames/collision.vdb", 12.0),
    "wisp": ("frames/wisp.vdb", 6.0),
}


@dataclass(frozen=True)
class Rays:
    """Absorbers (rays, n), and receivers (rays, d) with the exact share of light that reaches them. `texel` says which
    of the side x side texels of its map each ray is, where there is a map; those without smoke are left out."""

    depth: np.ndarray
    optical_depth: np.ndarray
    receivers: np.ndarray
    exact: np.ndarray
    width: float = 0.0
    texel: np.ndarray | None = None
    side: int = 0

    def in_single_precision(self) -> Rays:
        """What the module takes without converting it, for timing."""
        depth, optical_depth, receivers, exact = (
            np.ascontiguousarray(a, np.float32) for a in (self.depth, self.optical_depth, self.receivers, self.exact)
        )
        return Rays(depth, optical_depth, receivers, exact, self.width)

    def on_map(self) -> tuple[np.ndarray, np.ndarray]:
        """Depth and optical depth (side, side, n), with nothing where there is no smoke."""
        out = np.zeros((2, self.side * self.side, self.depth.shape[1]))
        out[:, self.texel] = self.depth, self.optical_depth
        depth, tau = out.reshape(2, self.side, self.side, -1)
        return depth, tau

    def every(self, stride: int) -> Rays:
        some = slice(None, None, stride)
        return Rays(self.depth[some], self.optical_depth[some], self.receivers[some], self.exact[some], self.width)


def flat(depth: np.ndarray, alpha: np.ndarray, receivers: np.ndarray) -> Rays:
    """Particles without extent, judged by the reference."""
    receivers = np.broadcast_to(receivers, (len(depth), np.shape(receivers)[-1]))
    exact = [sfumato.reference.transmittance(z, a, d) for z, a, d in zip(depth, alpha, receivers)]
    return Rays(depth, -np.log1p(-alpha), np.ascontiguousarray(receivers), np.array(exact))


def one_profile(case: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Depth and alpha of the particles of one ray."""

    def u(low: float, high: float, n: int | None = None) -> np.ndarray:
        return low + (high - low) * np.asarray(rng.random(n))

    def g(n: int) -> np.ndarray:
        return rng.standard_normal(n)

    match case:
        case "smoke":
            return u(0.3, 0.7) + u(0.06, 0.14) * g(64), u(0.03, 0.07, 64)
        case "dense":
            return u(0.3, 0.7) + 0.04 * g(80), u(0.06, 0.12, 80)
        case "sheets":
            return np.concatenate([u(0.1, 0.9) + u(0.015, 0.065) * g(24) for _ in range(3)]), u(0.02, 0.07, 72)
        case "layer":
            return u(0.15, 0.85, 1), np.array([0.9])
        case "layers":
            return u(0.1, 0.9, 2), u(0.3, 0.7, 2)
        case "hair":
            return u(0.35, 0.55) + u(0.0, 0.12, 40), u(0.05, 0.15, 40)
        case "outlier":
            return np.append(0.75 + 0.02 * g(48), 0.03), np.full(49, 0.05)
    raise ValueError(f"case is {case!r}, but must be one of {', '.join(SEEDED)}")


def seeded(case: str, count: int = 150) -> Rays:
    rng = np.random.default_rng(SEEDED.index(case))
    profiles = [one_profile(case, rng) for _ in range(count)]
    order = [rng.permutation(len(z)) for z, _ in profiles]
    depth = np.array([np.clip(z, 0.001, 0.999)[o] for (z, _), o in zip(profiles, order)])
    return flat(depth, np.array([a[o] for (_, a), o in zip(profiles, order)]), RECEIVERS)


def without_outlier(rays: Rays) -> Rays:
    """The case `outlier` less its one particle at .03."""
    keep = rays.depth != 0.03
    depth = rays.depth[keep].reshape(len(rays.depth), -1)
    return flat(depth, np.full(depth.shape, 0.05), RECEIVERS)


def translations(scale: float = 1.0, steps: int = 32) -> list[Rays]:
    """25 rays through a cloud that moves through an eighth of the map, with receivers that move along. `scale` is the
    depth of the map, in units of the first: everything comes to lie at smaller depths in a deeper one."""
    rng = np.random.default_rng(100)
    depth = 0.3 + 0.05 * rng.standard_normal((25, 64))
    alpha = np.full(depth.shape, -np.expm1(-0.05))
    receivers = 0.3 + 0.05 * (np.arange(5) - 2)
    shifts = 0.125 * np.arange(steps) / 32
    return [flat((depth + s) / scale, alpha, (receivers + s) / scale) for s in shifts]


def smoke_frame(case: str, direction: tuple[float, float, float], side: int = 24, slabs: int = 128) -> Rays:
    """Rays of a sun through a real frame in slabs, receivers between each ray's first and last smoke."""
    file, extinction = FRAMES[case]
    density, to_object = sfumato.read_volume(str(ROOT / "blend_samples" / file))
    scene = sfumato.Scene()
    scene.add_medium(density, to_object, scattering=(1, 1, 1), absorption=(0, 0, 0))
    along = np.array(direction) / np.linalg.norm(direction)
    across = np.cross((0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (0.0, 1.0, 0.0), along)
    across /= np.linalg.norm(across)
    axes = np.array([across, np.cross(along, across), along])
    corners = np.stack(np.meshgrid(*[(0, n) for n in density.shape[::-1]], indexing="ij"), -1).reshape(-1, 3)
    box = (corners @ to_object[:3, :3].T + to_object[:3, 3]) @ axes.T
    low, high = box.min(0), box.max(0)

    def world(xy: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Points (rays, depths, 3) from positions on the map (rays, 2) and depths (rays, depths)."""
        at = np.concatenate([np.broadcast_to(xy[:, None], (*z.shape, 2)), z[..., None]], -1)
        return np.asarray((low + at * (high - low)) @ axes)

    texel = (np.arange(side) + 0.5) / side
    xy = np.stack(np.meshgrid(texel, texel), -1).reshape(-1, 2)
    edges = world(xy, np.broadcast_to(np.linspace(0, 1, slabs + 1), (side * side, slabs + 1)))
    tau = extinction * sfumato.reference.column(scene, edges[:, :-1], edges[:, 1:])
    hit = tau.sum(1) > 0.01
    xy, tau = xy[hit], tau[hit]
    smoke = tau > 1e-6 * tau.sum(1, keepdims=True)
    first, last = smoke.argmax(1) / slabs, 1.0 - smoke[:, ::-1].argmax(1) / slabs
    receivers = first[:, None] + (last - first)[:, None] * RECEIVERS
    start = np.broadcast_to(world(xy, np.zeros((len(xy), 1))), (*receivers.shape, 3))
    exact = np.exp(-extinction * sfumato.reference.column(scene, start, world(xy, receivers)))
    depth = np.broadcast_to((np.arange(slabs) + 0.5) / slabs, tau.shape)
    return Rays(np.ascontiguousarray(depth), tau, receivers, exact, 1.0 / slabs, np.flatnonzero(hit), side)
