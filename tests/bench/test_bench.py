# SPDX-License-Identifier: GPL-3.0-or-later
"""The arithmetic behind the benchmark's speed-up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bench_heavy
import heavy_targets
from bench import growth, light_remarks, seconds_at_error, table
from bench_rows import CostRow, HeavyRow, LightRow, RayRow, Row
from heavy_before import folder_of


def noisy_rows(samples: list[int]) -> list[Row]:
    """A rival whose error is noise: 0.1 at one sample, which takes 0.5 s."""
    return [Row(case="", method=str(n), metric="", error=0.1 / n**0.5, seconds=0.5 * n, bytes=None) for n in samples]


@pytest.mark.parametrize("error", [0.1, 0.05, 0.03, 0.00625, 0.001])
def test_noise_costs_the_inverse_square_of_its_error(error: float) -> None:
    rows = noisy_rows([1, 4, 16, 64, 256])
    assert seconds_at_error(rows, error) == pytest.approx(0.5 * (0.1 / error) ** 2, rel=1e-12)
    assert seconds_at_error(rows[::-1], error) == seconds_at_error(rows, error)


def test_nothing_is_cheaper_than_the_cheapest_row() -> None:
    assert seconds_at_error(noisy_rows([4, 16]), 0.3) == 2.0


def test_zero_error_is_refused() -> None:
    with pytest.raises(ValueError, match="error must be positive, got 0"):
        seconds_at_error(noisy_rows([1]), 0.0)


def test_table_has_a_column_for_each_number() -> None:
    row = RayRow(
        case="smoke",
        method="fourier",
        metric="RMSE",
        error=0.026,
        seconds=0.5,
        bytes=None,
        look_up_seconds=None,
        coefficients=7,
        max_error=0.25,
        violations=3,
        swing=0.05,
        growth=0.02,
        outlier=0.9,
    )
    metric, names, numbers = table([row]).splitlines()
    assert metric == "error: RMSE"
    assert dict(zip(names.split(), numbers.split())) == {
        "case": "smoke",
        "method": "fourier",
        "error": "0.02600",
        "seconds": "0.50000",
        "bytes": "-",
        "look_up_seconds": "-",
        "coefficients": "7",
        "max_error": "0.25000",
        "violations": "3",
        "swing": "0.05000",
        "growth": "0.02000",
        "outlier": "0.90000",
    }


def columns(row: Row) -> dict[str, str]:
    """The table's cells of one row, by the name of their column."""
    _, names, numbers = table([row]).splitlines()
    return dict(zip(names.split(), numbers.split(), strict=True))


def light_row(method: str, error: float, seconds: float) -> LightRow:
    return LightRow(
        case="spot",
        method=method,
        metric="RMSE",
        error=(error**2 + 0.01**2) ** 0.5,
        seconds=seconds,
        bytes=None,
        noise=0.01,
        true_error=error,
    )


def test_lights_have_a_column_for_the_noise_of_the_golden() -> None:
    assert columns(light_row("sfumato-draft", 0.02, 0.1)) == {
        "case": "spot",
        "method": "sfumato-draft",
        "error": "0.02236",
        "seconds": "0.10000",
        "bytes": "-",
        "noise": "0.01000",
        "true_error": "0.02000",
    }


def test_ratio_to_cycles_is_free_of_the_noise_of_the_golden() -> None:
    rivals = [light_row(f"cycles-{n}", 0.1 / n**0.5, 0.5 * n) for n in (4, 16, 64)]
    ours = [light_row("sfumato-draft", 0.02, 0.1), light_row("sfumato-final", 0.001, 0.5)]
    # At draft's error Cycles takes 25 samples. Final's is below what the golden can tell, a quarter of its noise, where
    # Cycles takes 1600.
    (remark,) = light_remarks([*ours, *rivals])
    assert remark == "spot: Cycles needs as many times as long for Sfumato's error: draft 125, final at least 1.6e+03"


def cost_row(case: str, method: str, voxels: int, seconds: float) -> CostRow:
    return CostRow(
        case=case,
        method=method,
        metric="time",
        error=None,
        seconds=seconds,
        bytes=1088,
        voxels=voxels,
        texels=16,
        seconds_per_voxel=seconds / voxels,
    )


def test_cost_has_columns_for_voxels_and_texels() -> None:
    assert columns(cost_row("64^3", "map-128", 1000, 0.5)) == {
        "case": "64^3",
        "method": "map-128",
        "error": "-",
        "seconds": "0.50000",
        "bytes": "1088",
        "voxels": "1000",
        "texels": "16",
        "seconds_per_voxel": "5.00e-04",
    }


def test_growth_is_told_for_each_series_and_for_empty_space() -> None:
    rows = [
        cost_row("64^3", "map-128", 1000, 0.1),
        cost_row("64^3", "map-512", 1000, 0.4),
        cost_row("64^3 in 256^3", "map-512", 1000, 0.5),
        cost_row("128^3", "map-256", 8000, 0.8),
        cost_row("128^3", "map-512", 8000, 0.8),
    ]
    assert growth(rows) == [
        "128^3, map-512: 8.00 times the occupied cells of 64^3, map-512, in 2.00 times the time: exponent 0.33",
        "128^3, map-256: 8.00 times the occupied cells of 64^3, map-128, in 8.00 times the time: exponent 1.00",
        "64^3 in 256^3, map-512: 1.25 times the time without the empty space",
    ]


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
    assert bench_heavy.largest_difference(fresh + np.float32([0, 0.125, 0, 0]), fresh) == 0.125
    assert bench_heavy.largest_difference(fresh + np.float32([0, 0, 25.0, 0]), fresh) == 0.25
    assert bench_heavy.largest_difference(np.float32([0.5, 0.25, np.inf, np.inf]), fresh) == np.inf
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
