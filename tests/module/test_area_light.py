# SPDX-License-Identifier: GPL-3.0-or-later
"""Integrals over area lights: what geometry fixes, what the judge says, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from bench_area_lights import ROUND_LIGHTS, Polygons, cosine_rows, frame, placed, random_polygons, round_rows, unit
from bench_rows import error_of
from numpy.typing import NDArray

import sfumato
from sfumato import reference

Array = NDArray[Any]

SQUARE = np.array([[-1.0, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]])
FEW = random_polygons(800, seed=3)
PUBLISHED = ("lorentzian", "lorentzian-pearson", "ellipse-peak")
METHODS = ("poles-2", "arvo", *PUBLISHED)


def integral(lights: Polygons, exponent: Any, method: str = "poles-2", normal: Any = None) -> Array:
    arguments = (lights.vertices, lights.axis, exponent, method, normal, lights.counts, True)
    return np.asarray(sfumato.polygon_integral(*arguments))


def judged(lights: Polygons, exponent: Any, method: str = "boundary", normal: Any = None) -> Array:
    return np.asarray(reference.polygon_integral(lights.vertices, lights.axis, exponent, normal, lights.counts, method))


def rounded(lights: Polygons) -> Polygons:
    """What float32 makes of them, in float64."""
    return Polygons(single(lights).vertices.astype(float), lights.counts, single(lights).axis.astype(float))


def single(lights: Polygons) -> Polygons:
    return Polygons(lights.vertices.astype(np.float32), lights.counts, lights.axis.astype(np.float32))


# ---- The judge: three ways to one answer ----


@pytest.mark.parametrize("exponent", [1, 2, 3, 10, 101, 500])
def test_recurrence_is_quadrature(exponent: int) -> None:
    assert np.abs(judged(FEW, exponent) - judged(FEW, exponent, "recurrence")).max() < 1e-12


def test_quadrature_along_edges_is_quadrature_over_the_area() -> None:
    some = Polygons(FEW.vertices[:30], FEW.counts[:30], FEW.axis[:30])
    for exponent in (0.7, 4, 33.3):
        assert np.abs(judged(some, exponent) - judged(some, exponent, "area")).max() < 3e-6


# ---- Limits ----


@pytest.mark.parametrize("exponent", [1, 2.5, 8.9, 9, 100, 5000, 1e5])
def test_a_light_that_fills_the_hemisphere_gives_one(exponent: float) -> None:
    wide = SQUARE * [1e6, 1e6, 1]
    assert sfumato.polygon_integral(wide, [0, 0, 1], exponent) == pytest.approx(1, abs=3e-6)
    assert sfumato.ellipse_integral([0, 0, 1], [1e6, 0, 0], [0, 1e6, 0], [0, 0, 1], exponent) == pytest.approx(
        1, abs=3e-6
    )


@pytest.mark.parametrize("exponent", [1, 3.3, 20, 400])
@pytest.mark.parametrize("size", [1e-2, 1e-3])
def test_a_tiny_light_is_the_point_formula(exponent: float, size: float) -> None:
    place, axis = np.array([0.2, -0.1, 1.0]), np.array([0, 0, 1.0])
    distance = np.linalg.norm(place)
    solid = 4 * size**2 / distance**3
    point = (exponent + 1) / (2 * np.pi) * distance**-exponent * solid
    # Two poles miss the profile by 1e-4, and so its slope, which is what a tiny light sees, by some thousandths.
    allowed = 5e-3 * (exponent + 1) / (2 * np.pi) * solid + 6 * exponent * size**2 * point
    light = place + size * (SQUARE - [0, 0, 1])
    assert sfumato.polygon_integral(light, axis, exponent) == pytest.approx(point, abs=allowed)
    disk = (place, [size, 0, 0], [0, size, 0], axis, exponent)
    assert sfumato.ellipse_integral(*disk) == pytest.approx(np.pi / 4 * point, abs=allowed)


def test_narrow_lobes_are_gaussian() -> None:
    """Half a plane whose edge passes at an angle d from the axis: the normal distribution at d sqrt(n)."""
    for deviations in (-2.0, -0.5, 0.0, 1.0, 2.5):
        edge = math.tan(deviations / math.sqrt(1e5))
        half = np.array([[-9, -9, 1], [-9, 9, 1], [edge, 9, 1], [edge, -9, 1]])
        expected = 0.5 * (1 + math.erf(deviations / math.sqrt(2)))
        assert sfumato.polygon_integral(half, [0, 0, 1], 1e5) == pytest.approx(expected, abs=1e-4)


# ---- Symmetries ----


def split(lights: Polygons) -> tuple[Polygons, Polygons]:
    """Along the diagonal from the first to the third corner: a triangle and the rest."""
    v = lights.vertices
    rest = np.concatenate([v[:, :1], v[:, 2:], v[:, -1:]], axis=1)
    return (
        Polygons(v[:, :3], np.full(len(v), 3), lights.axis),
        Polygons(rest, np.maximum(lights.counts - 1, 3), lights.axis),
    )


@pytest.mark.parametrize("method", ["poles-2", "arvo"])
def test_parts_add_up(method: str) -> None:
    more = FEW.counts > 3
    lights = Polygons(FEW.vertices[more], FEW.counts[more], FEW.axis[more])
    for exponent in (2, 40):
        first, second = (integral(part, exponent, method) for part in split(lights))
        lit = np.minimum(first, second) > 1e-4  # what the poles make negative is cut off
        assert lit.sum() > 100
        assert np.abs(first + second - integral(lights, exponent, method))[lit].max() < 1e-12
    first, second = (np.asarray(sfumato.diffuse_polygon(p.vertices, p.axis, p.counts, True)) for p in split(lights))
    whole = sfumato.diffuse_polygon(lights.vertices, lights.axis, lights.counts, True)
    assert np.abs(first + second - whole).max() < 1e-12


@pytest.mark.parametrize("method", METHODS)
def test_turning_or_scaling_everything_changes_nothing(method: str) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    turned = Polygons(FEW.vertices @ turn.T * 7.5, FEW.counts, FEW.axis @ turn.T * 0.2)
    assert np.abs(integral(turned, 60, method) - integral(FEW, 60, method)).max() < 1e-7


@pytest.mark.parametrize("factor", [1e-15, 1e15])
def test_single_precision_bears_any_unit_of_length(factor: float) -> None:
    lights = single(FEW)
    scaled = Polygons(lights.vertices * np.float32(factor), lights.counts, lights.axis)
    assert np.abs(integral(scaled, 60) - integral(lights, 60)).max() < 2e-6
    here, there = (sfumato.diffuse_polygon(x.vertices, x.axis, x.counts, True) for x in (lights, scaled))
    assert np.abs(here - there).max() < 2e-6


def test_the_back_of_a_polygon_is_black_unless_it_has_two_sides() -> None:
    functions: tuple[Callable[[Any, bool], Any], ...] = (
        lambda p, s: sfumato.polygon_integral(p, [0, 0, 1], 9, two_sided=s),
        lambda p, s: sfumato.diffuse_polygon(p, [0, 0, 1], two_sided=s),
    )
    for function in functions:
        front = function(SQUARE, False)
        assert front > 0.5
        assert function(SQUARE[::-1], False) == 0
        assert function(SQUARE[::-1], True) == pytest.approx(front, rel=1e-12)


def test_cosine_about_the_normal_is_lambert() -> None:
    lambert = np.asarray(sfumato.diffuse_polygon(FEW.vertices, FEW.axis, FEW.counts, True))
    assert np.abs(integral(FEW, 1) - lambert).max() < 1e-14


# ---- The judge's answers ----


@pytest.mark.parametrize("exponent", [10, 100, 500, 5000, 100000])
def test_poles_meet_their_targets(exponent: int) -> None:
    poles = next(row for row in cosine_rows(random_polygons(2000), exponent) if row["method"] == "poles-2")
    assert error_of(poles) < 3e-5
    assert poles["max_error"] < 1e-4
    assert poles["p95_relative"] < 3e-3


# The same error of the same formulas in an independent program, over other polygons.
ELSEWHERE = {
    100: (0.0064, 0.0037, 0.0054),
    500: (0.0065, 0.0041, 0.0016),
    5000: (0.0053, 0.0047, 0.0033),
}


@pytest.mark.parametrize("exponent", ELSEWHERE)
def test_published_methods_err_as_published(exponent: int) -> None:
    rows = {row["method"]: row for row in cosine_rows(random_polygons(2000), exponent)}
    for method, error in zip(PUBLISHED, ELSEWHERE[exponent]):
        assert 0.3 * error < error_of(rows[method]) < 1.1 * error


@pytest.mark.parametrize("case", ["sphere", "ellipse"])
def test_round_lights_meet_their_targets_with_and_without_horizon(case: str) -> None:
    ours, _ = round_rows(case)
    assert error_of(ours) < 3e-5
    assert ours["max_error"] < 1e-4


def test_whole_exponents_are_exact() -> None:
    normal = np.random.default_rng(5).normal(size=(len(FEW.axis), 3))
    for exponent in range(0, 9):
        allowed = 1e-13 if exponent else 1e-8  # the judge's quadrature sees a root there
        assert np.abs(integral(FEW, exponent, "arvo") - judged(FEW, exponent)).max() < allowed
        cut = integral(FEW, exponent, "arvo", normal) - judged(FEW, exponent, normal=normal)
        assert np.abs(cut).max() < allowed
        if exponent >= 1:
            assert np.abs(integral(FEW, exponent) - judged(FEW, exponent)).max() < 1e-13


@pytest.mark.parametrize("exponent", [1.3, 2.5, 4.4, 8.5, 8.99, 9.0, 14.5])
def test_real_exponents_below_the_poles_and_just_above(exponent: float) -> None:
    assert np.abs(integral(FEW, exponent) - judged(FEW, exponent)).max() < 1e-4


def test_exponents_and_axes_of_one_batch_may_differ() -> None:
    exponents = np.exp(np.linspace(0.1, 8, len(FEW.axis)))
    together = integral(FEW, exponents)
    for i in range(0, len(exponents), 97):
        one = sfumato.polygon_integral(FEW.vertices[i, : FEW.counts[i]], FEW.axis[i], exponents[i], two_sided=True)
        assert together[i] == pytest.approx(one, abs=1e-12)


def test_horizon_is_exact_and_nothing_leaks() -> None:
    rng = np.random.default_rng(6)
    normal = rng.normal(size=(len(FEW.axis), 3))
    for exponent in (1, 30, 3000):
        cut = integral(FEW, exponent, normal=normal)
        assert np.abs(cut - judged(FEW, exponent, normal=normal)).max() < 1e-4
        below = (FEW.vertices * normal[:, None]).sum(-1).max(1) < 0
        assert below.sum() > 50
        assert (cut[below] == 0).all()
    disk = ([0.0, 0, -1], [0.999, 0, 0.0], [0, 0.999, 0.0])
    assert sfumato.ellipse_integral(*disk, [0, 0.6, -0.8], 20, normal=[0, 0, 1]) == 0
    assert sfumato.diffuse_ellipse(*disk, [0, 0, 1]) == 0
    assert sfumato.sphere_integral([0, 0, -1], 0.999, [0, 0.6, -0.8], 20, normal=[0, 0, 1]) == 0


def test_ellipses_of_low_exponents_are_many_sided_polygons() -> None:
    rng = np.random.default_rng(7)
    axis, centre, plane = placed(rng, 300)
    u, v = frame(rng, plane)
    exact = reference.ellipse_integral(centre, 0.6 * u, 0.3 * v, axis, 3.5)
    assert np.abs(sfumato.ellipse_integral(centre, 0.6 * u, 0.3 * v, axis, 3.5) - exact).max() < 2e-4


# ---- Single precision ----


def slivers(count: int) -> Polygons:
    """Triangles a ten-thousandth as wide as they are long, seen flat on, axes beside their middle."""
    rng = np.random.default_rng(8)
    axis, centre, plane = placed(rng, count)
    u, v = frame(rng, plane)
    corners = np.stack([centre - 0.5 * u, centre + 0.5 * u, centre + 1e-4 * v], axis=1)
    return Polygons(corners, np.full(count, 3), unit(centre + 0.01 * rng.normal(size=(count, 3))))


HARD = {
    "random": FEW,
    "axis on a corner": Polygons(FEW.vertices, FEW.counts, FEW.vertices[:, 1]),
    "axis on an edge": Polygons(FEW.vertices, FEW.counts, 0.4 * FEW.vertices[:, 0] + 0.6 * FEW.vertices[:, 1]),
    "tiny": Polygons(FEW.axis[:, None] + 1e-2 * FEW.vertices, FEW.counts, FEW.axis),
    "slivers": slivers(800),
}


@pytest.mark.parametrize("case", HARD)
@pytest.mark.parametrize("exponent", [1, 5.5, 10, 100, 5000])
def test_single_precision_suffices(case: str, exponent: float) -> None:
    lights = HARD[case]
    assert integral(single(lights), exponent).dtype == np.float32
    assert np.abs(integral(single(lights), exponent) - integral(rounded(lights), exponent)).max() < 5e-6


@pytest.mark.parametrize("case", HARD)
def test_single_precision_suffices_for_the_narrowest_lobes_but_for_an_axis_on_an_edge(case: str) -> None:
    """There the last bit of a corner moves the edge by a hundred-thousandth of the lobe."""
    error = np.abs(integral(single(HARD[case]), 5e4) - integral(rounded(HARD[case]), 5e4))
    assert np.sqrt(np.mean(error**2)) < (1e-7 if case == "axis on a corner" else 1e-6)
    assert error.max() < (2e-5 if case == "axis on an edge" else 5e-6)


# ---- Several axes ----


@pytest.mark.parametrize("exponent", [0, 1, 2, 7, 30])
def test_double_moment_is_its_definition(exponent: int) -> None:
    rng = np.random.default_rng(9)
    for _ in range(5):
        axis, b = unit(np.array([0, 0, 1]) + 0.5 * rng.normal(size=3)), rng.normal(size=3)
        grid = (np.arange(600) + 0.5) / 300 - 1
        x, y = np.meshgrid(grid, grid)
        u = np.stack([x, y, np.ones_like(x)], axis=-1)
        distance = np.linalg.norm(u, axis=-1)
        u /= distance[..., None]
        lobe = np.where(u @ axis > 0, np.maximum(u @ axis, 0) ** exponent * (u @ b), 0)
        expected = (lobe / distance**3).sum() * (grid[1] - grid[0]) ** 2
        assert sfumato.double_moment(SQUARE, axis, exponent, b) == pytest.approx(expected, abs=3e-5)


@pytest.mark.parametrize(
    "exponents, degrees, allowed", [((100, 1), 75, 0.05), ((100, 10), 50, 0.035), ((8, 8), 1, 1e-3)]
)
def test_one_lobe_stands_for_a_product(exponents: tuple[int, int], degrees: float, allowed: float) -> None:
    """The L1 error over the sphere, of which plain spherical Gaussians leave .86 in the first two cases."""
    angle = math.radians(degrees)
    axes = np.array([[0, 0, 1], [math.sin(angle), 0, math.cos(angle)]])
    axis, exponent, scale = sfumato.product_of_lobes(axes, exponents)
    z, phi = np.meshgrid((np.arange(2000) + 0.5) / 2000, 2 * np.pi * np.arange(400) / 400)
    u = np.stack([np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi), z], axis=-1)
    product = np.maximum(u @ axes[0], 0) ** exponents[0] * np.maximum(u @ axes[1], 0) ** exponents[1]
    one = scale * np.maximum(u @ axis, 0) ** exponent
    assert np.abs(one - product).sum() / product.sum() < allowed


# ---- Refusals ----

DISK: dict[str, Any] = {"centre": [0, 0, 1], "u": [1, 0, 0], "v": [0, 1, 0]}
STAR = [[math.cos(0.8 * math.pi * i), math.sin(0.8 * math.pi * i), 1] for i in range(5)]


@pytest.mark.parametrize(
    "change, message",
    [
        ({"polygons": [[0, 0, 1], [1, 0, 1], [2, 0, 1]]}, r"polygons holds .* flat index 0, which has no area"),
        ({"polygons": [*SQUARE[:3], [1, -1, 2]]}, r"which is not planar"),
        ({"polygons": [SQUARE[0], SQUARE[1], [-0.9, -0.9, 1], SQUARE[3]]}, r"which is not convex"),
        ({"polygons": STAR}, r"is not convex, or crosses itself"),
        ({"polygons": [[np.nan, 0, 1], [1, 0, 1], [0, 1, 1]]}, r"polygons holds nan at flat index 0"),
        ({"polygons": [[0, 0, 1], [1, 0, 1]]}, r"polygons has shape \(2, 3\)"),
        ({"counts": 2}, r"counts holds 2 at flat index 0"),
        ({"counts": 5}, r"counts holds 5"),
        ({"axis": [0, 0, 0]}, r"axis holds \(0, 0, 0\)"),
        ({"axis": [0, np.inf, 0]}, r"axis holds inf"),
        ({"axis": [[0, 0, 1], [0, 0, 1]]}, r"axis has shape \(2, 3\)"),
        ({"normal": [0, 0, 0]}, r"normal holds \(0, 0, 0\)"),
        ({"exponent": 0.5}, r"exponent holds 0.5"),
        ({"exponent": 2e5}, r"exponent holds (2e\+05|200000)"),
        ({"exponent": np.nan}, r"exponent holds nan"),
        ({"method": "arvo", "exponent": 2.5}, r"exponent holds 2.5 .* whole"),
        ({"method": "lorentzian", "exponent": 3}, r"exponent holds 3 "),
        ({"method": "spinning"}, r"method is 'spinning'"),
    ],
)
def test_unusable_polygons_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        arguments: dict[str, Any] = {"polygons": SQUARE, "axis": [0, 0, 1], "exponent": 20}
        sfumato.polygon_integral(**(arguments | change))


@pytest.mark.parametrize(
    "function, arguments, message",
    [
        (sfumato.sphere_integral, ([0, 0, 2], 0, [0, 0, 1], 9), "radius holds 0 at flat index 0"),
        (sfumato.sphere_integral, ([0, 0, 2], -1, [0, 0, 1], 9), "radius holds -1"),
        (sfumato.sphere_integral, ([0, 0, 2], 2, [0, 0, 1], 9), "radius holds 2 .* reaches the origin"),
        (sfumato.diffuse_sphere, ([0, 0, 2], np.nan, [0, 0, 1]), "radius holds nan"),
        (sfumato.diffuse_ellipse, ([0, 0, 2], [0, 0, 0], [0, 1, 0], [0, 0, 1]), r"u holds \(0, 0, 0\)"),
        (sfumato.diffuse_ellipse, ([0, 0, 2], [1, 1, 0], [0, 1, 0], [0, 0, 1]), "must be perpendicular"),
        (sfumato.diffuse_ellipse, ([0, 0, np.inf], [1, 0, 0], [0, 1, 0], [0, 0, 1]), "centre holds inf"),
        (sfumato.product_of_lobes, ([[0, 0, 1]], [-1]), "exponents holds -1"),
        (sfumato.double_moment, (SQUARE, [0, 0, 1], -1, [0, 0, 1]), "exponent is -1"),
    ],
)
def test_unusable_round_lights_are_refused(function: Any, arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        function(*arguments)


def test_shapes_and_precisions_are_kept() -> None:
    lights = np.broadcast_to(SQUARE, (2, 3, 4, 3))
    assert sfumato.polygon_integral(lights, [0, 0, 1], 20).shape == (2, 3)
    assert sfumato.polygon_integral(lights.astype(np.float32), [0, 0, 1], np.full((2, 3), 20)).dtype == np.float32
    assert sfumato.polygon_integral(lights, [0, 0, 1], 20).dtype == np.float64
    assert sfumato.diffuse_sphere(np.ones((5, 0, 3)), 1, [0, 0, 1]).shape == (5, 0)
    assert sfumato.diffuse_ellipse(**DISK, normal=[0, 0, 1]).shape == ()
    assert ROUND_LIGHTS > 1000
