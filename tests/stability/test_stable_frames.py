# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures where methods fail, with light rays stored in every way that a frame has. Sizes of known weaknesses are those
of docs/stability.md."""

from __future__ import annotations

import frame_failures as failures
import pytest
from frame_failures import LAMPS, WAYS
from known import judge

every_way = pytest.mark.parametrize("way", WAYS)


@every_way
def test_a_camera_goes_round_what_looks_the_same_from_all_sides(way: str) -> None:
    """EEVEE's change beside it: `tests/blender/interface/orbits.py`."""
    judge(failures.orbit_of_the_camera(way), 0.0005)


@every_way
def test_a_sun_goes_round_the_plume(way: str) -> None:
    judge(failures.orbit_of_the_sun(way), 0.0025)


@every_way
def test_all_moves_along_the_rays_of_the_sun(way: str) -> None:
    judge(failures.along_the_ray(way), 1e-5)


@every_way
def test_a_stray_wisp_widens_the_bounds(way: str) -> None:
    judge(failures.stray_wisp(way), 0.005, {"piecewise": 0.00669}.get(way))


@every_way
@pytest.mark.parametrize("where", ["cell", "corners", "line", "layer"])
def test_smoke_one_cell_wide(where: str, way: str) -> None:
    judge(failures.one_cell_wide(where, way), 0.02 if where == "layer" else 0.01)


@pytest.mark.parametrize(
    "edges, depth, known",
    [
        ("soft", 1.0, None),
        ("soft", 5.0, 0.0465),
        ("soft", 20.0, 0.138),
        ("hard", 1.0, 0.128),
        ("hard", 5.0, 0.598),
        ("hard", 20.0, 0.837),
    ],
)
def test_cells_of_great_optical_depth(edges: str, depth: float, known: float | None) -> None:
    """At Preview. Where smoke begins, what reaches a cell's neighbour says little of what reaches its edge."""
    judge(failures.dense_cells(depth, edges), 0.02, known)


@pytest.mark.parametrize(
    "metres, told, known",
    [(1e4, False, None), (1e5, False, 0.0073), (1e6, False, 0.0305), (1e5, True, None), (1e6, True, None)],
)
def test_far_from_the_origin(metres: float, told: bool, known: float | None) -> None:
    """Single precision is 8 mm at 100 km. Told of the origin, as Blender's export tells it, a scene is where it was."""
    judge(failures.far_away(metres, told), 0.0 if told else 0.001, known)


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("air", [False, True], ids=["smoke", "air"])
def test_light_stays_out_of_a_closed_room(lamp: str, air: bool) -> None:
    """Walls and smoke are black; air has a thousandth at most, beside the walls that it ends at."""
    judge(failures.leak_into_a_room(lamp, air), 0.001 if air else 0.0)


@pytest.mark.parametrize("height, known", [(0.1, None), (0.3, 0.0303), (0.5, 0.0743), (0.8, 0.141)])
def test_light_stays_above_a_roof_in_smoke(height: float, known: float | None) -> None:
    """Cells hold what of a light solids leave in their middles: between a lit one and a dark one it is a line."""
    judge(failures.leak_below_a_roof(height), 0.01, known)


@pytest.mark.parametrize("kind", ["solid", "sheet"])
@pytest.mark.parametrize("elevation", [90.0, 30.0, 5.0, 1.0, 0.1])
def test_a_plate_throws_no_shadow_on_itself(kind: str, elevation: float) -> None:
    judge(failures.shadow_of_itself(kind, elevation), 1e-4)


@pytest.mark.parametrize("above, known", [(1e-4, 1.0), (3e-4, None), (1e-2, None)])
@pytest.mark.parametrize("kind", ["solid", "sheet"])
def test_what_lies_close_above_a_plate_throws_its_shadow(kind: str, above: float, known: float | None) -> None:
    """45 m from the origin of the scene, where single precision is 4e-6 m."""
    judge(failures.shadow_of_itself(kind, 30.0, above), 1e-4, known)
