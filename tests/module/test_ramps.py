# SPDX-License-Identifier: GPL-3.0-or-later
"""Media under transfer functions: rays against the judge, and light against smoke that was classified beforehand on a
grid eight times as fine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sfumato
from numpy.typing import NDArray
from sfumato import Camera, Frame, Scene, TransferFunction

Array = NDArray[np.float64]
N = 12
MIDDLES = np.array([0.2, 0.4, 0.6, 0.8])
# Each some tenths of a cell wide.
PEAKS = np.concatenate([[0.0], (MIDDLES[:, None] + (-0.03, 0.0, 0.03)).ravel(), [1.0]])
PEAKED = np.concatenate([[0.0], np.tile([0.0, 0.6, 0.0], 4), [0.0]])
COLOURS = 1.0 + 0.5 * np.sin(np.multiply.outer(PEAKS, (9.0, 5.0, 3.0)))
WHITE = np.ones((len(PEAKS), 3))
FAR = 100.0


def blob(n: int = N) -> Array:
    """Smooth smoke from 0 to 1 that fades before the grid ends."""
    z, y, x = np.meshgrid(*[(np.arange(n) + 0.5) / n * 2 - 1] * 3, indexing="ij")
    waves = 1.0 + 0.3 * np.sin(5 * x + 1) * np.cos(4 * y) + 0.2 * np.sin(7 * z)
    cells = np.maximum(1.0 - (x**2 + y**2 + z**2) / 0.7, 0.0) * waves
    return np.asarray(cells / cells.max(), np.float64)


def along(start: Array, end: Array) -> Camera:
    """Orthographic, along a ray, so narrow that its pixels see one."""
    towards = (end - start) / np.linalg.norm(end - start)
    across = np.cross(towards, (0.3, 0.5, 0.8))
    across /= np.linalg.norm(across)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack((across * 1e4, np.cross(across, towards) * 1e4, towards / FAR))
    matrix[:3, 3] = -matrix[:3, :3] @ (0.5 * (start + end))
    return Camera(matrix)


def rays(count: int, n: int = N) -> tuple[Array, Array]:
    rng = np.random.default_rng(3)
    middle = n * (0.5 + 0.25 * (rng.random((count, 3)) - 0.5))
    towards = rng.standard_normal((count, 3))
    towards *= n / np.linalg.norm(towards, axis=1, keepdims=True)
    return middle - towards, middle + towards


def seen(frame: Frame, start: Array, end: Array) -> Array:
    """(rays, 4): radiance and transmittance."""
    out = [frame.render(along(*ray), 3, 3)[1, 1].astype(np.float64) for ray in zip(start, end)]
    return np.asarray(np.stack(out) * (1, 1, 1, -1) + (0, 0, 0, 1), np.float64)


def off(found: Array, wanted: Array) -> float:
    """Root mean square of the radiance by its mean."""
    return float(np.sqrt(np.mean((found - wanted)[:, :3] ** 2)) / wanted[:, :3].mean())


@pytest.mark.parametrize("case", ["peaks", "steps"])
def test_what_a_ramp_emits_and_takes_is_the_judges(case: str) -> None:
    if case == "peaks":
        stops, extinction, interpolation, tolerance = PEAKS, PEAKED, "linear", 5e-4
    else:
        stops, extinction, interpolation = np.array([0.0, 0.1, 0.5]), np.array([0.0, 0.3, 0.05]), "constant"
        tolerance = 3e-3
    colour = (1.0 + 0.5 * np.sin(np.multiply.outer(stops, (9.0, 5.0, 3.0)))) * extinction[:, None]
    cells, (start, end) = blob(), rays(24)
    scene = Scene()
    scene.add_medium(
        cells,
        np.eye(4),
        (0, 0, 0),
        (1, 1, 1),
        transfer=TransferFunction(stops, extinction, np.ones((len(stops), 3)), interpolation, associated=False),
        radiated=TransferFunction(stops, 0 * extinction, colour, interpolation),
    )
    wanted = sfumato.reference.sent_along(
        TransferFunction(stops, extinction, colour, interpolation), cells, start, end, points=200_000
    )
    found = seen(Frame(scene), start, end)
    assert off(found, wanted) < tolerance
    assert np.abs(found - wanted)[:, 3].max() < 2 * tolerance


def trilinear(cells: Array, place: Array) -> Array:
    """(...,) at places (..., 3) in cells, x first, of which the first has its centre at a half; 0 outside."""
    padded = np.pad(cells, 1)
    at = np.clip(place[..., ::-1] + 0.5, 0.0, np.array(padded.shape) - 1.001)
    low = np.floor(at).astype(int)
    share = at - low
    out = np.zeros(place.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1.0 - share), axis=-1)
        out += weight * padded[tuple(np.moveaxis(low + corner, -1, 0))]
    return out


SUN, IRRADIANCE = np.array([0.3, 0.2, -1.0]), np.array([3.0, 2.0, 1.0])
POINTS, LIGHT_POINTS = 800, 400


def scattered(cells: Array, transfer: TransferFunction, scattering: Array, extinction: Array, ray: Any) -> Array:
    """(4,): what one ray brings home by single scattering, and the mean transmittance, by brute force."""
    start, end = ray
    middles = (np.arange(POINTS) + 0.5) / POINTS
    places = start + middles[:, None] * (end - start)
    towards = -SUN / np.linalg.norm(SUN) * 1.5 * N
    on_the_way = places[:, None] + ((np.arange(LIGHT_POINTS) + 0.5) / LIGHT_POINTS)[:, None] * towards
    column = transfer.at(trilinear(cells, on_the_way))[..., 3].sum(1) * 1.5 * N / LIGHT_POINTS
    here = transfer.at(trilinear(cells, places))
    step = np.linalg.norm(end - start) / POINTS
    before = (np.cumsum(here[:, 3]) - 0.5 * here[:, 3]) * step
    arriving = np.exp(-(before + column)[:, None] * extinction) * IRRADIANCE / (4.0 * np.pi)
    through = np.exp(-here[:, 3].sum() * step * extinction).mean()
    return np.append((here[:, :3] * scattering * arriving).sum(0) * step, through)


@pytest.mark.parametrize("coloured", [False, True])
def test_smoke_under_a_ramp_is_lit_and_shades_itself(coloured: bool) -> None:
    """Of shells of a third of a cell, whose shadows lie on maps of two texels a cell: each ray is 4.6 % off, their mean
    2.7 %."""
    scattering = np.array((0.9, 0.6, 0.3) if coloured else (0.8, 0.8, 0.8))
    extinction = scattering + ((0.1, 0.2, 0.3) if coloured else 0.2)
    cells, (start, end) = blob(), rays(10)
    transfer = TransferFunction(PEAKS, PEAKED, COLOURS / COLOURS.max(), associated=False)
    scene = Scene()
    scene.add_medium(cells, np.eye(4), scattering, extinction - scattering, transfer=transfer)
    scene.add_sun(SUN, IRRADIANCE)
    found = seen(Frame(scene), start, end)
    wanted = np.stack([scattered(cells, transfer, scattering, extinction, ray) for ray in zip(start, end)])
    assert off(found, wanted) < 0.06
    np.testing.assert_allclose(found[:, :3].mean(0), wanted[:, :3].mean(0), rtol=0.03)
    assert np.abs(found - wanted)[:, 3].max() < 2e-3


def test_a_ramp_that_is_the_density_itself_changes_nothing() -> None:
    """Beside plain smoke that glows, and in front of a floor; but for steps that end elsewhere."""
    cells = blob()
    pictures = []
    for transfer in (None, TransferFunction([0.0, 2.0], [0.0, 2.0], np.ones((2, 3)), associated=False)):
        scene = Scene()
        scene.add_medium(cells, np.eye(4), (0.2, 0.3, 0.4), (0.1, 0.1, 0.1), 0.3, transfer=transfer)
        beside = np.eye(4)
        beside[:3, 3] = 4.0, 3.0, -2.0
        rows = [(0.0, 0.0, 0.0), (0.1, 0.2, 0.3)]
        scene.add_medium(cells, beside, (0.2,) * 3, (0.1,) * 3, glow=cells, emission=rows)
        scene.add_sun(SUN, IRRADIANCE)
        scene.add_mesh([(-9, -9, 0), (30, -9, 0), (9, 40, 0)], [(0, 1, 2)], [[(0, 0, 1)] * 3], [0], [(0.5, 0.5, 0.5)])
        start, end = rays(16)
        pictures.append(seen(Frame(scene, steps_per_cell=2.0), start, end))
    plain, ramped = pictures
    np.testing.assert_allclose(ramped, plain, rtol=1e-2, atol=2e-3)


def test_only_what_depends_on_a_stop_is_made_again() -> None:
    prepared = sfumato.Prepared()
    made = []
    for peak, red in ((0.6, 1.0), (0.6, 0.5), (0.5, 0.5)):
        scene = Scene()
        extinction = PEAKED * (peak / 0.6)
        transfer = TransferFunction(PEAKS, extinction, WHITE * (red, 1.0, 1.0), associated=False)
        scene.add_medium(GRID, np.eye(4), (0.8,) * 3, (0.2,) * 3, transfer=transfer)
        scene.add_sun(SUN, IRRADIANCE)
        Frame(scene, prepared=prepared)
        made.append((prepared.made["maps"], prepared.made["volumes"]))
    assert made == [(1, 1), (1, 1), (2, 2)], "a colour is not in the maps, an extinction is"


GRID = sfumato.Grid(blob().astype(np.float32))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"radiated": TransferFunction([0, 1], [0, 0], [(0, 0, 0), (1, 1, 1)])},
            "there is a radiated, but no transfer",
        ),
        ({"transfer": TransferFunction([0, 1], [1, 0], [(1, 1, 1)] * 2)}, "transfer has 1 of extinction and .* at 0"),
        (
            {"transfer": TransferFunction([0, 1], [0, 1], [(0, 0, 0)] * 2), "colour": np.ones((N, N, N, 3))},
            "there are cells' colours and a transfer",
        ),
        (
            {
                "transfer": TransferFunction([0, 1], [0, 1], [(0, 0, 0)] * 2),
                "radiated": TransferFunction([0, 1], [0, 1], [(0, 0, 0)] * 2),
            },
            "radiated has an extinction",
        ),
    ],
)
def test_what_no_medium_can_be_of_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        Scene().add_medium(blob(), np.eye(4), (1, 1, 1), (0, 0, 0), **given)
