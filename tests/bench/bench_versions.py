# SPDX-License-Identifier: GPL-3.0-or-later
"""What each kind of lamp and material is in each Blender, asked of that Blender's own Cycles: the rows that tests inside
Blender print (tests/blender/pictures.py, beside_cycles)."""

from __future__ import annotations

import json
import subprocess
from typing import cast

import progress
from bench_rows import VersionRow
from blender_run import ROOT

TESTS = "light_power", "materials"
PATTERN = f"({'|'.join(TESTS)})$"
# Debian 12, then newer Debians, then official builds.
COMMANDS = (
    *(["tests/blender/start", "background", f"tests/blender/background/{name}.py"] for name in TESTS),
    ["tests/matrix", "--root", "trixie", PATTERN],
    ["tests/matrix", "--root", "sid", PATTERN],
    ["tests/official", "--tests", PATTERN],
)


EVERY_ROW = {"metric": "radiance over that of this version's Cycles, less 1", "bytes": None}


def rows_of(printed: str) -> list[VersionRow]:
    """The rows in what the tests printed; of equal cases and versions, as of both layouts of a build, the worst one."""
    found: dict[tuple[str, str], VersionRow] = {}
    for line in printed.splitlines():
        mark, _, text = line.partition(" ")
        if mark != "ROW":
            continue
        row = cast(VersionRow, EVERY_ROW | json.loads(text))
        key = row["case"], row["method"]
        if key not in found or abs(row["error"] or 0.0) > abs(found[key]["error"] or 0.0):
            found[key] = row
    return list(found.values())


def versions() -> tuple[list[VersionRow], list[str]]:
    """Rows by case and version, and for each version its worst case; where Cycles itself changed, the versions between
    which it did. A Blender that is not at hand has no rows and a remark."""
    rows: list[VersionRow] = []
    remarks = []
    for command in COMMANDS:
        progress.step(" ".join(command))
        done = subprocess.run(
            command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
        if done.returncode != 0:
            remarks.append(f"{' '.join(command)} ended with status {done.returncode}")
        rows += rows_of(done.stdout)
    rows.sort(key=lambda row: (row["case"], _number(row["method"])))
    return rows, remarks + worst(rows) + changes(rows)


def worst(rows: list[VersionRow]) -> list[str]:
    remarks = []
    for version in sorted({row["method"] for row in rows}, key=_number):
        there = [row for row in rows if row["method"] == version]
        row = max(there, key=lambda row: abs(row["error"] or 0.0))
        remarks.append(f"{version}: {len(there)} cases, the worst {row['case']}, {row['error']:+.2%}")
    return remarks


def changes(rows: list[VersionRow], least: float = 0.003) -> list[str]:
    """Where a version's Cycles differs from the one before by more than `least` and both their noises."""
    remarks = []
    for before, after in zip(rows, rows[1:]):
        if before["case"] != after["case"]:
            continue
        ratio = after["cycles"] / before["cycles"]
        if abs(ratio - 1.0) > least + 3.0 * (before["noise"] + after["noise"]):
            remarks.append(
                f"{after['case']}: Cycles {after['method']} shows {ratio:.3f} of what {before['method']} does"
            )
    return remarks


def _number(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split("."))
