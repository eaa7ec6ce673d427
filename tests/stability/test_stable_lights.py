# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights and light shafts where methods fail, ours and rivals'. Sizes of known weaknesses are those of
docs/stability.md. What is below the horizon gives nothing at all: `tests/module/test_area_light.py`; walls one texel
thick let no shaft through: `tests/module/test_shafts.py`."""

from __future__ import annotations

import bench_microfacet
import light_failures as failures
import pytest
from known import judge

every_method = pytest.mark.parametrize("method", bench_microfacet.METHODS)


@every_method
def test_a_lamp_sets_behind_a_surface_seen_at_grazing_angle(method: str) -> None:
    judge(failures.off_while_it_sets(method)[0], 0.008, {"ltc": 0.283, "mrp": 4.84, "montecarlo-64": 0.293}.get(method))


@every_method
def test_its_light_changes_evenly_meanwhile(method: str) -> None:
    judge(failures.off_while_it_sets(method)[1], 0.001, {"ltc": 0.0119, "mrp": 1.62, "montecarlo-64": 1.18}.get(method))


@every_method
def test_views_at_grazing_angles(method: str) -> None:
    judge(failures.off_at_grazing(method), 0.008, {"ltc": 0.0484, "mrp": 3.93, "montecarlo-64": 0.592}.get(method))


@pytest.mark.parametrize("method", failures.PHONG)
def test_a_lobe_at_the_horizon(method: str) -> None:
    known = {"lorentzian": 0.00424, "lorentzian-pearson": 0.00807, "ellipse-peak": 0.0116}
    judge(failures.phong_while_it_sets(method), 1e-4, known.get(method))


@pytest.mark.parametrize("method, most", [("minmax", 1e-6), ("epipolar", 0.03), ("epipolar-fine", 0.01)])
def test_an_epipole_on_the_edge_of_a_pillar(method: str, most: float) -> None:
    off, change = failures.off_at_an_edge(method)
    judge(off, most)
    judge(change, most)
