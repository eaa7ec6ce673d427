# SPDX-License-Identifier: GPL-3.0-or-later
"""bench.py scenes: what light from the world costs and how right it is, beside the Cycles of an official Blender without
and with its denoiser."""

from __future__ import annotations

from bench_denoised import remarks, rows_of
from bench_rows import LightRow


def scenes() -> tuple[list[LightRow], list[str]]:
    """Rows of all cases, where Cycles stands in each, and what each costs beside the plume in its sun alone."""
    rows = rows_of("tests/bench/bench_scenes_in_blender.py")
    said: list[str] = []
    alone = next(row["seconds"] for row in rows if row["case"] == "plume" and row["method"] == "sfumato")
    for case in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == case]
        said += [f"{case}, {line}" for line in remarks(own)]
        said.append(f"{case}: {own[0]['seconds'] / alone:.3g} times the time of the plume in its sun")
    return rows, said
