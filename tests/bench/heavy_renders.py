# SPDX-License-Identifier: GPL-3.0-or-later
"""The side of `bench.py heavy` that renders in Blender's background: one case by one method, in a process of its own.

    blender -b --factory-startup --addons sfumato --python heavy_renders.py -- CASE METHOD FOLDER

Leaves CASE-METHOD.json and the picture, CASE-METHOD.npy, in FOLDER, where trail.vdb is. Times are of all processors,
user and system (time.process_time is the sum of os.times, in finer steps).
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from itertools import islice
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parent))
import heavy_scenes  # noqa: E402
from bench_in_blender import choose, pixels, relative_rmse  # noqa: E402
from peak_memory import peak_bytes  # noqa: E402

Image = NDArray[np.float64]

GOLDEN = Path(__file__).resolve().parents[1] / "goldens" / "plume_cycles.exr"
MOST_AGAIN = 3
ENOUGH_SECONDS = 10.0  # of processors
LOOP_INSTANCES, LOOP_RUNS = 18000, 5


def engine_of(method: str) -> None:
    """Sfumato of whichever build, or Cycles with light that scatters once and nothing that hides its noise."""
    choose(method if method.startswith("cycles") else "sfumato")
    cycles = bpy.context.scene.cycles
    cycles.device = "CPU"
    cycles.volume_bounces = 0
    cycles.use_denoising = False


def seconds_of_render() -> float:
    start = time.process_time()
    bpy.ops.render.render()
    return time.process_time() - start


def bare_loop() -> float:
    """What Blender's Python itself takes to visit so many instances and copy where they are."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    runs = []
    for _ in range(LOOP_RUNS):
        start = time.process_time()
        matrices = [instance.matrix_world.copy() for instance in islice(depsgraph.object_instances, LOOP_INSTANCES)]
        runs.append(time.process_time() - start)
        if len(matrices) != LOOP_INSTANCES:
            raise RuntimeError(f"the scene has {len(matrices)} instances, fewer than {LOOP_INSTANCES}")
    return statistics.median(runs)


def picture_of(folder: Path, name: str) -> Image:
    """What was rendered last, scene-linear."""
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    path = folder / f"{name}.exr"
    bpy.data.images["Render Result"].save_render(str(path))
    return pixels(path)


def error_of_plume(picture: Image) -> float:
    x0, y0, x1, y1 = json.loads(GOLDEN.with_suffix(".json").read_text(encoding="utf-8"))["rectangle"]
    return relative_rmse(picture[y0:y1, x0:x1], pixels(GOLDEN)[y0:y1, x0:x1])


def main(case: str, method: str, folder: Path) -> None:
    heavy_scenes.open_empty()
    engine_of(method)
    seconds_of_render()  # kernels, threads, the module
    before = peak_bytes()
    heavy_scenes.MAKERS[case](folder)
    engine_of(method)
    bpy.context.view_layer.update()
    first = seconds_of_render()
    again: list[float] = []
    while len(again) < MOST_AGAIN and first + sum(again) < ENOUGH_SECONDS:
        again.append(seconds_of_render())
    peak = peak_bytes() - before
    picture = picture_of(folder, f"{case}-{method}")
    np.save(folder / f"{case}-{method}.npy", picture)
    answer = {
        "seconds": first,
        "again": statistics.median(again) if again else None,
        "bytes": peak,
        "error": error_of_plume(picture) if case == "plume" else None,
        "bare_loop": bare_loop() if case == "instances-20000" else None,
    }
    (folder / f"{case}-{method}.json").write_text(json.dumps(answer), encoding="utf-8")


if __name__ == "__main__":
    case_argument, method_argument, folder_argument = sys.argv[sys.argv.index("--") + 1 :]
    main(case_argument, method_argument, Path(folder_argument))
