# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of bench.py that runs inside Blender: time whole renders of the open scene, compare each with a golden.

    blender -b SCENE.blend --python tests/bench/bench_in_blender.py -- GOLDEN.exr ROWS.json METHOD ...

GOLDEN.json beside GOLDEN.exr gives the frame and the rectangle. A METHOD is `sfumato`, `sfumato-QUALITY` or
`cycles-SAMPLES`.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import progress  # noqa: E402

# A cheap render is repeated and its median taken, a costly one is not.
MOST_RUNS = 5
ENOUGH_SECONDS = 10.0


def pixels(path: Path) -> np.ndarray:
    """Scene-linear RGB of an EXR file, (height, width, 3), row 0 at the top."""
    image = bpy.data.images.load(str(path))
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    width, height = image.size
    bpy.data.images.remove(image)
    return values.reshape(height, width, 4)[::-1, :, :3].astype(np.float64)


def relative_rmse(image: np.ndarray, golden: np.ndarray) -> float:
    return float(np.sqrt(np.mean((image - golden) ** 2)) / np.mean(golden))


def choose(method: str) -> None:
    """Make the next render one by `method`."""
    scene = bpy.context.scene
    engine, _, setting = method.partition("-")
    scene.render.engine = engine.upper()
    if engine == "cycles":
        scene.cycles.samples = int(setting)
    elif setting:
        scene.sfumato.quality = setting.upper()


def seconds_of_render() -> float:
    start = time.perf_counter()
    bpy.ops.render.render()
    return time.perf_counter() - start


def median_seconds() -> float:
    runs = [seconds_of_render()]
    while len(runs) < MOST_RUNS and sum(runs) < ENOUGH_SECONDS:
        runs.append(seconds_of_render())
    return statistics.median(runs)


def main(golden_path: Path, rows_path: Path, methods: list[str]) -> None:
    scene = bpy.context.scene
    facts = json.loads(golden_path.with_suffix(".json").read_text(encoding="utf-8"))
    scene.frame_set(facts["frame"])
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR"
    settings.color_mode = "RGB"
    settings.color_depth = "32"
    x0, y0, x1, y1 = facts["rectangle"]
    golden = pixels(golden_path)
    rows = []
    warm = set()
    with tempfile.TemporaryDirectory() as folder:
        for method in methods:
            progress.step(method)
            choose(method)
            if scene.render.engine not in warm:
                seconds_of_render()
                warm.add(scene.render.engine)
            seconds = median_seconds()
            result = Path(folder) / f"{method}.exr"
            bpy.data.images["Render Result"].save_render(str(result))
            image = pixels(result)
            if image.shape != golden.shape:
                raise RuntimeError(f"{method} rendered {image.shape}, but {golden_path.name} is {golden.shape}")
            rows.append(
                {
                    "case": Path(bpy.data.filepath).stem,
                    "method": method,
                    "metric": "relative RMSE in the rectangle, against " + golden_path.stem,
                    "error": relative_rmse(image[y0:y1, x0:x1], golden[y0:y1, x0:x1]),
                    "seconds": seconds,
                    "bytes": None,
                }
            )
    rows_path.write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    golden_argument, rows_argument, *method_arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(golden_argument), Path(rows_argument), method_arguments)
