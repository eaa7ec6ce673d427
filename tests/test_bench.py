# SPDX-License-Identifier: GPL-3.0-or-later
"""The arithmetic behind the benchmark's speed-up."""

from __future__ import annotations

import pytest

from bench import seconds_at_error, table
from bench_rows import RayRow, Row


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
