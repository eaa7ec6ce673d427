# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of `bench.py lights` that runs inside Blender: the plume in each light, by each method.

    blender -b plume.blend --python bench_lights_in_blender.py -- GOLDENS ROWS.json METHOD ...

GOLDENS is a folder of CASE.exr and of facts.json, which knows their noise. A METHOD is `sfumato-QUALITY` or
`cycles-SAMPLES`.
"""

from __future__ import annotations

import json
import math
import statistics
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import progress  # noqa: E402
from bench_in_blender import ENOUGH_SECONDS, choose, pixels, relative_rmse, seconds_of_render  # noqa: E402
from bench_rows import LightRow  # noqa: E402
from light_cases import CASES, put_lights, small_picture  # noqa: E402

RUNS = 3


def measure(case: str, method: str, golden: np.ndarray, noise: float, folder: Path) -> LightRow:
    runs = [seconds_of_render()]
    while len(runs) < RUNS and sum(runs) < ENOUGH_SECONDS:
        runs.append(seconds_of_render())
    result = folder / f"{case}-{method}.exr"
    bpy.data.images["Render Result"].save_render(str(result))
    error = relative_rmse(pixels(result), golden)
    return LightRow(
        case=case,
        method=method,
        metric="relative RMSE of the picture, against tests/goldens/lights",
        error=error,
        seconds=statistics.median(runs),
        bytes=None,
        noise=noise,
        # A golden's noise knows nothing of the rival's error, so their squares add up.
        true_error=math.sqrt(max(error**2 - noise**2, 0.0)),
    )


def main(goldens: Path, rows_path: Path, methods: list[str]) -> None:
    facts = json.loads((goldens / "facts.json").read_text(encoding="utf-8"))
    small_picture()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            put_lights(case)
            golden = pixels(goldens / f"{case}.exr")
            noise = facts["cases"][case]["noise"]
            engine = ""
            for method in methods:
                progress.step(f"{case}, {method}")
                choose(method)
                if bpy.context.scene.render.engine != engine:
                    engine = bpy.context.scene.render.engine
                    seconds_of_render()
                rows.append(measure(case, method, golden, noise, Path(folder)))
    rows_path.write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    goldens_argument, rows_argument, *method_arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(goldens_argument), Path(rows_argument), method_arguments)
