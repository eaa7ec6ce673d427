# SPDX-License-Identifier: GPL-3.0-or-later
"""Real smoke under three ramps, and rays through it, for the benchmark and the tests of pre-integration."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import sfumato

ROOT = Path(__file__).resolve().parents[2]
FRAMES = {
    "plume": "plume_cache/data/fluid_data_0025.vdb",
    "collision": "frames/collision.vdb",
    "wisp": "frames/wisp.vdb",
}
STEP = 1.0  # voxels


def ramp(case: str) -> sfumato.TransferFunction:
    """Optical depths of at most .6 a voxel: `smooth`; four narrow `peaks`; constants in `ramp`."""
    if case == "peaks":
        middles = np.array([0.2, 0.4, 0.6, 0.8])
        stops = np.concatenate([[0.0], (middles[:, None] + (-0.03, 0.0, 0.03)).ravel(), [1.0]])
        extinction = np.concatenate([[0.0], np.tile([0.0, 0.6, 0.0], 4), [0.0]])
    elif case == "ramp":
        stops, extinction = np.array([0.0, 0.1, 0.5]), np.array([0.0, 0.3, 0.05])
    else:
        stops = np.linspace(0.0, 1.0, 9)
        extinction = 0.6 * stops**2
    colour = 1.0 + 0.5 * np.sin(np.multiply.outer(stops, (9.0, 5.0, 3.0)))
    interpolation = "constant" if case == "ramp" else "linear"
    return sfumato.TransferFunction(stops, extinction, colour, interpolation, associated=False)


def smoke(frame: str) -> np.ndarray:
    """The square root of the density, of which thin smoke has its share, from 0 to 1."""
    density, _ = sfumato.read_volume(str(ROOT / "blend_samples" / FRAMES[frame]))
    return np.sqrt(density / density.max())


def rays(cells: np.ndarray, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Start and end (count, 3), in cells, x first: in all directions through smoke, from end to end of its box."""
    rng = np.random.default_rng(seed)
    inside = np.argwhere(cells > 0.25)
    middle = (inside[rng.integers(len(inside), size=count)] + rng.random((count, 3)))[:, ::-1]
    along = rng.standard_normal((count, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    size = np.array(cells.shape[::-1])
    walls = (np.stack([np.zeros(3), size])[:, None] - middle) / along
    near, far = walls.min(0).max(1), walls.max(0).min(1)
    return middle + near[:, None] * along, middle + far[:, None] * along


def error(sent: np.ndarray, exact: np.ndarray) -> float:
    """Root mean square by the mean radiance."""
    return float(np.sqrt(np.mean((sent - exact)[:, :3] ** 2)) / exact[:, :3].mean())
