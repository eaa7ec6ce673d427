# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py denoised: the plume by Sfumato, and by the Cycles of an official Blender, without and with its denoiser, which
Debian's Cycles does not have."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

import progress
from bench_rows import LightRow
from blender_run import ROOT

VERSION = "5.0.1"
CASES = "SFUMATO_BENCH_CASES"  # names with commas; none for all


def denoised() -> tuple[list[LightRow], list[str]]:
    """Rows of all methods, and for each way of Cycles where it stands. Raises RuntimeError where Blender fails."""
    rows = rows_of("tests/bench/bench_denoised_in_blender.py")
    return rows, remarks(rows)


def rows_of(script: str, cases: str = "") -> list[LightRow]:
    """What a script prints inside an official Blender, which finds `cases` in its environment. Whatever ends this ends
    Blender, too. Raises RuntimeError where that fails."""
    command = ["tests/official", "--script", script, VERSION]
    printed = []
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env=os.environ | {CASES: cases},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                printed.append(line)
                if line.startswith(progress.MARK):
                    print(line, end="", file=sys.stderr, flush=True)
            process.wait()
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)  # by which the shell passes it on
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{''.join(printed[-40:])}")
    return [json.loads(line[4:]) for line in printed if line.startswith("ROW ")]


def series(rows: list[LightRow], way: str, end: str) -> list[LightRow]:
    """The rows of `cycles` or `marching`, with the denoiser where `end` is `-denoised`, by samples."""
    return [row for row in rows if row["method"].startswith(f"{way}-") and (row["method"].count("-") == 2) == bool(end)]


def remarks(rows: list[LightRow]) -> list[str]:
    """For each way of Cycles, the cheapest row that has Sfumato's error; where none has, how close it comes."""
    ours = rows[0]
    said = []
    for way in ("cycles", "marching"):
        for end in ("", "-denoised"):
            own = series(rows, way, end)
            good = [row for row in own if row["true_error"] <= ours["true_error"]]
            row = min(good, key=_seconds) if good else min(own, key=_error)
            said.append(
                f"{way}{end}: {row['method']} {'has' if good else 'is the best,'} {row['true_error']:.2%} against "
                f"Sfumato's {ours['true_error']:.2%}, in {row['seconds'] / ours['seconds']:.3g} times its time"
            )
    return said


def _seconds(row: LightRow) -> float:
    return row["seconds"]


def _error(row: LightRow) -> float:
    return row["true_error"]
