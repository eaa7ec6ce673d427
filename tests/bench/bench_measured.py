# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py measured: what a frame says of its own error, against what the judge says, on scenes drawn from a seed."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import sfumato

from bench_rows import MeasuredRow
from planner_cases import Array, Case, case_of, judged
from progress import step

CASES = 40
PIXELS = 256
# As addon/props.py has them, with as many samples at edges.
QUALITIES: dict[str, tuple[dict[str, Any], int]] = {
    "draft": ({"coefficients": 7, "texels_per_cell": 1.0, "steps_per_cell": 0.5, "light_samples": 4}, 4),
    "preview": ({"coefficients": 15, "texels_per_cell": 2.0, "steps_per_cell": 1.0, "light_samples": 16}, 16),
    "final": ({"coefficients": 31, "texels_per_cell": 4.0, "steps_per_cell": 2.0, "light_samples": 36}, 64),
}


def measured_row(case: Case, exact: Array, method: str, seed: int) -> MeasuredRow:
    settings, edge_samples = QUALITIES[method]
    start = time.perf_counter()
    frame = sfumato.Frame(case.scene, **settings)
    images = frame.passes(case.camera, case.width, case.height, [], edge_samples=edge_samples, filter="box")
    seconds = time.perf_counter() - start
    picture = images["picture"]
    off = (picture.astype(float) - exact)[..., :3]
    found = frame.measure(case.camera, picture, pixels=PIXELS, seed=seed, filter="box")
    return {
        "case": case.name,
        "method": method,
        "metric": "relative RMSE of the picture, against the reference",
        "error": float(np.sqrt(np.mean(off**2)) / np.mean(exact[..., :3])),
        "seconds": seconds,
        "bytes": None,
        "reported": found.reported,
        "low": found.low,
        "high": found.high,
        "pixels": found.pixels,
        "measure_seconds": found.seconds,
    }


def remarks(rows: list[MeasuredRow]) -> list[str]:
    held = [row["low"] <= (row["error"] or 0.0) <= row["high"] for row in rows]
    ratios = [row["high"] / row["low"] if row["low"] > 0.0 else float("inf") for row in rows]
    each = np.median([row["measure_seconds"] / row["pixels"] for row in rows])
    bias = np.median([row["reported"] / (row["error"] or 1.0) for row in rows])
    return [
        f"the interval holds the true error in {np.mean(held):.1%} of {len(rows)}, wanted at least 90 %",
        f"high / low: {np.median(ratios):.3g} in the median, wanted at most 2, and {max(ratios):.3g} at most, wanted 4",
        f"reported / true: {bias:.3g} in the median; {1e3 * each:.3g} ms a pixel",
    ]


def measured(seed: int) -> tuple[list[MeasuredRow], list[str]]:
    rows: list[MeasuredRow] = []
    for number in range(CASES):
        case = case_of(seed, number)
        step(f"{number + 1} of {CASES}: {case.name}")
        exact = judged(case)
        rows += [measured_row(case, exact, method, number) for method in QUALITIES]
    return rows, remarks(rows)
