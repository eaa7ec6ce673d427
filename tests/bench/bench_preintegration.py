# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of bench.py preintegration: real smoke under ramps, and the tables that some ways through it need."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import progress
import sfumato
from bench_rows import RampRow, error_of
from ramp_cases import FRAMES, error, ramp, rays, smoke
from sfumato import PreintegratedTable, TransferFunction

STEPPED = ("post-classified", "mean-source", "full")
STEPS = (2.0, 1.0, 0.5, 0.25)
RAYS = 240
AUTO_ERROR = 2e-3  # asked for
ENTRIES = 1024
METRIC = "RMSE by the mean radiance; of a table, the most of any entry"


def fastest(run: Callable[[], object], times: int = 3) -> float:
    """Seconds of this process: what else the machine does is left out."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        run()
        seconds.append(time.process_time() - start)
    return min(seconds)


def row(case: str, method: str, off: float, seconds: float, step: float | None, samples: float | None) -> RampRow:
    table = ENTRIES if case.startswith("build") else 256 if method == "full" else 0
    return RampRow(
        case=case,
        method=method,
        metric=METRIC,
        error=off,
        seconds=seconds,
        bytes=16 * table * table or None,
        step=step,
        samples=samples,
    )


def ways(case: str, frame: str) -> tuple[list[RampRow], dict[float, str]]:
    """Half of the rays choose for `auto`; the others are measured. And for each step the method that is chosen where any
    error will do."""
    transfer, cells = ramp(case), smoke(frame)
    start, end = rays(cells, 2 * RAYS, seed=1)
    length = float(np.linalg.norm((end - start)[1::2], axis=1).sum())
    exact = sfumato.reference.sent_along(transfer, cells, start[1::2], end[1::2], 256)

    def measured(name: str, method: str, step: float | None) -> RampRow:
        def run() -> tuple[Any, ...]:
            return sfumato.classify(cells, start[1::2], end[1::2], transfer, method, step or 1.0)

        sent, samples = run()
        return row(case, name, error(sent, exact), fastest(run) / RAYS, step, float(samples.sum()) / length)

    def chosen(step: float, most: float) -> str:
        return sfumato.choose_classification(cells, start[::2], end[::2], transfer, step, most)[0]

    rows = [measured("split", "split", None)]
    for step in STEPS:
        rows += [measured(method, method, step) for method in STEPPED]
        rows.append(measured("auto", chosen(step, AUTO_ERROR), step))
    return rows, {step: chosen(step, 1e9) for step in STEPS}


def moved(stop: float) -> TransferFunction:
    """The four peaks, of which the last one's top lies elsewhere."""
    stops = [0.0, 0.17, 0.2, 0.23, 0.37, 0.4, 0.43, 0.57, 0.6, 0.63, 0.77, stop, 0.83, 1.0]
    extinction = np.array([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0])
    colour = 1.0 + 0.5 * np.sin(np.multiply.outer(stops, (9.0, 5.0, 3.0)))
    return TransferFunction(stops, extinction, colour, associated=False)


def another(transfer: TransferFunction) -> TransferFunction:
    """One that differs everywhere."""
    stops = np.linspace(0.0, 1.0, 9)
    values = transfer.at(stops)
    return TransferFunction(stops, values[:, 3] + 0.5, values[:, :3] + 0.1, associated=False)


def build_seconds(entries: int) -> float:
    """Of all entries of a table that is there: no memory is asked for."""
    table = PreintegratedTable(another(moved(0.8)), [1.0], entries)
    both = [moved(0.8), another(moved(0.8))]
    return min(fastest(lambda: table.rebuild(transfer), 1) for transfer in 3 * both)


def builds() -> tuple[list[RampRow], list[str]]:
    transfer = moved(0.8)
    rng = np.random.default_rng(1)
    i, j = rng.integers(ENTRIES, size=(2, 2000))
    i, j = i[i != j], j[i != j]
    rows, remarks = [], []
    worst = 0.0
    for depth in (1.0, 50.0):
        exact = sfumato.reference.sent(transfer, i / (ENTRIES - 1), j / (ENTRIES - 1), depth)
        table = PreintegratedTable(transfer, [depth], ENTRIES)
        found = table.values[0, i, j].astype(float)
        found[:, 3] = 1.0 - found[:, 3]
        worst = max(worst, float(np.abs(found - exact).max()))
        if depth == 1.0:
            progress.step("build-1024, direct")
            plain: list[np.ndarray] = []
            seconds = fastest(lambda: plain.append(sfumato.reference.table(transfer, depth, ENTRIES)), 1)
            off = float(np.abs(plain[0][i, j] - exact).max())
            rows.append(row("build-1024", "direct", off, seconds, None, None))
        else:
            remarks.append(f"build-1024: every entry finite at a depth of 50 a step: {np.isfinite(table.values).all()}")
    progress.step("build-1024")
    rows.append(row("build-1024", "full", worst, build_seconds(ENTRIES), None, None))
    direct, own = rows
    remarks.insert(
        0,
        f"build-1024: {direct['seconds'] / own['seconds']:.0f} times as fast as each entry by itself,"
        f" an error of {error_of(own):.1e} at depths of 1 and 50 a step",
    )
    sizes = (256, 512, 1024, 2048)
    seconds_of = [build_seconds(size) for size in sizes]
    exponents = [math.log(seconds_of[n + 1] / seconds_of[n]) / math.log(2.0) for n in range(len(sizes) - 1)]
    remarks.append(
        f"tables of {', '.join(map(str, sizes))} entries: {', '.join(f'{1e3 * s:.1f}' for s in seconds_of)} ms,"
        f" exponents {', '.join(f'{e:.2f}' for e in exponents)}"
    )
    table = PreintegratedTable(moved(0.8), [1.0], ENTRIES)
    stops = iter((0.81, 0.8, 0.81, 0.8, 0.81))
    part = fastest(lambda: table.rebuild(moved(next(stops))), 4)
    share = table.rebuild(moved(0.805)) / ENTRIES**2
    remarks.append(f"a stop of the last peak moves: {1e3 * part:.1f} ms for {100 * share:.0f} % of {ENTRIES}^2 entries")
    return rows, remarks


def said(name: str, rows: list[RampRow], loosest: dict[float, str]) -> str:
    by_step: dict[float, dict[str, RampRow]] = {}
    for each in rows:
        by_step.setdefault(each["step"] or 0.0, {})[each["method"]] = each
    split = by_step.pop(0.0)["split"]
    best = {step: min(error_of(own[method]) for method in STEPPED) for step, own in by_step.items()}
    auto = max(error_of(own["auto"]) / best[step] for step, own in by_step.items())
    loose = max(error_of(own[loosest[step]]) / best[step] for step, own in by_step.items())
    fine, coarse = (by_step[step]["post-classified"] for step in (STEPS[-1], 1.0))
    order = math.log(error_of(coarse) / error_of(fine)) / math.log(1.0 / STEPS[-1])
    return (
        f"{name}: split {100 * error_of(split):.4f} % at {split['samples'] or 0.0:.2f} samples a voxel; of the best that"
        f" steps, auto has at most {auto:.2f}, and {loose:.2f} where any error will do; post-classified is of order"
        f" {order:.2f} below a voxel"
    )


def preintegration() -> tuple[list[RampRow], list[str]]:
    rows: list[RampRow] = []
    remarks = []
    for case in ("smooth", "ramp", "peaks"):
        for frame in FRAMES:
            progress.step(f"{case}, {frame}")
            own, loosest = ways(case, frame)
            rows += own if frame == "plume" else []
            remarks.append(said(f"{case}, {frame}", own, loosest))
    more, about = builds()
    return rows + more, remarks + about
