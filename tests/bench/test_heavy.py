# SPDX-License-Identifier: GPL-3.0-or-later
"""The arithmetic of bench.py heavy, and what it does with programs that fail."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bench_heavy
import heavy_targets
from bench_rows import HeavyRow
from heavy_before import folder_of


def heavy_row(case: str, method: str, seconds: float, peak: int | None = None, error: float | None = None) -> HeavyRow:
    return HeavyRow(case=case, method=method, metric="", error=error, seconds=seconds, bytes=peak, again=None)


def test_heavy_cases_and_methods_can_be_chosen() -> None:
    assert bench_heavy.chosen(None, None) == {name: list(case.methods) for name, case in bench_heavy.CASES.items()}
    assert bench_heavy.chosen(["playback", "trail"], None) == {
        "playback": ["before", "sfumato"],
        "trail": ["before", "sfumato", "cycles-1"],
    }
    assert bench_heavy.chosen(["trail", "half-full"], ["cycles-1"]) == {"trail": ["cycles-1"], "half-full": []}
    with pytest.raises(ValueError, match="--case is 'trial', but must be one of camera-drag, "):
        bench_heavy.chosen(["trial"], None)
    with pytest.raises(ValueError, match="--method is 'cycles', but must be one of before, cycles-1, sfumato"):
        bench_heavy.chosen(None, ["cycles"])


def test_heavy_targets_name_rows_that_are_measured() -> None:
    known = {(name, method) for name, case in bench_heavy.CASES.items() for method in case.methods}
    known.add(("instances-20000", "bare-loop"))
    for target in heavy_targets.TARGETS:
        for number in (target.number, *target.over):
            assert not number.case or (number.case, number.method) in known, number


def test_heavy_targets_are_told_for_the_rows_that_are_there() -> None:
    rows = [
        heavy_row("instances-2000", "sfumato", 1.0, 120),
        heavy_row("instances-2000", "cycles-1", 4.0, 100),
        heavy_row("instances-20000", "sfumato", 5.0),
        heavy_row("instances-20000", "bare-loop", 0.5),
        heavy_row("lamp-drag", "sfumato", 0.2, None, 2e-5),
        heavy_row("lamp-drag", "before", 30.0),
        heavy_row("trail", "sfumato", 1.0, 260 << 20),
        heavy_row("plume", "sfumato", 1.0, None, 0.0043),
    ]
    assert heavy_targets.remarks(rows) == [
        "instances-2000: seconds 0.25 of cycles-1's, wanted at most 0.5: reached",
        "instances-2000: bytes 1.2 of cycles-1's, wanted at most 1.2: reached",
        "instances-20000: seconds 2 of twice instances-2000's and the bare loop's, wanted at most 1: missed",
        "lamp-drag: seconds 0.00667 of before's, wanted at most 0.01: reached",
        "lamp-drag: error 2e-05, wanted at most 1e-05: missed",
        "trail: bytes 260 MiB, wanted at most 130: missed",
        "plume: error 0.43 %, wanted at most 0.86: reached",
    ]
    without_loop = [row for row in rows if row["method"] != "bare-loop"]
    assert not any(remark.startswith("instances-20000") for remark in heavy_targets.remarks(without_loop))


def test_heavy_rows_are_medians_of_processes() -> None:
    answers = [{"seconds": s, "again": None, "bytes": 10 * s, "error": 0.1 * s} for s in (4.0, 1.0, 2.0)]
    row = bench_heavy.row_of("plume", "sfumato", answers)
    assert (row["seconds"], row["bytes"], row["again"]) == (2.0, 20, None) and row["error"] == pytest.approx(0.2)


def test_surfaces_differ_by_the_largest_of_their_differences() -> None:
    fresh = np.array([0.5, 0.25, 100.0, np.inf], np.float32)
    assert bench_heavy.largest_difference(fresh, fresh) == 0.0
    assert bench_heavy.largest_difference(fresh + np.array([0, 0.125, 0, 0], np.float32), fresh) == 0.125
    assert bench_heavy.largest_difference(fresh + np.array([0, 0, 25.0, 0], np.float32), fresh) == 0.25
    assert bench_heavy.largest_difference(np.array([0.5, 0.25, np.inf, np.inf], np.float32), fresh) == np.inf
    assert bench_heavy.relative_rmse(np.full((2, 2, 3), 1.5), np.full((2, 2, 3), 1.0)) == 0.5


def test_a_program_that_fails_or_never_ends_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    bench_heavy.run(["sh", "-c", "exit 0"], {})
    with pytest.raises(RuntimeError, match="sh ended with 4:\nwhy"):
        bench_heavy.run(["/bin/sh", "-c", "echo why; exit 4"], {})
    monkeypatch.setattr(bench_heavy, "LONGEST", 0.1)
    with pytest.raises(RuntimeError, match="sh is stopped after 0.1 s"):
        bench_heavy.run(["/bin/sh", "-c", "sleep 60"], {})


def test_an_interrupted_benchmark_keeps_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    def measure(name: str, *_: object) -> tuple[list[HeavyRow], list[str]]:
        if name != "half-full":
            raise KeyboardInterrupt
        return [heavy_row(name, "sfumato", 1.0)], []

    monkeypatch.setattr(bench_heavy, "measure", measure)
    rows, remarks = bench_heavy.heavy(case=["half-full", "dense-256"], method=["sfumato"])
    assert [row["case"] for row in rows] == ["half-full"]
    assert remarks == ["interrupted: what is above is all that was measured"]


def test_another_commit_is_built_in_the_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert folder_of("0123456789ab") == tmp_path / "sfumato" / "before-0123456789ab"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert folder_of("0123456789ab") == tmp_path / ".cache" / "sfumato" / "before-0123456789ab"
