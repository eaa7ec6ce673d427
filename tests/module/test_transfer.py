# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer functions: their refusals, and real smoke under them against the judge."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ramp_cases import FRAMES, error, ramp, rays, smoke

import sfumato
from sfumato import PreintegratedTable, TransferFunction

STEPPED = ("post-classified", "mean-source", "full")
WHITE = [(1, 1, 1), (1, 1, 1)]


def two_stops(**changed: Any) -> TransferFunction:
    arguments: dict[str, Any] = {"stops": [0, 1], "extinction": [0, 1], "colour": WHITE, **changed}
    return TransferFunction(**arguments)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"stops": [0.5, 0.5]}, "stops holds 0.5 at flat index 1 and 0.5 before it; each must be above the one before"),
        ({"stops": [1, 0]}, "stops holds 0 at flat index 1 and 1 before it"),
        ({"stops": [0, np.nan]}, "stops holds nan at flat index 1"),
        ({"extinction": [0, -0.1]}, "extinction holds -0.1 at flat index 1; every value must lie between 0 and"),
        ({"extinction": [0, np.inf]}, "extinction holds inf at flat index 1"),
        ({"extinction": [0, 1, 2]}, r"extinction has shape \(3,\), but must have \(2,\)"),
        ({"colour": [(1, 1, 1), (1, -1, 1)]}, "colour holds -1 at flat index 4"),
        ({"colour": [1, 1]}, r"colour has shape \(2,\), but must have \(2, 3\)"),
        ({"interpolation": "ease"}, "interpolation is 'ease', but must be one of 'linear', 'constant'"),
        (
            {"stops": [], "extinction": [], "colour": np.zeros((0, 3))},
            r"stops has shape \(0,\), but must have at least",
        ),
    ],
)
def test_a_ramp_that_is_none_is_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        two_stops(**changed)


def test_what_no_table_can_be_of_is_refused() -> None:
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"steps": [1.0, -1.0]}, "steps holds -1 at flat index 1"),
        ({"steps": []}, r"steps has shape \(0,\), but must have 1 to 64 lengths"),
        ({"steps": [1.0], "low": 2.0}, "high is 1, but must be above low, 2"),
        ({"steps": [1.0], "entries": 1}, "entries is 1, but must lie between 2 and 4096"),
        ({"steps": [1.0], "self_attenuation": "some"}, "self_attenuation is 'some', but must be one of 'full', "),
    )
    for arguments, message in cases:
        with pytest.raises(ValueError, match=f"^{message}"):
            PreintegratedTable(two_stops(), **arguments)


@pytest.mark.parametrize("interpolation", ["linear", "constant"])
def test_a_segment_is_what_the_table_has(interpolation: str) -> None:
    transfer = two_stops(interpolation=interpolation, extinction=[0.5, 3], colour=[(1, 0.5, 0), (0, 1, 2)])
    values = np.linspace(-0.5, 1.5, 21)
    front, back = np.meshgrid(values, values, indexing="ij")
    for how in ("full", "mean-source", "none"):
        table = PreintegratedTable(transfer, [2.0], entries=21, low=-0.5, high=1.5, self_attenuation=how)
        segment = transfer.segment(front, back, 2.0, how)
        np.testing.assert_allclose(table.values[0, ..., :3], segment[..., :3], atol=3e-6)
        np.testing.assert_allclose(table.values[0, ..., 3], 1.0 - segment[..., 3], atol=1e-6)
    off = ~np.eye(21, dtype=bool)
    judged = sfumato.reference.sent(transfer, front[off], back[off], 2.0)
    np.testing.assert_allclose(transfer.segment(front[off], back[off], 2.0), judged, atol=1e-6)


@pytest.mark.parametrize("frame", FRAMES)
def test_the_split_is_exact_on_real_smoke(frame: str) -> None:
    """At most 5 samples a voxel."""
    cells = smoke(frame)
    start, end = rays(cells, 60, seed=1)
    length = np.linalg.norm(end - start, axis=1).sum()
    for case, most in (("peaks", 5e-4), ("ramp", 3e-3), ("smooth", 5e-4)):
        transfer = ramp(case)
        sent, samples = sfumato.classify(cells, start, end, transfer)
        assert error(sent, sfumato.reference.sent_along(transfer, cells, start, end, 128)) <= most
        assert samples.sum() <= 5.0 * length


@pytest.mark.parametrize("frame", FRAMES)
def test_what_is_chosen_is_no_worse_than_the_best_that_steps(frame: str) -> None:
    """By half of the rays, and judged by the others."""
    cells = smoke(frame)
    start, end = rays(cells, 240, seed=2)
    for case in ("smooth", "ramp", "peaks"):
        transfer = ramp(case)
        for step in (1.0, 0.5):
            method, errors = sfumato.choose_classification(cells, start[::2], end[::2], transfer, step, error=1.0)
            assert method in STEPPED and set(errors) == set(STEPPED)
            exact, _ = sfumato.classify(cells, start[1::2], end[1::2], transfer)
            own = {
                name: error(sfumato.classify(cells, start[1::2], end[1::2], transfer, name, step)[0], exact)
                for name in STEPPED
            }
            assert own[method] <= 1.05 * min(own.values())
            strict, _ = sfumato.choose_classification(cells, start[::2], end[::2], transfer, step, error=1e-4)
            assert strict == "split"


def test_a_smooth_ramp_is_met_by_the_square_of_the_step() -> None:
    cells = smoke("plume")
    start, end = rays(cells, 120, seed=3)
    transfer = ramp("smooth")
    exact, _ = sfumato.classify(cells, start, end, transfer)
    steps = np.array([1.0, 0.5, 0.25, 0.125])
    for method in STEPPED:
        errors = [error(sfumato.classify(cells, start, end, transfer, method, step)[0], exact) for step in steps]
        order, _ = np.polyfit(np.log(steps), np.log(errors), 1)
        assert order >= (1.9 if method == "post-classified" else 1.7), (method, order)


def test_the_same_rays_give_the_same_answer() -> None:
    cells = smoke("wisp")
    start, end = rays(cells, 20, seed=4)
    first, second = (sfumato.classify(cells, start, end, ramp("peaks"), "full")[0] for _ in range(2))
    assert np.array_equal(first, second)
