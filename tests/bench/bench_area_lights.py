# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py arealights: cosine powers over polygons, spheres and ellipses, by our poles and by what was published."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import progress
import sfumato
from bench_rows import AreaLightRow, error_of
from numpy.typing import NDArray

Array = NDArray[Any]

POLYGONS = 6000
ROUND_LIGHTS = 2000
EXPONENTS = (10, 100, 500, 5000, 100000)
SAMPLES = 64
METRIC = "RMSE of L over its range"
# The share of light allowed to be wrong: RMSE, maximum; and nanoseconds per edge on one core.
TARGETS = (3e-5, 1e-4, 60.0)


def unit(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def frame(rng: np.random.Generator, normal: Array) -> tuple[Array, Array]:
    """Two unit vectors across `normal`, turned at random."""
    u = unit(np.cross(normal, rng.normal(size=normal.shape)))
    return u, np.cross(normal, u)


def placed(rng: np.random.Generator, count: int) -> tuple[Array, Array, Array]:
    """Axes, and centres and normals of lights: at a distance of 1, 0 to 60 degrees from the axis, uniformly in angle,
    and tilted by up to 70 degrees from facing the origin."""
    axis = unit(rng.normal(size=(count, 3)))
    u, _ = frame(rng, axis)
    angle = rng.uniform(0, np.pi / 3, (count, 1))
    centre = axis * np.cos(angle) + u * np.sin(angle)
    u, _ = frame(rng, centre)
    tilt = np.radians(rng.uniform(0, 70, (count, 1)))
    return axis, centre, unit(u * np.sin(tilt) - centre * np.cos(tilt))


@dataclass(frozen=True)
class Polygons:
    vertices: Array  # (count, 6, 3), the last repeated
    counts: Array
    axis: Array


def random_polygons(count: int = POLYGONS, seed: int = 17) -> Polygons:
    """Convex polygons of 3 to 6 edges: corners at random angles, no two neighbours more than 170 degrees apart, on
    circles of radius .1 to 1.5, uniformly in the logarithm, placed as above. The reference's own table does not say how
    its polygons were drawn, only how many there were."""
    rng = np.random.default_rng(seed)
    axis, centre, normal = placed(rng, count)
    counts = rng.integers(3, 7, count)
    angles = np.zeros((count, 6))
    left = np.arange(count)
    while len(left):
        drawn = rng.uniform(0, 2 * np.pi, (len(left), 6))
        beyond = np.arange(6)[None] >= counts[left, None]
        drawn = np.sort(np.where(beyond, np.inf, drawn), axis=1)
        last = np.take_along_axis(drawn, counts[left, None] - 1, axis=1)
        drawn = np.where(beyond, last, drawn)
        gaps = np.append(np.diff(drawn, axis=1), drawn[:, :1] + 2 * np.pi - last, axis=1)
        good = gaps.max(1) < np.radians(170)
        angles[left[good]] = drawn[good]
        left = left[~good]
    radius = np.exp(rng.uniform(np.log(0.1), np.log(1.5), (count, 1)))
    u, v = frame(rng, normal)
    circle = u[:, None] * np.cos(angles)[..., None] + v[:, None] * np.sin(angles)[..., None]
    return Polygons(centre[:, None] + radius[..., None] * circle, counts, axis)


def sampled(points: Array, towards: Array, axis: Array, exponent: Array, normal: Array | None = None) -> Array:
    """Monte Carlo: the mean over (lights, samples) of the lobe at `points`, each worth `towards` of solid angle."""
    u = unit(points)
    lobe = np.maximum((u * unit(axis)[:, None]).sum(-1), 0.0) ** exponent[:, None]
    if normal is not None:
        lobe = np.where((u * normal[:, None]).sum(-1) > 0, lobe, 0.0)
    return (exponent + 1) / (2 * np.pi) * (lobe * towards).mean(1)


def polygons_sampled(lights: Polygons, exponent: float, seed: int = 5) -> Array:
    """64 points, uniform over the area of each polygon."""
    rng = np.random.default_rng(seed)
    v = lights.vertices
    twice = np.cross(v[:, 1:-1] - v[:, :1], v[:, 2:] - v[:, :1])
    areas = np.linalg.norm(twice, axis=-1)
    shares = np.cumsum(areas, axis=1)
    chosen = (rng.uniform(size=(len(v), SAMPLES))[..., None] * shares[:, None, -1:] > shares[:, None]).sum(-1)
    p, q = np.sqrt(rng.uniform(size=(2, len(v), SAMPLES, 1)) ** [[[[1]]], [[[2]]]])
    rows = np.arange(len(v))[:, None]
    a, b, c = v[rows, 0], v[rows, chosen + 1], v[rows, chosen + 2]
    x = a + p * ((b - a) * (1 - q) + (c - a) * q)
    r = np.linalg.norm(x, axis=-1)
    solid = 0.5 * np.abs((x * twice.sum(1)[:, None]).sum(-1)) / r**3
    return sampled(x, solid, lights.axis, np.full(len(v), float(exponent)))


def fastest(run: Callable[[], object], repeats: int = 7) -> float:
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    return best


def row(case: str, method: str, value: Array, exact: Array, seconds: float) -> AreaLightRow:
    error = np.abs(np.asarray(value, dtype=float) - exact)
    bright = exact > 0.01
    return AreaLightRow(
        case=case,
        method=method,
        metric=METRIC,
        error=float(np.sqrt(np.mean(error**2)) / np.ptp(exact)),
        seconds=seconds,
        bytes=0,
        max_error=float(error.max()),
        p95_relative=float(np.quantile(error[bright] / exact[bright], 0.95)),
    )


def cosine_rows(lights: Polygons, exponent: int) -> list[AreaLightRow]:
    case = f"cosine-{exponent}"
    progress.step(case)
    edges = int(lights.counts.sum())
    single = [x.astype(np.float32) for x in (lights.vertices, lights.axis)]
    # What float32 inputs mean is their own value, not that of the numbers before rounding.
    corners, axis = (x.astype(float) for x in single)
    lights = Polygons(corners, lights.counts, axis)
    exact = sfumato.reference.polygon_integral(corners, axis, exponent, counts=lights.counts)
    rows = []
    for method in ("arvo", "lorentzian", "lorentzian-pearson", "ellipse-peak", "poles-2"):
        if method == "arvo" and exponent > 5000:
            continue

        def run(method: str = method) -> Array:
            corners, axes = single
            return np.asarray(sfumato.polygon_integral(corners, axes, exponent, method, None, lights.counts, True))

        rows.append(row(case, method, run(), exact, fastest(run, 2 if method == "arvo" else 7) / edges))
    seconds = fastest(lambda: polygons_sampled(lights, exponent), 1) / edges
    return [*rows, row(case, f"montecarlo-{SAMPLES}", polygons_sampled(lights, exponent), exact, seconds)]


def round_rows(case: str, seed: int = 23) -> list[AreaLightRow]:
    """Spheres, half angle 3 to 60 degrees, or ellipses, half axes .05 to 1, with a random horizon above which at least
    a part of the light is: it cuts a good third of them."""
    progress.step(case)
    rng = np.random.default_rng(seed)
    axis, centre, plane = placed(rng, ROUND_LIGHTS)
    exponent = rng.choice(EXPONENTS[:4], ROUND_LIGHTS).astype(float)
    u, v = frame(rng, plane)
    u, v = (x * np.exp(rng.uniform(np.log(0.05), 0, (ROUND_LIGHTS, 1))) for x in (u, v))
    radius = np.sin(np.radians(rng.uniform(3, 60, ROUND_LIGHTS)))
    normal = unit(rng.normal(size=(ROUND_LIGHTS, 3)))
    normal = np.where((normal * centre).sum(-1, keepdims=True) < -0.2, -normal, normal)
    names = (centre, radius, axis) if case == "sphere" else (centre, u, v, axis)
    single = [x.astype(np.float32) for x in names]
    double = [x.astype(float) for x in single]
    normal32 = normal.astype(np.float32)
    normal = normal32.astype(float)
    functions: dict[str, tuple[Callable[..., Any], Callable[..., Array]]] = {
        "sphere": (sfumato.sphere_integral, sfumato.reference.sphere_integral),
        "ellipse": (sfumato.ellipse_integral, sfumato.reference.ellipse_integral),
    }
    ours, judge = functions[case]
    exact = judge(*double, exponent, normal)

    def run() -> Array:
        return np.asarray(ours(*single, exponent, normal32))

    def noise() -> Array:
        angle, share = 2 * np.pi * rng.uniform(size=(ROUND_LIGHTS, SAMPLES, 1)), rng.uniform(
            size=(ROUND_LIGHTS, SAMPLES)
        )
        if case == "sphere":
            cone = np.sqrt(1 - radius**2)[:, None]
            cosine = (1 - share * (1 - cone))[..., None]
            a, b = frame(rng, centre)
            across = a[:, None] * np.cos(angle) + b[:, None] * np.sin(angle)
            x = centre[:, None] * cosine + across * np.sqrt(1 - cosine**2)
            solid = np.broadcast_to(2 * np.pi * (1 - cone), share.shape)
        else:
            across = u[:, None] * np.cos(angle) + v[:, None] * np.sin(angle)
            x = centre[:, None] + across * np.sqrt(share)[..., None]
            solid = np.pi * np.abs((x * np.cross(u, v)[:, None]).sum(-1)) / np.linalg.norm(x, axis=-1) ** 3
        return sampled(x, solid, axis, exponent, normal)

    return [
        row(case, "poles-2", run(), exact, fastest(run) / ROUND_LIGHTS),
        row(case, f"montecarlo-{SAMPLES}", noise(), exact, fastest(noise, 1) / ROUND_LIGHTS),
    ]


def cosine_lights() -> tuple[list[AreaLightRow], list[str]]:
    lights = random_polygons()
    rows = [row for exponent in EXPONENTS for row in cosine_rows(lights, exponent)]
    rows += round_rows("sphere") + round_rows("ellipse")
    return rows, remarks(rows)


def remarks(rows: list[AreaLightRow]) -> list[str]:
    out = []
    by_name = {(row["case"], row["method"]): row for row in rows}
    for (case, method), ours in by_name.items():
        if method != "poles-2":
            continue
        line = f"{case}: error {ours['error']:.1e} (target {TARGETS[0]:.0e}), most {ours['max_error']:.1e} ({TARGETS[1]:.0e})"
        published = by_name.get((case, "ellipse-peak"))
        if published:
            line += (
                f", {1e9 * ours['seconds']:.0f} ns an edge ({TARGETS[2]:.0f}), {error_of(published) / error_of(ours):.0f} times"
                f" closer than the ellipse peak in {ours['seconds'] / published['seconds']:.2f} of its time"
            )
        out.append(line)
    return [*out, "seconds are per edge, or per sphere and ellipse; Monte Carlo's are NumPy's"]
