#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of bench.py arealights: what rough surfaces reflect of rectangles, against quadrature. Runs alone, too:
PYTHONPATH=build/python tests/bench/bench_microfacet.py"""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import ltc
import numpy as np
import progress
import sfumato
from bench_rows import Row, error_of

Array = np.ndarray
Method = Callable[["Lit"], Array]


class ReflectionRow(Row):
    max_error: float
    p95_relative: float  # where the radiance is above 0.02


@dataclass(frozen=True)
class Lit:
    """Rectangles (n, 4, 3), views (n, 3), alphas (n, 2), and the lobe."""

    rectangles: Array
    views: Array
    alphas: Array
    brdf: str = "ggx"

    def reference(self) -> Array:
        return np.asarray(sfumato.reference.microfacet_polygon(self.rectangles, self.views, self.alphas, self.brdf))


def lit(count: int, seed: int, cosines: tuple[float, float], anisotropic: bool = False) -> Lit:
    """Half of the rectangles near the mirrored view; many cut by the horizon, none wholly below it. Roughness (the root
    of alpha) and the view's cosine are uniform."""
    random = np.random.default_rng(seed)

    def normal() -> Array:
        return random.normal(size=(3 * count, 3))

    def lengths(low: float, high: float) -> Array:
        return np.asarray(np.exp(random.uniform(np.log(low), np.log(high), (3 * count, 1))))

    alphas = random.uniform(0.1, 1.0, (3 * count, 2)) ** 2
    if not anisotropic:
        alphas[:, 1] = alphas[:, 0]
    cosine, turn = random.uniform(*cosines, 3 * count), random.uniform(0, 2 * np.pi, 3 * count)
    sine = np.sqrt(1 - cosine**2)
    views = np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], -1)
    near = random.random((3 * count, 1)) < 0.5
    centre = np.where(near, ltc.unit(views * [-1, -1, 1] + 0.5 * normal()), ltc.unit(normal()))
    centre = centre * random.uniform(0.5, 4.0, (3 * count, 1))
    facing = ltc.unit(normal())
    u = ltc.unit(np.cross(facing, normal()))
    v = np.cross(facing, u) * lengths(0.1, 2.0)
    u = u * lengths(0.1, 2.0)
    rectangles = np.stack([centre - u - v, centre + u - v, centre + u + v, centre - u + v], 1)
    seen = np.flatnonzero(rectangles[..., 2].max(1) > 1e-3)[:count]
    return Lit(rectangles[seen], views[seen], alphas[seen])


def cases(count: int) -> dict[str, Lit]:
    every, grazing = (0.03, 1.0), (0.03, 0.2)
    return {
        "ggx": lit(count, 1, every),
        "ggx-grazing": lit(count, 2, grazing),
        "ggx-anisotropic": lit(count, 3, every, anisotropic=True),
        "beckmann": replace(lit(count, 4, every), brdf="beckmann"),
    }


def closed_form(lights: Lit) -> Array:
    corners, views, alphas = (x.astype(np.float32) for x in (lights.rectangles, lights.views, lights.alphas))
    return np.asarray(sfumato.microfacet_polygon(corners, views, alphas, lights.brdf))


def of_ggx(method: Callable[[Array, Array, Array], Array]) -> Method:
    return lambda lights: method(lights.rectangles, lights.views, lights.alphas)


# The rivals are of GGX, and in NumPy: what they take here is not the method's time, see lane_seconds().
METHODS: dict[str, tuple[Method, int]] = {
    "closed-form": (closed_form, 0),
    "ltc": (of_ggx(ltc.ltc), ltc.TABLE_BYTES),
    "mrp": (of_ggx(ltc.representative_point), 0),
    "montecarlo-64": (of_ggx(lambda *lights: ltc.monte_carlo(64, *lights)), 0),
}


def reflections(count: int = 3000) -> list[ReflectionRow]:
    rows = []
    for case, lights in cases(count).items():
        progress.step(f"{case}: the reference of {count} lights, and every method")
        exact = lights.reference()
        bright = exact > 0.02
        for name, (method, size) in METHODS.items():
            if lights.brdf != "ggx" and name != "closed-form":
                continue
            times = []
            for _ in range(3):
                start = time.perf_counter()
                answer = method(lights)
                times.append(time.perf_counter() - start)
            error = np.abs(answer - exact)
            rows.append(
                ReflectionRow(
                    case=case,
                    method=name,
                    metric="RMSE of radiance over its range",
                    error=float(np.sqrt(np.mean(error**2)) / np.ptp(exact)),
                    seconds=min(times) / len(exact),
                    bytes=size,
                    max_error=float(error.max()),
                    p95_relative=float(np.quantile(error[bright] / exact[bright], 0.95)),
                )
            )
    return rows


# Error of the closed form: RMSE over the range, and the 95th percentile of the relative one.
TARGETS = {
    "ggx": (0.004, 0.1),
    "ggx-grazing": (0.008, 0.1),
    "ggx-anisotropic": (0.007, None),
    "beckmann": (0.0075, None),
}


def lane_seconds() -> dict[str, float]:
    """Seconds a rectangle of each method on GGX, from tests/bench/microfacet_cost.cpp, where all are compiled alike."""
    progress.step("times: building and running microfacet_cost")
    build = Path(__file__).resolve().parents[2] / "build"
    subprocess.run(["cmake", "--build", build, "--target", "microfacet_cost"], check=True, stdout=subprocess.DEVNULL)
    runs = [
        subprocess.run([build / "tests" / "microfacet_cost", "methods"], check=True, text=True, stdout=subprocess.PIPE)
        for _ in range(3)
    ]
    times: dict[str, float] = {}
    for line in "".join(run.stdout for run in runs).splitlines():
        method, nanoseconds = line.split()
        times[method] = min(times.get(method, np.inf), 1e-9 * float(nanoseconds))
    return times


def microfacet_lights() -> tuple[list[ReflectionRow], list[str]]:
    """For bench.py: the rows, and each case beside its target."""
    rows = reflections()
    seconds = lane_seconds()
    for row in rows:
        if row["case"].startswith("ggx"):
            row["seconds"] = seconds[row["method"]]
    remarks = ["seconds on GGX: all methods compiled alike, on as many lanes as the processor has (microfacet_cost)"]
    for row in rows:
        if row["method"] == "closed-form":
            error, relative = TARGETS[row["case"]]
            remarks.append(
                f"closed-form, {row['case']}: {row['error']:.4f} (target {error}), 95th percentile of the relative"
                f" error {row['p95_relative']:.1%}" + (f" (target {relative:.0%})" if relative else "")
            )
    return rows, remarks


if __name__ == "__main__":
    for row in reflections():
        print(
            f"{row['case']:16} {row['method']:14} error {error_of(row):.5f} max {row['max_error']:.4f} "
            f"p95 {row['p95_relative']:.4f} {1e9 * row['seconds']:8.0f} ns {row['bytes']} bytes"
        )
