# SPDX-License-Identifier: GPL-3.0-or-later
"""What bench.py heavy wants, and how its rows stand to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench_rows import HeavyRow

MIB = float(1 << 20)
GRID = 256.0**3 * 4.0  # bytes of dense-256's own


@dataclass(frozen=True)
class Number:
    """A column of one row, or with no case the number 1 itself, `times` over."""

    case: str = ""
    method: str = "sfumato"
    column: str = "seconds"
    times: float = 1.0


@dataclass(frozen=True)
class Target:
    """`number` over the sum of `over` is to be at most `most`."""

    number: Number
    over: tuple[Number, ...]
    most: float
    said: str  # what that sum is


def against(case: str, method: str, most: float, column: str = "seconds") -> Target:
    return Target(Number(case, column=column), (Number(case, method, column),), most, f"{method}'s")


def absolute(case: str, column: str, unit: float, most: float, said: str) -> Target:
    return Target(Number(case, column=column), (Number(times=unit),), most, said)


TARGETS = [
    against("triangles-4m", "cycles-1", 0.5),
    against("instances-2000", "cycles-1", 0.5),
    against("instances-2000", "cycles-1", 1.2, "bytes"),
    Target(
        Number("instances-20000"),
        (Number("instances-2000", times=2.0), Number("instances-20000", "bare-loop")),
        1.0,
        "twice instances-2000's and the bare loop's",
    ),
    against("lamp-drag", "before", 0.01),
    Target(Number("lamp-drag"), (Number("lamp-drag-15k"),), 1.5, "lamp-drag-15k's"),
    absolute("lamp-drag", "error", 1.0, 1e-5, ""),
    absolute("lamp-drag-15k", "error", 1.0, 1e-5, ""),
    against("camera-drag", "before", 0.5),
    against("playback", "before", 0.7),
    absolute("trail", "bytes", MIB, 130.0, "MiB"),
    against("trail", "cycles-1", 2.0),
    against("half-full", "before", 1.1),
    absolute("dense-256", "bytes", GRID, 4.0, "grids"),
    absolute("plume", "error", 0.01, 0.86, "%"),
    against("plume", "before", 0.6),
]


def remarks(rows: Sequence[HeavyRow]) -> list[str]:
    """A line for each target whose rows are all there."""
    known = {(row["case"], row["method"]): row for row in rows}

    def value(number: Number) -> float | None:
        if not number.case:
            return number.times
        row = known.get((number.case, number.method))
        found = row.get(number.column) if row is not None else None
        return number.times * float(found) if isinstance(found, (int, float)) else None

    out = []
    for target in TARGETS:
        top, parts = value(target.number), [value(number) for number in target.over]
        below = sum(part for part in parts if part is not None)
        if top is None or None in parts or not below > 0.0:
            continue
        ratio = top / below
        unit = target.said if not target.over[0].case else f"of {target.said}"
        out.append(
            f"{target.number.case}: {target.number.column} {ratio:.3g} {unit}".rstrip()
            + f", wanted at most {target.most:g}: {'reached' if ratio <= target.most else 'missed'}"
        )
    return out
