# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py scenes: how right and how fast pictures are of what scenes have beside smoke, against the Cycles of an official
Blender without and with its denoiser.

    bench.py scenes [--case CASE]...
"""

from __future__ import annotations

from collections.abc import Sequence

from bench_denoised import rows_of, series
from bench_rows import LightRow, seconds_at_error

CASES = (
    "plume grey-world sky hdri textured-floor nodes alpha glass-pane chrome closed-room room street".split()
)  # bench_scenes_in_blender.py has each
SMALL, TIMES, TIMES_ELSEWHERE = 0.03, 30.0, 10.0  # of an error up to the first, how many times as fast we want to be


def scenes(case: Sequence[str] | None = None) -> tuple[list[LightRow], list[str]]:
    """Rows of the cases, all or some, and what is reached in each. Raises ValueError for a name that is not known."""
    for name in case or ():
        if name not in CASES:
            raise ValueError(f"--case is '{name}', but must be one of {', '.join(CASES)}")
    rows = rows_of("tests/bench/bench_scenes_in_blender.py", ",".join(case or CASES))
    return rows, [reached([row for row in rows if row["case"] == name]) for name in case or CASES]


def reached(rows: list[LightRow]) -> str:
    """Of one case, Sfumato's first: how many times as long Cycles takes for its error, by the better of its two ways, and
    what was wanted. An error below a quarter of the judge's noise the judge cannot tell, and counts as that quarter."""
    ours = rows[0]
    error = max(ours["true_error"], 0.25 * ours["noise"])
    way, times = min(
        (
            (f"cycles{end}", seconds_at_error(_by_true_error(series(rows, "cycles", end)), error) / ours["seconds"])
            for end in ("", "-denoised")
        ),
        key=lambda each: each[1],
    )
    wanted = TIMES if ours["true_error"] <= SMALL else TIMES_ELSEWHERE
    said = f"{ours['case']}: {ours['true_error']:.2%}, for which {way} takes {times:.3g} times as long"
    least = next(row for row in rows if row["method"] == "cycles-1-denoised")["true_error"]
    if ours["true_error"] > least:
        return f"{said}: missed, since one denoised sample has {least:.2%}"
    return f"{said}, wanted {wanted:g}: {'reached' if times >= wanted else 'missed'}"


def _by_true_error(rows: Sequence[LightRow]) -> list[LightRow]:
    out = [row.copy() for row in rows]
    for row in out:
        row["error"] = max(row["true_error"], 1e-9)
    return out
