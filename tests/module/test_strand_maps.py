# SPDX-License-Identifier: GPL-3.0-or-later
"""Light maps of hair, beside lists of what every ray meets, made here one strand after another."""

from __future__ import annotations

from typing import Any

import numpy as np
import sfumato
from numpy.typing import NDArray

Array = NDArray[Any]
WIDTH = 0.012  # of a strand, metres


def ball(count: int = 400) -> tuple[Array, Array]:
    """Straight hairs (count, 2, 3) of a ball, and radii (count, 2)."""
    rng = np.random.default_rng(4)
    towards = rng.normal(size=(count, 3))
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    aside = rng.normal(size=(count, 3)) * 0.1
    ends = np.stack((0.3 * towards, 0.6 * towards + aside), axis=1)
    return ends, np.full((count, 2), WIDTH / 2.0)


def frame(ends: Array, radii: Array, **more: Any) -> sfumato.Frame:
    scene = sfumato.Scene()
    scene.add_sun((0.3, 0.2, -1.0), (1, 1, 1))
    scene.add_strands(ends.reshape(-1, 3), radii.reshape(-1), np.arange(0, 2 * len(ends) + 1, 2), smooth=False)
    return sfumato.Frame(scene, texels_per_cell=2.0, **more)


def met_by_rays(found: sfumato.LightMap, ends: Array, radii: Array) -> tuple[Array, Array]:
    """Of each strand on each texel's ray the depth on the map and the optical depth, (height, width, strands): the share
    of the texel that it covers, across and along, both measured in texels from the texel's middle."""
    height, width = found.coefficients.shape[:2]
    to_map = np.array(found.world_to_light)
    places = ends @ to_map[:3, :3].T + to_map[:3, 3]
    size = np.array((width, height))
    per_metre = float(np.linalg.norm(to_map[0, :3])) * width
    middles = np.stack(np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5), axis=-1)
    depth, tau = (np.zeros((height, width, len(ends))) for _ in range(2))
    for i, (a, b) in enumerate(places):
        start, way = a[:2] * size, (b - a)[:2] * size
        length = np.hypot(*way)
        forth = (middles - start) @ way / length
        aside = np.abs((middles - start) @ np.array((-way[1], way[0])) / length)
        radius = radii[i, 0] * per_metre
        across = np.clip(np.minimum(aside + radius, 0.5) - np.maximum(aside - radius, -0.5), 0.0, 1.0)
        along = np.clip(np.minimum(length - forth, 0.5) - np.maximum(-forth, -0.5), 0.0, 1.0)
        tau[..., i] = -np.log1p(-np.minimum(across, 1.0 - 2.0**-20)) * along
        depth[..., i] = a[2] + (b[2] - a[2]) * np.clip(forth / length, 0.0, 1.0)
    return depth, tau


def test_a_map_holds_all_that_its_rays_meet() -> None:
    ends, radii = ball()
    found = frame(ends, radii, coefficients=31).light_map()
    depth, tau = met_by_rays(found, ends, radii)
    assert tau.sum(-1).max() > 1.0
    np.testing.assert_allclose(found.coefficients[..., 0], tau.sum(-1), atol=1e-4)


def box(values: Array, width: int) -> Array:
    """The means (height, width, n) of squares, of nothing beyond the rim."""
    half = width // 2
    padded = np.pad(values, ((half + 1, half), (half + 1, half), (0, 0)))
    sums = padded.cumsum(0).cumsum(1)
    return (sums[width:, width:] - sums[:-width, width:] - sums[width:, :-width] + sums[:-width, :-width]) / width**2


def filtered_error(basis: str, count: int, ends: Array, radii: Array) -> float:
    """Of the light behind hair at 33 depths, beside the exact optical depths, filtered."""
    found = frame(ends, radii, coefficients=count, basis=basis, ranges="shared").light_map()
    depth, tau = met_by_rays(found, ends, radii)
    receivers = (np.arange(33) + 0.37) / 33
    exact = np.exp(-box(np.stack([(tau * (depth <= d)).sum(-1) for d in receivers], -1), 33))
    filtered = sfumato.filter_map(found.coefficients, 33)
    at = np.broadcast_to(receivers, (*filtered.shape[:2], len(receivers)))
    light = sfumato.transmittance(filtered, at, found.basis)
    return float(np.sqrt(np.mean((light - exact) ** 2)))


def test_blurred_maps_of_five_coefficients() -> None:
    """Jansen and Bavoil (2010), figure 9: one range for all rays, and a filter of 33 x 33 texels; the target is .02. Measured
    first where 32 slices of the hair's own box had less than half of what five coefficients had."""
    ends, radii = ball()
    errors = {basis: filtered_error(basis, 5, ends, radii) for basis in ("fourier", "cosine", "learned")}
    errors["32 slices"] = filtered_error("piecewise", 32, ends, radii)
    print({name: f"{error:.5f}" for name, error in errors.items()})
    assert max(errors.values()) < 0.01, errors


def test_nothing_hangs_on_the_order_of_strands() -> None:
    ends, radii = ball()
    there = frame(ends, radii, coefficients=15).light_map().coefficients
    back = frame(ends[::-1], radii, coefficients=15).light_map().coefficients
    np.testing.assert_allclose(there, back, atol=1e-5 * there.max())


def test_hair_shades_what_is_behind_it_in_any_light() -> None:
    """A mat of hair that covers half of all rays halves the light on what lies behind, of a sun and of a lamp alike: with
    texels as wide as a strand. Wider ones take strands for strewn, and regular ones hide more than these."""
    count = 400
    x = np.linspace(-1.0, 1.0, count)
    ends = np.stack([np.stack((x, np.full(count, y), np.zeros(count)), axis=1) for y in (-1.0, 1.0)], axis=1)
    radii = np.full((count, 2), 0.25 * (x[1] - x[0]))
    points = np.random.default_rng(1).uniform(-0.5, 0.5, (2000, 3)) * (1.0, 1.0, 0.0)
    for is_sun in (True, False):
        scene = sfumato.Scene()
        scene.add_strands(ends.reshape(-1, 3), radii.reshape(-1), np.arange(0, 2 * count + 1, 2), smooth=False)
        if is_sun:
            scene.add_sun((0, 0, -1), (1, 1, 1))
        else:
            scene.add_point((0.0, 0.0, 4.0), (1, 1, 1))
        for basis in ("cosine", "curve"):
            frame_of_mat = sfumato.Frame(scene, texels_per_cell=4.0, basis=basis)
            behind = frame_of_mat.transmittance(points - (0.0, 0.0, 0.5)).mean()
            before = frame_of_mat.transmittance(points + (0.0, 0.0, 0.5)).min()
            assert abs(behind - 0.5) < 0.01 and before > 0.999, (is_sun, basis, behind, before)
