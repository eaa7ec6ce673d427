# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame's light maps in every basis: what they hold is what the console's functions make of the same rays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sfumato
from sfumato import Frame, Prepared, Scene

Array = np.ndarray[Any, Any]

SERIES: list[dict[str, Any]] = [
    {"basis": basis, "coefficients": count, "ranges": ranges}
    for basis, count in (("fourier", 7), ("cosine", 15), ("piecewise", 32), ("learned", 9))
    for ranges in ("own", "shared")
]
EVERY = [*SERIES, {"basis": "curve"}]


def name_of(how: dict[str, Any]) -> str:
    return "-".join(str(value) for value in how.values())


def smoke(cells: int = 16) -> Array:
    """A ball with waves in it, nothing at the faces."""
    x, y, z = np.meshgrid(*[(np.arange(cells) + 0.5) / cells * 2.0 - 1.0] * 3, indexing="ij")
    inside = np.cos(0.5 * np.pi * np.minimum(np.sqrt(x * x + y * y + z * z), 1.0))
    return np.asarray(inside**2 * (1.0 + 0.5 * np.sin(7.0 * x + 3.0 * y) * np.cos(5.0 * z)))


def scene_of(angle: float = 0.0, absorption: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Scene:
    scene = Scene()
    scene.add_medium(smoke(), np.diag([0.125, 0.125, 0.125, 1.0]), scattering=(2, 2, 2), absorption=absorption)
    scene.add_sun((0.3, 0.2, -1.0), (4, 4, 4), angle=angle)
    scene.add_point((1.0, -1.5, 2.5), (9, 9, 9))
    return scene


def on_rays(light_map: sfumato.LightMap, shape: tuple[int, ...], z: Array) -> Array:
    """Where in the world depths z of the rays of all texels of a sun's map are: (height, width, z, 3)."""
    height, width = shape[:2]
    v, u, w = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, z, indexing="ij")
    place = np.stack([u, v, w, np.ones_like(u)], axis=-1)
    return np.asarray((place @ np.linalg.inv(light_map.world_to_light).T)[..., :3])


Z = (np.arange(24) + 0.37) / 24


@pytest.mark.parametrize("how", SERIES, ids=name_of)
def test_a_frame_reads_its_series_as_the_console_does(how: dict[str, Any]) -> None:
    frame = Frame(scene_of(absorption=(0, 1, 3)), **how)
    light_map = frame.light_map()
    columns, spans = light_map.coefficients, light_map.range
    assert columns.shape[2] == how["coefficients"] and spans.shape == (*columns.shape[:2], 2)
    found = frame.transmittance(on_rays(light_map, columns.shape, Z))
    depth = np.broadcast_to(Z, (*columns.shape[:2], len(Z)))
    for colour, extinction in enumerate(frame.media[0].extinction.tolist()):
        expected = sfumato.transmittance(columns * extinction, depth, basis=light_map.basis, range=spans)
        np.testing.assert_allclose(found[..., colour], expected, rtol=0, atol=1e-5)


def test_a_frame_reads_its_curves_as_the_console_does() -> None:
    for absorption, colours in (((1, 1, 1), 1), ((0, 1, 3), 3)):
        frame = Frame(scene_of(absorption=absorption), basis="curve")
        light_map = frame.light_map()
        texels = light_map.texels
        assert light_map.basis == "curve" and texels.shape[2:] == (colours, 20) and light_map.bytes == texels.size
        found = frame.transmittance(on_rays(light_map, texels.shape, Z))
        depth = np.broadcast_to(Z, (*texels.shape[:2], len(Z)))
        for colour in range(3):
            curves = np.ascontiguousarray(texels[:, :, min(colour, colours - 1)])
            expected = sfumato.RayStorage().transmittance(curves, depth)
            np.testing.assert_allclose(found[..., colour], expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("how", EVERY, ids=name_of)
def test_every_way_sees_the_same_smoke(how: dict[str, Any]) -> None:
    points = np.random.default_rng(4).uniform(-0.5, 2.5, (3000, 3))
    judge, frame = Frame(scene_of(), coefficients=63), Frame(scene_of(), **how)
    for light in (0, 1):
        expected, found = judge.transmittance(points, light), frame.transmittance(points, light)
        assert found.min() >= 0.0 and found.max() <= 1.0
        assert np.sqrt(np.mean((found - expected) ** 2)) < (0.01 if how != SERIES[1] else 0.03)
    # The cells are lit from the same maps.
    lit, expected = (np.exp(-f.media[0].light[:, ..., 0]) for f in (frame, judge))
    assert np.sqrt(np.mean((lit - expected) ** 2)) < (0.02 if how != SERIES[1] else 0.05)


def test_a_frame_has_cosines_over_own_ranges_if_not_told_otherwise() -> None:
    usual, told = Frame(scene_of()), Frame(scene_of(), coefficients=15, basis="cosine", ranges="own")
    np.testing.assert_array_equal(usual.light_map().coefficients, told.light_map().coefficients)
    assert usual.light_map().basis == "cosine"


def test_a_shared_map_is_the_papers_and_the_gpus() -> None:
    """All rays over the map's whole depth, so sums over the slices of a ray: a_0 is twice the column."""
    frame = Frame(scene_of(), coefficients=5, basis="fourier", ranges="shared")
    own = Frame(scene_of(), coefficients=5, basis="fourier")
    shared = frame.light_map()
    assert (shared.range == (0.0, 1.0)).all()
    np.testing.assert_allclose(shared.coefficients[..., 0], own.light_map().coefficients[..., 0], rtol=0, atol=1e-6)
    behind = frame.transmittance(on_rays(shared, shared.coefficients.shape, np.ones(1)))[..., 0, 0]
    extinction = float(frame.media[0].extinction[0])
    np.testing.assert_allclose(behind, np.exp(-0.5 * extinction * shared.coefficients[..., 0]), rtol=0, atol=1e-6)


def test_a_large_light_is_one_map_where_ranges_are_shared() -> None:
    many = Frame(scene_of(angle=0.3), light_samples=64)
    one = Frame(scene_of(angle=0.3), ranges="shared")
    hard = Frame(scene_of(), ranges="shared")
    assert one.lights[0, 2, 3] == 1 and many.lights[0, 2, 3] > 4
    below = np.random.default_rng(4).uniform(0.0, 2.0, (4000, 3)) * (1, 1, 0.5) - (0, 0, 1)
    soft, found, unfiltered = (frame.transmittance(below)[:, 0] for frame in (many, one, hard))
    filtered_error, error = (float(np.sqrt(np.mean((t - soft) ** 2))) for t in (found, unfiltered))
    assert filtered_error < 0.9 * error, (filtered_error, error)


def test_another_basis_leaves_solids_as_they_are() -> None:
    prepared = Prepared()
    scene = scene_of()
    Frame(scene, prepared=prepared)
    before = dict(prepared.made)
    Frame(scene, prepared=prepared, basis="piecewise")
    after = dict(prepared.made)
    assert after["maps"] == before["maps"] + 2 and after["volumes"] == before["volumes"] + 2
    assert after["solids on maps"] == before["solids on maps"]


WRONG: dict[str, Callable[[], Any]] = {
    "basis is 'wavelet', but must be one of 'fourier', 'cosine', 'piecewise', 'learned', 'curve'": lambda: Frame(
        Scene(), basis="wavelet"
    ),
    "ranges is 'tiles', but must be one of 'own', 'shared'": lambda: Frame(Scene(), ranges="tiles"),
    "coefficients is 8, but must be odd": lambda: Frame(Scene(), 8, basis="fourier"),
    "coefficients is 64": lambda: Frame(Scene(), 64, basis="piecewise"),
    "coefficients is 7, but the basis is 'curve'": lambda: Frame(Scene(), 7, basis="curve"),
    "ranges is 'shared', but the basis is 'curve'": lambda: Frame(Scene(), basis="curve", ranges="shared"),
    "basis is 'curve', so there are no coefficients": lambda: Frame(scene_of(), basis="curve").light_map().coefficients,
    "basis is 'curve', so there are no coefficients and r": lambda: Frame(scene_of(), basis="curve").light_map().range,
    "basis is 'cosine', so there are no texels": lambda: Frame(scene_of()).light_map().texels,
}


@pytest.mark.parametrize("message", WRONG)
def test_refusals_name_the_argument_and_its_value(message: str) -> None:
    with pytest.raises(ValueError, match=message):
        WRONG[message]()
