# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of bench.py shafts: a room whose windows cut the sun's light, in one sun and in two; samples beside Cycles."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import progress
import sfumato
from bench_denoised import remarks as where_cycles_stands
from bench_denoised import rows_of
from bench_rows import LightRow, Row, ShaftRow
from shaft_cases import Array, distances, perspective, room, sun_map

# Pixels and texels: as published, and a preview's.
SIZES = {"": (2560, 1600, 2048), "-640": (640, 360, 1024)}
SUNS = np.array([(-0.75, -0.25, -0.42), (-0.6, 0.45, -0.3)])
STRENGTH = [(3.0, 3.0, 3.0), (2.0, 2.0, 2.0)]
AIR: dict[str, Any] = {"mie": (0.05, 0.05, 0.05), "anisotropy": 0.5}
METRIC = "RMSE by the mean radiance, against the march from texel to texel; p999 and max_error likewise"


def measured(case: str, method: str, view: tuple[Any, ...], exact: Array | None, times: int) -> tuple[ShaftRow, Array]:
    far, camera, maps, suns = view
    seconds = []
    for _ in range(times):
        start = time.process_time()
        made, texels, _ = sfumato.shafts(far, camera, maps, suns, STRENGTH[: len(maps)], method=method, **AIR)
        seconds.append(time.process_time() - start)
    mean = float(made.mean(dtype=float)) if exact is None else float(exact.mean(dtype=float))
    off = np.abs(made[..., 1] - (made if exact is None else exact)[..., 1]) / mean
    row = ShaftRow(
        case=case,
        method=method,
        metric=METRIC,
        error=float(np.sqrt(np.mean(off.astype(float) ** 2))),
        seconds=min(seconds),
        bytes=None,
        p999=float(np.quantile(off, 0.999)),
        max_error=float(off.max()),
        texels=texels / far.size,
    )
    return row, made


def windows() -> tuple[list[Row], list[str]]:
    """Seconds are of all processors, without SolidMap's, which is made once for a light."""
    boxes = room()
    rows: list[ShaftRow] = []
    remarks: list[str] = []
    for name, (width, height, texels) in SIZES.items():
        progress.step(f"a room of {width} x {height} pixels and {texels} x {texels} texels")
        camera = sfumato.Camera(perspective(np.array((-3.2, -2.0, 1.6)), np.array((3.0, 1.2, 1.3)), width, height))
        far = distances(boxes, camera, width, height)
        depths = [sun_map(boxes, sun, texels) for sun in SUNS]
        start = time.process_time()
        maps = [sfumato.SolidMap(*depth) for depth in depths]
        remarks.append(f"window{name}: {(time.process_time() - start) / 2:.3f} s to make one SolidMap")
        for case, lights in (("window", 1), ("two-lights", 2)):
            view = (far, camera, maps[:lights], SUNS[:lights])
            truth, exact = measured(case + name, "march", view, None, 1)
            own = [
                measured(case + name, method, view, exact, 3)[0] for method in ("minmax", "epipolar", "epipolar-fine")
            ]
            rows += [truth, *own]
            remarks += [
                f"{case}{name}: {r['method']} is {truth['seconds'] / r['seconds']:.3g} times as fast" for r in own
            ]
    seconds = {(row["case"], row["method"]): row["seconds"] for row in rows}
    for name in SIZES:
        ratio = seconds["two-lights" + name, "epipolar"] / seconds["window" + name, "epipolar"]
        remarks.append(f"two-lights{name}: {ratio:.2f} times the time of one")
    return [*rows], remarks


def samples() -> tuple[list[LightRow], list[str]]:
    """Samples by Sfumato and by the Cycles of an official Blender, without and with its denoiser."""
    rows = rows_of("tests/bench/bench_shafts_in_blender.py")
    said: list[str] = []
    for case in dict.fromkeys(row["case"] for row in rows):
        said += [f"{case}, {line}" for line in where_cycles_stands([row for row in rows if row["case"] == case])]
    return rows, said
