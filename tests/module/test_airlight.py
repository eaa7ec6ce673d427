# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp's and a sun's light in air: refusals, shapes, and what physics fixes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sfumato

DUST: dict[str, Any] = {"position": (0, 0, 0), "extinction": 0.1}


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"anisotropy": 1.0}, "anisotropy is 1, but must lie between -0.9999 and 0.9999"),
        ({"anisotropy": -1.0}, "anisotropy is -1, but must lie between -0.9999 and 0.9999"),
        ({"extinction": -0.1}, "extinction is -0.1, but must lie between 0 and"),
        ({"extinction": np.inf}, "extinction is inf, but must lie between 0 and"),
        ({"scale_height": -1.0}, "scale_height is -1, but must lie between 0 and"),
        ({"phase": "mie"}, "phase is 'mie', but must be one of 'henyey-greenstein', 'cornette-shanks', 'rayleigh'"),
        ({"direction": (0, 0, 0)}, r"direction is \(0, 0, 0\), but must have a length"),
        ({"radius": -1.0}, "radius is -1, but must lie between 0 and"),
        ({"points": 0}, "points is 0, but must lie between 1 and 64"),
        ({"end": [[1, 2, 3]]}, r"end has shape \(1, 3\), but must have that of start, \(3,\)"),
        ({"start": [0, 0]}, r"start has shape \(2,\), but its last axis must be 3"),
        ({"start": [0, 0, np.nan]}, "start holds nan at flat index 2"),
    ],
)
def test_what_is_no_air_or_lamp_is_refused(changed: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {"start": [0, 1, 0], "end": [5, 1, 0], **DUST, **changed}
    with pytest.raises(ValueError, match=f"^{message}"):
        sfumato.airlight(**arguments)


def test_what_is_no_plate_is_refused() -> None:
    plate: dict[str, Any] = {"across": (1, 0, 0), "up": (0, 1, 0), **DUST}
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"up": (2, 0, 0)}, "up has no part at right angles to across: the plate has no area"),
        ({"spread": 0.0}, "spread is 0, but must lie between 0.001 and"),
    )
    for changed, message in cases:
        with pytest.raises(ValueError, match=f"^{message}"):
            sfumato.airlight_of_plate([0, 0, 1], [1, 0, 1], **{**plate, **changed})


def test_a_small_plate_is_a_point() -> None:
    """Far away, where its cosine is the same for all of it."""
    plate = sfumato.airlight_of_plate(
        [-0.1, 0, 9], [0.1, 0, 9], across=(0.02, 0, 0), up=(0, 0.03, 0), **DUST, anisotropy=0.4
    )
    point = sfumato.airlight([-0.1, 0, 9], [0.1, 0, 9], **DUST, anisotropy=0.4)
    assert float(plate) == pytest.approx(float(point) * 4 * 0.02 * 0.03, rel=1e-3)
    behind = sfumato.airlight_of_plate([-1, 0, -3], [1, 0, -3], across=(1, 0, 0), up=(0, 1, 0), **DUST)
    assert float(behind) == 0.0


def test_a_way_to_nowhere_sends_nothing() -> None:
    assert sfumato.airlight([[[1, 2, 3]]], [[[1, 2, 3]]], **DUST).tolist() == [[0.0]]
    assert float(sfumato.sunlight([1, 2, 3], [1, 2, 3], direction=(0, 0, -1), extinction=0.1)) == 0.0


def test_light_from_all_around_fills_all_directions() -> None:
    """What clear air sends into all directions is what it scatters: a small ball of it at a distance of 2."""
    rng = np.random.default_rng(3)
    towards = rng.standard_normal((20000, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    start = np.array([2.0, 0.0, 0.0]) - 1e-3 * towards
    for phase, g in (("henyey-greenstein", 0.5), ("cornette-shanks", 0.5), ("rayleigh", 0.0)):
        sent = sfumato.airlight(
            start, start + 2e-3 * towards, position=(0, 0, 0), extinction=0.0, anisotropy=g, phase=phase
        )
        assert 4 * np.pi * sent.mean() / 2e-3 == pytest.approx(1 / 4, rel=0.02)


def test_parts_of_a_way_add_up() -> None:
    """Through air a lamp passes close by, the eye sees the near half and, dimmed, the far one."""
    eye, middle, end = [-5, 0.3, 0], [0.1, 0.3, 0], [7, 0.3, 0]
    for g in (-0.9, 0.0, 0.95):
        near, far, both = (
            float(sfumato.airlight(a, b, anisotropy=g, **DUST)) for a, b in ((eye, middle), (middle, end), (eye, end))
        )
        assert near + np.exp(-0.1 * 5.1) * far == pytest.approx(both, rel=1e-4)


def test_thin_air_is_even_over_a_great_scale_height() -> None:
    ways: tuple[Any, Any] = ([3, -4, 0.5], [-2, 6, 1])
    even = float(sfumato.airlight(*ways, anisotropy=0.7, **DUST))
    assert float(sfumato.airlight(*ways, anisotropy=0.7, scale_height=1e7, **DUST)) == pytest.approx(even, rel=1e-5)


def test_a_sphere_within_a_cone_is_judged() -> None:
    rng = np.random.default_rng(11)
    start, end = rng.uniform(-3, 3, (2, 12, 3))
    lamp: dict[str, Any] = {"radius": 0.3, "direction": (1, 1, 0), "cone": 2.0, "blend": 0.5, **DUST}
    wanted = sfumato.reference.airlight(start, end, **lamp)
    assert np.abs(sfumato.airlight(start, end, **lamp) - wanted).max() < 2e-3 * wanted.max()
