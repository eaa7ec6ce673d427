# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows `point` and `spot` of bench.py shafts: a lamp's light in even air, unshadowed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import progress
import sfumato
from airlight_rivals import Table, march
from bench_rows import AirlightRow

RAYS = 400  # for each peak and depth
REACHES = (0.1, 2.0, 20.0, 200.0)  # metres of air that takes 1 a metre
PEAKS = (-0.98, -0.5, 0.0, 0.3, 0.5, 0.76, 0.9, 0.98, 0.999)
AS_PUBLISHED = (0.0, 0.76, 0.98)  # the peaks that the table's own sample and its successor have, and none
EXTINCTION = 1.0
CONE = 0.8  # of the spot, radians; a hard edge, since a table of a point's light knows no other
DARK = 1e-30  # what no single precision holds is not compared
METRIC = "RMSE by the mean, of rays of one g in [-.98, .999] and optical reach in [.1, 200]; the median of these"


@dataclass
class Rays:
    """As the published table's error was measured: distances from the lamp by their logarithm, both ends anywhere."""

    h: np.ndarray
    s: np.ndarray  # (rays, 2) of eye and end, from the lamp's foot
    foot: np.ndarray  # (rays, 3) unit vectors from the lamp to its foot
    along: np.ndarray

    def place(self, s: np.ndarray) -> np.ndarray:
        return np.asarray(self.foot * self.h[:, None] + self.along * s[:, None])


def rays(reach: float, seed: int) -> Rays:
    rng = np.random.default_rng(seed)
    along, other = rng.standard_normal((2, RAYS, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    foot = np.cross(along, other)
    foot /= np.linalg.norm(foot, axis=1, keepdims=True)
    h = reach * np.exp(rng.uniform(np.log(1e-3), np.log(0.5), RAYS))
    return Rays(h, np.sort(rng.uniform(-reach, reach, (RAYS, 2)), 1), foot, along)


def lit(given: Rays, cone: float) -> tuple[np.ndarray, np.ndarray]:
    """Where each ray enters and leaves the cone around -z, by the quadratic of the double cone."""
    cosine2 = np.cos(0.5 * cone) ** 2
    p, e = -given.foot[:, 2] * given.h, -given.along[:, 2]
    a, b, c = e * e - cosine2, p * e, p * p - cosine2 * given.h**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
    first, second = np.sort([(-b - root) / a, (-b + root) / a], axis=0)
    within, onwards = (a < 0) & (p > 0) & (root >= 0), a > 0
    start = np.where(within, first, np.where(onwards & (e > 0), second, -np.inf))
    end = np.where(within, second, np.where(onwards & (e < 0), first, np.inf))
    none = ~(within | onwards)
    start = np.clip(start, given.s[:, 0], given.s[:, 1])
    end = np.clip(np.where(none, start, end), start, given.s[:, 1])
    return start, end


@dataclass
class Measured:
    errors: list[np.ndarray] = field(default_factory=list)  # relative, for each peak and depth
    by_mean: list[float] = field(default_factory=list)
    seconds: float = 0.0

    def add(self, run: Callable[[], np.ndarray], exact: np.ndarray) -> None:
        start = time.process_time()
        found = run()
        self.seconds += time.process_time() - start
        seen = exact > DARK
        self.errors.append(np.abs(found[seen] / exact[seen] - 1.0))
        self.by_mean.append(float(np.sqrt(np.mean((found - exact) ** 2)) / exact.mean()))


def case(name: str, cone: float) -> tuple[list[AirlightRow], list[str]]:
    methods = ("substitution", "substitution-12", "table", "march-16", "march")
    measured = {method: Measured() for method in methods}
    by_peak: dict[float, list[np.ndarray]] = {g: [] for g in PEAKS}
    for seed, (reach, g) in enumerate((reach, g) for reach in REACHES for g in PEAKS):
        given = rays(reach, seed)
        ways = given.place(given.s[:, 0]), given.place(given.s[:, 1])
        lamp: dict[str, Any] = {"position": (0, 0, 0), "extinction": EXTINCTION, "anisotropy": g, "cone": cone}
        exact = sfumato.reference.airlight(*ways, **lamp)
        start, end = lit(given, cone) if cone < 2 * np.pi else (given.s[:, 0], given.s[:, 1])
        table = Table(reach, EXTINCTION, g)
        eye = given.s[:, 0]
        measured["substitution"].add(lambda: sfumato.airlight(*ways, **lamp), exact)
        measured["substitution-12"].add(lambda: sfumato.airlight(*ways, **lamp, points=12), exact)
        measured["table"].add(lambda: table.sent(given.h, eye, start, end), exact)
        for steps, method in ((16, "march-16"), (512, "march")):
            measured[method].add(lambda: march(given.h, eye, start, end, EXTINCTION, g, steps), exact)
        by_peak[g].append(measured["substitution"].errors[-1])
    rows = []
    for method, own in measured.items():
        errors = np.concatenate(own.errors)
        rows.append(
            AirlightRow(
                case=name,
                method=method,
                metric=METRIC,
                error=float(np.median(own.by_mean)),
                seconds=own.seconds / RAYS / len(PEAKS) / len(REACHES),
                bytes=4 * 512 * 512 * 4 if method == "table" else None,
                p95=float(np.quantile(errors, 0.95)),
                max_error=float(errors.max()),
            )
        )
    worst = {g: np.concatenate(errors) for g, errors in by_peak.items()}
    said = ", ".join(f"{g:g}: {np.quantile(e, 0.95):.1e} ({e.max():.1e})" for g, e in worst.items())
    table_errors = measured["table"].errors[REACHES.index(20.0) * len(PEAKS) :]
    of_table = ", ".join(
        f"{g:g}: {np.median(e):.1%}, {np.quantile(e, 0.95):.0%}"
        for g, e in zip(PEAKS, table_errors)
        if g in AS_PUBLISHED
    )
    return rows, [
        f"{name}, substitution by g, 95th percentile (most): {said}",
        f"{name}, table at a reach of 20 by g, median, 95th percentile: {of_table}",
    ]


def points() -> tuple[list[AirlightRow], list[str]]:
    rows: list[AirlightRow] = []
    remarks: list[str] = []
    for name, cone in (("point", 2 * np.pi), ("spot", CONE)):
        progress.step(name)
        own, about = case(name, cone)
        rows += own
        remarks += about
    return rows, remarks
